"""Shells as implicit integrators see them: their points as bodies, and the matrix of all of these.

A point that moves by itself becomes a row of the node table behind the bodies that have names, and
rides on it; one that is held altogether rides on the ground. The elements' forces then act on
bodies, and their stiffness joins nodes that share an element (system/stiffness.py).
"""

from typing import Any

import numpy as np

from crashsolve.foundation.bordered import plan
from crashsolve.foundation.point import LANES, RIDER, RIDES
from crashsolve.foundation.record import Record
from crashsolve.model.nodes import COMPLIANT, NODE

HELD = 63  # all motions

LINK = Record(
    point_a=("index", "a point"),
    point_b=("index", "the same, or one that shares an element with it and is eliminated before"),
    block=("index", "block of the matrix for both"),
)
COUNTS = Record(
    numbers=("count", "numbers that elements keep"),
    colours=("count", "colours of the points; those of one have no neighbour in common"),
)


def embody(model: Any, state: Any) -> None:
    """Give every point a body to ride on. Writes: model.elements, state.nodes, points."""
    points, elements = state.points, model.elements
    alone = points["held"] < RIDES
    fixed = np.flatnonzero(alone & (points["held"] == HELD))
    moving = np.flatnonzero(alone & (points["held"] != HELD))
    more = np.zeros(len(moving), NODE.dtype)
    own = points[moving]
    more["r"], more["v"], more["w"] = own["r"], own["v"], own["w"]
    more["q"][:, 0] = 1.0
    more["A"] = np.eye(3).ravel()
    more["mass_inv"] = own["mass_inv"]
    more["J_inv"] = own["J_inv"][:, None] * np.eye(3).ravel()
    more["J"] = np.eye(3).ravel() / own["J_inv"][:, None]
    more["L"] = own["w"] / own["J_inv"][:, None]
    riders = np.zeros(len(moving) + len(fixed), RIDER.dtype)
    riders["point"] = np.concatenate([moving, fixed])
    riders["node"][: len(moving)] = len(state.nodes) + np.arange(len(moving))
    riders["spot"][len(moving) :] = points["r"][fixed]
    # the ground stands where it does at the start of every step
    state.nodes["start_q"], state.nodes["start_A"] = state.nodes["q"], state.nodes["A"]
    state.nodes = np.concatenate([state.nodes, more])
    elements.riders = np.concatenate([elements.riders, riders])
    elements.embodied = moving
    points["held"] |= RIDES


def assembled(model: Any, state: Any, laws: list[Any]) -> dict[str, np.ndarray]:
    """Tables of the matrix and of the compliant rows beside it.

    `laws` are the rows of every group that has tangents, and the nodes of each of its members.
    """
    elements = model.elements
    joints = [(joint.rows, joint.nodes) for joint in model.joints]
    whole = joints + [(rows, nodes) for rows, own in laws for nodes in own]
    ends = [
        (int(nodes[k]), int(nodes[k + 1]))
        for rows, nodes in whole
        for k in range(0, len(nodes), 2)
        for _ in range(rows)
    ]
    neighbours = neighbours_of(elements.corners, len(state.points))
    body = np.zeros(len(state.points), int)
    body[elements.riders["point"]] = elements.riders["node"]
    pairs = {(int(body[a]), int(body[b])) for a, near in enumerate(neighbours) for b in near}
    given = sum(joint.rows * joint.parts for joint in model.joints)
    pairs |= set(ends[given:])
    matrix, found = plan(list(range(1, len(state.nodes))), pairs, joints, ends)
    links = [
        (a, b, found[int(body[a]), int(body[b])])
        for a, near in enumerate(neighbours)
        for b in near
        if (int(body[a]), int(body[b])) in found
    ]
    colours = colours_of(neighbours)
    counts = np.zeros(1, COUNTS.dtype)
    counts["numbers"], counts["colours"] = len(state.blocks), colours.max() + 1
    rows = np.zeros(len(ends), COMPLIANT.dtype)
    rows["node_a"], rows["node_b"] = np.array(ends, int).reshape(-1, 2).T
    return {
        "columns_0": matrix.columns,
        "blocks_0": matrix.blocks,
        "compliant_updates": matrix.updates,
        "compliant_pairs": matrix.pairs,
        "compliant_0": rows,
        "links": np.array(links, LINK.dtype),
        "colours": colours,
        "counts": counts,
        "base": np.zeros(6 * len(state.points)),
        "lanes_before": state.blocks.copy(),
    }


def neighbours_of(corners: np.ndarray, count: int) -> list[set[int]]:
    """Points that share an element with each, itself among them."""
    near: list[set[int]] = [{i} for i in range(count)]
    for element in corners.reshape(-1, 4, LANES).transpose(0, 2, 1).reshape(-1, 4).tolist():
        for point in element:
            near[point].update(element)
    return near


def colours_of(neighbours: list[set[int]]) -> np.ndarray:
    """A colour for each point; those of one colour have no neighbour in common."""
    colours = np.full(len(neighbours), -1)
    for point, near in enumerate(neighbours):
        taken = {colours[other] for middle in near for other in neighbours[middle]}
        colours[point] = next(k for k in range(len(neighbours)) if k not in taken)
    return colours
