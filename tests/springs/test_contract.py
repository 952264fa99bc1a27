"""What every spring promises: balance, energy, invariance, honest stiffness, complete output."""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from bench import Bench, Law, assert_balanced, written

from crashsolve.deck.laws import package_folder

CURVES = """
curves:
  soft: {points: [[-3, -400], [-1, -200], [0, 0], [1, 200], [3, 400]], extrapolate: linear}
  smooth:
    points: [[-4, -900], [-2, -300], [0, 0], [2, 300], [4, 900]]
    interpolation: cubic
    extrapolate: linear
  low: {points: [[-3, -100], [-0.5, 0], [0, 0], [0.5, 0], [3, 100]], extrapolate: linear}
  pushes: {points: [[0, 0], [1, 50], [5, 900]], extrapolate: linear}
  growth: {points: [[0, 1], [2, 1.4], [50, 2]], extrapolate: hold}
  shock: {points: [[-1, -60], [0, 0], [1, 37]], extrapolate: linear}
  oil: {points: [[-2, -90], [-1, -20], [0, 0], [1, 20], [2, 90]], interpolation: cubic,
    extrapolate: linear}
materials:
  cork: {type: elastic, young: 2e6, poisson: 0.3, density: 1}
  lead:
    {type: elastoplastic, young: 2e6, poisson: 0.3, density: 1, yield_stress: 3e4, hardening: 1e5}
sections: {bar: {type: rectangle, width: 0.01, height: 0.016}}
"""
POINTS = "a: a, b: b, at_a: [0.1, 0, 0.2], at_b: [0, 0.2, -0.1]"
# of two rigid segments, where the ends of a spring are two sides of one cut
CUT = "a: a, b: b, at_a: [0.1, 0, 0.2], at_b: [-0.67514343, -0.00563788, -0.33786027]"
BEAM = "axis: [1, 0, 2], side: [0, 1, 0], length: 0.4, section: bar"
AXIS = "a: a, b: b, axis: [1, 2, -1]"
# every spring whose force follows from configuration and velocity alone, in each of its ways
REVERSIBLE = {
    "linear": f"{{type: linear, {POINTS}, stiffness: 50, damping: 3, length: 0.7}}",
    "damper": f"{{type: damper, {POINTS}, curve: shock}}",
    "smooth damper": f"{{type: damper, {POINTS}, curve: oil}}",
    "torsional": f"{{type: torsional, {AXIS}, stiffness: 40, damping: 2, angle: 0.3}}",
    "bushing": f"{{type: bushing, {POINTS}, stiffness: [50, 90, 20], damping: [1, 2, 3],"
    " rotational_stiffness: [30, 10, 20], rotational_damping: [0.5, 1, 0.2],"
    " offset: [0.5, 0.1, 0]}",
    "segment": f"{{type: segment, {CUT}, {BEAM}, material: cork, damping: 0.02}}",
    "curve": f"{{type: curve, {POINTS}, curve: smooth, damping: 2, length: 0.6}}",
    "curve_torsional": f"{{type: curve_torsional, {AXIS}, curve: smooth, damping: 2, angle: -0.6}}",
    "curve with growth": f"{{type: curve, {POINTS}, curve: soft, rate_curve: growth, length: 0.5}}",
    "curve with power law": f"{{type: curve, {POINTS}, curve: soft, power_law: {{}}, length: 0.5}}",
    "cable": "{type: cable, through: [{body: a, at: [0.1, 0, 0.2]}, {body: b,"
    " at: [0.3, -2, 0.4]}, {body: a, at: [0, 0.2, -0.1]}, {body: b, at: [1, 1, 3]}],"
    " stiffness: 50, damping: 0.3, length: 0.5}",
    "anti_roll_bar": "{type: anti_roll_bar, body: a, at: [0.1, 0.2, 0], axis: [1, 2, 0],"
    " left: {arm: [0.1, 0.1, 1.6], body: b, at: [1, -1, 0.5]},"
    " right: {arm: [0.3, 0.4, -1.4], body: b, at: [1, 0, -0.5]}, stiffness: 50}",
    "strut": f"{{type: strut, {POINTS}, stiffness: 50, length: 0.7, bump_damping: 1,"
    " rebound_damping: 4}",
    "strut in bump": f"{{type: strut, {POINTS}, stiffness: 50, length: 0.7, bump_length: 3,"
    " bump_stiffness: 90, bump_damping: 2, rebound_damping: 1}",
    "strut in rebound": f"{{type: strut, {POINTS}, curve: smooth, length: 0.7,"
    " damping_curve: soft, rebound_length: 0.1, rebound_curve: pushes}",
    "curve with gap": f"{{type: curve, {POINTS}, curve: soft, gap: 0.02, length: 0.4}}",
}
# path-dependent springs
SLIDING = {
    "set": f"{{type: curve, {POINTS}, curve: smooth, unloading_stiffness: 1200, length: 0.9}}",
    "set with gap": f"{{type: curve, {POINTS}, curve: soft, unloading_stiffness: 900, length: 0.6,"
    " gap: 0.01}",
    "set one way": f"{{type: curve, {POINTS}, curve: soft, unloading_stiffness: 900, length: 2,"
    " acts: compression}",
    "between": f"{{type: curve, {POINTS}, curve: smooth, unloading_curve: low,"
    " unloading_stiffness: 1200, length: 0.9}",
    "torsional set": f"{{type: curve_torsional, {AXIS}, curve: soft, unloading_stiffness: 900}}",
    "elastoplastic": f"{{type: elastoplastic, {POINTS}, stiffness: 900, yield_force: 60}}",
    "isotropic": f"{{type: elastoplastic, {POINTS}, stiffness: 900, yield_force: 60,"
    " tangent: 200}",
    "kinematic": f"{{type: elastoplastic, {POINTS}, stiffness: 900, yield_force: 60, tangent: 200,"
    " hardening: kinematic}",
    "segment that yields": f"{{type: segment, {CUT}, {BEAM}, material: lead}}",
    "brake along": f"{{type: brake, {POINTS}, axis: [1, 0, 2], force: 50, stiffness: 800}}",
    "brake across": f"{{type: brake, {POINTS}, axis: [1, 0, 2], force: 50, stiffness: 800,"
    " motion: across}",
}
ALL = REVERSIBLE | SLIDING
Make = Callable[..., Law]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    def spring(case: str, seed: int | None = None, **motion: float) -> Law:
        """A spring, its bodies somewhere and in motion where there is a seed."""
        law = Bench(tmp_path, f"{CURVES}springs:\n  s: {ALL[case]}\n").law("springs", "s")
        if seed is not None:
            law.bench.shake(seed, **motion)
        return law

    return spring


