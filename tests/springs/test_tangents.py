"""Claim: the tangents that implicit integrators get are the derivatives of the forces.

A law acts through rows: its force on the bodies is D^T f. Along any change of position and velocity

    dF = dD^T f - D^T (k D dq + c (D dv + G dq))

The left side and dD come from central differences. What dD^T f is of forces along a line stands in
the blocks of nodes where there are some.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, Law, Tangents, matrix_of_pair, pair_of_blocks, tangents_of
from test_contract import ALL, CURVES, REVERSIBLE

from crashsolve.deck.laws import package_folder

STEP = 1e-6
# stops act on a joint; their rows are those of other laws, and stop_tangent has a test below
SMOOTH = [direction for direction in ALL if not direction.startswith("brake")]
# directions turn with both points, or with one body: dv/dq is in closed form
POINTS = ["linear", "curve", "bushing along"]
LAWS = ALL | {
    "bushing along": "{type: bushing, a: a, b: b, at_a: [0.1, 0, 0.2], at_b: [0, 0.2, -0.1],"
    " stiffness: [50, 90, 20], damping: [1, 2, 3]}"
}
# forces along a line between two points
ALONG = ("linear", "damper", "curve", "strut", "elastoplastic")
LINES = [
    direction for direction in SMOOTH if ALL[direction].split("type: ")[1].split(",")[0] in ALONG
]
Make = Callable[[str], Law]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    return lambda case: Bench(tmp_path, f"{CURVES}springs:\n  s: {LAWS[case]}\n").law(
        "springs", "s"
    )


def stepped(make: Make, case: str, seed: int, **motion: float) -> Law:
    """A spring in motion, a step behind it."""
    law = make(case)
    law.bench.shake(seed, **motion)
    law.force()
    law.accept()
    return law


def load(law: Law) -> np.ndarray:
    """Forces and torques on both bodies (12,)."""
    law.force()
    n = law.bench.nodes
    return np.concatenate([n.force[1], n.torque[1], n.force[2], n.torque[2]])


def rows(law: Law) -> Tangents:
    """The law's compliant rows at the present position."""
    return tangents_of(law, [1, 2])


def rotations_of(law: Law) -> np.ndarray:
    """D of the law's own forces; what yields together has mixtures of them for rows."""
    if "yields" not in law.p.dtype.names:
        return rows(law).D.copy()
    unloading_work, law.p.yields = int(law.p.yields), 0
    D = rows(law).D.copy()
    law.p.yields = unloading_work
    return D


def shift(
    law: Law, start: np.ndarray, direction: np.ndarray, rate: np.ndarray, step: float
) -> None:
    """Both bodies from `start` by step times a change of place and of velocity (12,) each."""
    bench = law.bench
    bench.nodes[:] = start
    for node in (1, 2):
        part = slice(6 * node - 6, 6 * node)
        dq, dv = step * direction[part], step * rate[part]
        b = bench.nodes[node]
        bench.rotation(node, dq[3:])
        bench.move(node, r=b.r + dq[:3], v=b.v + dv[:3], w=b.w + dv[3:])


def compare(law: Law, direction: np.ndarray, rate: np.ndarray, sides: tuple[float, float]) -> None:
    """Differences over `sides` steps against the rows in the middle."""
    start = law.bench.state()
    here = rows(law)
    force = np.linalg.lstsq(rotations_of(law).T, load(law), rcond=None)[0]
    ends = []
    for side in sides:
        shift(law, start, direction, rate, side * STEP)
        ends.append((load(law), rotations_of(law)))
    law.bench.nodes[:] = start
    span = (sides[1] - sides[0]) * STEP
    change = (ends[1][0] - ends[0][0]) / span - ((ends[1][1] - ends[0][1]) / span).T @ force
    given = here.stiffness * (here.D @ direction) + here.damping * (
        here.D @ rate + here.G @ direction
    )
    scale = 1.0 + np.abs(change).max()
    # round-off of forces of 1e3 over the step; on one side, second derivatives of some 1e3 times it
    bound = 1e-6 * scale + (5e-3 if sides[0] == 0.0 else 0.0)
    np.testing.assert_allclose(change, -here.D.T @ given, atol=bound)


def test_every_spring_that_implicit_methods_take_has_a_tangent() -> None:
    for path in (package_folder() / "springs").glob("[!_]*.py"):
        text = path.read_text("utf-8")
        # laws of whole steps name the implicit methods that go by whole steps too
        is_implicit = "STEPWISE = True" not in text or "IMPLICIT = (" in text
        assert is_implicit == ("def tangent(" in text), path.stem


