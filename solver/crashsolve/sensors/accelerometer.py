"""Accelerometer: motion of a point of a body, in the axes of the body.

    a = A^T ( r_ddot + w_dot x d + w x (w x d) - g )

g only with `gravity: true`: an instrument shows -g at rest and nothing in free fall. Where gravity
acts and the card does not say which is meant, the motion alone is measured, with a warning. `role`
names the part of an occupant or vehicle, for measures of injury. Consequence
to test: on an arm of radius R turning at w it shows w^2 R towards the axis.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import field_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, point_velocity
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, norm, put, sub, vec

if TYPE_CHECKING:
    from crashsolve.sensors._rows.accelerometer import Output, Parameters

FAMILY = "nodout"
MME = re.compile(r"[A-Z0-9?]{12}")


class Accelerometer(Card):
    """Acceleration and velocity of a point of a body, in the axes of the body."""

    body: BodyName = word("body it is fixed to")
    at: Vec3 = quantity("m", "position in the frame of the body", default=(0.0, 0.0, 0.0))
    gravity: bool | None = word(
        "true: subtract free fall, as an instrument does; false or absent: the motion alone",
        default=None,
    )
    role: Literal["head", "chest", "pelvis", "vehicle"] | None = word(
        "part of an occupant, or vehicle: sets filter class, injury measures and limits",
        default=None,
    )
    mme: str | None = word(
        "first 12 letters of its ISO-MME channel code: test object to fine location 3", default=None
    )

    @field_validator("mme")
    @classmethod
    def _is_location_code(cls, text: str | None) -> str | None:
        if text is not None and not MME.fullmatch(text):
            raise ValueError("must be 12 capital letters, digits or ?, such as 11HEAD000000")
        return text


PARAMETERS = Record("""
    node       index     body
    point      m      3  from the mass centre, body axes
    free_fall  m/s^2  3  g, world axes; 0 when it is not subtracted
    has_role   flag      whether measures of injury need it
""")
OUTPUT = Record("""
    acceleration      m/s^2  3  of the point, body axes
    resultant         m/s^2     magnitude of the acceleration
    velocity          m/s    3  of the point, body axes
    angular_velocity  rad/s  3  of the body, body axes
""")


def build(card: Accelerometer, scene: Scene) -> Columns:
    node = scene.node(card.body)
    loads = scene.deck.entries["loads"].values()
    falls = [entry.card.acceleration for entry in loads if entry.type == "gravity"]
    if falls and card.gravity is None:
        scene.warn(
            f"accelerometer on '{card.body}': it omits gravity, which an instrument shows; "
            "give gravity: true, or false to omit it"
        )
    falls = falls if card.gravity else []
    return {
        "node": node,
        "point": scene.from_mass_centre(node, card.at),
        "free_fall": np.sum(falls, axis=0) if falls else np.zeros(3),
        "has_role": card.role is not None,
    }


@kernel
def measure(p: Parameters, out: Output, t, nodes, rows, curves):
    """Writes: out."""
    body = nodes[p.node]
    d, w = arm(body, vec(p.point)), vec(body.w)
    spin = add(cross(vec(body.w_dot), d), cross(w, cross(w, d)))
    a = sub(add(vec(body.v_dot), spin), vec(p.free_fall))
    put(out.acceleration, matvec_t(body.A, a))
    out.resultant = norm(a)
    put(out.velocity, matvec_t(body.A, point_velocity(body, d)))
    put(out.angular_velocity, matvec_t(body.A, w))
