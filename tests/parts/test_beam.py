"""What a beam element promises: gradient, balance, invariance, honest stiffness and tangents."""

from pathlib import Path

import numpy as np
import pytest
from bench import ONE_BEAM, Bench, Law, exponential, matrix_of_pair, pair_of_blocks, written

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build
from crashsolve.model.nodes import COMPLIANT

DECK = ONE_BEAM.replace("WORDS", "damping: DAMPING")
# a step of differences: relative error h^2 = 1e-10 times third derivatives over first, some units,
# and round-off 1e-16 / h
STEP = 1e-5


@pytest.fixture(params=range(4))
def seed(request: pytest.FixtureRequest) -> int:
    return int(request.param)


def element(
    folder: Path, seed: int, speed: float, damping: float = 0.02, rotation: float = 0.8
) -> Law:
    """The element between two nodes anywhere within `rotation` of its start, and somewhere far
    off.
    """
    law = Bench(folder, "", DECK.replace("DAMPING", str(damping))).law("parts", "s_1")
    law.bench.shake(seed, speed, rotation)
    rigid(law, np.random.default_rng(seed + 10).normal(size=3))
    return law


def rigid(law: Law, rotation: np.ndarray) -> np.ndarray:
    """Turn and move both nodes together; the matrix of the turn."""
    R = matrix(exponential(rotation))
    for node in (1, 2):
        b = law.bench.nodes[node]
        law.bench.rotation(node, rotation)
        law.bench.move(node, r=R @ b.r + [5, -3, 2], v=R @ b.v, w=R @ b.w)
    return R


def load(law: Law) -> np.ndarray:
    """Forces and torques on both nodes (12,)."""
    law.force()
    n = law.bench.nodes
    return np.concatenate([n.force[1], n.torque[1], n.force[2], n.torque[2]])


def shift(
    law: Law, start: np.ndarray, direction: np.ndarray, rate: np.ndarray, step: float
) -> None:
    """Both nodes from `start` by step times a change of place and of velocity (12,) each."""
    law.bench.nodes[:] = start
    for node in (1, 2):
        part = slice(6 * node - 6, 6 * node)
        dq, dv = step * direction[part], step * rate[part]
        b = law.bench.nodes[node]
        law.bench.rotation(node, dq[3:])
        law.bench.move(node, r=b.r + dq[:3], v=b.v + dv[:3], w=b.w + dv[3:])


def test_the_force_is_the_gradient_of_the_energy(tmp_path: Path, seed: int) -> None:
    law = element(tmp_path, seed, speed=0.0)
    force, start = load(law), law.bench.state()
    gradient = np.zeros(12)
    for k, direction in enumerate(np.eye(12)):
        stored = []
        for side in (-STEP, STEP):
            shift(law, start, direction, np.zeros(12), side)
            stored.append(float(law.force().stored))
        gradient[k] = (stored[1] - stored[0]) / (2.0 * STEP)
    np.testing.assert_allclose(-gradient, force, atol=1e-8 * np.abs(force).max())


def test_power_on_the_nodes_is_the_decrease_of_stored_energy(tmp_path: Path, seed: int) -> None:
    law = element(tmp_path, seed, speed=1.0)
    out = law.force()
    given, lost = law.power_on_bodies(), float(out.power)
    assert lost > 0.0
    assert given == pytest.approx(-law.growth(STEP) - lost, rel=1e-8)


def test_action_equals_reaction_also_in_moment(tmp_path: Path, seed: int) -> None:
    law = element(tmp_path, seed, speed=1.0)
    size, n = np.abs(load(law)).max(), law.bench.nodes
    # round-off of sums of products with arms of up to 10 m
    np.testing.assert_allclose(n.force.sum(axis=0), 0.0, atol=1e-14 * size)
    moment = (n.torque + np.cross(n.r, n.force)).sum(axis=0)
    np.testing.assert_allclose(moment, 0.0, atol=1e-13 * size)


