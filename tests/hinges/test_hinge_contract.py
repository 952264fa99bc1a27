"""What every hinge promises: balance, energy, invariance, honest rows and tangents."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench import Bench, Law, assert_balanced, spoil, write_rows, written

from crashsolve.deck.laws import package_folder
from crashsolve.model.nodes import COMPLIANT

CURVES = """
curves:
  turn: {points: [[0, 0], [0.02, 8], [0.3, 12], [0.4, 6], [1, 5]], extrapolate: hold}
  low: {points: [[0, 0], [0.02, 8], [1, 9]], extrapolate: hold}
  push: {points: [[0, 0], [0.01, 300], [0.3, 500]], extrapolate: hold}
"""
AT = "a: a, b: b, at: [0.4, 0.3, 0.1]"
HINGES = {
    "bending": f"type: bending, {AT}, axis: [0, 0, 1], curve: turn",
    "bending softened": f"type: bending, {AT}, axis: [0, 0, 1], curve: turn,"
    " curve_negative: low, cyclic: peak_oriented, initial_angle: 0.001",
    "torsion": f"type: torsion, {AT}, axis: [1, 0, 2], curve: low, cyclic: kinematic, rate: {{}}",
    "axial": f"type: axial, {AT}, axis: [1, 2, 0], curve: push, rate: {{coefficient: 0.3}}",
    "biaxial": f"type: biaxial, {AT}, axis: [1, 0, 0], side: [0, 1, 1], curve: turn,"
    " second_curve: low",
    "biaxial uncoupled": f"type: biaxial, {AT}, axis: [1, 0, 0], side: [0, 1, 1], curve: turn,"
    " second_curve: low, interaction: uncoupled, cyclic: peak_oriented",
    "axial_bending": f"type: axial_bending, {AT}, axis: [0, 0, 1], beam: [1, 0, 0], curve: turn,"
    " axial_curve: push",
    "axial_bending uncoupled": f"type: axial_bending, {AT}, axis: [0, 0, 1], beam: [1, 0, 0],"
    " curve: turn, axial_curve: push, interaction: uncoupled",
}
Make = Callable[[str], Law]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    return lambda case: Bench(tmp_path, f"{CURVES}hinges:\n  h: {{{HINGES[case]}}}\n").law(
        "hinges", "h"
    )


def each() -> pytest.MarkDecorator:
    return pytest.mark.parametrize("case", list(HINGES))


def near(law: Law, seed: int, speed: float = 1.0, rotation: float = 0.4) -> None:
    """Any motion, after which most hinges have yielded."""
    law.bench.shake(seed, speed=speed, rotation=rotation)


def test_every_hinge_is_under_this_contract() -> None:
    laws = {path.stem for path in (package_folder() / "hinges").glob("[!_]*.py")}
    assert laws == {text.split("type: ")[1].split(",")[0] for text in HINGES.values()}


@each()
@pytest.mark.parametrize("seed", range(3))
def test_action_equals_reaction_also_in_moment(make: Make, case: str, seed: int) -> None:
    law = make(case)
    near(law, seed)
    before = law.old.tobytes()
    law.force()
    assert_balanced(law.bench.nodes)
    assert written(law.new, law.module.HISTORY)
    assert written(law.out, law.module.OUTPUT)
    assert law.old.tobytes() == before


@each()
@pytest.mark.parametrize("seed", range(2))
def test_a_common_rigid_motion_has_no_effect(make: Make, case: str, seed: int) -> None:
    law = make(case)
    near(law, seed)
    out = law.force()
    before, torque = [float(out.stored), float(out.loss)], law.bench.nodes.torque[2].copy()
    R = law.bench.carry_away()
    out = law.force()
    # round-off of products of numbers below 1e3
    np.testing.assert_allclose([float(out.stored), float(out.loss)], before, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(law.bench.nodes.torque[2], R @ torque, atol=1e-10)


@each()
@pytest.mark.parametrize("seed", range(2))
def test_work_on_the_bodies_is_stored_and_dissipated(make: Make, case: str, seed: int) -> None:
    """Along a path of many small steps, the work of the forces by trapezoids."""
    law, step, work = make(case), 2e-3, 0.0
    near(law, seed, rotation=0.05)
    law.bench.nodes.v[1:] *= 0.3
    out = law.force()
    law.accept()
    stored, lost, power = float(out.stored), 0.0, law.power_on_bodies()
    for _ in range(150):
        law.bench.drift(step)
        out = law.force()
        work -= 0.5 * step * (power + law.power_on_bodies())
        power, lost = law.power_on_bodies(), lost + float(out.loss)
        law.accept()
    assert lost >= 0.0
    # second order in the step; a corner costs k (v h)^2 / 8, some 1e-3 J
    assert work == pytest.approx(float(out.stored) - stored + lost, rel=5e-3, abs=5e-3)


@each()
@pytest.mark.parametrize("seed", range(2))
def test_rows_are_the_derivatives_of_what_they_hold(make: Make, case: str, seed: int) -> None:
    law = make(case)
    near(law, seed, rotation=0.6)
    bench, count = law.bench, law.module.ROWS
    rows = slice(law.p.first_row, law.p.first_row + count)
    args = (bench.nodes, bench.rows, bench.curves)
    start = bench.state()

    def rate(time: float) -> np.ndarray:
        """D v of the bodies that have moved on for a time."""
        bench.nodes[:] = start
        bench.drift(time)
        write_rows(law.module, "jacobian", law.p, law.old, 0.0, *args)
        D, n = bench.rows.D[rows], bench.nodes
        return D @ np.concatenate([n.v[1], n.w[1], n.v[2], n.w[2]])

    def phi(time: float) -> np.ndarray:
        bench.nodes[:] = start
        bench.drift(time)
        write_rows(law.module, "residual", law.p, law.old, law.new, 0.0, *args)
        return bench.rows.phi[rows].copy()

    step = 1e-5
    # central differences: third derivatives of some 10 times 1e-10, round-off 1e-11
    np.testing.assert_allclose((phi(step) - phi(-step)) / (2 * step), rate(0.0), atol=1e-8)
    gamma = -(rate(step) - rate(-step)) / (2 * step)
    bench.nodes[:] = start
    write_rows(law.module, "convective", law.p, law.old, 0.0, *args)
    np.testing.assert_allclose(bench.rows.gamma[rows], gamma, atol=1e-7)


@each()
def test_failure_frees_the_joint_and_gives_up_its_energy(make: Make, case: str) -> None:
    law = make(case)
    near(law, 1)
    law.p.failure[0] = 1e-6
    law.p.is_apart = 1
    out = law.force()
    assert out.failed == 1 and out.stored == 0.0 and out.loss > 0.0
    assert np.abs(law.bench.nodes.torque).max() == 0.0
    law.accept()
    rows = slice(law.p.first_row, law.p.first_row + law.module.ROWS)
    args = (law.bench.nodes, law.bench.rows, law.bench.curves)
    write_rows(law.module, "residual", law.p, law.old, law.new, 0.0, *args)
    write_rows(law.module, "jacobian", law.p, law.old, 0.0, *args)
    write_rows(law.module, "convective", law.p, law.old, 0.0, *args)
    held = law.bench.rows[rows]
    assert not held.D.any() and not held.phi.any() and not held.gamma.any() and not held.nu.any()
    law.p.is_apart = 0
    write_rows(law.module, "jacobian", law.p, law.old, 0.0, *args)
    assert law.bench.rows[rows].D.any()
    out = law.force()
    assert out.failed == 1 and out.loss == 0.0


def load(law: Law) -> np.ndarray:
    law.force()
    n = law.bench.nodes
    return np.concatenate([n.force[1], n.torque[1], n.force[2], n.torque[2]])


def tangents(law: Law) -> Any:
    rows = np.zeros(law.module.TANGENTS, COMPLIANT.dtype).view(np.recarray)
    law.module.tangent(law.p, law.old, law.bench.nodes, law.bench.curves, rows, 0)
    return rows


@pytest.mark.parametrize("case", ["bending", "bending softened", "torsion", "axial"])
@pytest.mark.parametrize("seed", range(2))
def test_tangents_are_derivatives_as_the_hinge_flows_on(make: Make, case: str, seed: int) -> None:
    """dF = dD^T f - D^T k D dq, onward along the velocity, without rate hardening."""
    law = make(case)
    law.p.rate_coefficient = 0.0
    near(law, seed)
    law.force()
    law.accept()
    n = law.bench.nodes
    onward = np.concatenate([n.v[1], n.w[1], n.v[2], n.w[2]])
    start, here = law.bench.state(), tangents(law)
    force = np.linalg.lstsq(here.D.T, load(law), rcond=None)[0]
    ends, step = [], 1e-6
    for time in (0.0, step):
        law.bench.nodes[:] = start
        law.bench.drift(time)
        ends.append((load(law), tangents(law).D.copy()))
    rotated = ((ends[1][1] - ends[0][1]) / step).T @ force
    wanted = -here.D.T @ (here.stiffness * (here.D @ onward))
    # round-off of forces of 1e3 over the step, and second derivatives of some 1e3 times it
    np.testing.assert_allclose(
        (ends[1][0] - ends[0][0]) / step - rotated, wanted, atol=1e-2 * (1.0 + np.abs(wanted).max())
    )


def test_the_order_of_bodies_changes_the_sign_of_both_angles_alone(tmp_path: Path) -> None:
    outcomes = []
    for ends in ("a: a, b: b", "a: b, b: a"):
        text = HINGES["biaxial"].replace("a: a, b: b", ends)
        law = Bench(tmp_path, f"{CURVES}hinges:\n  h: {{{text}}}\n").law("hinges", "h")
        near(law, 2)
        out = law.force()
        outcomes.append((out.angle.copy(), out.moment.copy(), law.bench.nodes.torque[2].copy()))
    # round-off of angles of 1 rad and moments of 10 N m
    np.testing.assert_allclose(outcomes[0][0], -outcomes[1][0], atol=1e-14)
    np.testing.assert_allclose(outcomes[0][1], -outcomes[1][1], atol=1e-11)
    np.testing.assert_allclose(outcomes[0][2], outcomes[1][2], atol=1e-11)


def test_angles_are_counted_over_many_turns(make: Make) -> None:
    law = make("bending")
    spoil(law.new, law.module.HISTORY)
    for k in range(1, 60):
        law.bench.rotation(2, [0.0, 0.0, 0.5])
        out = law.force()
        law.accept()
        assert float(out.angle) == pytest.approx(0.5 * k, abs=1e-11)
