"""Accelerometer: motion of a point of a body, in the axes of the body.

    a = A^T ( r_ddot + w_dot x d + w x (w x d) - g )

g only with `gravity: true`: an instrument shows -g at rest and nothing in free fall. Consequence to
test: on an arm of radius R turning at w it shows w^2 R towards the axis.
"""

from typing import Any

import numpy as np

from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, point_velocity
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, norm, put, sub, vec

FAMILY = "nodout"


class Accelerometer(Card):
    """Acceleration and velocity of a point of a body, in the axes of the body."""

    body: BodyName = word("body it is fixed to")
    at: Vec3 = quantity("m", "place in the frame of the body", default=(0.0, 0.0, 0.0))
    gravity: bool = word("subtract free fall, as an instrument does", default=False)


PARAMETERS = Record("""
    node       index     body
    point      m      3  from the mass centre, body axes
    free_fall  m/s^2  3  g, world axes; 0 when it is not subtracted
""")
OUTPUT = Record("""
    acceleration      m/s^2  3  of the point, body axes
    resultant         m/s^2     magnitude of the acceleration
    velocity          m/s    3  of the point, body axes
    angular_velocity  rad/s  3  of the body, body axes
""")


def build(card: Accelerometer, scene: Any) -> dict[str, Any]:
    node = scene.node(card.body)
    loads = scene.deck.entries["loads"].values() if card.gravity else ()
    falls = [entry.card.acceleration for entry in loads if entry.type == "gravity"]
    return {
        "node": node,
        "point": scene.from_mass_centre(node, card.at),
        "free_fall": np.sum(falls, axis=0) if falls else np.zeros(3),
    }


@kernel
def measure(p, out, t, nodes, rows, curves):
    """Writes: out."""
    body = nodes[p.node]
    d, w = arm(body, vec(p.point)), vec(body.w)
    spin = add(cross(vec(body.w_dot), d), cross(w, cross(w, d)))
    a = sub(add(vec(body.v_dot), spin), vec(p.free_fall))
    put(out.acceleration, matvec_t(body.A, a))
    out.resultant = norm(a)
    put(out.velocity, matvec_t(body.A, point_velocity(body, d)))
    put(out.angular_velocity, matvec_t(body.A, w))
