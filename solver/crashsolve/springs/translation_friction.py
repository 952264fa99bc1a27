"""Friction against the travel of a prismatic or cylindrical joint; holds and slides.

    F = K z + c z_dot while it holds,   |F| <= F_0 + mu |lambda|;   it slides at the limit

z is the elastic travel since it last slid and lambda the force across the axis, expected from its
course as in rotation_friction; the moments that tilt the slider in its guide are not counted.

Consequence to test: a slider with the speed v_0 stops after m v_0 / F_0; on an axis inclined by
alpha it stays for ever while tan alpha < mu. The energy lost is the work of F less what the
bristle stores.

Reference: Dahl (1968), A solid friction model, The Aerospace Corporation TOR-0158.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, JointName, quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, scale, vec
from crashsolve.springs._between import SLIDE, add_stiffness_bound_along, push, relative_position
from crashsolve.springs._bristle import BRISTLE, PRESSING, friction_limit, retained_share
from crashsolve.springs._joint import named_joint

if TYPE_CHECKING:
    from crashsolve.springs._rows.translation_friction import History, Output, Parameters

LEDGER = "joint"


class TranslationFriction(Card):
    """Friction against the travel of a joint: constant, a share of the reaction, or both."""

    joint: JointName = word("joint that has a travel: prismatic, cylindrical, ...")
    force: float = quantity("N", "constant part of the limit", default=0.0, ge=0)
    friction_coefficient: float = quantity(
        "1", "mu, of the force across the axis", default=0.0, ge=0
    )
    stiffness: float = quantity("N/m", "K, stiffness of the bristle", gt=0)
    damping: float = quantity("N s/m", "c, of the bristle", default=0.0, ge=0)

    @model_validator(mode="after")
    def _consistent(self) -> TranslationFriction:
        if self.force == 0.0 and self.friction_coefficient == 0.0:
            raise ValueError("needs force, friction_coefficient or both")
        return self


# the bristle is stretched by the slip of a whole step
STEPWISE = True
PARAMETERS = SLIDE + BRISTLE
HISTORY = PRESSING + Record("""
    travel            m  of b from the start
    slider            m  travel without stretch of the bristle
    force             N  F
    accumulated_slip  m  distance slid
""")
OUTPUT = Record("""
    force             N  positive pushes b back along the axis
    limit             N  at which it slides
    accumulated_slip  m  distance slid
""")


def build(card: TranslationFriction, scene: Scene) -> Columns:
    joint = named_joint(scene, card.joint, "travel")
    return SLIDE.columns_of(joint.frame) | {
        "level": card.force,
        "friction_coefficient": card.friction_coefficient,
        "first_row": joint.first_row,
        "pressing": joint.angular.count(False),
        "stiffness": card.stiffness,
        "damping": card.damping,
    }


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    x, x_dot, d_a, d_b = relative_position(p, nodes)
    axis = vec(p.axis_a)
    travel, rate = dot(axis, x), dot(axis, x_dot)
    trial = travel - old.slider
    limit = friction_limit(p, p.level, old, new, h, rows)
    z = trial * retained_share(p.stiffness, abs(trial), limit)
    friction = min(max(p.stiffness * z + p.damping * rate, -limit), limit)
    new.travel = travel
    new.slider = travel - z
    new.force = friction
    new.accumulated_slip = old.accumulated_slip + abs(trial - z)
    out.force = friction
    out.limit = limit
    out.accumulated_slip = new.accumulated_slip
    out.stored = 0.5 * p.stiffness * z * z
    out.power = out.loss = 0.0
    if h > 0.0:
        absorbed = 0.5 * (old.force + friction) * (travel - old.travel)
        out.loss = absorbed - (out.stored - 0.5 * p.stiffness * (old.travel - old.slider) ** 2)
    push(p, nodes, scale(-friction, axis), d_a, d_b)
    add_stiffness_bound_along(p, nodes, p.axis_a, d_a, d_b, p.stiffness, p.damping)
