"""Sparse block Cholesky of the constraint matrix S = D M^-1 D^T, with rank detection.

Each joint is one block of up to 6 rows; two joints couple when they share a body. A row acts
between two bodies; a joint of more bodies (gear) has several parts, each with all its rows, and the
parts of a row add up and share one multiplier. The order of elimination (minimum degree) and every
address are fixed at build; the compiled loops only follow them. A pivot that has lost all its digits marks a redundant row: its multiplier is set to zero and
the row is satisfied by the others when the constraints agree with each other.

Reference: George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from crashsolve.foundation.compile import kernel

# a pivot below this share of its diagonal is round-off: S loses twice the digits of D
REDUNDANT = 1e-11


class Saddle(NamedTuple):
    """Addresses and storage of the block factor; blocks are row-major."""

    row: Any  # (n_blocks + 1,) first entry in the table of rows of each block, in model order
    order: Any  # (n_blocks,) elimination order
    diagonal: Any  # (n_blocks,) address of the diagonal block, by elimination position
    below_start: Any  # (n_blocks + 1,) range of sub-diagonal blocks per position
    below_position: Any  # elimination position of each sub-diagonal block
    below_address: Any  # address of each sub-diagonal block
    update_start: Any  # (n_blocks + 1,) range of updates per position
    update: Any  # (n_updates, 5) address 1, address 2, target, rows 1, rows 2
    pair: Any  # (n_pairs, 8) entry, column, rows of block 1; of block 2; address; 1 if diagonal
    factor: Any  # blocks of S, then of L
    inverse: Any  # (n_rows,) 1 / L_ii by elimination; 0 where redundant
    work: Any  # (n_rows,) right-hand side in elimination order
    first: Any  # (n_blocks + 1,) first row of each elimination position
    redundant: Any  # (1,) rows found redundant by the last factorisation


def plan(rows: list[int], nodes: list[tuple[int, ...]]) -> Saddle:
    """Addresses for blocks of `rows[k]` rows between nodes `nodes[k]`, two per part (0: ground)."""
    n = len(rows)
    touching = _blocks_by_node(nodes)
    neighbours = [
        {j for node in set(pair) - {0} for j in touching[node]} - {k}
        for k, pair in enumerate(nodes)
    ]
    order, below = _eliminate(neighbours, rows)
    position = {block: p for p, block in enumerate(order)}
    address: dict[tuple[int, int], int] = {}
    size = 0
    for p, block in enumerate(order):
        for q in [p, *sorted(position[b] for b in below[block])]:
            address[q, p] = size
            size += rows[order[q]] * rows[block]
    return _tables(n, rows, nodes, order, position, below, address, size, touching)


def _blocks_by_node(nodes: list[tuple[int, ...]]) -> dict[int, list[int]]:
    touching: dict[int, list[int]] = {}
    for k, pair in enumerate(nodes):
        for node in set(pair) - {0}:
            touching.setdefault(node, []).append(k)
    return touching


def _eliminate(
    neighbours: list[set[int]], rows: list[int]
) -> tuple[list[int], dict[int, set[int]]]:
    """Minimum-degree order and, for each block, the later blocks its column reaches."""
    graph = [set(s) for s in neighbours]
    left = set(range(len(rows)))
    order: list[int] = []
    below: dict[int, set[int]] = {}
    while left:
        block = min(left, key=lambda b: (sum(rows[j] for j in graph[b]), b))
        left.remove(block)
        order.append(block)
        below[block] = graph[block]
        for j in graph[block]:
            graph[j] = (graph[j] | graph[block]) - {block, j}
    return order, below


def _tables(
    n: int,
    rows: list[int],
    nodes: list[tuple[int, ...]],
    order: list[int],
    position: dict[int, int],
    below: dict[int, set[int]],
    address: dict[tuple[int, int], int],
    size: int,
    touching: dict[int, list[int]],
) -> Saddle:
    below_start, below_position, below_address = [0], [], []
    update_start, update = [0], []
    for p, block in enumerate(order):
        reached = sorted(position[b] for b in below[block])
        below_position += reached
        below_address += [address[q, p] for q in reached]
        below_start.append(len(below_position))
        for q1 in reached:
            for q2 in reached:
                if q1 >= q2:
                    m1, m2 = rows[order[q1]], rows[order[q2]]
                    update.append([address[q1, p], address[q2, p], address[q1, q2], m1, m2])
        update_start.append(len(update))

    entries = [0, *np.cumsum([m * len(ends) // 2 for m, ends in zip(rows, nodes, strict=True)])]
    pair = _pairs(entries, rows, nodes, position, address, touching)

    def integers(values: Any, width: int = 0) -> np.ndarray:
        array = np.array(values, np.int64)
        return array.reshape(-1, width) if width else array

    total = sum(rows)
    return Saddle(
        row=integers(entries),
        order=integers(order),
        diagonal=integers([address[p, p] for p in range(n)]),
        below_start=integers(below_start),
        below_position=integers(below_position),
        below_address=integers(below_address),
        update_start=integers(update_start),
        update=integers(update, 5),
        pair=integers(pair, 8),
        factor=np.zeros(size),
        inverse=np.zeros(total),
        work=np.zeros(total),
        first=integers([0, *np.cumsum([rows[b] for b in order])]),
        redundant=np.zeros(1, np.int64),
    )


def _pairs(
    entries: list[int],
    rows: list[int],
    nodes: list[tuple[int, ...]],
    position: dict[int, int],
    address: dict[tuple[int, int], int],
    touching: dict[int, list[int]],
) -> list[list[int]]:
    """Products D X^T that make up S: each node adds one per pair of sides that lie on it."""

    def sides(k: int, node: int) -> list[list[int]]:
        """First entry, first column and rows of each side of block k that is this node."""
        ends = [side for side, end in enumerate(nodes[k]) if end == node]
        return [[entries[k] + side // 2 * rows[k], 6 * (side % 2), rows[k]] for side in ends]

    pair = []
    for node, blocks in sorted(touching.items()):
        for k in blocks:
            for j in blocks:
                if position[k] >= position[j]:
                    target = [address[position[k], position[j]], int(k == j)]
                    pair += [a + b + target for a in sides(k, node) for b in sides(j, node)]
    return pair


@kernel
def factorise(s, rows):
    """S = D X^T = L L^T, dropping redundant rows. Writes: s.factor, inverse, redundant."""
    assemble(s.pair, s.factor, rows)
    save_diagonal(s.first, s.diagonal, s.factor, s.work)
    dropped = 0
    for p in range(s.order.shape[0]):
        m = s.first[p + 1] - s.first[p]
        dropped += factor_diagonal(s.factor, s.diagonal[p], m, s.first[p], s.inverse, s.work)
        for e in range(s.below_start[p], s.below_start[p + 1]):
            q = s.below_position[e]
            height = s.first[q + 1] - s.first[q]
            solve_below(
                s.factor, s.below_address[e], height, s.diagonal[p], m, s.first[p], s.inverse
            )
        for e in range(s.update_start[p], s.update_start[p + 1]):
            u = s.update
            subtract(s.factor, u[e, 0], u[e, 1], u[e, 2], u[e, 3], u[e, 4], m)
    s.redundant[0] = dropped


@kernel
def assemble(pair, S, rows):
    """Blocks of S = D X^T; of diagonal blocks only the lower half. Writes: S."""
    S[:] = 0.0
    for e in range(pair.shape[0]):
        k, a, height = pair[e, 0], pair[e, 1], pair[e, 2]
        j, b, width = pair[e, 3], pair[e, 4], pair[e, 5]
        for p in range(height):
            D = rows[k + p].D
            target = pair[e, 6] + p * width
            for q in range(p + 1 if pair[e, 7] == 1 else width):
                X = rows[j + q].X
                S[target + q] += (
                    D[a] * X[b]
                    + D[a + 1] * X[b + 1]
                    + D[a + 2] * X[b + 2]
                    + D[a + 3] * X[b + 3]
                    + D[a + 4] * X[b + 4]
                    + D[a + 5] * X[b + 5]
                )


@kernel
def save_diagonal(first, diagonal, S, work):
    """Keep the diagonal of S, against which pivots are judged. Writes: work."""
    for p in range(diagonal.shape[0]):
        m = first[p + 1] - first[p]
        for i in range(m):
            work[first[p] + i] = S[diagonal[p] + i * m + i]


@kernel
def factor_diagonal(L, at, m, first, inverse, original):
    """Dense Cholesky of one diagonal block; returns the number of rows dropped."""
    dropped = 0
    for i in range(m):
        pivot = L[at + i * m + i]
        for j in range(i):
            x = L[at + i * m + j]
            for k in range(j):
                x -= L[at + i * m + k] * L[at + j * m + k]
            x *= inverse[first + j]
            L[at + i * m + j] = x
            pivot -= x * x
        if pivot <= REDUNDANT * original[first + i]:
            inverse[first + i] = 0.0
            dropped += 1
        else:
            inverse[first + i] = 1.0 / sqrt(pivot)
            L[at + i * m + i] = pivot * inverse[first + i]
    return dropped


@kernel
def solve_below(L, at, height, diagonal, m, first, inverse):
    """Rows of a sub-diagonal block: L_qp = S_qp L_pp^-T. Writes: L."""
    for i in range(at, at + height * m, m):
        for j in range(m):
            x = L[i + j]
            for k in range(j):
                x -= L[i + k] * L[diagonal + j * m + k]
            L[i + j] = x * inverse[first + j]


@kernel
def subtract(L, a, b, target, m1, m2, m):
    """S_q1q2 -= L_q1p L_q2p^T. Writes: L."""
    for i in range(m1):
        for j in range(m2):
            x = 0.0
            for k in range(m):
                x += L[a + i * m + k] * L[b + j * m + k]
            L[target + i * m2 + j] -= x


@kernel
def solve(s):
    """Solve L L^T y = work in place, in elimination order; redundant rows give 0. Writes: s.work."""
    n = s.order.shape[0]
    for p in range(n):
        m = s.first[p + 1] - s.first[p]
        forward(s.factor, s.work, s.inverse, s.diagonal[p], s.first[p], m)
        for e in range(s.below_start[p], s.below_start[p + 1]):
            q = s.first[s.below_position[e]]
            height = s.first[s.below_position[e] + 1] - q
            eliminate_below(s.factor, s.work, s.below_address[e], height, q, s.first[p], m)
    for p in range(n - 1, -1, -1):
        m = s.first[p + 1] - s.first[p]
        for e in range(s.below_start[p], s.below_start[p + 1]):
            q = s.first[s.below_position[e]]
            height = s.first[s.below_position[e] + 1] - q
            collect_below(s.factor, s.work, s.below_address[e], height, q, s.first[p], m)
        backward(s.factor, s.work, s.inverse, s.diagonal[p], s.first[p], m)


@kernel
def forward(L, w, inverse, at, first, m):
    for i in range(m):
        y = w[first + i]
        for k in range(i):
            y -= L[at + i * m + k] * w[first + k]
        w[first + i] = y * inverse[first + i]


@kernel
def eliminate_below(L, w, at, height, q, first, m):
    for i in range(height):
        y = 0.0
        for k in range(m):
            y += L[at + i * m + k] * w[first + k]
        w[q + i] -= y


@kernel
def collect_below(L, w, at, height, q, first, m):
    for i in range(height):
        y = w[q + i]
        for k in range(m):
            w[first + k] -= L[at + i * m + k] * y


@kernel
def backward(L, w, inverse, at, first, m):
    for i in range(m - 1, -1, -1):
        y = w[first + i]
        for k in range(i + 1, m):
            y -= L[at + k * m + i] * w[first + k]
        w[first + i] = y * inverse[first + i]


@kernel
def solve_delta(s, rows, factor):
    """rows.delta = S^-1 (factor * phi). Writes: rows.delta, s.work."""
    for p in range(s.order.shape[0]):
        start, end = s.row[s.order[p]], s.row[s.order[p] + 1]
        m = s.first[p + 1] - s.first[p]
        for i in range(m):
            total = 0.0
            for k in range(start + i, end, m):
                total += rows[k].phi
            s.work[s.first[p] + i] = factor * total
    solve(s)
    for p in range(s.order.shape[0]):
        start, end = s.row[s.order[p]], s.row[s.order[p] + 1]
        m = s.first[p + 1] - s.first[p]
        for i in range(m):
            for k in range(start + i, end, m):
                rows[k].delta = s.work[s.first[p] + i]


@kernel
def solve_reaction(s, rows, factor):
    """rows.reaction = S^-1 (factor * reaction). Writes: rows.reaction, s.work."""
    for p in range(s.order.shape[0]):
        start, end = s.row[s.order[p]], s.row[s.order[p] + 1]
        m = s.first[p + 1] - s.first[p]
        for i in range(m):
            total = 0.0
            for k in range(start + i, end, m):
                total += rows[k].reaction
            s.work[s.first[p] + i] = factor * total
    solve(s)
    for p in range(s.order.shape[0]):
        start, end = s.row[s.order[p]], s.row[s.order[p] + 1]
        m = s.first[p + 1] - s.first[p]
        for i in range(m):
            for k in range(start + i, end, m):
                rows[k].reaction = s.work[s.first[p] + i]
