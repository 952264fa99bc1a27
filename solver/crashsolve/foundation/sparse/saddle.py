"""Sparse Cholesky of the constraint matrix S = D M^-1 D^T, with rank detection.

Each joint is one column of up to 6 rows; two joints couple when they share a body. Of each column
the rows that are not zero are kept, one after the other. Columns that do not need each other make a
level, whose loops are few and long. A row acts
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
# rows that a column may have
SIZES = (1, 2, 3, 4, 5, 6)

COLUMN = Record("""
    rows     count     rows of the joint, at most 6
    entry    index     its first entry in the table of rows
    end      index     one past its last entry; the parts follow each other
    work     index     its numbers: right-hand side, then solution;
    inverse  index     1 / L_ii, 0 where redundant;
    first    index     the diagonal block, followed by the rows below, `rows` numbers each
    below    count     rows below the diagonal block
    line     index     the first of these among the lines of its level
    dropped  count     rows found redundant
    pivot    1      6  diagonal of S, against which pivots are judged
    node     index     the hub whose velocities these are; 0 for a joint
""")
# columns of as many rows, none of which needs another: their operations need no order
LEVEL = Record("""
    rows        count  rows of each column
    is_hub      flag   whether it is that of a hub
    column      index  first column
    column_end  index  one past the last
    line        index  first line: a row below
    line_end    index  one past the last
    update      index  first update: two rows below
    update_end  index  one past the last
""")
LINE = Record("""
    at     index  its first number
    first  index  that of the diagonal block of its column
    work   index  its right-hand side
""")
# products of two rows with those above them and with themselves
UPDATE = Record("""
    one     index  first number of a row below
    other   index  that of the next row; of the last again where there is none
    first   index  that of the first row below
    count   count  rows from that to the other
    target  index  where the numbers stand, two of each, from which the products are subtracted
""")
PAIR = Record("""
    row_k   index  first entry of one joint
    half_k  flag   which half of D: 0 body a, 1 body b
    rows_k  count  its rows
    row_j   index  the same of the other joint
    half_j  flag   half
    rows_j  count  rows
    target  index  first number of the block to which D_k X_j^T adds, by rows of rows_j
    lower   flag   1: that is a diagonal block, whose lower triangle is enough; 2: it is that of a
                   hub and joint j, and takes D_j^T
