"""What tyres promise: forces within friction, smooth, of a known energy, on any road."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench import BODIES, Bench, Law, assert_balanced, refusal, written

from crashsolve.foundation.rows import as_rows
from crashsolve.tyres import fiala, gim
from crashsolve.tyres._road import profile_distance

C_X, C_Y, MU, F_Z, LENGTH = 8e4, 6e4, 0.9, 3000.0, 0.15
BRUSHES = {"gim": gim.brush, "fiala": fiala.forces}
SLIPS = [(s * np.cos(a), s * np.sin(a)) for s in (1e-3, 0.02, 0.1, 0.5, 1) for a in range(12)]


def brush(name: str, s_x: float, s_y: float, mu: float = MU) -> np.ndarray:
    return np.array(BRUSHES[name](C_X, C_Y, s_x, s_y, mu, F_Z, LENGTH))


@pytest.mark.parametrize("name", BRUSHES)
def test_the_slopes_at_zero_are_the_stiffnesses(name: str) -> None:
    s = 1e-7
    # the force falls below the slope by C s / mu F_z, 3e-6
    assert brush(name, s, 0.0)[0] / s == pytest.approx(C_X, rel=1e-5)
    assert brush(name, 0.0, s)[1] / s == pytest.approx(C_Y, rel=1e-5)
    # the trail of the parabola is a sixth of the patch
    assert -brush(name, 0.0, s)[2] / (C_Y * s) == pytest.approx(LENGTH / 6.0, rel=1e-5)


@pytest.mark.parametrize("name", BRUSHES)
@pytest.mark.parametrize("s_x, s_y", SLIPS)
def test_the_force_stays_within_friction_and_opposes_the_slip(
    name: str, s_x: float, s_y: float
) -> None:
    F = brush(name, s_x, s_y)
    # round-off of sums of numbers of 3e3
    assert np.hypot(F[0], F[1]) <= MU * F_Z * (1.0 + 1e-14)
    assert F[0] * s_x >= 0.0 and F[1] * s_y >= 0.0
    mirrored = brush(name, -s_x, s_y)
    assert mirrored[:2] == pytest.approx([-F[0], F[1]], rel=1e-13)


@pytest.mark.parametrize("name", BRUSHES)
@pytest.mark.parametrize("angle", [0.0, 0.4, 1.1, np.pi / 2])
def test_the_force_is_continuous_up_to_full_sliding(name: str, angle: float) -> None:
    s = np.linspace(0.0, 1.5, 30001)
    F = np.array([brush(name, x * np.cos(angle), x * np.sin(angle)) for x in s])
    # the largest slope is C_X: a step of 5e-5 changes the force by 4 N at most
    assert np.abs(np.diff(F[:, :2], axis=0)).max() <= C_X * 5e-5 * 1.01
    assert np.abs(np.diff(F[:, 2])).max() <= C_Y * 5e-5 * LENGTH
    assert np.hypot(*F[-1, :2]) == pytest.approx(MU * F_Z, rel=1e-2 if name == "fiala" else 1e-12)


@pytest.mark.parametrize("s_y", [1e-4, 1e-2, 0.05, 0.1349, 0.2, 1.0, -0.03])
def test_across_the_wheel_the_two_laws_are_one(s_y: float) -> None:
    # the same polynomial in two forms: round-off of numbers of 3e3
    np.testing.assert_allclose(brush("gim", 0, s_y)[:3], brush("fiala", 0, s_y)[:3], atol=1e-11)


@pytest.mark.parametrize("angle", np.linspace(0.0, 1.5, 7))
def test_with_equal_stiffnesses_friction_is_a_circle(angle: float) -> None:
    for s in (0.01, 0.05, 0.3):
        F = gim.brush(C_Y, C_Y, s * np.cos(angle), s * np.sin(angle), MU, F_Z, LENGTH)
        H = max(1.0 - C_Y * s / (3.0 * MU * F_Z), 0.0)
        assert np.hypot(F[0], F[1]) == pytest.approx(MU * F_Z * (1 - H**3), rel=1e-12)


def test_the_energy_of_the_carcass_is_the_work_of_the_brush() -> None:
    class P:
        C_x, C_y, sigma_x, sigma_y = C_X, C_Y, 0.1, 0.3

    for q_x, q_y in ((1e-3, 0.0), (0.0, 5e-3), (4e-3, -9e-3), (0.03, 0.05)):
        grip: Any = type("Grip", (), {"q_x": q_x, "q_y": q_y, "mu": MU, "F_z": F_Z})
        t = (np.arange(4000) + 0.5) / 4000
        F = np.array([brush("gim", x * q_x / 0.1, x * q_y / 0.3) for x in t])
        work = (F[:, 0] * q_x + F[:, 1] * q_y).mean()
        # the midpoint rule of 4000 parts: a corner at full sliding costs some 1e-7
        assert gim.carcass_energy(P, grip) == pytest.approx(work, rel=1e-6)


ROADS = """
surfaces:
  level: {type: plane, body: a, at: [0, 0, -0.25], normal: [0.1, 0.2, 1]}
  kerb: {type: box, body: a, at: [1.0, 0.3, -0.2], size: [0.9, 1.2, 0.4],
         rotation: {axis: [0, 0, 1], angle: 0.2}}
  hill:
    {type: mesh, body: a, vertices: [[-2, -2, 0], [2, -2, 0], [2, 2, 0.3], [-2, 2, 0]],
    faces: [[0, 1, 2], [0, 2, 3]], thickness: 1}
