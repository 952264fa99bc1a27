"""Force on a point of a body, constant or by a curve of time.

    f = F phi(t)  in world axes,  or  f = A F phi(t)  in body axes;   power f . v of the point

Consequence to test: a constant force F in world axes does the work F . (x - x_0).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity
from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_external, arm, point_velocity
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, put, vec
from crashsolve.loads._on_body import BODY_LOAD, BodyLoadCard, body_load, present_load

if TYPE_CHECKING:
    from crashsolve.loads._rows.force import History, Output, Parameters


class Force(BodyLoadCard):
    """Force on a point of a body, constant or by a curve of time."""

    at: Vec3 = quantity("m", "point in the frame of the body", default=(0.0, 0.0, 0.0))
    force: Vec3 = quantity("N", "vector of the force; times curve")


CURVES_OF_TIME = ("curve",)
PARAMETERS = BODY_LOAD + Record("point  m  3  from the mass centre, body axes")
AMPLITUDE = "vector"
HISTORY = Record()
OUTPUT = Record("force  N  3  world axes")


def build(card: Force, scene: Scene) -> Columns:
    load = body_load(card, card.force, scene)
    return load | {"point": scene.from_mass_centre(load["node"], card.at)}


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    body = nodes[p.node]
    f = present_load(p, t, nodes, curves)
    d = arm(body, vec(p.point))
    apply_external(nodes, p.node, f, d, (0.0, 0.0, 0.0))
    put(out.force, f)
    out.stored = 0.0
    out.power = dot(f, point_velocity(body, d))
    out.loss = 0.0


@kernel
def present(p: Parameters, out: Output, A):
    """Present force, its arm in a body rotated by A, and torque; world axes."""
    return vec(out.force), matvec(A, vec(p.point)), (0.0, 0.0, 0.0)