def test_a_common_rigid_motion_of_both_nodes_has_no_effect(tmp_path: Path, seed: int) -> None:
    law = element(tmp_path, seed, speed=1.0)
    before, out = load(law), law.force()
    numbers = [float(out.stored), float(out.power), *out.force, *out.moment_a, *out.moment_b]
    R = rigid(law, np.array([0.3, -0.5, 2.9]))
    after, out = load(law), law.force()
    rotated = (before.reshape(4, 3) @ R.T).ravel()
    # round-off of positions of up to 10 m, times stiffness
    np.testing.assert_allclose(after, rotated, atol=1e-12 * np.abs(before).max())
    again = [float(out.stored), float(out.power), *out.force, *out.moment_a, *out.moment_b]
    np.testing.assert_allclose(again, numbers, atol=1e-12 * np.abs(before).max())


def test_an_element_does_not_know_its_first_node(tmp_path: Path, seed: int) -> None:
    law = element(tmp_path, seed, speed=1.0)
    before, stored = load(law), float(law.force().stored)
    # the same beam reported from its other end: both nodes half a rotation about the section's y
    # axis
    law.bench.nodes[1:] = law.bench.nodes[[2, 1]]
    for node in (1, 2):
        y = law.bench.nodes[node].A.reshape(3, 3)[:, 1].copy()
        law.bench.rotation(node, np.pi * y)
    after = load(law)
    np.testing.assert_allclose(np.roll(after, 6), before, atol=1e-12 * np.abs(before).max())
    assert float(law.force().stored) == pytest.approx(stored, rel=1e-13)


def test_every_column_is_written(tmp_path: Path, seed: int) -> None:
    law = element(tmp_path, seed, speed=1.0)
    out = law.force()
    assert written(out, law.module.OUTPUT)
    assert np.isfinite([out.stored, out.power, out.loss]).all()


FRAME = DECK.replace("    type: beam\n", "    type: frame\n").replace(
    "    mesh: {shape: line, from: [0.2, -0.1, 0.4], to: [1.2, 0.9, 0.1], elements: 1}\n",
    "    points: [[0.2, -0.1, 0.4], [1.2, 0.9, 0.1]]\n    bars: [[1, 2]]\n    elements: 1\n",
)


@pytest.mark.parametrize("rotation", [0.0, 1e-6, 0.8])
@pytest.mark.parametrize("text", [DECK, FRAME], ids=["beam", "frame"])
def test_forces_by_motions_are_their_derivatives(
    tmp_path: Path, text: str, rotation: float
) -> None:
    law = Bench(tmp_path, "", text.replace("DAMPING", "0")).law("parts", "s_1")
    law.bench.shake(1, 0.0, rotation)
    rigid(law, np.array([1.1, -0.7, 0.4]))
    start, still, wanted = law.bench.state(), np.zeros(12), np.zeros((12, 12))
    forces = law.module.forces_by_motions(law.p.reshape(1), None, law.bench.nodes, None)[0]
    for k, direction in enumerate(np.eye(12)):
        # of fourth order: steps of 1e-3 leave 1e-12 of fifth derivatives, and round-off 1e-13
        for steps, weight in ((1, 8), (-1, -8), (2, -1), (-2, 1)):
            shift(law, start, direction, still, steps * 1e-3)
            wanted[:, k] += weight * load(law) / 12e-3
    law.bench.nodes[:] = start
    np.testing.assert_allclose(forces, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())


VISCOUS = "0.02\n    viscosity: {linear: 0.1, quadratic: 0.5}"
FIBRES = DECK.replace("type: beam", "type: fibre_beam\n    fibres: [3, 7]") + (
    "curves: {flow: {points: [[0, 200], [0.1, 260], [5, 900]]}}\n"
)


def yields(words: str) -> str:
    """A fibre beam beyond yield, at a strain of 0.1, in some of its fibres."""
    return FIBRES.replace("type: elastic,", f"type: elastoplastic, {words},")


KINDS = {
    "beam": DECK,
    "frame": FRAME,
    "fibres, elastic": yields("yield_stress: 1e9"),
    "fibres, perfect": yields("yield_stress: 200"),
    "fibres, isotropic": yields("yield_stress: 200, hardening: 500"),
    "fibres, kinematic": yields("yield_stress: 200, hardening: 500, kinematic: 1"),
    "fibres, both": yields("yield_stress: 200, hardening: 500, kinematic: 0.4"),
    "fibres, curve": yields("curve: flow"),
    "fibres, rate": yields("yield_stress: 200, hardening: 500, rate_D: 0.4, rate_q: 2"),
    "fibres, curve and rate": yields("curve: flow, rate_D: 0.4, rate_q: 5"),
}


