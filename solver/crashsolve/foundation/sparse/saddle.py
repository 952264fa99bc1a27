"""Sparse block Cholesky of the constraint matrix S = D M^-1 D^T, with rank detection.

Each joint is one block of up to 6 rows; two joints couple when they share a body. A row acts
between two bodies; a joint of more bodies (gear) has several parts, each with all its rows, and the
parts of a row add up and share one multiplier. The order of elimination (minimum degree) and every
address are fixed at build; the compiled loops only follow them. A pivot that has lost all its
digits marks a redundant row: its multiplier is set to zero and the row is satisfied by the others
when the constraints agree with each other.

Reference: George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.record import Record

# a pivot below this share of its diagonal is round-off: S loses twice the digits of D
REDUNDANT = 1e-11

COLUMN = Record("""
    rows        count     rows of the joint, at most 6
    entry       index     its first entry in the table of rows
    end         index     one past its last entry; the parts follow each other
    block       index     its diagonal block, followed by the blocks below
    block_end   index     one past its last block
    update      index     first update of the later columns
    update_end  index     one past the last
    dropped     count     rows found redundant
    inverse     1      6  1 / L_ii; 0 where redundant
    pivot       1      6  diagonal of S, against which pivots are judged
    work        1      6  right-hand side, then solution
""")
BLOCK = Record("""
    x       1      36  S, then L, by rows of 6
    column  index      column of the joint whose rows these are
""")
UPDATE = Record("""
    a       index  block
    b       index  block
    target  index  target -= a b^T
""")
PAIR = Record("""
    row_k   index  first entry of one joint
    half_k  flag   which half of D: 0 body a, 1 body b
    rows_k  count  its rows
    row_j   index  the same of the other joint
    half_j  flag   half
    rows_j  count  rows
    block   index  block to which D_k X_j^T adds
    lower   flag   whether that is a diagonal block: its lower triangle is enough
