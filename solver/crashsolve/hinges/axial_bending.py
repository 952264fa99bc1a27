"""Hinge of axial force and moment: b slides along the beam and rotates about one axis across it.

    F(delta), M(theta) by _pair.py,   delta = beam . (x_b - x_a) - delta_0

The beam's direction is that of a, and the force acts in the point of b; theta is counted as in
_one_axis.py. On the ellipse (M / M_p)^2 + (F / F_p)^2 = 1 a hinge that bends also yields along the
beam under axial force. Consequence to test: without axial force it is a bending hinge.

References: Ambrosio (2003), Eq. 6-7 and Fig. 3; Powell and Chen (1986), ASCE J. Eng. Mech. 112,
627-641.
"""

from __future__ import annotations

from functools import partial
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import axis_tangent, pull, rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.hinges import _pair
from crashsolve.hinges._card import AxialCurve, MomentCurve, Motion, PairCard, law, pair_backbones
from crashsolve.hinges._joint import COMMON, LEDGER, across, at_start, motion_of, release_rows
from crashsolve.hinges._law import LAW, PATH, growth_bound
from crashsolve.hinges._one_axis import rotated
from crashsolve.hinges._pair import PAIR, WORK, Motions
from crashsolve.hinges.axial import stroke_along
from crashsolve.joints._card import FRAME, direction
from crashsolve.joints._constraint_rows import slide_along, slide_jacobian, slide_jacobian_rate
from crashsolve.joints.basic import parallel

if TYPE_CHECKING:
    from crashsolve.hinges._rows.axial_bending import History, Output, Parameters

__all__ = ["LEDGER", "release_rows"]
# the axes of its rows are not those of a line
CONSTRAINTS = ()
ROWS = 4
COUNTS_ROTATIONS = True
ANGULAR = (False, False, True, True)
TANGENTS = 2
MOTIONS = (
    Motion("curve", "curve_negative", "stiffness", "initial_angle", "failure_angle"),
    Motion("axial_curve", "axial_negative", "axial_stiffness", "initial_stroke", "failure_stroke"),
)
curves = partial(pair_backbones, MOTIONS)


class AxialBending(PairCard):
    """Hinge of axial force and moment: b slides along the beam and rotates about one axis."""

    beam: Vec3 = word("direction of the beam at the start, at right angles to `axis`")
    curve: MomentCurve = word("moment over angle, from [0, 0]")
    curve_negative: MomentCurve | None = word(
        "the same for negative angles; as curve when absent", default=None
    )
    axial_curve: AxialCurve = word("force over change of length, from [0, 0]")
    axial_negative: AxialCurve | None = word(
        "the same for shortening, both counted positive; as axial_curve when absent", default=None
    )
    stiffness: float | None = quantity(
        "N m/rad", "elastic, of curve; its first slope when absent", default=None, gt=0
    )
    axial_stiffness: float | None = quantity(
        "N/m", "elastic, of axial_curve; its first slope when absent", default=None, gt=0
    )
    initial_angle: float = quantity(
        "rad", "rotation of b from the start at which there is no moment", default=0.0
    )
    initial_stroke: float = quantity(
        "m", "displacement of b from the start at which there is no force", default=0.0
    )
    failure_angle: float | None = quantity(
        "rad", "angle in either direction at which the hinge fails", default=None, gt=0
    )
    failure_stroke: float | None = quantity(
        "m", "change of length in either direction at which it fails", default=None, gt=0
    )


PARAMETERS = (
    FRAME
    + LAW
    + PAIR
    + Record("""
        beam_a    1  3  direction of the beam, axes of a
        across_a  1  3  axis x beam, axes of a
        rate_arm  m     arm of the angle in the speed of the factor
    """)
)
HISTORY = PATH + WORK
OUTPUT = COMMON + Record("""
    moment           N m    positive rotates b back
    force            N      pull is positive
    angle            rad    of b from the undeformed hinge
    stroke           m      of b along the beam from the undeformed hinge
    rate             rad/s  of the angle
    stroke_rate      m/s    of the stroke
    plastic_angle    rad    sum of plastic rotations in both directions
    residual_angle   rad    that would be left without moment and force
    plastic_stroke   m      sum of plastic displacements in both directions
    residual_stroke  m      that would be left without moment and force
""")