"""
WORDS = (
    "wheel: b, axis: [0.1, 1, 0.2], at: [0, -0.1, 0], radius: 0.7, damping: 20,"
    " slip_stiffness: 300, cornering_stiffness: 200, camber_stiffness: 50, friction_max: 0.8,"
    " friction_min: 0.6, rolling_resistance: 0.02, side_stiffness: 400"
)
TYRES = {
    "gim": f"{{type: gim, road: [level], stiffness: 900, {WORDS}}}",
    "gim on a kerb": f"{{type: gim, road: [level, kerb], stiffness: 900, {WORDS}}}",
    "gim on a mesh": f"{{type: gim, road: [hill], stiffness: 900, {WORDS}}}",
    "fiala": f"{{type: fiala, road: [level], stiffness: 900, {WORDS}}}",
    "fiala on a curve": f"{{type: fiala, road: [kerb, level], curve: y, {WORDS}}}",
}
CURVE = "curves: {y: {points: [[0, 0], [0.1, 90], [2, 4000]], extrapolate: linear}}\n"


def tyre(folder: Path, text: str) -> Law:
    return Bench(folder, f"{CURVE}{ROADS}tyres: {{t: {text}}}\n").law("tyres", "t")


def act(law: Law, h: float = 1e-3) -> Any:
    """Forces of the tyre, with its meshes where it has some."""
    group = next(g for g in law.bench.model.groups if g.keyword == "tyres")
    if not group.data:
        return law.force(h)
    kernel, data = law.kernel, tuple(as_rows(table) for table in group.data)
    law.kernel = lambda *args: law.module.force_with_tables(*args, data)
    try:
        return law.force(h)
    finally:
        law.kernel = kernel


@pytest.mark.parametrize("name", TYRES)
def test_wheel_and_road_bear_opposite_forces_also_in_moment(tmp_path: Path, name: str) -> None:
    law = tyre(tmp_path, TYRES[name])
    start, touched = law.bench.state(), 0
    for seed in range(24):
        law.bench.nodes[:] = start
        law.bench.shake(seed, rotation=0.4)
        before = law.old.tobytes()
        out = act(law)
        assert written(law.new, law.module.HISTORY) and written(law.out, law.module.OUTPUT)
        assert law.old.tobytes() == before
        if out.normal > 0.0:
            touched += 1
            assert_balanced(law.bench.nodes)
            force = law.bench.nodes.force[2]
            np.testing.assert_allclose(out.force, force, atol=1e-12)
            assert np.hypot(out.longitudinal, out.lateral) <= 0.8 * out.normal * (1 + 1e-12)
    assert touched >= 4


@pytest.mark.parametrize("name", TYRES)
def test_power_is_what_is_stored_and_lost(tmp_path: Path, name: str) -> None:
    """At rest in the carcass: the vertical spring alone stores, and all else is lost."""
    law = tyre(tmp_path, TYRES[name])
    start, touched = law.bench.state(), 0
    for seed in range(24):
        law.bench.nodes[:] = start
        law.bench.shake(seed, rotation=0.4)
        out = act(law, 0.0)
        # within half a radius of an edge its normal turns too fast for this
        if out.normal == 0.0 or out.depth > 0.35:
            continue
        touched += 1
        given, lost = law.power_on_bodies(), float(out.power)
        moved, stored = law.bench.state(), []
        for t in (-1e-6, 1e-6):
            law.bench.nodes[:] = moved
            law.bench.drift(t)
            stored.append(float(act(law, 0.0).stored))
        # central difference of energies of 1e2 J over 2e-6 s: round-off 1e-14 / 1e-6. A wheel that
        # leans on an edge turns the normal as it moves, which the force leaves out
        close = 1e-2 if "kerb" in TYRES[name] else 1e-6
        assert given == pytest.approx(-(stored[1] - stored[0]) / 2e-6 - lost, rel=close, abs=1e-6)
    assert touched >= 4


@pytest.mark.parametrize("seed", range(5))
def test_the_distance_from_a_profile_is_the_least(seed: int) -> None:
    from crashsolve.foundation.curve import pack

    x = np.linspace(-3, 3, 61)
    slope, y = 0.3 * np.cos(2 * x), 0.15 * np.sin(2 * x)
    c = np.array(
        [
            [y[i], slope[i], *np.linalg.solve([[0.01, 1e-3], [0.2, 0.03]],
             [y[i + 1] - y[i] - 0.1 * slope[i], slope[i + 1] - slope[i]])]
            for i in range(60)
        ]
    )  # fmt: skip
    points, starts = pack([(x, c, 1)])
    curves = as_rows(points)
    rng = np.random.default_rng(seed)
    at = (rng.uniform(-2, 2), 0.0, rng.uniform(0.3, 0.6))
    distance, n, _ = profile_distance(curves, starts[0], 2.0, at)
    s = np.linspace(-3, 3, 60001)
    brute = np.hypot(s - at[0], 0.15 * np.sin(2 * s) - at[2]).min()
    # the grid is 1e-4 fine and the cubics follow the sine to 1e-6
    assert distance == pytest.approx(brute, abs=3e-6)
    assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("seed", range(20))
def test_corners_steps_and_troughs_of_a_profile_have_their_true_distance(seed: int) -> None:
    from crashsolve.foundation.curve import pack

    rng = np.random.default_rng(seed)
    # steps of 1 mm and slopes of 45 degrees: a wheel may lie on any corner, or on two
    x = np.cumsum(rng.choice([1e-3, 0.05, 0.3], 40))
    z = np.cumsum(rng.choice([-0.1, 0.0, 0.1], 40))
    c = np.column_stack([z[:-1], np.diff(z) / np.diff(x), np.zeros((39, 2))])
    points, starts = pack([(x, c, 1)])
    curves = as_rows(points)
    s = x[0] + (x[-1] - x[0]) * rng.uniform(0.2, 0.8)
    at = (s, 0.0, np.interp(s, x, z) + rng.uniform(0.0, 0.4))
    distance, n, _ = profile_distance(curves, starts[0], 2.0, at)
    # the exact distance from every chord
    a, d = np.column_stack([x, z])[:-1], np.column_stack([np.diff(x), np.diff(z)])
    t = (((s, at[2]) - a) * d).sum(1) / (d * d).sum(1)
    foot = a + np.clip(t, 0.0, 1.0)[:, None] * d
    exact = np.hypot(*(foot - (s, at[2])).T).min()
    # round-off of metres
    assert distance == pytest.approx(exact, abs=1e-13)
    assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("over", [-0.01, 0.02])
def test_the_step_counts_the_rim_also_before_it_is_met(tmp_path: Path, over: float) -> None:
    words = f"{WORDS}, rim_radius: 0.55, rim_stiffness: 7000"
    law = tyre(tmp_path, f"{{type: gim, road: [level], stiffness: 900, {words}}}")
    law.bench.move(2, q=[1.0, 0.0, 0.0, 0.0])
    n = np.array([0.1, 0.2, 1.0]) / np.sqrt(1.05)
    deeper = 0.15 + over - float(act(law, 0.0).depth)
    law.bench.move(2, r=law.bench.nodes[2].r - deeper * n)
    assert float(act(law, 0.0).depth) == pytest.approx(0.15 + over, abs=1e-12)
    # along the normal the wheel weighs 3 kg
    assert law.bench.nodes[2].stiffness >= 7900.0 / 3.0
    if over > 0.0:
        pressed = [law.bench.nodes[2].r - step * n for step in (-1e-6, 1e-6)]
        loads = []
        for r in pressed:
            law.bench.move(2, r=r)
            loads.append(float(act(law, 0.0).normal))
        # central difference of forces of 300 N: round-off 1e-13 / 1e-6
        assert (loads[1] - loads[0]) / 2e-6 == pytest.approx(7900.0, rel=1e-6)


WRONG = {
    "wheel: the ground is no wheel": "{type: gim, road: [level], stiffness: 900, "
    + WORDS.replace("wheel: b", "wheel: ground")
    + "}",
    "road: the wheel cannot roll on itself": "{type: gim, road: [level], stiffness: 900, "
    + WORDS.replace("wheel: b", "wheel: a")
    + "}",
    "road: needs a surface, or a profile": f"{{type: gim, stiffness: 900, {WORDS}}}",
    "road: names a surface twice": f"{{type: gim, road: [level, level], stiffness: 9, {WORDS}}}",
    "needs one of stiffness and curve": f"{{type: gim, road: [level], {WORDS}}}",
    "friction_min: must not exceed": "{type: gim, road: [level], stiffness: 900, "
    + WORDS.replace("friction_min: 0.6", "friction_min: 0.9")
    + "}",
    "rim_radius: must be below radius": (
        f"{{type: gim, road: [level], stiffness: 9, rim_radius: 0.8, rim_stiffness: 5, {WORDS}}}"
    ),
}


@pytest.mark.parametrize("message", WRONG)
def test_a_tyre_that_cannot_be_meant_is_refused(tmp_path: Path, message: str) -> None:
    text = f"{BODIES}{CURVE}{ROADS}tyres: {{t: {WRONG[message]}}}\n"
    assert message in refusal(tmp_path, text)
