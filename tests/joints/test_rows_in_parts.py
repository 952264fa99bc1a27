"""Claim: the sparse saddle solve equals the dense one, also for rows of more than two bodies."""

from typing import Any

import numpy as np
from plain import plain, records

from crashsolve.foundation.saddle import factorise, plan, solve_rate
from crashsolve.model.nodes import ROW

# rows and nodes of five blocks: a chain with a loop, and two gears (two parts, one body shared)
BLOCKS = [(5, (0, 1)), (5, (1, 2)), (3, (2, 3)), (1, (1, 2, 0, 3)), (2, (0, 1, 1, 3))]


def random_rows(rng: np.random.Generator) -> tuple[Any, Any, np.ndarray]:
    """Saddle, rows with random D and X = D M^-1, and the dense S."""
    rows = records(sum(m * len(ends) // 2 for m, ends in BLOCKS), ROW)
    weight = [np.zeros((6, 6))] + [np.diag(rng.uniform(0.5, 2.0, 6)) for _ in range(3)]
    dense = np.zeros((sum(m for m, _ in BLOCKS), 24))
    entry = line = 0
    for m, ends in BLOCKS:
        for part in range(len(ends) // 2):
            a, b = ends[2 * part : 2 * part + 2]
            for i in range(m):
                D = rng.normal(size=12)
                row = rows[entry + part * m + i]
                row["D"] = D
                row["X"] = np.concatenate([weight[a] @ D[:6], weight[b] @ D[6:]])
                dense[line + i, 6 * a : 6 * a + 6] += D[:6]
                dense[line + i, 6 * b : 6 * b + 6] += D[6:]
        entry, line = entry + m * len(ends) // 2, line + m
    mass_inv = np.zeros((24, 24))
    for k in range(4):
        mass_inv[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = weight[k]
    saddle = plan([m for m, _ in BLOCKS], [ends for _, ends in BLOCKS])
    saddle = saddle._make(table.view(np.recarray) for table in saddle)
    return saddle, rows, dense @ mass_inv @ dense.T


def test_sparse_solution_equals_dense_solution() -> None:
    rng = np.random.default_rng(1)
    saddle, rows, S = random_rows(rng)
    rows["rate"] = rng.normal(size=len(rows))
    right, first = [], []
    entry = 0
    for m, ends in BLOCKS:
        parts = rows["rate"][entry : entry + m * len(ends) // 2].reshape(-1, m)
        right.append(parts.sum(axis=0))
        first.append(np.arange(entry, entry + m))
        entry += parts.size
    expected = np.linalg.solve(S, -2.0 * np.concatenate(right))
    plain(factorise)(saddle, rows)
    plain(solve_rate)(saddle, rows, -2.0)
    # round-off times the condition of S
    tolerance = 1e-14 * np.linalg.cond(S) * np.abs(expected).max()
    np.testing.assert_allclose(rows["delta"][np.concatenate(first)], expected, atol=tolerance)
    assert rows["delta"][entry - 4] == rows["delta"][entry - 2]  # both parts of one row
    assert saddle.redundant() == 0
