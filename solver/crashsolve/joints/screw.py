"""Screw joint: b rotates about one axis of a and moves along it in proportion.

    Phi = ( side_a . d,  third_a . d,  side_a . axis_b,  third_a . axis_b,  x - h theta ) = 0

with d = x_b - x_a, the travel x = axis_a . d, the angle theta since the start over all revolutions,
and h the lead over 2 pi. Consequence to test: one degree of freedom; a nut of mass m and inertia J
on an upright screw falls with m g / (m + J / h^2).
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.angles import angle_about, angle_gradient, angle_jacobian_rate, counted
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import scale
from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints._constraint_rows import (
    also_rotates,
    slide_along,
    slide_jacobian,
    slide_jacobian_rate,
)
from crashsolve.joints.basic import line, parallel, rows_of

if TYPE_CHECKING:
    from crashsolve.joints._rows.screw import History, Parameters

COUNTS_ROTATIONS = True
CONSTRAINTS = (line, parallel)
ROWS, ANGULAR = rows_of(CONSTRAINTS, False)
FREE = ("angle", "travel")
PARAMETERS = FRAME + Record("advance  m/rad  h, travel over angle")
HISTORY = Record("angle  rad  theta, over all revolutions")


class Screw(AxisJointCard):
    """Screw and nut: b rotates about one axis fixed in a, and moves along it in proportion."""

    lead: float = quantity("m", "travel along the axis per revolution; negative if left-handed")


def build(card: Screw, scene: Scene) -> Columns:
    if card.lead == 0.0:
        raise scene.fail("must not be 0; a joint that only rotates is of type revolute", "lead")
    return scene.joint_frame(card) | {"advance": card.lead / (2.0 * pi)}


@kernel
def residual(p: Parameters, old: History, new: History, t, nodes, rows, curves):
    """Writes: rows.phi, new."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    new.angle = counted(angle_about(a, b, p.axis_a, p.side_a, p.side_b), old.angle)
    travel = slide_along(a, b, p.point_a, p.point_b, p.axis_a)
    rows[p.first_row + 4].phi = travel - p.advance * new.angle


@kernel
def jacobian(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    row = rows[p.first_row + 4]
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, row)
    also_rotates(row, scale(-p.advance, angle_gradient(a, b, p.axis_a, p.side_b)))


@kernel
def convective(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    sliding = slide_jacobian_rate(a, b, p.point_a, p.point_b, p.axis_a)
    convective = angle_jacobian_rate(a, b, p.axis_a, p.side_b)
    rows[p.first_row + 4].gamma = p.advance * convective - sliding