def is_plastic(kind: str) -> bool:
    return kind.startswith("fibres") and not kind.endswith("elastic")


def on_its_way(folder: Path, kind: str, seed: int, speed: float, rotation: float) -> Law:
    """An element in a step that begins deformed, yielding where it can, and goes any way."""
    law = Bench(folder, "", KINDS[kind].replace("DAMPING", VISCOUS)).law("parts", "s_1")
    law.bench.shake(seed, 0.0, rotation)
    rigid(law, np.array([1.1, -0.7, 0.4]))
    load(law)
    law.accept()
    direction = np.random.default_rng(seed + 21).normal(size=12)
    small = np.tile(np.repeat([0.1, 0.2 * rotation], 3), 2)
    shift(law, law.bench.state(), small * direction, speed * direction, 1.0)
    return law


@pytest.mark.parametrize("kind", KINDS)
def test_rows_are_the_derivative_by_the_velocity(tmp_path: Path, kind: str, seed: int) -> None:
    """dF = -D^T c D dv, as tests/springs/test_tangents.py has it."""
    law = on_its_way(tmp_path, kind, seed, 1.0, 0.8)
    rows = as_rows(np.zeros(law.module.TANGENTS, COMPLIANT.dtype))
    position = (law.bench.nodes, law.bench.curves, rows, 0)
    law.module.tangent(law.p, law.old, *position, *law.materials)
    start, rate, ends = law.bench.state(), np.random.default_rng(seed).normal(size=12), []
    for side in (-STEP, STEP):
        shift(law, start, np.zeros(12), rate, side)
        ends.append(load(law))
    change = (ends[1] - ends[0]) / (2.0 * STEP)
    reported = -rows.D.T @ (rows.damping * (rows.D @ rate))
    np.testing.assert_allclose(reported, change, atol=1e-8 * np.abs(change).max())


def whole_tangent(law: Law, flips: int) -> np.ndarray:
    """Blocks of the element as one matrix (12, 12) of the nodes."""
    position, blocks = pair_of_blocks(flips)
    given = (law.bench.nodes, law.bench.curves, position, blocks)
    # fibres have a rate from the length of the step, that of load()
    step = (1.0,) if law.materials else ()
    law.module.tangent_blocks(law.p, law.old, *step, *given, *law.materials)
    return matrix_of_pair(blocks, flips)


@pytest.mark.parametrize("speed", [0.0, 1.0])
@pytest.mark.parametrize("rotation", [0.0, 0.8])
@pytest.mark.parametrize("kind", KINDS)
def test_blocks_are_the_derivative_by_the_position(
    tmp_path: Path, kind: str, rotation: float, speed: float
) -> None:
    """In any configuration, with damping and viscosity while it moves, elastic and yielding."""
    law = on_its_way(tmp_path, kind, 5, speed, rotation)
    load(law)
    # some fibres flow, and with a turn some do not
    assert not is_plastic(kind) or (law.new.hardening > law.old.hardening).any()
    start, still, wanted = law.bench.state(), np.zeros(12), np.zeros((12, 12))
    tangents = [whole_tangent(law, flips) for flips in (0, 1)]
    for k, direction in enumerate(np.eye(12)):
        # as above, but no fibre may yield or turn back on the way: round-off is 1e-11
        for steps, weight in ((1, 8), (-1, -8), (2, -1), (-2, 1)):
            shift(law, start, direction, still, steps * 1e-4)
            wanted[:, k] -= weight * load(law) / 12e-4
    for K in tangents:
        np.testing.assert_allclose(K, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())