@pytest.mark.parametrize("flips", [0, 1])
@pytest.mark.parametrize("case", LINES)
@pytest.mark.parametrize("seed", range(3))
def test_rows_and_blocks_are_the_whole_derivative(
    make: Make, case: str, seed: int, flips: int
) -> None:
    """dF = -(K + D^T (k D + c G)) dq, where the force has turned the line and the arms."""
    law = make(case)
    law.bench.shake(seed)
    tension = float(law.force().force)
    law.accept()
    law.force()
    position, blocks = pair_of_blocks(flips)
    law.module.geometric_stiffness(law.p, law.out, law.bench.nodes, position, blocks)
    K, here, start = matrix_of_pair(blocks, flips), rows(law), law.bench.state()
    reported = K + here.D.T @ (here.stiffness[:, None] * here.D + here.damping[:, None] * here.G)
    wanted, motions = np.zeros((12, 12)), np.eye(12)
    if case not in REVERSIBLE:
        # what slides stands at a corner of its law: move it at the same length
        motions -= here.D.T @ here.D / (here.D @ here.D.T)
    for k, motion in enumerate(motions):
        for side in (1, -1):
            shift(law, start, motion, np.zeros(12), side * STEP)
            wanted[:, k] -= side * load(law) / (2.0 * STEP)
    # round-off of forces of 1e3 over the step
    np.testing.assert_allclose(
        reported @ motions, wanted, rtol=0, atol=1e-6 * (1.0 + np.abs(wanted).max())
    )
    assert np.abs(K).max() > 0.1 * abs(tension)


@pytest.mark.parametrize("at", [1, 2])
def test_an_end_on_the_ground_has_no_blocks(make: Make, at: int) -> None:
    law = make("linear")
    law.bench.shake(1)
    law.force()
    matrices = []
    for free in (False, True):
        position, blocks = pair_of_blocks(0)
        if not free:
            position["a" if at == 1 else "b"] = position["across"] = -1
        law.module.geometric_stiffness(law.p, law.out, law.bench.nodes, position, blocks)
        matrices.append(matrix_of_pair(blocks, 0))
    # all that is left is what the other end does to itself
    matrices[1][6 * at - 6 : 6 * at] = matrices[1][:, 6 * at - 6 : 6 * at] = 0.0
    np.testing.assert_array_equal(matrices[0], matrices[1])


@pytest.mark.parametrize("case", list(REVERSIBLE))
@pytest.mark.parametrize("seed", range(3))
def test_stiffness_is_the_derivative_by_the_position(make: Make, case: str, seed: int) -> None:
    law = stepped(make, case, seed, speed=0.0)
    direction = np.random.default_rng(seed).normal(size=12)
    compare(law, direction, np.zeros(12), (-1.0, 1.0))


@pytest.mark.parametrize("case", SMOOTH)
@pytest.mark.parametrize("seed", range(3))
def test_damping_is_the_derivative_by_the_velocity(make: Make, case: str, seed: int) -> None:
    law = stepped(make, case, seed)
    direction = np.random.default_rng(seed).normal(size=12)
    compare(law, np.zeros(12), direction, (-1.0, 1.0))


@pytest.mark.parametrize("case", POINTS)
@pytest.mark.parametrize("seed", range(3))
def test_damping_turns_with_the_bodies(make: Make, case: str, seed: int) -> None:
    law = stepped(make, case, seed)
    rng = np.random.default_rng(seed)
    compare(law, rng.normal(size=12), rng.normal(size=12), (-1.0, 1.0))


SLIDING = [direction for direction in SMOOTH if direction not in REVERSIBLE]


@pytest.mark.parametrize("case", SLIDING)
@pytest.mark.parametrize("seed", range(3))
def test_a_sliding_spring_is_as_stiff_as_the_way_it_goes(make: Make, case: str, seed: int) -> None:
    law = stepped(make, case, seed)
    # a little on its way, so that what slides or flows does so
    law.bench.drift(1e-5)
    n = law.bench.nodes
    onward = np.concatenate([n.v[1], n.w[1], n.v[2], n.w[2]])
    # past the point where the slider moves there is a corner: look ahead only
    compare(law, onward, np.zeros(12), (0.0, 1.0))