def each(cases: dict[str, str]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("case", list(cases))


def test_every_spring_is_under_this_contract() -> None:
    laws = {path.stem for path in (package_folder() / "springs").glob("[!_]*.py")}
    # limits and friction act on a joint and are tested with the joints
    laws = {law for law in laws if not law.endswith(("_limit", "_stop", "_friction"))}
    assert laws == {text.split("type: ")[1].split(",")[0] for text in ALL.values()}


@each(ALL)
@pytest.mark.parametrize("seed", range(4))
def test_action_equals_reaction_also_in_moment(make: Make, case: str, seed: int) -> None:
    law = make(case, seed)
    law.force()
    assert_balanced(law.bench.nodes)


@each(ALL)
@pytest.mark.parametrize("seed", range(4))
def test_every_column_is_written_and_the_past_is_kept(make: Make, case: str, seed: int) -> None:
    law = make(case, seed)
    before = law.old.tobytes()
    law.force()
    module: ModuleType = law.module
    assert written(law.new, module.HISTORY)
    assert written(law.out, module.OUTPUT)
    assert np.isfinite([law.out.stored, law.out.power, law.out.loss]).all()
    assert law.old.tobytes() == before


@each(REVERSIBLE)
@pytest.mark.parametrize("seed", range(4))
def test_power_on_the_bodies_is_what_is_no_longer_stored(make: Make, case: str, seed: int) -> None:
    law = make(case, seed)
    out = law.force()
    given, lost = law.power_on_bodies(), float(out.power)
    # central difference: relative error h^2 = 1e-10 times speeds and curvatures of a few units,
    # and round-off of up to 100 J, 1e-14 / 1e-5
    assert given == pytest.approx(-law.growth(1e-5) - lost, rel=1e-8, abs=1e-8)
    assert lost >= 0.0


@each(REVERSIBLE)
@pytest.mark.parametrize("seed", range(3))
def test_without_speed_the_force_is_the_gradient_of_the_energy(
    make: Make, case: str, seed: int
) -> None:
    law = make(case, seed, speed=0.0)
    law.force()
    force, torque = law.bench.nodes.force.copy(), law.bench.nodes.torque.copy()
    start = law.bench.state()
    for node in (1, 2):
        for axis in np.eye(3):
            stored = []
            for step in (-1e-5, 1e-5, -1e-5, 1e-5):
                law.bench.nodes[:] = start
                if len(stored) < 2:
                    law.bench.move(node, r=law.bench.nodes[node].r + step * axis)
                else:
                    law.bench.rotation(node, step * axis)
                stored.append(float(law.force().stored))
            # central differences as above; third derivatives of the energy are below 1e3
            assert (stored[0] - stored[1]) / 2e-5 == pytest.approx(force[node] @ axis, abs=1e-6)
            assert (stored[2] - stored[3]) / 2e-5 == pytest.approx(torque[node] @ axis, abs=1e-6)


@each(ALL)
@pytest.mark.parametrize("seed", range(3))
def test_a_common_rigid_motion_has_no_effect(make: Make, case: str, seed: int) -> None:
    law = make(case, seed)
    out = law.force()
    before = [float(out.stored), float(out.power), float(out.loss)]
    force = law.bench.nodes.force[2].copy()
    R = law.bench.carry_away()
    out = law.force()
    # the same numbers but for round-off of products with entries up to 1e3
    after = [float(out.stored), float(out.power), float(out.loss)]
    np.testing.assert_allclose(after, before, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(law.bench.nodes.force[2], R @ force, atol=1e-10)


@each(REVERSIBLE)
@pytest.mark.parametrize("seed", range(4))
def test_stiffness_for_the_step_bounds_the_highest_frequency(
    make: Make, case: str, seed: int
) -> None:
    """2 max_i stiffness_i is not below the largest eigenvalue of M^-1 K (system.timestep)."""
    law = make(case)
    law.bench.shake(seed, speed=0.0, rotation=0.3)
    law.force()
    bound = 2.0 * law.bench.nodes.stiffness[1:].max()
    start = law.bench.state()

    def acceleration(k: int, step: float) -> np.ndarray:
        law.bench.nodes[:] = start
        node, axis = 1 + k // 6, np.eye(3)[k % 3]
        if k % 6 < 3:
            law.bench.move(node, r=law.bench.nodes[node].r + step * axis)
        else:
            law.bench.rotation(node, step * axis)
        law.force()
        n = law.bench.nodes
        W = n.W[1:].reshape(2, 3, 3)
        linear = n.force[1:] * n.mass_inv[1:, None]
        return np.stack([linear, np.einsum("nij,nj->ni", W, n.torque[1:])], axis=1).ravel()

    columns = [(acceleration(k, 1e-6) - acceleration(k, -1e-6)) / 2e-6 for k in range(12)]
    highest = np.linalg.eigvals(-np.array(columns).T).real.max()
    # 1 % for the turning of the line of force, which the bound leaves out (F / l against k)
    assert highest <= 1.01 * bound
