"""Sparse block Cholesky of the constraint matrix S = D M^-1 D^T, with rank detection.

Each joint is one block of up to 6 rows; two joints couple when they share a body. A row acts
between two bodies; a joint of more bodies (gear) has several parts, each with all its rows, and the
parts of a row add up and share one multiplier. The order of elimination (minimum degree) and every
address are fixed at build; the compiled loops only follow them. A pivot that has lost all its
digits marks a redundant row: its multiplier is set to zero and the row is satisfied by the others
when the constraints agree with each other.

Joints of one body couple with each other, and those of a chassis fill the factor. Such a hub is
left out of S, and its six velocities y are unknowns beside the multipliers, eliminated last:

    | S'    D_c  | | lambda |   | r |
    | D_c^T -M_c | |   y    | = | 0 |      S = S' + D_c M_c^-1 D_c^T

S' is definite where S is as long as nothing that hangs on the hub is joined to the ground: moving
all together strains no joint, so that D_c lies within the others. Consequence to test: the same
lambda.

References: George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems;
Vanderbei (1995), Symmetric quasidefinite matrices, SIAM Journal on Optimization 5, 100-113.
"""

from math import sqrt
from typing import NamedTuple

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
    node        index     the hub whose velocities these are; 0 for a joint
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
    lower   flag   1: that is a diagonal block, whose lower triangle is enough; 2: it is that of a
                   hub and joint j, and takes D_j^T
""")


class Saddle(NamedTuple):
    """Columns in the order of elimination, their blocks, and what adds to which block."""

    columns: np.ndarray
    blocks: np.ndarray
    updates: np.ndarray
    pairs: np.ndarray

    def redundant(self) -> int:
        """Rows found redundant by the last factorisation."""
        return int(self.columns["dropped"].sum())

    def rows(self) -> int:
        """Number of constraint rows."""
        return int(self.columns["rows"][self.columns["node"] == 0].sum())


@kernel
def factorise(saddle, rows, nodes):
    """S = D X^T = L L^T, dropping redundant rows. Writes: saddle."""
    assemble(saddle.pairs, saddle.blocks, rows)
    for p in range(saddle.columns.shape[0]):
        c = saddle.columns[p]
        if c.node > 0:
            put_mass(saddle.blocks[c.block].x, nodes[c.node])
    eliminate(saddle)


@inlined
def put_mass(x, body):
    """Subtract the lower triangle of the mass matrix of a hub, world axes. Writes: x."""
    W = body.W
    m = 1.0 / body.mass_inv
    x[0] = x[7] = x[14] = -m
    # the cofactors of W, which is symmetric
    a, b, c = W[4] * W[8] - W[5] * W[5], W[2] * W[5] - W[1] * W[8], W[1] * W[5] - W[2] * W[4]
    per = -1.0 / (W[0] * a + W[1] * b + W[2] * c)
    x[21], x[27], x[33] = per * a, per * b, per * c
    x[28] = per * (W[0] * W[8] - W[2] * W[2])
    x[34] = per * (W[1] * W[2] - W[0] * W[5])
    x[35] = per * (W[0] * W[4] - W[1] * W[1])


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
        # with a literal size the compiler unrolls: most joints are hinges or balls, 5 or 3 rows
        if m == 5:
            factor_column(c, columns, blocks, updates, 5)
        elif m == 3:
            factor_column(c, columns, blocks, updates, 3)
        elif c.node > 0:
            # M_c + D_c^T S'^-1 D_c, whose negative has come together
            negate(blocks[c.block].x, 36)
            factor_column(c, columns, blocks, updates, 6)
        else:
            factor_column(c, columns, blocks, updates, m)


@inlined
def negate(x, n):
    """Writes: x."""
    for k in range(n):
        x[k] = -x[k]


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
        elif pair.lower == 2:
            add_transposed(x, rows, pair)
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
def add_transposed(x, rows, pair):
    """x += D_j^T of one body, a hub. Writes: x."""
    for q in range(pair.rows_j):
        d = half(rows[pair.row_j + q].D, pair.half_j)
        x[q] += d[0]
        x[6 + q] += d[1]
        x[12 + q] += d[2]
        x[18 + q] += d[3]
        x[24 + q] += d[4]
        x[30 + q] += d[5]


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
        elif c.rows == 3:
            solve_down(c, columns, blocks, 3)
        else:
            solve_down(c, columns, blocks, c.rows)
    for p in range(n - 1, -1, -1):
        c = columns[p]
        if c.rows == 5:
            solve_up(c, columns, blocks, 5)
        elif c.rows == 3:
            solve_up(c, columns, blocks, 3)
        elif c.node > 0:
            solve_up(c, columns, blocks, 6)
            # its block has the other sign
            negate(c.work, 6)
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
    """Subtract the m solved values of a block from the blocks below. Writes: columns.work."""
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
    """Subtract the values of a block below from the m of its column. Writes: w."""
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
            total = 0.0
            # all parts of a row; none of a hub
            while k < c.end:
                total += rows[k].right
                k += c.rows
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
