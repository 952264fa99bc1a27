"""Bodies whose velocities are unknowns beside the multipliers, as they hold many others: hubs.

The joints of a chassis all couple with each other, and fill the factor of S = D M^-1 D^T. A hub is
taken out of it (foundation/sparse/saddle.py) where nothing that hangs together with it is joined to
the ground, where it is the heaviest of these, so that no digits are lost, and where joints enough
meet on it to pay for its column.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np

from crashsolve.foundation.sparse.planning import plan
from crashsolve.foundation.sparse.saddle import Saddle
from crashsolve.model.model import Joint

# joint rows on a hub: below them its column of 6 costs as much as it saves
LEAST_ROWS = 24


def plan_of(joints: Sequence[Joint], mass: np.ndarray) -> Saddle:
    """Addresses of the constraint matrix of these joints; `mass` (n,) of all nodes."""
    return plan([j.rows for j in joints], [j.nodes for j in joints], hubs_of(joints, mass))


def hubs_of(joints: Sequence[Joint], mass: np.ndarray) -> tuple[int, ...]:
    """Nodes that are hubs, at most one of a group that joints connect; `mass` (n,) of all nodes."""
    hubs = []
    for group in _connected(joints):
        nodes = {node for joint in group for node in joint.nodes}
        rows: dict[int, int] = defaultdict(int)
        for joint in group:
            for node in set(joint.nodes):
                rows[node] += joint.rows
        if 0 in nodes:
            continue
        hub = max(sorted(nodes), key=lambda node: rows[node])
        others = nodes - {hub}
        if rows[hub] >= LEAST_ROWS and all(mass[hub] >= mass[node] > 0.0 for node in others):
            hubs.append(hub)
    return tuple(hubs)


def set_references(nodes: np.ndarray, joints: Sequence[Joint]) -> None:
    """Writes: nodes.reference, the first body of each mechanism, or the ground that holds it."""
    for mechanism in mechanisms(joints):
        held = {node for joint in mechanism for node in joint.nodes}
        nodes["reference"][list(held)] = min(held)


def mechanisms(joints: Sequence[Joint]) -> list[list[Joint]]:
    """Joints in groups that share bodies other than the ground."""
    return _connected(joints, lambda joint: [node for node in joint.nodes if node])


def _connected(
    joints: Sequence[Joint], ends: Callable[[Joint], Sequence[int]] = lambda joint: joint.nodes
) -> list[list[Joint]]:
    """Joints in groups that share bodies of their `ends`, of which the ground may be one."""
    parent: dict[int, int] = {}

    def root(node: int) -> int:
        while parent.setdefault(node, node) != node:
            node = parent[node]
        return node

    for joint in joints:
        first = root(ends(joint)[0])
        for node in ends(joint)[1:]:
            parent[root(node)] = first
    groups: dict[int, list[Joint]] = defaultdict(list)
    for joint in joints:
        groups[root(ends(joint)[0])].append(joint)
    return list(groups.values())


def longest_arm(joints: list[Joint]) -> float:
    """Largest distance of a joint's point from its body's mass centre, or length of a rod [m]."""
    ends = [(joint.node_a, joint.frame.get("point_a")) for joint in joints]
    ends += [(joint.node_b, joint.frame.get("point_b")) for joint in joints]
    arms = [float(np.linalg.norm(point)) for node, point in ends if node > 0 and point is not None]
    return max(arms + [float(joint.frame.get("length", 0.0)) for joint in joints], default=0.0)
