"""Plan of the constraint matrix: the order of elimination, and the address of every block.

Joints are eliminated in an order of minimum degree, hubs after them (see saddle.py).

Reference: George and Liu (1981), Computer Solution of Large Sparse Positive Definite Systems.
"""

from heapq import heapify, heappop, heappush

import numpy as np

from crashsolve.foundation.sparse.saddle import BLOCK, COLUMN, PAIR, UPDATE, Saddle


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
    address = addresses(columns, order, position, below)
    updates = updates_of(columns, order, position, below, address)
    blocks = np.zeros(len(address), BLOCK.dtype)
    blocks["column"] = [q for q, _ in address]
    pairs = _pairs(entries, rows, nodes, hubs, position, address)
    return Saddle(columns, blocks, np.array(updates, UPDATE.dtype), np.array(pairs, PAIR.dtype))


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
            # what has changed since then is further back in the heap as well
            if block in below or known != degree(block):
                continue
            order.append(block)
            below[block] = graph[block]
            for other in graph[block]:
                graph[other] = (graph[other] | graph[block]) - {block, other}
                if other in members:
                    heappush(heap, (degree(other), other))
    return order, below


def addresses(
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


def updates_of(
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


def _pairs(
    entries: list[int],
    rows: list[int],
    nodes: list[tuple[int, ...]],
    hubs: tuple[int, ...],
    position: dict[int, int],
    address: dict[tuple[int, int], int],
) -> list[tuple[int, ...]]:
    """Products D X^T that make up S: each node adds one per pair of sides that lie on it."""

    def sides(k: int, node: int) -> list[tuple[int, int, int]]:
        """First entry, half of D and rows of each side of joint k that is this node."""
        ends = [side for side, end in enumerate(nodes[k]) if end == node]
        return [(entries[k] + side // 2 * rows[k], side % 2, rows[k]) for side in ends]

    touching = _joints_by_node(nodes)
    found: list[tuple[int, ...]] = [
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
            found += [(0, 0, 6, *side, block, 2) for side in sides(k, hub)]
    return found
