"""Plan of the constraint matrix: the order of elimination, and the address of every block.

Joints are eliminated in an order of minimum degree, hubs after them (see saddle.py).

Reference: George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems.
"""

from heapq import heapify, heappop, heappush

import numpy as np

from crashsolve.foundation.sparse.saddle import COLUMN, LEVEL, LINE, PAIR, UPDATE, Saddle


def plan(rows: list[int], nodes: list[tuple[int, ...]], hubs: tuple[int, ...] = ()) -> Saddle:
    """Addresses for joints of `rows[k]` rows between nodes `nodes[k]`, two per part (0: ground).

    The velocities of `hubs` become unknowns; no two of them may share a joint.
    """
    touching = _joints_by_node(nodes)
    neighbours = [
        {j for node in set(ends) - {0, *hubs} for j in touching[node]} - {k}
        for k, ends in enumerate(nodes)
    ]
    first_hub = len(rows)
    for number, hub in enumerate(hubs, start=first_hub):
        neighbours.append(set(touching[hub]))
        for k in touching[hub]:
            neighbours[k].add(number)
    sizes = rows + [6] * len(hubs)
    order, below = minimum_degree(neighbours, sizes, first_hub)
    order, kinds = in_levels(order, below, sizes, first_hub)
    position = {joint: p for p, joint in enumerate(order)}
    entries = [0, *np.cumsum([m * len(ends) // 2 for m, ends in zip(rows, nodes, strict=True)])]
    columns = np.zeros(len(sizes), COLUMN.dtype)
    for p, joint in enumerate(order):
        column = columns[p]
        column["rows"] = sizes[joint]
        if joint < first_hub:
            column["entry"], column["end"] = entries[joint], entries[joint + 1]
        else:
            column["node"] = hubs[joint - first_hub]
    reached = [sorted(position[b] for b in below[joint]) for joint in order]
    address, count = addresses(columns, reached)
    levels, lines, updates, targets = elimination(columns, kinds, reached, address, count)
    pairs = np.array(_pairs(entries, rows, nodes, hubs, position, address), PAIR.dtype)
    return Saddle(columns, levels, lines, updates, targets, pairs, np.zeros(count + 1))


def _joints_by_node(nodes: list[tuple[int, ...]]) -> dict[int, list[int]]:
    touching: dict[int, list[int]] = {}
    for k, pair in enumerate(nodes):
        for node in set(pair) - {0}:
            touching.setdefault(node, []).append(k)
    return touching


def minimum_degree(
    neighbours: list[set[int]], sizes: list[int], last_from: int
) -> tuple[list[int], dict[int, set[int]]]:
    """Order of elimination, and the later blocks that the column of each block reaches.

    The least coupled rows go first; blocks from `last_from` on come after all others.
    """
    graph = [set(s) for s in neighbours]

    def degree(block: int) -> int:
        return sum(sizes[j] for j in graph[block])

    order: list[int] = []
    below: dict[int, set[int]] = {}
    for members in (range(last_from), range(last_from, len(graph))):
        heap = [(degree(block), block) for block in members]
        heapify(heap)
        while heap:
            known, block = heappop(heap)
            # entries changed since then are further back in the heap as well
            if block in below or known != degree(block):
                continue
            order.append(block)
            below[block] = graph[block]
            for other in graph[block]:
                graph[other] = (graph[other] | graph[block]) - {block, other}
                if other in members:
                    heappush(heap, (degree(other), other))
    return order, below


def in_levels(
    order: list[int], below: dict[int, set[int]], sizes: list[int], first_hub: int
) -> tuple[list[int], list[tuple[int, bool, int]]]:
    """The same order by levels, and the level, whether it is a hub, and the rows of each.

    A column needs those that reach it. What does not need another one may come before it or after:
    the factor is the same.
    """
    level = dict.fromkeys(order, 0)
    for joint in order:
        for other in below[joint]:
            level[other] = max(level[other], level[joint] + 1)
    kinds = {joint: (level[joint], joint >= first_hub, sizes[joint]) for joint in order}
    order = sorted(order, key=lambda joint: kinds[joint])
    return order, [kinds[joint] for joint in order]


def addresses(
    columns: np.ndarray, reached: list[list[int]]
) -> tuple[dict[tuple[int, int], int], int]:
    """First number of the block at each (row, column) of positions, and the count of all numbers.

    `reached` are the later positions that each column has rows of, in order. Writes: work, inverse,
    first and below of the columns.
    """
    sizes = columns["rows"].tolist()
    address: dict[tuple[int, int], int] = {}
    count = 0
    for p, others in enumerate(reached):
        size = sizes[p]
        columns[p]["work"], columns[p]["inverse"] = count, count + size
        count += 2 * size
        columns[p]["first"] = count
        columns[p]["below"] = sum(sizes[q] for q in others)
        for q in [p, *others]:
            address[q, p] = count
            count += sizes[q] * size
    return address, count


def elimination(
    columns: np.ndarray,
    kinds: list[tuple[int, bool, int]],
    reached: list[list[int]],
    address: dict[tuple[int, int], int],
    unread: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Levels, their lines and updates, and the targets of these (see saddle.py).

    `unread` is the number that takes values which are never read. Writes: line of the columns.
    """
    levels: list[tuple[int, ...]] = []
    lines: list[tuple[int, ...]] = []
    updates: list[tuple[int, ...]] = []
    targets: list[int] = []
    for kind in dict.fromkeys(kinds):
        own = [p for p, other in enumerate(kinds) if other == kind]
        starts = len(lines), len(updates)
        for p in own:
            columns[p]["line"] = len(lines)
            below = lines_of(columns, p, reached[p], address)
            lines += below
            target_blocks = targets_of(columns, reached[p], address)
            for i in range(0, len(below), 2):
                last = min(i + 1, len(below) - 1)
                one, other, first = below[i][0], below[last][0], below[0][0]
                updates.append((one, other, first, last + 1, len(targets)))
                both = np.full((last + 1, 2), unread)
                both[: i + 1, 0] = target_blocks[i, : i + 1]
                if last > i:
                    both[:, 1] = target_blocks[last, : last + 1]
                targets += both.ravel().tolist()
        levels.append((kind[2], kind[1], own[0], own[-1] + 1, starts[0], len(lines)))
        levels[-1] += (starts[1], len(updates))
        updates[starts[1] :] = sorted(updates[starts[1] :], key=lambda u: u[3])
    return (
        np.array(levels, LEVEL.dtype),
        np.array(lines, LINE.dtype),
        np.array(updates, UPDATE.dtype),
        np.array(targets, np.int32),
    )


def lines_of(
    columns: np.ndarray, p: int, others: list[int], address: dict[tuple[int, int], int]
) -> list[tuple[int, int, int]]:
    """Of each row below column p: where it stands, the column, and its right-hand side."""
    size, first = int(columns["rows"][p]), int(columns["first"][p])
    return [
        (address[q, p] + size * i, first, int(columns["work"][q]) + i)
        for q in others
        for i in range(columns["rows"][q])
    ]


def targets_of(
    columns: np.ndarray, others: list[int], address: dict[tuple[int, int], int]
) -> np.ndarray:
    """Number that each two rows i >= j below a column change; (rows, rows)."""
    heights = columns["rows"][others]
    # joint of each row, and which row of it
    joint = np.repeat(np.arange(len(others)), heights)
    row = np.arange(len(joint)) - np.repeat(np.cumsum(heights) - heights, heights)
    block = np.array([[address.get((q, r), 0) for r in others] for q in others], int)
    block = block.reshape(len(others), len(others))
    # a block has the width of its own column
    return block[joint[:, None], joint] + row[:, None] * heights[joint] + row


def _pairs(
    entries: list[int],
    rows: list[int],
    nodes: list[tuple[int, ...]],
    hubs: tuple[int, ...],
    position: dict[int, int],
    address: dict[tuple[int, int], int],
) -> list[tuple[int, ...]]:
    """Products D X^T that make up S: each node adds one per pair of sides that lie on it.

    Those of one shape follow each other.
    """

    def sides(k: int, node: int) -> list[tuple[int, int, int]]:
        """First entry, half of D and rows of each side of joint k that is this node."""
        ends = [side for side, end in enumerate(nodes[k]) if end == node]
        return [(entries[k] + side // 2 * rows[k], side % 2, rows[k]) for side in ends]

    touching = _joints_by_node(nodes)
    pairs: list[tuple[int, ...]] = [
        (*a, *b, address[position[k], position[j]], int(k == j))
        for node, joints in sorted(touching.items())
        if node not in hubs
        for k in joints
        for j in joints
        if position[k] >= position[j]
        for a in sides(k, node)
        for b in sides(j, node)
    ]
    for number, hub in enumerate(hubs, start=len(rows)):
        for k in touching[hub]:
            block = address[position[number], position[k]]
            pairs += [(0, 0, 6, *side, block, 2) for side in sides(k, hub)]
    return sorted(pairs, key=lambda pair: (pair[-1], pair[2], pair[5]))
