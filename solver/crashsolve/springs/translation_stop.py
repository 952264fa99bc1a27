"""Stops of the travel of a joint that has one, beyond which a spring and damper act.

    F = k e + c e_dot >= 0,   e = x - upper, or lower - x,   or F = f(e) + c e_dot

Consequence to test: without damping the joint rebounds with its speed after the time
pi sqrt(m / k); with the damping ratio zeta it rebounds with the restitution exp(-zeta omega t_c).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, axis_tangent
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, scale, vec
from crashsolve.springs import _joint
from crashsolve.springs._between import SLIDE, add_stiffness_bound_along, push, relative_position

if TYPE_CHECKING:
    from crashsolve.springs._rows.translation_stop import History, Output, Parameters

LEDGER = "joint"


class TranslationStop(_joint.StopCard):
    """Stops of the travel of a joint, counted from its position at the start."""

    curve_axes: ClassVar = {"curve": ("m", "N")}

    lower: float | None = quantity("m", "travel of the lower stop; none when absent", default=None)
    upper: float | None = quantity("m", "travel of the upper stop; none when absent", default=None)
    stiffness: float | None = quantity("N/m", "k, stiffness", default=None, gt=0)
    damping: float = quantity("N s/m", "c, damping", default=0.0, ge=0)


PARAMETERS = SLIDE + _joint.STOPS
HISTORY = _joint.STOPPED
TANGENTS = 1
OUTPUT = Record("""
    force   N    positive pushes b back
    travel  m    of b from the start
    rate    m/s  of the travel
""")


def build(card: TranslationStop, scene: Scene) -> Columns:
    frame = _joint.named_joint(scene, card.joint, "travel").frame
    columns = SLIDE.columns_of(frame) | _joint.stops(card, scene)
    _joint.check_start(card, scene, columns, 0.0, "m")
    return columns


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    x, x_dot, d_a, d_b = relative_position(p, nodes)
    axis = vec(p.axis_a)
    out.travel = dot(axis, x)
    out.rate = dot(axis, x_dot)
    out.force = _joint.stop(p, new, out.travel, out.rate, out, curves)
    push(p, nodes, scale(-out.force, axis), d_a, d_b)
    # counted in the gap as well: nothing else shortens the step before the stop is met
    add_stiffness_bound_along(p, nodes, p.axis_a, d_a, d_b, p.largest_slope, p.damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    x, x_dot, d_a, d_b = relative_position(p, nodes)
    axis = vec(p.axis_a)
    stiffness, damping = _joint.stop_tangent(p, dot(axis, x), dot(axis, x_dot), curves)
    a, b = nodes[p.node_a], nodes[p.node_b]
    axis_tangent(rows[first], a, b, arm(a, axis), d_a, d_b, stiffness, damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance of the travel from the range in which it began the step, between the stops or
    beyond one [m].
    """
    return _joint.stop_event(p, old, dot(vec(p.axis_a), relative_position(p, nodes)[0]))