def build(card: AxialBending, scene: Scene) -> Columns:
    frame = dict(scene.joint_frame(card))
    axis, beam = direction(card, scene, "axis"), across(card, "beam", scene)
    if card.rate is not None and card.rate.arm is None:
        raise scene.fail("needs the arm: its speed is that of stroke and angle together", "rate")
    a = frame["node_a"]
    return (
        frame
        | law(card, MOTIONS, scene)
        | {
            "is_elliptic": card.interaction == "elliptic",
            "beam_a": scene.rotation_to_body(a, beam),
            "across_a": scene.rotation_to_body(a, np.cross(axis, beam)),
            "rate_arm": card.rate.arm if card.rate else 1.0,
        }
    )


def initial_history(card: AxialBending, p: np.void, scene: Scene) -> Columns:
    v, w = motion_of(scene, p)
    A = scene.matrix(p["node_a"])
    speed = np.hypot(v @ (A @ p["beam_a"]), p["rate_arm"] * (w @ (A @ p["axis_a"])))
    return at_start(p, float(speed))


@kernel
def residual(p: Parameters, old: History, new: History, t, nodes, rows, curves):
    """Writes: rows.phi."""
    a, b, r = nodes[p.node_a], nodes[p.node_b], p.first_row
    rows[r].phi = slide_along(a, b, p.point_a, p.point_b, p.axis_a)
    rows[r + 1].phi = slide_along(a, b, p.point_a, p.point_b, p.across_a)
    parallel.residual(p, nodes, rows, r + 2)


@kernel
def jacobian(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    a, b, r = nodes[p.node_a], nodes[p.node_b], p.first_row
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, rows[r])
    slide_jacobian(a, b, p.point_a, p.point_b, p.across_a, rows[r + 1])
    parallel.jacobian(p, nodes, rows, r + 2)


@kernel
def convective(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b, r = nodes[p.node_a], nodes[p.node_b], p.first_row
    rows[r].gamma = -slide_jacobian_rate(a, b, p.point_a, p.point_b, p.axis_a)
    rows[r + 1].gamma = -slide_jacobian_rate(a, b, p.point_a, p.point_b, p.across_a)
    parallel.convective(p, nodes, rows, r + 2)


@kernel
def deformation_of(p: Parameters, state: History, nodes):
    """Both motions, the gradient of the angle, the axis and the arms of the force [m]."""
    angle, rate, g = rotated(p, state.x[0], nodes)
    length_change, along, u, d_a, d_b = stroke_along(p, nodes, p.beam_a)
    stroke, speed = length_change - p.initial[1], sqrt(along * along + (p.rate_arm * rate) ** 2)
    deformation = Motions(angle, stroke, rate, along, speed, (abs(angle), abs(stroke)))
    return deformation, g, u, d_a, d_b


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    deformation, g, u, d_a, d_b = deformation_of(p, old, nodes)
    moment, pulled, phi = _pair.response(p, old, new, out, deformation, curves)
    out.moment, out.force, out.angle, out.stroke = moment, pulled, deformation.x, deformation.y
    out.rate, out.stroke_rate = deformation.rate, deformation.across
    out.plastic_angle, out.residual_angle = new.flow[0], new.plastic[0]
    out.plastic_stroke, out.residual_stroke = new.flow[1], new.plastic[1]
    bound = growth_bound(p, new.speed) / phi if new.failed == 0 else 0.0
    k, j = (p.stiffness[0], p.stiffness[1]) if new.failed == 0 else (0.0, 0.0)
    pull(p, nodes, pulled, u, d_a, d_b, j, bound * (abs(pulled) + abs(moment) / p.rate_arm))
    twist(p, nodes, moment, g, k, bound * p.rate_arm * (abs(moment) + p.rate_arm * abs(pulled)))


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    deformation, g, u, d_a, d_b = deformation_of(p, state, nodes)
    one, other = _pair.tangent(p, state, deformation, curves)
    a, b = nodes[p.node_a], nodes[p.node_b]
    rotation_tangent(rows[first], a, b, g, one[2], 0.0)
    axis_tangent(rows[first + 1], a, b, u, d_a, d_b, other[2], 0.0)
    for k in range(12):
        rotation, slide = rows[first].D[k], rows[first + 1].D[k]
        rows[first].D[k] = one[0] * rotation + one[1] * slide
        rows[first + 1].D[k] = other[0] * rotation + other[1] * slide
        rotation, slide = rows[first].G[k], rows[first + 1].G[k]
        rows[first].G[k] = one[0] * rotation + one[1] * slide
        rows[first + 1].G[k] = other[0] * rotation + other[1] * slide


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the branch of the law on which the step began [rad]."""
    return _pair.beyond(p, old, h, deformation_of(p, old, nodes)[0], curves)
