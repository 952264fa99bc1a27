"""Sparse matrix of the nodes of a mesh, bordered by the rows of joints: L U in 6 by 6 blocks.

    | A  D^T |  | x  |   | f |
    | D   0  |  | -y | = | r |      A of the nodes, not symmetric in its numbers

A node is one block of six, a joint one of up to six rows. Nodes are eliminated first, in an order
of minimum degree, joints after them: then no pivot vanishes but that of a redundant row, whose
multiplier is set to zero (see saddle.py). A block of two nodes stands there twice, as it is below
the diagonal and transposed as it is above. A need not be symmetric or definite. Consequence to
test: the solution is that of the dense matrix.

Reference: George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems.
"""

from typing import NamedTuple

import numpy as np

from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.sparse.planning import minimum_degree
from crashsolve.foundation.sparse.saddle import REDUNDANT

COLUMN = Record("""
    rows        count      rows of the node or joint, at most 6
    entry       index      of a joint its first entry in the table of rows
    end         index      one past its last entry; the parts follow each other
    block       index      its diagonal block, followed by the blocks below
    block_end   index      one past its last block
    update      index      first update of the later columns
    update_end  index      one past the last
    dropped     count      rows found redundant
    inverse     1       6  1 / U_ii; 0 where redundant
    pivot       1       6  diagonal, against which pivots are judged
    work        1       6  right-hand side, then solution
    node        index      of which the block is; 0 for a joint
    mass        kg         of the node
    J           kg m^2  9  its inertia, world axes
""")
BLOCK = Record("""
    x            1    36  A, then L, by rows of 6
    column       index    column of the node or joint whose rows these are
    above        1    36  transpose of the block on the other side of the diagonal, then that of U
    stiff        N/m  36  stiffness of the elements, by rows of 6
    stiff_above  N/m  36  transpose of that of the other side
""")
UPDATE = Record("""
    a       index  block
    b       index  block
    target  index  target -= a b^T
""")
# of every compliant row; below 0 for a node that does not move
SLOT = Record("""
    a       index  block of node a, of a joint that of its rows and this node
    b       index  the same of node b
    across  index  block of both nodes
    flips   flag   whether that has the rows of node b
""")


class Bordered(NamedTuple):
    """Columns in the order of elimination, their blocks, the updates of each block, and the
    rows.
    """

    columns: np.ndarray
    blocks: np.ndarray
    updates: np.ndarray
    slots: np.ndarray


