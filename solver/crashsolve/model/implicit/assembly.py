"""Shells as implicit integrators see them: their points as bodies, and the matrix of all of these.

A point that moves by itself becomes a row of the node table behind the bodies that have names, and
is attached to it; one without free motions is attached to the ground. The elements' forces then act
on bodies, and their stiffness joins nodes that share an element (system/implicit/stiffness.py).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.elements.shells.tangents.records import BASE, CHANGE
from crashsolve.foundation.point import ATTACHED, ATTACHED_POINT, LANES, OWN
from crashsolve.foundation.record import Record
from crashsolve.foundation.sparse.bordered import plan
from crashsolve.model.nodes import COMPLIANT, NODE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from crashsolve.model.model import Elements, Model, State

ALL_FIXED = 63  # all motions

COUNTS = Record("""
    numbers  count  numbers that elements keep
    arms     count  points that are attached beside the mass centres of bodies
""")


def add_nodes_of_points(model: Model, state: State) -> None:
    """Attach every point to a body. Writes: model.elements, state.nodes, points."""
    points, elements = state.points, model.elements
    assert elements is not None
    alone = points["fixed"] < ATTACHED
    fixed = np.flatnonzero(alone & (points["fixed"] == ALL_FIXED))
    moving = np.flatnonzero(alone & (points["fixed"] != ALL_FIXED))
    more = np.zeros(len(moving), NODE.dtype)
    own = points[moving]
    more["r"], more["v"], more["w"] = own["r"], own["v"], own["w"]
    more["q"][:, 0] = 1.0
    more["A"] = np.eye(3).ravel()
    more["mass_inv"] = own["mass_inv"]
    more["J_inv"] = own["J_inv"][:, None] * np.eye(3).ravel()
    more["J"] = np.eye(3).ravel() / own["J_inv"][:, None]
    more["L"] = own["w"] / own["J_inv"][:, None]
    attached_points = np.zeros(len(moving) + len(fixed), ATTACHED_POINT.dtype)
    attached_points["point"] = np.concatenate([moving, fixed])
    attached_points["node"][: len(moving)] = len(state.nodes) + np.arange(len(moving))
    attached_points["spot"][len(moving) :] = points["r"][fixed]
    # the ground stands where it does at the start of every step
    state.nodes["start_q"], state.nodes["start_A"] = state.nodes["q"], state.nodes["A"]
    state.nodes = np.concatenate([state.nodes, more])
    elements.attached_points = np.concatenate([elements.attached_points, attached_points])
    elements.node_points = moving
    points["fixed"][moving] |= OWN
    points["fixed"] |= ATTACHED


def assembled(
    model: Model, state: State, laws: list[tuple[int, list[Sequence[int]]]], factors: int
) -> dict[str, np.ndarray]:
    """Tables of so many matrices and of the compliant rows beside each.

    `laws` are the rows of every group that has tangents, and the nodes of each of its members.
    """
    joints = [(joint.rows, joint.nodes) for joint in model.joints]
    whole = joints + [(rows, nodes) for rows, own in laws for nodes in own]
    ends = [
        (int(nodes[k]), int(nodes[k + 1]))
        for rows, nodes in whole
        for k in range(0, len(nodes), 2)
        for _ in range(rows)
    ]
    pairs = shared_by_shells(model.elements, state) if model.elements else []
    given = sum(joint.rows * joint.parts for joint in model.joints)
    near = set(pairs) | set(ends[given:])
    matrix, block_of = plan(list(range(1, len(state.nodes))), near, joints, ends)
    rows = np.zeros(len(ends), COMPLIANT.dtype)
    rows["node_a"], rows["node_b"] = np.array(ends, int).reshape(-1, 2).T
    tables = {"compliant_updates": matrix.updates, "compliant_slots": matrix.slots}
    for k in range(factors):
        tables |= {f"columns_{k}": matrix.columns.copy(), f"blocks_{k}": matrix.blocks.copy()}
        tables[f"compliant_{k}"] = rows.copy()
    return tables | (
        tables_of_shell_tangents(model.elements, state, pairs, block_of) if model.elements else {}
    )


def shared_by_shells(elements: Elements, state: State) -> list[tuple[int, int]]:
    """Bodies of every two corners of the elements."""
    attached_points, body = elements.attached_points, np.zeros(len(state.points), int)
    body[attached_points["point"]] = attached_points["node"]
    return pairs_of(body[elements.corners.reshape(-1, 4, LANES)])


def tables_of_shell_tangents(
    elements: Elements,
    state: State,
    pairs: list[tuple[int, int]],
    block_of: dict[tuple[int, int], int],
) -> dict[str, np.ndarray]:
    """Tables of the tangents of shells, and the addresses of their blocks."""
    counts, attached_points = np.zeros(1, COUNTS.dtype), elements.attached_points
    counts["numbers"] = len(state.blocks)
    counts["arms"] = (attached_points["spot"].any(axis=1) & (attached_points["node"] > 0)).sum()
    return {
        "block_addresses": np.array([address(pair, block_of) for pair in pairs]),
        "base": np.zeros(BASE.SIZE * LANES),
        "change": np.zeros(CHANGE.SIZE * LANES),
        "counts": counts,
        "arms": np.zeros(3 * len(state.points)),
        "lanes_before": state.blocks.copy(),
    }


def pairs_of(own: np.ndarray) -> list[tuple[int, int]]:
    """Bodies of every two corners of elements (blocks, 4, lanes), as (blocks, 4, 4, lanes)."""
    rows, columns = np.broadcast_arrays(own[:, :, None], own[:, None])
    return list(zip(rows.ravel().tolist(), columns.ravel().tolist(), strict=True))


def address(pair: tuple[int, int], block_of: dict[tuple[int, int], int]) -> int:
    """Address of K of two bodies: twice the number of their block, plus 1 for its other side.

    Rows are those of the first; -1 where one of them does not move.
    """
    if pair in block_of:
        return 2 * block_of[pair]
    # no block has the number -1, and so 2 (-1) + 1
    return 2 * block_of.get(pair[::-1], -1) + 1
