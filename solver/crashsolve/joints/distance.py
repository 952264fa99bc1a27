"""Distance: a massless rod with ball joints between a point of a and a point of b.

    Phi = (d . d / L - L) / 2 = 0,   d = x_b - x_a,   D v = d . d_dot / L

lambda is the force in the rod, compression positive. Consequence to test: five degrees of freedom;
a particle on a rod is a pendulum.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import point_velocity
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import cross, dot, scale, sub
from crashsolve.joints._card import POINTS
from crashsolve.joints._constraint_rows import centripetal, separation, write_row

if TYPE_CHECKING:
    from crashsolve.joints._rows.distance import Parameters

CONSTRAINTS = ()
ROWS = 1
ANGULAR = (False,)
PARAMETERS = POINTS + Record("length  m  L")


class Distance(Card):
    """Keeps the distance between a point of a and a point of b, as a massless rod."""

    a: BodyName = word("first body", default="ground")
    b: BodyName = word("second body")
    at_a: Vec3 = quantity("m", "point in the frame of a", default=(0.0, 0.0, 0.0))
    at_b: Vec3 = quantity("m", "point in the frame of b", default=(0.0, 0.0, 0.0))
    length: float | None = quantity(
        "m", "distance kept; that at the start when absent", default=None, gt=0
    )


def build(card: Distance, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    start = scene.distance(ends)
    allowed = scene.deck.control.constraint_tolerance * scene.size
    if start <= allowed:
        raise scene.fail("the two points coincide; use a spherical joint", "at_b")
    if card.length is not None and abs(card.length - start) > allowed:
        raise scene.fail(
            f"is {card.length:.12g} m, but the points are {start:.12g} m apart at the start; "
            "leave it out to keep that distance",
            "length",
        )
    return dict(ends) | {"length": start}


@kernel
def residual(p: Parameters, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    d, _, _ = separation(nodes[p.node_a], nodes[p.node_b], p.point_a, p.point_b)
    rows[p.first_row].phi = 0.5 * (dot(d, d) / p.length - p.length)


@kernel
def jacobian(p: Parameters, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    d, s_a, s_b = separation(nodes[p.node_a], nodes[p.node_b], p.point_a, p.point_b)
    u = scale(1.0 / p.length, d)
    write_row(rows[p.first_row], scale(-1.0, u), cross(u, s_a), u, cross(s_b, u))


@kernel
def convective(p: Parameters, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    d, s_a, s_b = separation(a, b, p.point_a, p.point_b)
    d_dot = sub(point_velocity(b, s_b), point_velocity(a, s_a))
    spin = sub(centripetal(b, s_b), centripetal(a, s_a))
    rows[p.first_row].gamma = -(dot(d_dot, d_dot) + dot(d, spin)) / p.length