""")


class Saddle(NamedTuple):
    """Columns in the order of elimination, their blocks, and what adds to which block."""

    columns: Any
    blocks: Any
    updates: Any
    pairs: Any

    def redundant(self) -> int:
        """Rows found redundant by the last factorisation."""
        return int(self.columns["dropped"].sum())

    def rows(self) -> int:
        """Number of constraint rows."""
        return int(self.columns["rows"].sum())


def plan(rows: list[int], nodes: list[tuple[int, ...]]) -> Saddle:
    """Addresses for joints of `rows[k]` rows between nodes `nodes[k]`, two per part (0: ground)."""
    touching = _joints_by_node(nodes)
    neighbours = [
        {j for node in set(ends) - {0} for j in touching[node]} - {k}
        for k, ends in enumerate(nodes)
    ]
    order, below = _eliminate(neighbours, rows)
    position = {joint: p for p, joint in enumerate(order)}
    entries = [0, *np.cumsum([m * len(ends) // 2 for m, ends in zip(rows, nodes, strict=True)])]
    columns = np.zeros(len(rows), COLUMN.dtype)
    address: dict[tuple[int, int], int] = {}
    for p, joint in enumerate(order):
        column = columns[p]
        column["rows"], column["entry"], column["end"] = (
            rows[joint],
            entries[joint],
            entries[joint + 1],
        )
        column["block"] = len(address)
        for q in [p, *sorted(position[b] for b in below[joint])]:
            address[q, p] = len(address)
        column["block_end"] = len(address)
    updates = updates_of(columns, order, position, below, address)
    blocks = np.zeros(len(address), BLOCK.dtype)
    blocks["column"] = [q for q, _ in address]
    pairs = _pairs(entries, rows, nodes, position, address)
    return Saddle(columns, blocks, np.array(updates, UPDATE.dtype), np.array(pairs, PAIR.dtype))


def _joints_by_node(nodes: list[tuple[int, ...]]) -> dict[int, list[int]]:
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


def updates_of(
    columns: np.ndarray,
    order: list[int],
    position: dict[int, int],
    below: dict[int, set[int]],
    address: dict[tuple[int, int], int],
) -> list[tuple[int, int, int]]:
    """What each column subtracts from the later ones: blocks (a, b, target), target -= a b^T.

    In the order of elimination. Writes: update and update_end of the columns.
    """
    updates: list[tuple[int, int, int]] = []
    for p, joint in enumerate(order):
        reached = sorted(position[b] for b in below[joint])
        columns[p]["update"] = len(updates)
        updates += [
            (address[q1, p], address[q2, p], address[q1, q2])
            for q1 in reached
            for q2 in reached
            if q1 >= q2
        ]
        columns[p]["update_end"] = len(updates)
    return updates


def _pairs(
    entries: list[int],
    rows: list[int],
    nodes: list[tuple[int, ...]],
    position: dict[int, int],
    address: dict[tuple[int, int], int],
) -> list[tuple[int, ...]]:
    """Products D X^T that make up S: each node adds one per pair of sides that lie on it."""

    def sides(k: int, node: int) -> list[tuple[int, int, int]]:
        """First entry, half of D and rows of each side of joint k that is this node."""
        ends = [side for side, end in enumerate(nodes[k]) if end == node]
        return [(entries[k] + side // 2 * rows[k], side % 2, rows[k]) for side in ends]

    return [
        (*a, *b, address[position[k], position[j]], k == j)
        for node, joints in sorted(_joints_by_node(nodes).items())
        for k in joints
        for j in joints
        if position[k] >= position[j]
        for a in sides(k, node)
        for b in sides(j, node)
    ]


@kernel
def factorise(saddle, rows):
    """S = D X^T = L L^T, dropping redundant rows. Writes: saddle."""
    assemble(saddle.pairs, saddle.blocks, rows)
    eliminate(saddle)


@kernel
def eliminate(saddle):
    """S = L L^T in place. Writes: saddle."""
    columns, blocks, updates = saddle.columns, saddle.blocks, saddle.updates
    # before any column has been eliminated
    for p in range(columns.shape[0]):
        keep_diagonal(columns[p], blocks[columns[p].block].x)
    for p in range(columns.shape[0]):
        c = columns[p]
        m = c.rows
        # with a literal size the compiler unrolls: most joints are hinges, 5 rows
        if m == 5:
            factor_column(c, columns, blocks, updates, 5)
        else:
            factor_column(c, columns, blocks, updates, m)


@inlined
def keep_diagonal(c, x):
    """Writes: c.pivot."""
    for i in range(c.rows):
        c.pivot[i] = x[7 * i]


@kernel
def assemble(pairs, blocks, rows):
    """Blocks of S = D X^T. Writes: blocks."""
    for e in range(blocks.shape[0]):
        x = blocks[e].x
        for k in range(36):
            x[k] = 0.0
    for e in range(pairs.shape[0]):
        pair = pairs[e]
        x = blocks[pair.block].x
        if pair.rows_k == 5 and pair.rows_j == 5:
            add_product(x, rows, pair, 5, 5)
        else:
            add_product(x, rows, pair, pair.rows_k, pair.rows_j)


@inlined
def add_product(x, rows, pair, height, width):
    """x += D_k X_j^T over one body. Writes: x."""
    for p in range(height):
        d = half(rows[pair.row_k + p].D, pair.half_k)
        for q in range(p + 1 if pair.lower == 1 else width):
            w = half(rows[pair.row_j + q].X, pair.half_j)
            x[6 * p + q] += (
                d[0] * w[0] + d[1] * w[1] + d[2] * w[2] + d[3] * w[3] + d[4] * w[4] + d[5] * w[5]
            )


@inlined
def half(D, second):
    """First or second half of a row of D or X."""
    c = 6 if second == 1 else 0
    return (D[c], D[c + 1], D[c + 2], D[c + 3], D[c + 4], D[c + 5])


@inlined
def factor_column(c, columns, blocks, updates, m):
    """Eliminate one joint of m rows. Writes: c, blocks."""
    factor_diagonal(blocks[c.block].x, c, m)
    for e in range(c.block + 1, c.block_end):
        solve_below(blocks[e].x, columns[blocks[e].column].rows, blocks[c.block].x, c.inverse, m)
    for e in range(c.update, c.update_end):
        u = updates[e]
        a, b = blocks[u.a], blocks[u.b]
        height, width = columns[a.column].rows, columns[b.column].rows
        subtract(blocks[u.target].x, a.x, b.x, height, width, m)


@inlined
def factor_diagonal(x, c, m):
    """Dense Cholesky of a diagonal block. Writes: x, c."""
    dropped = 0
    for i in range(m):
        pivot = x[7 * i]
        for j in range(i):
            y = x[6 * i + j]
            for k in range(j):
                y -= x[6 * i + k] * x[6 * j + k]
            y *= c.inverse[j]
            x[6 * i + j] = y
            pivot -= y * y
        if pivot <= REDUNDANT * c.pivot[i]:
            c.inverse[i] = 0.0
            dropped += 1
        else:
            c.inverse[i] = 1.0 / sqrt(pivot)
            x[7 * i] = pivot * c.inverse[i]
    c.dropped = dropped


@inlined
def solve_below(x, height, diagonal, inverse, m):
    """Rows of a block below: L_qp = S_qp L_pp^-T. Writes: x."""
    for i in range(height):
        for j in range(m):
            y = x[6 * i + j]
            for k in range(j):
                y -= x[6 * i + k] * diagonal[6 * j + k]
            x[6 * i + j] = y * inverse[j]


@inlined
def subtract(x, a, b, height, width, m):
    """x -= a b^T. Writes: x."""
    for i in range(height):
        for j in range(width):
            y = 0.0
            for k in range(m):
                y += a[6 * i + k] * b[6 * j + k]
            x[6 * i + j] -= y


@kernel
def solve(saddle):
    """Solve L L^T y = work in place; redundant rows give 0. Writes: saddle.columns.work."""
    columns, blocks = saddle.columns, saddle.blocks
    n = columns.shape[0]
    for p in range(n):
        c = columns[p]
        if c.rows == 5:
            solve_down(c, columns, blocks, 5)
        else:
            solve_down(c, columns, blocks, c.rows)
    for p in range(n - 1, -1, -1):
        c = columns[p]
        if c.rows == 5:
            solve_up(c, columns, blocks, 5)
        else:
            solve_up(c, columns, blocks, c.rows)


@inlined
def solve_down(c, columns, blocks, m):
    """Forward substitution of one joint of m rows. Writes: columns.work."""
    x, w = blocks[c.block].x, c.work
    for i in range(m):
        y = w[i]
        for k in range(i):
            y -= x[6 * i + k] * w[k]
        w[i] = y * c.inverse[i]
    hand_down(c, columns, blocks, m)


@inlined
def solve_up(c, columns, blocks, m):
    """Backward substitution of one joint of m rows. Writes: c.work."""
    x, w = blocks[c.block].x, c.work
    for e in range(c.block + 1, c.block_end):
        take_up(blocks[e].x, columns[blocks[e].column], w, m)
    for i in range(m - 1, -1, -1):
        y = w[i]
        for k in range(i + 1, m):
            y -= x[6 * k + i] * w[k]
        w[i] = y * c.inverse[i]


@inlined
def hand_down(c, columns, blocks, m):
    """What the m solved values of a block take from the blocks below. Writes: columns.work."""
    w = c.work
    for e in range(c.block + 1, c.block_end):
        b, below = blocks[e].x, columns[blocks[e].column]
        for i in range(below.rows):
            y = 0.0
            for k in range(m):
                y += b[6 * i + k] * w[k]
            below.work[i] -= y


@inlined
def take_up(b, below, w, m):
    """What the values of a block below take from the m of its column. Writes: w."""
    for i in range(below.rows):
        y = below.work[i]
        for k in range(m):
            w[k] -= b[6 * i + k] * y


@kernel
def solve_rows(saddle, rows, factor):
    """rows.delta = S^-1 (factor * right). Writes: rows.delta, saddle."""
    columns = saddle.columns
    for p in range(columns.shape[0]):
        c = columns[p]
        for i in range(c.rows):
            k = c.entry + i
            total = rows[k].right
            while k + c.rows < c.end:
                k += c.rows
                total += rows[k].right
            c.work[i] = factor * total
    solve(saddle)
    spread_solution(columns, rows)


@inlined
def spread_solution(columns, rows):
    """The solution of every column to all parts of its rows. Writes: rows.delta."""
    for p in range(columns.shape[0]):
        c = columns[p]
        for i in range(c.rows):
            k = c.entry + i
            while k < c.end:
                rows[k].delta = c.work[i]
                k += c.rows