def plan(
    nodes: list[int],
    pairs: set[tuple[int, int]],
    joints: list[tuple[int, tuple[int, ...]]],
    ends: list[tuple[int, int]],
) -> tuple[Bordered, dict[tuple[int, int], int]]:
    """Addresses for these nodes, pairs of which share stiffness, joints (rows, nodes), and rows.

    `ends` are the nodes of all rows, those of the joints first. Returns the matrix, and the block
    of two nodes.
    """
    graph = _graph(nodes, pairs, joints)
    order, below = minimum_degree(graph, [1] * len(graph), len(nodes))
    position = {key: p for p, key in enumerate(order)}
    entries = np.cumsum([0, *(rows * len(own) // 2 for rows, own in joints)])
    columns = np.zeros(len(order), COLUMN.dtype)
    for p, key in enumerate(order):
        column, joint = columns[p], key - len(nodes)
        column["rows"] = 6 if joint < 0 else joints[joint][0]
        column["node"] = nodes[key] if joint < 0 else 0
        column["entry"], column["end"] = entries[joint : joint + 2] if joint >= 0 else (0, 0)
    address = _addresses(columns, order, position, below)
    updates = _updates_of(columns, order, position, below, address)
    blocks = np.zeros(len(address), BLOCK.dtype)
    blocks["column"] = [q for q, _ in address]
    names = [nodes[key] if key < len(nodes) else len(nodes) - 1 - key for key in order]
    block_of = {(names[q], names[p]): block for (q, p), block in address.items()}
    slots = np.array(_positions(ends, joints, block_of), SLOT.dtype)
    return Bordered(columns, blocks, np.array(updates, UPDATE.dtype), slots), block_of


def _graph(
    nodes: list[int], pairs: set[tuple[int, int]], joints: list[tuple[int, tuple[int, ...]]]
) -> list[set[int]]:
    """Neighbours of all nodes, and behind them of all joints, by their numbers in this list."""
    moving = {node: k for k, node in enumerate(nodes)}
    graph: list[set[int]] = [set() for _ in range(len(nodes) + len(joints))]
    edges = [(moving[a], moving[b]) for a, b in pairs if a in moving and b in moving]
    for k, (_, own) in enumerate(joints, start=len(nodes)):
        edges += [(k, moving[node]) for node in own if node in moving]
    for a, b in edges:
        if a != b:
            graph[a].add(b)
            graph[b].add(a)
    return graph


def _addresses(
    columns: np.ndarray,
    order: list[int],
    position: dict[int, int],
    below: dict[int, set[int]],
) -> dict[tuple[int, int], int]:
    """Number of the block at each (row, column) of positions in the order of elimination.

    Writes: block and block_end of the columns.
    """
    address: dict[tuple[int, int], int] = {}
    for p, key in enumerate(order):
        columns[p]["block"] = len(address)
        for q in [p, *sorted(position[b] for b in below[key])]:
            address[q, p] = len(address)
        columns[p]["block_end"] = len(address)
    return address


def _updates_of(
    columns: np.ndarray,
    order: list[int],
    position: dict[int, int],
    below: dict[int, set[int]],
    address: dict[tuple[int, int], int],
) -> list[tuple[int, int, int]]:
    """Updates of later columns by each column: blocks (a, b, target), target -= a b^T.

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


def _positions(
    ends: list[tuple[int, int]],
    joints: list[tuple[int, tuple[int, ...]]],
    addresses: dict[tuple[int, int], int],
) -> list[tuple[int, int, int, bool]]:
    """Blocks of every row: of joints, of which number k is called -1 - k, and of compliant ones."""
    slots = []
    for k, (rows, own) in enumerate(joints):
        for part in range(0, len(own), 2):
            a, b = (addresses.get((-1 - k, node), -1) for node in own[part : part + 2])
            slots += [(a, b, -1, False)] * rows
    for a, b in ends[len(slots) :]:
        across = addresses.get((a, b), addresses.get((b, a), -1)) if a != b else -1
        slots.append(
            (addresses.get((a, a), -1), addresses.get((b, b), -1), across, (b, a) in addresses)
        )
    return slots


@kernel
def assemble(matrix, rows, joint_rows, position, velocity):
    """A = M + position K, with compliant rows, and D. Writes: matrix.blocks, rows.X.

    X becomes sigma B (see compliance.py).
    """
    columns, blocks, slots = matrix.columns, matrix.blocks, matrix.slots
    for e in range(blocks.shape[0]):
        b = blocks[e]
        for k in range(36):
            b.x[k], b.above[k] = position * b.stiff[k], position * b.stiff_above[k]
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.node > 0:
            add_mass(c, blocks[c.block].x)
    for k in range(joint_rows):
        row, slot, line = rows[k], slots[k], line_of(matrix, slots[k], k)
        put_row(blocks, slot.a, row.D, 0, line)
        put_row(blocks, slot.b, row.D, 6, line)
    for k in range(joint_rows, rows.shape[0]):
        row, slot = rows[k], slots[k]
        sigma = position * row.stiffness + velocity * row.damping
        for j in range(12):
            row.X[j] = max(sigma, 0.0) * row.D[j]
        if sigma > 0.0:
            add_square(blocks, slot.a, row, 0)
            add_square(blocks, slot.b, row, 6)
            first = 6 if slot.flips else 0
            add_product(blocks, slot.across, row, first, 6 - first)


@kernel
def subtract_own(block, k, f, moment):
    """Subtract the force and moment on a node by its own motion k. Writes: block."""
    for i in range(3):
        block.stiff[6 * i + k] -= f[i]
        block.stiff[18 + 6 * i + k] -= moment[i]


@kernel
def subtract_coupling(block, k, is_column, f, moment):
    """Subtract the force and moment on a node by motion k of another, in a column or row of the
    block.

    Rows of a block of nodes a and b are those of a, or of b where it flips. Writes: block.
    """
    for i in range(3):
        if is_column:
            block.stiff[6 * i + k] -= f[i]
            block.stiff[18 + 6 * i + k] -= moment[i]
        else:
            block.stiff_above[6 * k + i] -= f[i]
            block.stiff_above[6 * k + 3 + i] -= moment[i]


@inlined
def add_mass(c, x):
    """Writes: x."""
    for k in range(3):
        x[7 * k] += c.mass
        for j in range(3):
            x[21 + 6 * k + j] += c.J[3 * k + j]


@inlined
def line_of(matrix, slot, k):
    """Number of row k among those of its joint."""
    block = slot.a if slot.a >= 0 else slot.b
    if block < 0:
        return 0
    c = matrix.columns[matrix.blocks[block].column]
    return (k - c.entry) % c.rows


@inlined
def put_row(blocks, block, D, half, line):
    """Writes: blocks."""
    if block >= 0:
        for j in range(6):
            blocks[block].x[6 * line + j] += D[half + j]
            blocks[block].above[6 * line + j] += D[half + j]


@inlined
def add_square(blocks, block, row, a):
    """sigma B^T B of one half of a row, where there is nothing above. Writes: blocks."""
    if block >= 0:
        x = blocks[block].x
        for i in range(6):
            for j in range(6):
                x[6 * i + j] += row.X[a + i] * row.D[a + j]


@inlined
def add_product(blocks, block, row, a, b):
    """sigma B^T B of two halves of a row. Writes: blocks."""
    if block >= 0:
        x, above = blocks[block].x, blocks[block].above
        for i in range(6):
            for j in range(6):
                more = row.X[a + i] * row.D[b + j]
                x[6 * i + j] += more
                above[6 * i + j] += more


@kernel
def factorise(matrix):
    """L U in place, dropping redundant rows. Writes: matrix."""
    columns, blocks, updates = matrix.columns, matrix.blocks, matrix.updates
    is_inner = True
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.node > 0:
            keep_diagonal(c, blocks[c.block].x)
            factor_column(c, columns, blocks, updates, 6)
            continue
        if is_inner:
            # of the joints before any of them has been eliminated
            for q in range(p, columns.shape[0]):
                keep_diagonal(columns[q], blocks[columns[q].block].x)
            is_inner = False
        factor_column(c, columns, blocks, updates, c.rows)


@inlined
def keep_diagonal(c, x):
    """Writes: c.pivot."""
    for i in range(c.rows):
        c.pivot[i] = abs(x[7 * i])


@inlined
def factor_column(c, columns, blocks, updates, m):
    """Eliminate one block of m rows. Writes: c, blocks."""
    factor_diagonal(blocks[c.block].x, c, m)
    for e in range(c.block + 1, c.block_end):
        height = columns[blocks[e].column].rows
        solve_below(blocks[e].x, height, blocks[c.block].x, c, m)
        solve_beside(blocks[e].above, height, blocks[c.block].x, m)
    for e in range(c.update, c.update_end):
        u = updates[e]
        a, b = blocks[u.a], blocks[u.b]
        height, width = columns[a.column].rows, columns[b.column].rows
        if height == 6 and width == 6:
            subtract(blocks[u.target].x, a.x, b.above, 6, 6, m)
            if u.a != u.b:
                subtract(blocks[u.target].above, a.above, b.x, 6, 6, m)
        else:
            subtract(blocks[u.target].x, a.x, b.above, height, width, m)
            if u.a != u.b:
                subtract(blocks[u.target].above, a.above, b.x, height, width, m)


@inlined
def factor_diagonal(x, c, m):
    """Dense factors of a diagonal block. Writes: x, c."""
    dropped = 0
    for k in range(m):
        pivot = x[7 * k]
        if abs(pivot) <= REDUNDANT * c.pivot[k]:
            c.inverse[k] = 0.0
            dropped += 1
        else:
            c.inverse[k] = 1.0 / pivot
        for i in range(k + 1, m):
            y = x[6 * i + k] * c.inverse[k]
            x[6 * i + k] = y
            for j in range(k + 1, m):
                x[6 * i + j] -= y * x[6 * k + j]
    c.dropped = dropped


@inlined
def solve_below(x, height, diagonal, c, m):
    """Rows of L in a block below. Writes: x."""
    for i in range(height):
        for j in range(m):
            y = x[6 * i + j]
            for k in range(j):
                y -= x[6 * i + k] * diagonal[6 * k + j]
            x[6 * i + j] = y * c.inverse[j]


@inlined
def solve_beside(x, height, diagonal, m):
    """Columns of U in a block beside, transposed. Writes: x."""
    for i in range(height):
        for j in range(m):
            y = x[6 * i + j]
            for k in range(j):
                y -= x[6 * i + k] * diagonal[6 * j + k]
            x[6 * i + j] = y


@kernel
def solve(matrix):
    """Solution of the bordered system, -y for joints, in place. Writes: matrix.columns.work."""
    columns, blocks = matrix.columns, matrix.blocks
    n = columns.shape[0]
    for p in range(n):
        c = columns[p]
        if c.node > 0:
            solve_down(c, columns, blocks, 6)
        else:
            solve_down(c, columns, blocks, c.rows)
    for p in range(n - 1, -1, -1):
        c = columns[p]
        if c.node > 0:
            solve_up(c, columns, blocks, 6)
        else:
            solve_up(c, columns, blocks, c.rows)


@inlined
def solve_down(c, columns, blocks, m):
    """Forward substitution of one block of m rows. Writes: columns.work."""
    x, w = blocks[c.block].x, c.work
    for i in range(m):
        for k in range(i):
            w[i] -= x[6 * i + k] * w[k]
    subtract_from_below(c, columns, blocks, m)


@inlined
def solve_up(c, columns, blocks, m):
    """Backward substitution of one block of m rows. Writes: c.work."""
    x, w = blocks[c.block].x, c.work
    for e in range(c.block + 1, c.block_end):
        subtract_below(blocks[e].above, columns[blocks[e].column], w, m)
    for i in range(m - 1, -1, -1):
        y = w[i]
        for j in range(i + 1, m):
            y -= x[6 * i + j] * w[j]
        w[i] = y * c.inverse[i]


@inlined
def subtract(x, a, b, height, width, m):
    """x -= a b^T. Writes: x."""
    for i in range(height):
        for j in range(width):
            y = 0.0
            for k in range(m):
                y += a[6 * i + k] * b[6 * j + k]
            x[6 * i + j] -= y


@inlined
def subtract_from_below(c, columns, blocks, m):
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
def subtract_below(b, below, w, m):
    """Subtract the values of a block below from the m of its column. Writes: w."""
    for i in range(below.rows):
        y = below.work[i]
        for k in range(m):
            w[k] -= b[6 * i + k] * y
