"""Claim: the bordered matrix of nodes and joints is solved as the dense one, whatever its signs."""

from typing import Any

import numpy as np
import pytest

from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.foundation.sparse.bordered import assemble, factorise, plan, solve
from crashsolve.model.nodes import COMPLIANT

# a strip of elements between nodes, the ground 0; a rod, a gear of two parts, and three springs
NODES = [1, 2, 3, 4, 5, 6]
PAIRS = {(a, b) for some in ((1, 2, 4, 3), (3, 4, 6, 5)) for a in some for b in some}
JOINTS: list[tuple[int, tuple[int, ...]]] = [(1, (2, 6)), (3, (0, 1, 5, 4))]
ENDS = [(2, 6), *[(0, 1)] * 3, *[(5, 4)] * 3, (0, 3), (6, 1), (2, 3)]
MULTIPLIERS = [1, 3]


class Bordered:
    """The matrix with random numbers, and the same as a dense one."""

    def __init__(self, seed: int, twin: bool = False) -> None:
        rng = np.random.default_rng(seed)
        matrix, addresses = plan(NODES, PAIRS | set(ENDS[7:]), JOINTS, ENDS)
        self.matrix: Any = matrix._make(as_rows(part) for part in matrix)
        rows = np.zeros(len(ENDS), COMPLIANT.dtype)
        rows["D"] = rng.normal(size=(len(rows), 12))
        if twin:
            # both parts of the gear's last row repeat those of the one before
            rows["D"][[3, 6]] = rows["D"][[2, 5]]
        rows["stiffness"][7:], rows["damping"][7:] = [3.0, -0.5, 2.0], [0.1, 0.2, 0.3]
        self.rows: Rows = as_rows(rows)
        A = np.zeros((42, 42))
        for p, c in enumerate(self.matrix.columns):
            if c.node:
                c.mass, c.J = rng.uniform(1, 2), np.diag(rng.uniform(1, 2, 3)).ravel()
                own = slice(6 * c.node, 6 * c.node + 6)
                A[own, own] += np.diag([*[c.mass] * 3, *c.J[[0, 4, 8]]])
            assert self.matrix.blocks[c.block].column == p
        K = np.zeros((42, 42))
        for a, b in PAIRS:
            if (a, b) in addresses:
                below, above = rng.normal(size=(2, 6, 6))
                K[6 * b : 6 * b + 6, 6 * a : 6 * a + 6] = above.T
                K[6 * a : 6 * a + 6, 6 * b : 6 * b + 6] = below
                block = self.matrix.blocks[addresses[a, b]]
                block.stiff, block.stiff_above = below.ravel(), above.ravel()
        A += 0.5 * K
        D = np.zeros((4, 42))
        for k, (a, b) in enumerate(ENDS):
            row = np.zeros(42)
            row[6 * a : 6 * a + 6] += rows["D"][k, :6]
            row[6 * b : 6 * b + 6] += rows["D"][k, 6:]
            if k < 7:
                D[k if k < 4 else k - 3] += row
                continue
            sigma = 0.5 * rows["stiffness"][k] + 0.7 * rows["damping"][k]
            A += max(sigma, 0.0) * np.outer(row, row)
        self.A, self.D = A[6:, 6:], D[:, 6:]

    def solve(self, f: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        columns, first = self.matrix.columns, {0: 0, 1: 1}
        assemble(self.matrix, self.rows, 7, 0.5, 0.7)
        factorise(self.matrix)
        for c in columns:
            start = 6 * (c.node - 1) if c.node else first[int(c.entry > 0)]
            c.work[: c.rows] = (f if c.node else r)[start : start + c.rows]
        solve(self.matrix)
        x, y = np.zeros(36), np.zeros(4)
        for c in columns:
            start = 6 * (c.node - 1) if c.node else first[int(c.entry > 0)]
            (x if c.node else y)[start : start + c.rows] = c.work[: c.rows]
        return x, y


@pytest.mark.parametrize("seed", range(3))
def test_the_solution_is_that_of_the_dense_matrix(seed: int) -> None:
    bordered, rng = Bordered(seed), np.random.default_rng(seed + 10)
    f, r = rng.normal(size=36), rng.normal(size=4)
    dense = np.block([[bordered.A, bordered.D.T], [bordered.D, np.zeros((4, 4))]])
    # random stiffness is as much negative as positive
    assert np.linalg.eigvalsh(bordered.A + bordered.A.T)[0] < 0.0
    x, y = bordered.solve(f, r)
    # round-off, times the condition of a matrix that nothing made definite
    limit = 1e-14 * np.linalg.cond(dense) * 100.0
    wanted = np.linalg.solve(dense, np.concatenate([f, r]))
    np.testing.assert_allclose(np.concatenate([x, y]), wanted, atol=limit * np.abs(wanted).max())


def test_a_redundant_row_is_dropped_and_holds() -> None:
    bordered = Bordered(1, twin=True)
    x, y = bordered.solve(np.ones(36), np.array([0.3, 0.1, 0.2, 0.2]))
    assert bordered.matrix.columns["dropped"].sum() == 1
    assert y[3] == 0.0
    np.testing.assert_allclose(bordered.D @ x, [0.3, 0.1, 0.2, 0.2], atol=1e-9)