""")


class Saddle(NamedTuple):
    """Columns in the order of elimination, and the updates of their numbers.

    `blocks` (numbers,) are the numbers of all columns, and a last one that nothing reads; `targets`
    are places among them.
    """

    columns: np.ndarray
    levels: np.ndarray
    lines: np.ndarray
    updates: np.ndarray
    targets: np.ndarray
    pairs: np.ndarray
    blocks: np.ndarray

    def redundant(self) -> int:
        """Rows found redundant by the last factorisation."""
        return int(self.columns["dropped"].sum())

    def rows(self) -> int:
        """Number of constraint rows."""
        return int(self.columns["rows"][self.columns["node"] == 0].sum())


@kernel
def factorise(saddle, rows, nodes):
    """S = D X^T = L L^T, dropping redundant rows. Writes: saddle."""
    assemble(saddle, rows)
    for p in range(saddle.columns.shape[0]):
        c = saddle.columns[p]
        if c.node > 0:
            put_mass(saddle.blocks, c.first, nodes[c.node])
    eliminate(saddle)


@inlined
def put_mass(x, at, body):
    """Subtract the lower triangle of the mass matrix of a hub, world axes. Writes: x."""
    W = body.W
    m = 1.0 / body.mass_inv
    x[at] = x[at + 7] = x[at + 14] = -m
    # the cofactors of W, which is symmetric
    a, b, c = W[4] * W[8] - W[5] * W[5], W[2] * W[5] - W[1] * W[8], W[1] * W[5] - W[2] * W[4]
    per = -1.0 / (W[0] * a + W[1] * b + W[2] * c)
    x[at + 21], x[at + 27], x[at + 33] = per * a, per * b, per * c
    x[at + 28] = per * (W[0] * W[8] - W[2] * W[2])
    x[at + 34] = per * (W[1] * W[2] - W[0] * W[5])
    x[at + 35] = per * (W[0] * W[4] - W[1] * W[1])


@kernel
def eliminate(saddle):
    """S = L L^T in place. Writes: saddle."""
    columns, levels, x = saddle.columns, saddle.levels, saddle.blocks
    # before any column has been eliminated
    for p in range(columns.shape[0]):
        keep_diagonal(columns[p], x)
    for k in range(levels.shape[0]):
        level = levels[k]
        if level.is_hub == 1:
            # M_c + D_c^T S'^-1 D_c, whose negative has come together
            for p in range(level.column, level.column_end):
                negate(x, columns[p].first, 36)
        # with a literal size the compiler unrolls
        for size in SIZES:
            if level.rows == size:
                eliminate_level(level, saddle, size)


@inlined
def keep_diagonal(c, x):
    """Writes: c.pivot."""
    for i in range(c.rows):
        c.pivot[i] = x[c.first + (c.rows + 1) * i]


@inlined
def negate(x, first, count):
    """Writes: x."""
    for k in range(first, first + count):
        x[k] = -x[k]


@kernel
def assemble(saddle, rows):
    """Numbers of S = D X^T. Writes: saddle.blocks."""
    columns, x, pairs = saddle.columns, saddle.blocks, saddle.pairs
    if columns.shape[0] > 0:
        last = columns[columns.shape[0] - 1]
        clear(x, last.first + last.rows * (last.rows + last.below))
    for e in range(pairs.shape[0]):
        pair = pairs[e]
        # read once: the compiler does not know that no write changes these
        left, right = (pair.row_k, 6 * pair.half_k), (pair.row_j, 6 * pair.half_j)
        height, width, kind, target = pair.rows_k, pair.rows_j, pair.lower, pair.target
        if kind == 2:
            add_transposed(x, target, rows, right, width)
        for m in SIZES:
            if kind == 1 and width == m:
                add_square(x, target, rows, left, right, m)
            if kind == 0 and width == m:
                add_product(x, target, rows, left, right, height, m)


@inlined
def clear(x, count):
    """Zeros in the first numbers; eight at a time are one instruction. Writes: x."""
    for k in range(0, count - 7, 8):
        for j in range(8):
            x[k + j] = 0.0
    for k in range(count - count % 8, count):
        x[k] = 0.0


@inlined
def add_square(x, target, rows, left, right, m):
    """x += D_j X_j^T over one body, its lower triangle. Writes: x."""
    for p in range(m):
        d = six(rows[left[0] + p].D, left[1])
        for q in range(p + 1):
            x[target + m * p + q] += along(d, six(rows[right[0] + q].X, right[1]))


@inlined
def add_product(x, target, rows, left, right, height, m):
    """x += D_k X_j^T over one body. Writes: x."""
    for p in range(height):
        d = six(rows[left[0] + p].D, left[1])
        for q in range(m):
            x[target + m * p + q] += along(d, six(rows[right[0] + q].X, right[1]))


@inlined
def add_transposed(x, target, rows, right, width):
    """x += D_j^T of one body, a hub. Writes: x."""
    for q in range(width):
        at = target + q
        for y in six(rows[right[0] + q].D, right[1]):
            x[at] += y
            at += width


@inlined
def six(D, c):
    """Six numbers of a row of D or X, from c on."""
    return (D[c], D[c + 1], D[c + 2], D[c + 3], D[c + 4], D[c + 5])


@inlined
def eliminate_level(level, saddle, m):
    """Eliminate the columns of a level, of m rows each. Writes: saddle."""
    columns, x = saddle.columns, saddle.blocks
    for p in range(level.column, level.column_end):
        c = columns[p]
        c.dropped = factor_diagonal(x, c.first, c.inverse, c.pivot, m)
    for e in range(level.line, level.line_end):
        solve_below(x, saddle.lines[e].at, saddle.lines[e].first, m)
    for e in range(level.update, level.update_end):
        subtract_products(x, saddle.updates[e], saddle.targets, m)


@inlined
def subtract_products(x, u, targets, m):
    """Writes: x."""
    one, other = numbers(x, u.one, m), numbers(x, u.other, m)
    first, target = u.first, u.target
    for j in range(u.count):
        b = numbers(x, first + m * j, m)
        x[targets[target + 2 * j]] -= along(one, b)
        x[targets[target + 2 * j + 1]] -= along(other, b)


@inlined
def factor_diagonal(x, first, inverse, diagonal, m):
    """Dense Cholesky of a diagonal block. Returns the rows dropped. Writes: x."""
    dropped = 0
    for i in range(m):
        at = first + m * i
        pivot = x[at + i]
        for j in range(i):
            y = x[at + j]
            for k in range(j):
                y -= x[at + k] * x[first + m * j + k]
            y *= x[inverse + j]
            x[at + j] = y
            pivot -= y * y
        if pivot <= REDUNDANT * diagonal[i]:
            x[inverse + i] = 0.0
            dropped += 1
        else:
            x[inverse + i] = 1.0 / sqrt(pivot)
            x[at + i] = pivot * x[inverse + i]
    return dropped


@inlined
def solve_below(x, at, first, m):
    """A row below the diagonal block: that of S times L^-T. Writes: x."""
    for j in range(m):
        y = x[at + j]
        for k in range(j):
            y -= x[at + k] * x[first + m * j + k]
        x[at + j] = y * x[first - m + j]


@inlined
def numbers(x, at, m):
    """The m numbers that stand there, and zeros up to six: in registers where m is literal."""
    return (
        x[at],
        x[at + 1] if m > 1 else 0.0,
        x[at + 2] if m > 2 else 0.0,
        x[at + 3] if m > 3 else 0.0,
        x[at + 4] if m > 4 else 0.0,
        x[at + 5] if m > 5 else 0.0,
    )


@inlined
def put_numbers(x, at, w, m):
    """The first m of six numbers. Writes: x."""
    x[at] = w[0]
    if m > 1:
        x[at + 1] = w[1]
    if m > 2:
        x[at + 2] = w[2]
    if m > 3:
        x[at + 3] = w[3]
    if m > 4:
        x[at + 4] = w[4]
    if m > 5:
        x[at + 5] = w[5]


@inlined
def along(a, b):
    """Scalar product of two rows of a column."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]


