"""Claim: the sparse saddle solve equals the dense one, also for rows of more than two bodies."""

from typing import Any

import numpy as np
import pytest

from crashsolve.foundation.rows import Rows as Columned
from crashsolve.foundation.rows import as_rows
from crashsolve.foundation.sparse.planning import plan
from crashsolve.foundation.sparse.saddle import factorise, solve_rows
from crashsolve.model.nodes import NODE, ROW

Block = tuple[int, tuple[int, ...]]
# rows and nodes of five joints: a chain with a loop, and two gears (two parts, one body shared)
JOINTS: list[Block] = [(5, (0, 1)), (5, (1, 2)), (3, (2, 3)), (1, (1, 2, 0, 3)), (2, (0, 1, 1, 3))]


class Rows:
    """Rows with random D and X = D M^-1 of some joints, their saddle, and the dense S."""

    def __init__(
        self,
        rng: np.random.Generator,
        joints: list[Block],
        twin: int | None,
        hubs: tuple[int, ...] = (),
    ) -> None:
        """The last joint repeats the joint `twin`."""
        self.joints = joints
        sizes = [m * len(ends) // 2 for m, ends in joints]
        self.start = [0, *np.cumsum(sizes)]
        table = np.zeros(sum(sizes), ROW.dtype)
        table["D"] = rng.normal(size=(len(table), 12))
        if twin is not None:
            table["D"][-sizes[-1] :] = table["D"][self.start[twin] :][: sizes[twin]]
        weight = [np.zeros((6, 6))] + [np.diag(rng.uniform(0.5, 2.0, 6)) for _ in range(3)]
        nodes = np.zeros(4, NODE.dtype)
        for k in range(1, 4):
            # of three coordinates alike is a mass, and the others an inertia in any axes
            weight[k][:3, :3] = weight[k][0, 0] * np.eye(3)
            A = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            weight[k][3:, 3:] = A @ weight[k][3:, 3:] @ A.T
            nodes[k]["mass_inv"], nodes[k]["W"] = weight[k][0, 0], weight[k][3:, 3:].ravel()
        self.nodes: Columned = as_rows(nodes)
        dense = []
        for (m, ends), start in zip(joints, self.start, strict=False):
            D = np.zeros((m, 24))
            for part in range(len(ends) // 2):
                rows = table[start + part * m : start + (part + 1) * m]
                for end, half in zip(ends[2 * part : 2 * part + 2], (0, 6), strict=True):
                    d = rows["D"][:, half : half + 6]
                    rows["X"][:, half : half + 6] = d @ weight[end]
                    D[:, 6 * end : 6 * end + 6] += d
            dense.append(D)
        D = np.vstack(dense)
        mass_inv = np.zeros((24, 24))
        for k in range(4):
            mass_inv[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = weight[k]
        self.S = D @ mass_inv @ D.T
        self.table: Columned = as_rows(table)
        saddle = plan([m for m, _ in joints], [ends for _, ends in joints], hubs)
        self.saddle: Any = saddle._make(as_rows(part) for part in saddle)

    def parts(self, column: str) -> list[np.ndarray]:
        """Values of a column per joint, by part and row."""
        return [
            self.table[column][a:b].reshape(-1, m)
            for (m, _), a, b in zip(self.joints, self.start, self.start[1:], strict=False)
        ]

    def solve(self, factor: float) -> np.ndarray:
        """Multipliers; all parts of a row have the same."""
        factorise(self.saddle, self.table, self.nodes)
        solve_rows(self.saddle, self.table, factor)
        for part in self.parts("delta"):
            assert (part == part[0]).all()
        return np.concatenate([part[0] for part in self.parts("delta")])

    def right_side(self) -> np.ndarray:
        return np.concatenate([part.sum(axis=0) for part in self.parts("right")])


def test_sparse_solution_equals_dense_solution() -> None:
    rng = np.random.default_rng(1)
    rows = Rows(rng, JOINTS, twin=None)
    rows.table.right = rng.normal(size=len(rows.table))
    expected = np.linalg.solve(rows.S, -2.0 * rows.right_side())
    # round-off times the condition of S
    tolerance = 1e-14 * np.linalg.cond(rows.S) * np.abs(expected).max()
    np.testing.assert_allclose(rows.solve(-2.0), expected, atol=tolerance)
    assert rows.saddle.redundant() == 0


def test_rows_given_twice_are_found_and_the_others_satisfy_them() -> None:
    for twin in (0, 1):
        rng = np.random.default_rng(2)
        rows = Rows(rng, [*JOINTS, JOINTS[twin]], twin)
        # twins that agree: the right side lies in the range of S
        rows.table.right[: len(rows.table)] = 0.0
        right = rows.S @ rng.normal(size=len(rows.S))
        first = 0
        for part in rows.parts("right"):
            part[0] = right[first : first + part.shape[1]]
            first += part.shape[1]
        residual = rows.S @ rows.solve(1.0) - right
        assert rows.saddle.redundant() == JOINTS[twin][0]
        # round-off times the condition of the rows that are kept, 1e4
        np.testing.assert_allclose(residual, 0.0, atol=1e-11 * np.abs(right).max())


# what hangs on body 1 and not on the ground: bodies 2 and 3 with each other, and a gear among all
FREE: list[Block] = [(5, (1, 2)), (3, (1, 3)), (2, (2, 3)), (1, (1, 2, 1, 3))]


@pytest.mark.parametrize("hub", [1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_a_hub_changes_the_factor_and_not_the_solution(hub: int, seed: int) -> None:
    solutions = []
    for hubs in ((), (hub,)):
        rows = Rows(np.random.default_rng(seed), FREE, None, hubs)
        rows.table.right = np.random.default_rng(seed + 9).normal(size=len(rows.table))
        solutions.append(rows.solve(-2.0))
        assert rows.saddle.redundant() == 0 and rows.saddle.rows() == 11
    # round-off times the condition of S
    tolerance = 1e-13 * np.linalg.cond(rows.S) * np.abs(solutions[0]).max()
    np.testing.assert_allclose(solutions[1], solutions[0], atol=tolerance)


def test_rows_given_twice_on_a_hub_are_found() -> None:
    rng = np.random.default_rng(2)
    rows = Rows(rng, [*FREE, FREE[0]], 0, (1,))
    rows.table.right[:] = 0.0
    right = rows.S @ rng.normal(size=len(rows.S))
    first = 0
    for part in rows.parts("right"):
        part[0] = right[first : first + part.shape[1]]
        first += part.shape[1]
    residual = rows.S @ rows.solve(1.0) - right
    assert rows.saddle.redundant() == 5
    np.testing.assert_allclose(residual, 0.0, atol=1e-11 * np.abs(right).max())
