"""Tie of nodes to faces: a node follows a face of another shell, without a motion of its own.

    r = sum N_i r_i + c n,   w = sum N_i w_i,   v = r_dot
    f_i = N_i f + c (dn / dr_i)^T f,   t_i = N_i t,   m_i += N_i m,   J_i += N_i J

N are the weights of the node's position on the face (bilinear, or linear on a triangle), c its
height above it, and n the normal of the diagonals; all stay as they are at the start. The forces
are those whose power is that of f and t, so a tie takes no energy, and forces and moments keep
their sums. Consequence to test: a rigid motion of both shells strains neither, and constant
strains pass where every node of the face's side has a tied node at it.

References: Hallquist, Goudreau and Benson (1985), Sliding interfaces with contact-impact in
large-scale Lagrangian computations, Computer Methods in Applied Mechanics and Engineering 51,
107-137 (tied interfaces, with height zero).
"""

import numpy as np

from crashsolve.deck.building import Columns, PartOfScene, Scene
from crashsolve.deck.card import Card, PartName, SetName, quantity, word
from crashsolve.ties._faces import OnFace, nearest_face

IMPLICIT = ("generalized_alpha", "radau_iia_5")


class NodeToFace(Card):
    """Nodes of a set of a shell that are tied to the faces of another."""

    part: PartName = word("shell part whose nodes are tied")
    nodes: SetName = word("set of nodes of its mesh")
    to: PartName = word("shell part to whose faces they are tied")
    within: float | None = quantity(
        "m", "largest distance from the face; half of both thicknesses", default=None, gt=0
    )


def build(card: NodeToFace, scene: Scene) -> list[Columns]:
    _refuse_method(scene)
    (tied, _, first), (target, _, base) = (
        scene.skin(card.part, "part"),
        scene.skin(card.to, "to"),
    )
    if target.can_fail:
        message = f"elements of '{card.to}' may be deleted, and would leave their nodes without a"
        raise scene.fail(f"{message} face; tie the nodes of '{card.to}' to '{card.part}'", "to")
    limit = card.within
    if limit is None:
        limit = 0.5 * (tied.card.thickness + target.card.thickness)
    rows = []
    for node in tied.set_of(card.nodes, "nodes", scene):
        _refuse_fixed(int(node), tied, scene)
        x = tied.mesh.points[node]
        face = nearest_face(x, target.mesh.points, target.mesh.quads)
        if face is None or not face.distance <= limit:
            raise scene.fail(_too_far(face, x, card, limit), "nodes")
        corners = base + target.mesh.quads[face.face]
        own = {"corner": corners, "weight": face.weights, "height": face.height}
        rows.append({"point": first + int(node)} | own)
    return rows


def _refuse_method(scene: Scene) -> None:
    control = scene.deck.control
    method = f"integrator {control.integrator}"
    if control.solution == "quasi_static":
        method = "solution quasi_static"
    elif control.integrator not in IMPLICIT:
        return
    message = f"nodes are tied to faces in explicit steps, and {method} has none"
    raise scene.fail(f"{message}; set integrator: rattle, or give both parts one mesh")


def _refuse_fixed(node: int, tied: PartOfScene, scene: Scene) -> None:
    """A node that has a motion given already."""
    if tied.fixed[node]:
        message = (
            f"the node at {_shown(tied.mesh.points[node])} is supported, named, welded or tied"
        )
        raise scene.fail(f"{message} already; leave it out of the set", "nodes")


def _too_far(face: OnFace | None, x: np.ndarray, card: NodeToFace, limit: float) -> str:
    if face is None:
        message = f"the node at {_shown(x)} lies beside all faces of '{card.to}'"
        return f"{message}; leave it out of the set, or move one of the parts"
    reason = "half of both thicknesses" if card.within is None else "within"
    message = f"the node at {_shown(x)} is {face.distance:.3g} m from the nearest face of"
    message += f" '{card.to}', more than {limit:.3g} m ({reason})"
    return f"{message}; move one of the parts, or allow the distance by within"


def _shown(x: np.ndarray) -> str:
    return "({}) m".format(", ".join(f"{value:.6g}" for value in x))