@kernel
def solve(saddle):
    """Solve L L^T y = work in place; redundant rows give 0. Writes: saddle.blocks."""
    columns, levels, x = saddle.columns, saddle.levels, saddle.blocks
    for k in range(levels.shape[0]):
        for size in SIZES:
            if levels[k].rows == size:
                solve_down(levels[k], saddle, size)
    for k in range(levels.shape[0] - 1, -1, -1):
        level = levels[k]
        for size in SIZES:
            if level.rows == size:
                solve_up(level, saddle, size)
        if level.is_hub == 1:
            # its block has the other sign
            for p in range(level.column, level.column_end):
                negate(x, columns[p].work, 6)


@inlined
def solve_down(level, saddle, m):
    """Forward substitution of the joints of a level, of m rows each. Writes: saddle.blocks."""
    columns, x = saddle.columns, saddle.blocks
    for p in range(level.column, level.column_end):
        first = columns[p].first
        for i in range(m):
            y = x[first - 2 * m + i]
            for k in range(i):
                y -= x[first + m * i + k] * x[first - 2 * m + k]
            x[first - 2 * m + i] = y * x[first - m + i]
    for e in range(level.line, level.line_end):
        line = saddle.lines[e]
        x[line.work] -= along(numbers(x, line.at, m), numbers(x, line.first - 2 * m, m))


@inlined
def solve_up(level, saddle, m):
    """Backward substitution of the joints of a level, of m rows each. Writes: saddle.blocks."""
    columns, x = saddle.columns, saddle.blocks
    for p in range(level.column, level.column_end):
        c = columns[p]
        w, first, work = numbers(x, c.work, m), c.first, c.work
        for e in range(c.line, c.line + c.below):
            line = saddle.lines[e]
            w = less(w, x[line.work], numbers(x, line.at, m))
        put_numbers(x, work, w, m)
        for i in range(m - 1, -1, -1):
            y = x[work + i]
            for k in range(i + 1, m):
                y -= x[first + m * k + i] * x[work + k]
            x[work + i] = y * x[first - m + i]


@inlined
def less(w, y, b):
    """w - y b, of six numbers each."""
    return (
        w[0] - y * b[0],
        w[1] - y * b[1],
        w[2] - y * b[2],
        w[3] - y * b[3],
        w[4] - y * b[4],
        w[5] - y * b[5],
    )


@kernel
def solve_rows(saddle, rows, factor):
    """rows.delta = S^-1 (factor * right). Writes: rows.delta, saddle."""
    columns, x = saddle.columns, saddle.blocks
    for p in range(columns.shape[0]):
        c = columns[p]
        # a hub has no rows, and its right-hand side is zero
        for i in range(c.rows):
            x[c.work + i] = 0.0
        # parts of a row add up
        for part in range(c.entry, c.end, c.rows):
            for i in range(c.rows):
                x[c.work + i] += factor * rows[part + i].right
    solve(saddle)
    spread_solution(columns, x, rows)


@inlined
def spread_solution(columns, x, rows):
    """The solution of every column to all parts of its rows. Writes: rows.delta."""
    for p in range(columns.shape[0]):
        c = columns[p]
        for part in range(c.entry, c.end, c.rows):
            for i in range(c.rows):
                rows[part + i].delta = x[c.work + i]


@inlined
def saddle_of(scene):
    """That of the joints of a scene."""
    return Saddle(
        scene.columns,
        scene.levels,
        scene.lines,
        scene.updates,
        scene.targets,
        scene.pairs,
        scene.blocks,
    )


@inlined
def compliant_saddle(scene, columns, blocks):
    """That of the compliant rows of a scene, of which there may be several factors."""
    return Saddle(
        columns,
        scene.compliant_levels,
        scene.compliant_lines,
        scene.compliant_updates,
        scene.compliant_targets,
        scene.compliant_pairs,
        blocks,
    )
