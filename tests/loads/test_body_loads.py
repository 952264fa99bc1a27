"""Forces and torques on bodies: where they act, in which axes, when, and with what power."""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench, assert_balanced, written

from crashsolve.deck.laws import types_in
from crashsolve.foundation.errors import DeckErrors

# every load, in each of its ways
LOADS = {
    "world": "type: force, body: b, at: [0.1, 0.2, 0.3], force: [1, -2, 3]",
    "own": "type: force, body: b, at: [0.1, 0.2, 0.3], force: [1, -2, 3], axes: body",
    "grows": "type: force, body: b, force: [4, 0, 0], curve: ramp",
    "twist": "type: torque, body: b, torque: [1, -2, 3]",
    "own_twist": "type: torque, body: b, torque: [1, -2, 3], axes: body, curve: ramp",
    "weight": "type: gravity, acceleration: [1, 2, -9]",
}
TEXT = "curves:\n  ramp: {points: [[0, 0], [2, 1]]}\nloads:\n" + "".join(
    f"  {name}: {{{words}}}\n" for name, words in LOADS.items()
)
VECTOR = np.array([1.0, -2.0, 3.0])


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    bench = Bench(tmp_path, TEXT)
    bench.shake(1)
    return bench


def test_every_load_is_under_this_contract() -> None:
    # these act on shells alone: test_pressure.py, test_nodal_force.py; the others within a joint
    words = {words.split(",")[0].split()[1] for words in LOADS.values()}
    assert set(types_in("loads")) == words | {
        "nodal_force",
        "pressure",
        "drive_torque",
        "path_steering",
    }


@pytest.mark.parametrize("name", LOADS)
def test_power_or_potential_equals_the_energy_of_the_bodies(bench: Bench, name: str) -> None:
    law = bench.law("loads", name)
    out = law.force(t=1.5)
    assert written(law.out, law.module.OUTPUT)
    assert float(out.loss) == 0.0
    if getattr(law.module, "LEDGER", "external") == "potential":
        assert float(out.power) == 0.0
    else:
        # the same products in another order
        assert float(out.power) == pytest.approx(law.power_on_bodies(), rel=1e-12)
        assert float(out.stored) == 0.0


@pytest.mark.parametrize("name", LOADS)
def test_forces_are_proportional_to_the_amplitude(bench: Bench, name: str) -> None:
    law, n, forces = bench.law("loads", name), bench.nodes, []
    full = np.array(law.p[law.module.AMPLITUDE])
    for share in (0.0, 1.0, 3.0):
        law.p[law.module.AMPLITUDE] = share * full
        law.force(t=1.5)
        forces.append(np.hstack([n.force, n.torque]))
    assert not forces[0].any()
    assert forces[1].any()
    np.testing.assert_allclose(forces[2], 3.0 * forces[1], rtol=1e-12)


@pytest.mark.parametrize("name", LOADS)
def test_what_comes_from_outside_is_counted_about_the_origin(bench: Bench, name: str) -> None:
    bench.law("loads", name).force(t=1.5)
    n = bench.nodes
    moment = (n.torque + np.cross(n.r, n.force)).sum(axis=0)
    np.testing.assert_allclose(n.external[0, :3], n.force.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(n.external[0, 3:], moment, rtol=1e-12)


def test_axes_and_point_of_a_force(bench: Bench) -> None:
    b = bench.nodes[2]
    A = b.A.reshape(3, 3)
    arm = A @ (np.array([0.1, 0.2, 0.3]) - [0, -0.1, 0])
    for name, f in (("world", VECTOR), ("own", A @ VECTOR)):
        bench.law("loads", name).force()
        np.testing.assert_allclose(b.force, f, rtol=1e-12)
        np.testing.assert_allclose(b.torque, np.cross(arm, f), rtol=1e-12)


def test_a_curve_is_a_factor_over_time(bench: Bench) -> None:
    law = bench.law("loads", "grows")
    for t in (0.0, 0.5, 2.0):
        law.force(t=t)
        np.testing.assert_allclose(bench.nodes[2].force, [2.0 * t, 0, 0])
    A = bench.nodes[2].A.reshape(3, 3)
    bench.law("loads", "own_twist").force(t=0.5)
    np.testing.assert_allclose(bench.nodes[2].torque, 0.25 * A @ VECTOR, rtol=1e-12)


def test_weight_is_the_gradient_of_its_potential(bench: Bench) -> None:
    law = bench.law("loads", "weight")
    out = law.force()
    np.testing.assert_allclose(bench.nodes[2].force, 3.0 * np.array([1, 2, -9]))
    np.testing.assert_allclose(out.force, 5.0 * np.array([1, 2, -9]))
    before = float(out.stored)
    bench.move(2, r=bench.nodes[2].r + [0, 0, 2])
    assert float(law.force().stored) - before == pytest.approx(3.0 * 9 * 2)


def test_a_load_on_the_ground_is_refused(tmp_path: Path) -> None:
    text = "loads:\n  f: {type: force, body: ground, force: [1, 0, 0]}\n"
    with pytest.raises(DeckErrors, match="the ground does not move; name a body"):
        Bench(tmp_path, text)


JOINT = "joints: {j: {type: revolute, a: a, b: b, at: [0.1, 0.2, 0], axis: [1, 2, -1]}}\n"


@pytest.mark.parametrize("seed", range(4))
def test_a_drive_torque_acts_between_the_bodies_of_its_joint(tmp_path: Path, seed: int) -> None:
    text = f"{JOINT}loads: {{d: {{type: drive_torque, joint: j, torque: 7}}}}\n"
    law = Bench(tmp_path, text).law("loads", "d")
    law.bench.shake(seed)
    out = law.force()
    assert written(law.out, law.module.OUTPUT)
    assert_balanced(law.bench.nodes)
    assert np.linalg.norm(law.bench.nodes.torque[2]) > 1.0
    # nothing comes from outside, and the power is what both bodies receive, in another order
    assert not law.bench.nodes.external.any()
    assert float(out.power) == pytest.approx(law.power_on_bodies(), rel=1e-12)


def test_a_drive_torque_needs_a_joint_with_an_angle(tmp_path: Path) -> None:
    text = JOINT.replace("revolute", "prismatic")
    with pytest.raises(DeckErrors, match="angle"):
        Bench(tmp_path, f"{text}loads: {{d: {{type: drive_torque, joint: j, torque: 7}}}}\n")