@pytest.mark.parametrize("most, least", [(0.01, 0.98), (1.0, 0.15)])
def test_stiffness_for_the_step_bounds_the_highest_frequency(
    tmp_path: Path, seed: int, most: float, least: float
) -> None:
    """2 max_i stiffness_i is not below the largest eigenvalue of M^-1 K (system.timestep).

    Of a straight element it is that, and a bend of 0.01 rad adds less than 0.02. One bent by up to
    a radian and stretched by tenths of a metre swings more slowly than its tension lets expect:
    steps are up to sqrt(6.5) times shorter there.
    """
    law = Bench(tmp_path, "", DECK.replace("DAMPING", "0")).law("parts", "s_1")
    bend = np.random.default_rng(seed).uniform(-most, most, 12)
    # displacements are strains: they stay small
    bend[:3] *= 0.1
    bend[6:9] *= 0.1
    shift(law, law.bench.state(), bend, np.zeros(12), 1.0)
    load(law)
    ratio = highest_over_bound(law)
    # a share of 1e-8 for differences
    assert least < ratio <= 1.0 + 1e-8


@pytest.mark.parametrize("angle", [0.2, 0.7])
def test_the_bound_has_the_coupling_of_stretch_and_bending(tmp_path: Path, angle: float) -> None:
    """Both modes of an element with I / A = l^2 / 13 have nearly one frequency: bent evenly, it
    swings faster by a share of the order of the angle.
    """
    words = {"DAMPING": "0", "width: 0.5, height: 0.8": "width: 1.4, height: 1.4"}
    text = DECK
    for old, new in words.items():
        text = text.replace(old, new)
    law = Bench(tmp_path, "", text).law("parts", "s_1")
    nodes = law.bench.nodes
    along = nodes.r[2] - nodes.r[1]
    across = np.cross(along, [0.0, 0.0, 1.0])
    half = 0.5 * angle * across / np.linalg.norm(across)
    law.bench.rotation(1, -half)
    law.bench.rotation(2, half)
    load(law)
    assert 0.85 < highest_over_bound(law) <= 1.0 + 1e-8


def highest_over_bound(law: Law) -> float:
    """Largest eigenvalue of M^-1 K over 2 max_i stiffness_i, of loaded nodes."""
    bound = 2.0 * law.bench.nodes.stiffness[1:].max()
    start, columns = law.bench.state(), []
    for direction in np.eye(12):
        ends = []
        for side in (-STEP, STEP):
            shift(law, start, direction, np.zeros(12), side)
            ends.append(acceleration(law))
        columns.append((ends[1] - ends[0]) / (2.0 * STEP))
    return float(np.linalg.eigvals(-np.array(columns).T).real.max() / bound)


def acceleration(law: Law) -> np.ndarray:
    load(law)
    n = law.bench.nodes
    angular = np.einsum("nij,nj->ni", n.W[1:].reshape(2, 3, 3), n.torque[1:])
    return np.stack([n.force[1:] * n.mass_inv[1:, None], angular], axis=1).ravel()


def test_divided_elements_are_the_same_beam_with_the_old_names(tmp_path: Path) -> None:
    models = []
    for count, division in ((2, 1), (2, 3), (6, 1)):
        text = DECK.replace("elements: 1", f"elements: {count}, division: {division}")
        path = tmp_path / f"{count}_{division}.yaml"
        path.write_text(text.replace("DAMPING", "0.1"), "utf-8")
        models.append(build(read_deck(path)))
    (coarse, at_coarse), (divided, at_divided), (fine, at_fine) = models
    names = ["s_start", "s_start_1", "s_start_2", "s_1", "s_1_1", "s_1_2", "s_end"]
    assert divided.bodies[1:] == names
    (group,) = [g for g in divided.groups if g.keyword == "parts"]
    assert group.names == ["s_1", "s_1_1", "s_1_2", "s_2", "s_2_1", "s_2_2"]
    # nodes, masses and elements are those of as many elements
    for name in ("r", "q", "mass_inv"):
        np.testing.assert_array_equal(at_divided.nodes[name], at_fine.nodes[name])
    (same,) = [g for g in fine.groups if g.keyword == "parts"]
    assert (group.parameters == same.parameters).all()
    for name in coarse.bodies[1:]:
        here, there = coarse.bodies.index(name), divided.bodies.index(name)
        np.testing.assert_allclose(
            at_coarse.nodes["r"][here], at_divided.nodes["r"][there], rtol=0, atol=1e-15
        )
