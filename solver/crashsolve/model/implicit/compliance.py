"""Compliant rows: springs and contacts as implicit integrators see them, beside the joints.

A spring is a compliant constraint. The rows of all joints come first, those of the laws that
have a `tangent` follow; the bodies that they share decide the order of elimination, once. Laws
without one (loads, contacts that keep a list of near pairs) are left to the iteration.
"""

import numpy as np

from crashsolve.deck.family import FamilyError
from crashsolve.foundation.sparse.planning import plan
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.model import Group, Model, State
from crashsolve.model.nodes import COMPLIANT, TANGENTS

# of a block of the sparse matrix: motions of one body against another
MAX_ROWS = 6


def tangent_groups(model: Model) -> list[Group]:
    """Groups of springs whose laws have a tangent."""
    return [g for g in model.groups if hasattr(g.module, "tangent")]


def has_nodal_tangents(model: Model) -> bool:
    """Whether there are elements whose tangents are blocks of their nodes."""
    return bool(model.elements) or any(hasattr(g.module, "tangent_blocks") for g in model.groups)


def tangent_contacts(model: Model) -> list[ContactGroup]:
    """Contact groups that keep all their pairs."""
    return [c for c in model.contact_groups if c.search is None]


def compliance(model: Model, state: State, factors: int) -> dict[str, np.ndarray]:
    """Tables of the compliant rows, and room for as many factors of their matrix.

    Raises FamilyError for a law with more rows than a block holds.
    """
    joints = [(joint.rows, joint.nodes) for joint in model.joints]
    laws, groups, first = [], [], []
    row = sum(rows * len(nodes) // 2 for rows, nodes in joints)
    for rows, ends in [*map(_spring_ends, tangent_groups(model)), *_contacts(model)]:
        first.append(row)
        groups.append((rows, ends))
        laws += [(rows, nodes) for nodes in ends]
        row += sum(rows * len(nodes) // 2 for nodes in ends)
    tangents = np.zeros(len(first), TANGENTS.dtype)
    tangents["first"] = first
    if has_nodal_tangents(model):
        from crashsolve.model.implicit.assembly import assembled

        return {"tangents": tangents} | assembled(model, state, groups, factors)
    for module in (g.module for g in tangent_groups(model) if g.module.TANGENTS > MAX_ROWS):
        message = f"{module.__name__}: TANGENTS is {module.TANGENTS}"
        raise FamilyError(f"{message}; two bodies have at most {MAX_ROWS} compliant rows")
    both = joints + laws
    saddle = plan([rows for rows, _ in both], [nodes for _, nodes in both])
    table = np.zeros(row, COMPLIANT.dtype)
    ends = [
        nodes[k : k + 2]
        for rows, nodes in both
        for k in range(0, len(nodes), 2)
        for _ in range(rows)
    ]
    table["node_a"], table["node_b"] = np.array(ends, int).reshape(-1, 2).T
    tables = {"tangents": tangents}
    shared = ("levels", "lines", "updates", "targets", "pairs")
    tables |= {f"compliant_{name}": getattr(saddle, name) for name in shared}
    for k in range(factors):
        tables |= {f"columns_{k}": saddle.columns.copy(), f"blocks_{k}": saddle.blocks.copy()}
        tables[f"compliant_{k}"] = table.copy()
    return tables


def _spring_ends(group: Group) -> tuple[int, list[tuple[int, ...]]]:
    """Rows of an entry, and the nodes of each: two, or two for each part of the rows."""
    p = group.parameters
    if group.joins_several:
        return group.module.TANGENTS, [tuple(nodes) for nodes in p["node"].tolist()]
    return group.module.TANGENTS, list(zip(p["node_a"].tolist(), p["node_b"].tolist(), strict=True))


def _contacts(model: Model) -> list[tuple[int, list[tuple[int, ...]]]]:
    pairs_of_contacts: list[tuple[int, list[tuple[int, ...]]]] = []
    for c in tangent_contacts(model):
        a = c.elements_a["node"][c.parameters["a"]]
        b = c.elements_b["node"][c.parameters["b"]]
        pairs_of_contacts.append((c.tangent_rows, list(zip(a.tolist(), b.tolist(), strict=True))))
    return pairs_of_contacts
