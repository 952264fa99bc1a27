"""Unilateral constraint: nodes that touch a surface are held on it as long as it pushes them.

    0 <= P_n,   v_n >= 0,   P_n v_n = 0       while a node touches, n out of b
    |P_t| <= mu P_n,   v_t = 0 below mu P_n,   P_t against v_t at mu P_n

P is the impulse on the node over half a step, v its velocity over b at the end of it: a node that
arrives loses its normal velocity at once (Eq. 23), then its normal acceleration (Eq. 24), and
leaves when the reaction would pull (Eq. 25; the chapter prints the opposite sign). Each
capture loses m v_n^2 / 2 of the node. Consequence to test: that of a bar's first node is 1 / (2 N)
of the energy for N elements; the impulse of a bar end on is that of the force laws as N grows. A
rigid body would lose all its energy, and its joints would be torn: it is refused.

References: Ambrosio (2003), Eq. 23-25; Moreau (1988), in Nonsmooth Mechanics and Applications, CISM
302, 1-82; Jean (1999), Computer Methods in Applied Mechanics and Engineering 177, 235-257.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import Card, SurfaceName, quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, dot, norm, scale

if TYPE_CHECKING:
    from crashsolve.contact._rows.unilateral import Parameters

STEPWISE = True
INSTEAD = "a law of force does: normal: {type: lankarani_nikravesh, stiffness: ..., ...}"


class Unilateral(Card):
    """Unilateral constraint: nodes of flexible parts stay on a surface while it pushes them."""

    a: tuple[SurfaceName, ...] = word("surfaces on nodes of flexible parts")
    b: tuple[SurfaceName, ...] = word("surfaces of the other side; the normal points out of them")
    friction_coefficient: float = quantity(
        "1", "mu; sticks below mu times the reaction", default=0.0, ge=0
    )


PARAMETERS = Record("friction_coefficient  1  mu")
HISTORY = Record("""
    normal         1    3  n
    arm_a          m    3  point of contact from the node of side a
    arm_b          m    3  the same of side b
    opening        N s  3  impulse on side a in the first half of the step
    closing        N s  3  in the second half
    impulse        N s  3  of unilateral impulses, at the end of the step
    lift           m/s     normal velocity that keeps the gap closed on a curved surface
    friction_loss  J       lost by friction in the step
    velocity_before  m/s  3  velocity over b before a capture
    reaction       N    3  force on side a at the end of the step, without unilateral impulses
""")


def build(card: Unilateral, scene: Scene, pair: Pair) -> Columns:
    return {"friction_coefficient": card.friction_coefficient}


def check(card: Unilateral, scene: Scene, nodes_a: set[int], nodes_b: set[int]) -> None:
    """Refuse bodies that the law must not hold; `nodes` are those of the surfaces of both sides."""
    flexible = {node for nodes in scene.part_nodes.values() for node in nodes}
    rigid = sorted(scene.names[node] for node in nodes_a - flexible)
    if rigid:
        whose = f"'{rigid[0]}' is not one" if rigid[0] != "ground" else "the ground is not one"
        message = f"holds nodes of flexible parts, and {whose}: to hold a rigid body would violate"
        raise scene.fail(f"{message} its joints and the energy; {INSTEAD}", "a")
    for joint in scene.joints.values():
        for node in sorted((set(joint.nodes) & (nodes_a | nodes_b)) - {0}):
            side = "a" if node in nodes_a else "b"
            message = f"joint '{joint.name}' holds '{scene.names[node]}' already"
            raise scene.fail(
                f"{message}, and a contact that holds would violate it; {INSTEAD}", side
            )


@kernel
def unilateral_impulse(p: Parameters, P, u, n, lift, mobility, mobility_along):
    """Impulse on side a, from P at velocity u over b, that leaves no v_n below `lift` [N s].

    The mobilities [1/kg] are those along n and along the slip.
    """
    P_n, u_n = dot(P, n), dot(u, n)
    push = max(P_n - (u_n - lift) / mobility, 0.0)
    tangential = add_scaled(P, -P_n, n)
    friction_force = add_scaled(tangential, -1.0 / mobility_along, add_scaled(u, -u_n, n))
    most, size = p.friction_coefficient * push, norm(friction_force)
    if size > most:
        friction_force = scale(most / size, friction_force)
    return add_scaled(friction_force, push, n)
