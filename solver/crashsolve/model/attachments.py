"""Nodes welded to a rigid body: its attached nodes, with no motion of their own.

    m = m_0 + sum m_k,   J = J_0 + m_0 [s_0] + sum (J_k + m_k [s_k]),   [s] = s . s I - s s^T

s_k are the positions of the nodes, s_0 that of the body's own mass centre, from the common one. It
is the mass matrix of Ambrosio (2003), Eq. 8, about the common mass centre, where it decouples into
that of a rigid body. Consequence to test: a free body with a beam welded on keeps its momentum and
its angular momentum, as it would with the joint `weld`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.foundation.orientation import crosses
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.deck.building import EntryOfScene, PartOfScene
    from crashsolve.elements.shells.cards import Weld

ATTACHED_NODE = Record("""
    node      index     the attached node
    body      index     to which it is welded
    arm       m      3  position of the node from the mass centre, body axes
    rotation  1      4  unit quaternion, node to body
""")
# methods in whose steps nodes are not carried
IMPLICIT = ("generalized_alpha", "radau_iia_5")
# shares by which distances and velocities may differ and are still the same
SAME = 1e-9
# mass of an attached node's row of the node table: its mass belongs to the body
NOTHING = 1e-300
# of its own inertia, in bounds of the step
LEAST_SHARE = 0.5


def weld(entry: EntryOfScene, scene: Scene) -> None:
    """Nodes welded to a body become its attached nodes. Writes: scene."""
    body, nodes = scene.names.index(entry.name), [scene.names.index(n) for n in entry.card.welded]
    flexible = {node for some in scene.part_nodes.values() for node in some}
    _refuse_implicit("welded", bool(nodes), scene)
    for node in nodes:
        name = scene.names[node]
        if node not in flexible:
            raise scene.fail(f"'{name}' is no node of a flexible part", "welded")
        if node in scene.welded:
            raise scene.fail(f"'{name}' is welded twice", "welded")
        _refuse_apart(body, node, "welded", scene)
        scene.welded[node] = body
    if nodes:
        add_welded_mass(body, nodes, scene)


def join(entry: EntryOfScene, scene: Scene) -> None:
    """A body that is part of another becomes its attached node, as do its own. Writes: scene."""
    body, name = scene.names.index(entry.name), entry.card.part_of
    whole = scene.names.index(name)
    _refuse_implicit("part_of", True, scene)
    if whole in (0, body):
        message = "must name another body; fix it to the ground by a joint of type weld"
        raise scene.fail(message, "part_of")
    above = scene.deck.entries["bodies"].get(name)
    if above is None:
        raise scene.fail(f"'{name}' is a node of a part; name a rigid body", "part_of")
    if above.card.part_of is not None:
        message = f"'{name}' is part of '{above.card.part_of}' itself"
        raise scene.fail(f"{message}; name '{above.card.part_of}'", "part_of")
    spin = float(np.linalg.norm(scene.w[body] - scene.w[whole]))
    if spin > SAME * (1.0 + np.linalg.norm(scene.w[whole])):
        message = f"begins with another angular velocity than '{name}', by {spin:.3g} rad/s"
        raise scene.fail(f"{message}; give both the same motion", "part_of")
    _refuse_apart(whole, body, "part_of", scene)
    own = [node for node, of in scene.welded.items() if of == body]
    scene.welded.update(dict.fromkeys([*own, body], whole))
    add_welded_mass(whole, [body], scene)


def _refuse_implicit(word: str, given: bool, scene: Scene) -> None:
    if given and scene.deck.control.integrator in IMPLICIT:
        message = f"'{word}' is for explicit integrators; use the joint of type weld instead"
        raise scene.fail(message, word)


def _refuse_apart(body: int, node: int, word: str, scene: Scene) -> None:
    """Refuse nodes that become part of a body without its motion."""
    apart = inconsistency(body, node, scene)
    if apart > SAME * (np.linalg.norm(scene.v[node]) + np.linalg.norm(scene.v[body])):
        message = f"'{scene.names[node]}' begins {apart:.3g} m/s faster than its position on "
        message += f"'{scene.names[body]}'" if word == "part_of" else "the body"
        raise scene.fail(f"{message}; give both the same motion", word)


def add_welded_mass(body: int, attached_nodes: list[int], scene: Scene) -> None:
    """Add mass and inertia of welded nodes to their body. Writes: scene.mass, J, r, v, offset."""
    some = [body, *attached_nodes]
    mass = scene.mass[some]
    A = scene.matrix(body)
    centre = mass @ scene.r[some] / mass.sum()
    J = np.zeros((3, 3))
    for i, m in zip(some, mass, strict=True):
        s, rotation = A.T @ (scene.r[i] - centre), A.T @ scene.matrix(i)
        J += rotation @ scene.J[i].reshape(3, 3) @ rotation.T
        J += m * (s @ s * np.eye(3) - np.outer(s, s))
    arm = centre - scene.r[body]
    scene.v[body] += crosses(scene.w[body], arm)
    scene.offset[body] += A.T @ arm
    scene.r[body], scene.mass[body], scene.J[body] = centre, mass.sum(), J.ravel()


def inertia_shares(scene: Scene) -> dict[int, float]:
    """Inertia of attached nodes for bounds of the step, over their own.

    The inertia M of a body is shared out among its nodes, most to the lightest, whose elements are
    the shortest and fastest, and to no node less than half of its own:

        M >= sum (1/2 + c w_n) T_n^T M_n T_n,   w_n = (m_least / m_n)^2

    with T_n the motion of node n by that of the body, and the largest c. A bound that holds for
    every node with its share holds for the body. Half is enough: a node within a member bears two
    elements, an attached one has one.
    """
    flexible = {node for some in scene.part_nodes.values() for node in some}
    own: dict[int, list[int]] = {}
    for node, body in scene.welded.items():
        if node in flexible:
            own.setdefault(body, []).append(node)
    shares: dict[int, float] = {}
    for body, nodes in own.items() if not scene.errors else ():
        least = float(scene.mass[nodes].min())
        weights = {node: (least / float(scene.mass[node])) ** 2 for node in nodes}
        rest, weighed = _inertia_about(body, body, scene), np.zeros((6, 6))
        for node, weight in weights.items():
            inertia = _inertia_about(body, node, scene)
            rest, weighed = rest - LEAST_SHARE * inertia, weighed + weight * inertia
        inverse = np.linalg.inv(np.linalg.cholesky(weighed))
        c = max(0.0, float(np.linalg.eigvalsh(inverse @ rest @ inverse.T)[0]))
        shares |= {node: LEAST_SHARE + c * weight for node, weight in weights.items()}
    return shares


def _inertia_about(body: int, node: int, scene: Scene) -> np.ndarray:
    """T^T M T (6, 6) of a node, by velocity and spin of its body's mass centre, world axes."""
    x, y, z = scene.r[node] - scene.r[body]
    T, M, A = np.eye(6), np.zeros((6, 6)), scene.matrix(node)
    T[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    M[:3, :3] = scene.mass[node] * np.eye(3)
    M[3:, 3:] = A @ scene.J[node].reshape(3, 3) @ A.T
    return T.T @ M @ T


def lump_points(body: int, x: np.ndarray, mass: np.ndarray, J: np.ndarray, scene: Scene) -> None:
    """Add points (n, 3) of these masses and inertias about any axis to a body.

    Writes: scene.mass, J, r, v, offset.
    """
    A, total = scene.matrix(body), scene.mass[body] + mass.sum()
    centre = (scene.mass[body] * scene.r[body] + mass @ x) / total
    if any(body in nodes for nodes in scene.part_nodes.values()):
        # an element holds its node at the mass centre, which must stay on the axis
        centre = scene.r[body]
    moments = scene.J[body].reshape(3, 3) + J.sum() * np.eye(3)
    positions, masses = np.vstack([scene.r[body], x]), np.append(scene.mass[body], mass)
    for s, m in zip((positions - centre) @ A, masses, strict=True):
        moments += m * (s @ s * np.eye(3) - np.outer(s, s))
    arm = centre - scene.r[body]
    scene.v[body] += crosses(scene.w[body], arm)
    scene.offset[body] += A.T @ arm
    scene.r[body], scene.mass[body], scene.J[body] = centre, total, moments.ravel()


def inconsistency(body: int, attached_node: int, scene: Scene) -> float:
    """Difference of the velocities of a node and of its position on the body [m/s]."""
    arm = scene.r[attached_node] - scene.r[body]
    apart = scene.v[attached_node] - scene.v[body] - crosses(scene.w[body], arm)
    return float(np.linalg.norm(apart))


def table(scene: Scene) -> np.ndarray:
    """The attached nodes (n,) as kernels read them."""
    rows = np.zeros(len(scene.welded), ATTACHED_NODE.dtype)
    for row, (node, body) in zip(rows, scene.welded.items(), strict=True):
        row["node"], row["body"] = node, body
        row["arm"] = scene.to_body(body, scene.r[node])
        row["rotation"] = _between(scene.q[body], scene.q[node])
    return rows


def transfer_inertia(nodes: np.ndarray, attached_nodes: np.ndarray) -> None:
    """Take their inertia from the rows of attached nodes. Writes: nodes."""
    at = attached_nodes["node"]
    nodes["mass_inv"][at], nodes["is_attached"][at] = 1.0 / NOTHING, 1
    for name in ("J", "J_inv", "L"):
        nodes[name][at] = 0.0


def _between(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternion p^-1 q."""
    w, v = p[0], -p[1:]
    return np.array([w * q[0] - v @ q[1:], *(w * q[1:] + q[0] * v + crosses(v, q[1:]))])


def check_reach(
    weld: Weld,
    meshed: PartOfScene,
    points: np.ndarray,
    gaps: np.ndarray,
    field: str,
    scene: Scene,
) -> None:
    """No node may be welded to one that is farther away than `within`.

    By default that is the longest side of the elements at these nodes: with nodes that face
    each other the distance is an offset of the axis or the thickness, and with a mesh that is
    twice as coarse half of its elements.
    """
    x = meshed.mesh.points[meshed.mesh.quads[np.isin(meshed.mesh.quads, points).any(axis=1)]]
    longest = float(np.linalg.norm(x - np.roll(x, -1, axis=1), axis=2).max())
    limit = longest if weld.within is None else weld.within
    worst = int(np.argmax(gaps))
    if gaps[worst] > limit * (1.0 + SAME):
        location = ", ".join(f"{value:.6g}" for value in meshed.mesh.points[points[worst]])
        reason = "the longest side of its elements" if weld.within is None else "within"
        message = (
            f"the node at ({location}) m is {gaps[worst]:.3g} m from the nearest node of "
            f"'{weld.part}' that is a body, more than {limit:.3g} m ({reason})"
        )
        advice = "move one of the parts, or allow the distance by within"
        raise scene.fail(f"{message}; {advice}", field)


def check_attached(
    meshed: PartOfScene, points: np.ndarray, body: int, field: str, scene: Scene
) -> None:
    """The points must begin with the motion of their positions on the body."""
    arm = meshed.mesh.points[points] - scene.r[body]
    velocity = scene.v[body] + crosses(scene.w[body], arm)
    apart = float(np.linalg.norm(meshed.velocities()[points] - velocity, axis=1).max(initial=0.0))
    spin = float(np.linalg.norm(meshed.spin[points] - scene.w[body], axis=1).max(initial=0.0))
    speed = float(np.linalg.norm(velocity, axis=1).max(initial=0.0))
    if apart > SAME * (speed + 1.0) or spin > SAME * (1.0 + np.linalg.norm(scene.w[body])):
        message = f"nodes begin {apart:.3g} m/s faster than their positions on the body"
        raise scene.fail(f"{message}; give both the same motion", field)
