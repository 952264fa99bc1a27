"""Bending hinge in two directions: b rotates about every axis across the beam, not about the beam.

    theta = log(A_a^T A_b A_b0^T A_a0),   theta . beam = 0,   M_i(theta_i) by _pair.py
    torque on b = -T^T M,   theta_dot = T w      (Ambrosio (2003), Fig. 3b)

theta is the rotation vector of b in a since the start, less the initial one. It has the same
components in both bodies, so that their order only changes its sign, and it is the same in every
frame. The joint holds its component along the beam at 0: sin|theta| e . beam = 0, with the sides s
and t of both bodies t_a . s_b - s_a . t_b = 0. Against the two axes of a universal joint, this has
no direction of its own, so that a round section bends alike in all. theta is known up to half a
turn; a hinge that folds by 3 rad ends the run. Consequence to test: M does the work M . theta_dot
in every configuration.

References: Ambrosio (2003), Fig. 3; Bauchau and Trainelli (2003), Nonlinear Dynamics 32, 71-92.
"""

from __future__ import annotations

from functools import partial
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity, word
from crashsolve.foundation.angles import FOLDED, rotation_vector, tangent_factor, tangent_map
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_torque,
    arm,
    rotation_tangent,
    spin_mobility,
)
from crashsolve.foundation.orientation import relative
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, dot, norm, scale, sub, vec
from crashsolve.hinges import _pair
from crashsolve.hinges._card import MomentCurve, Motion, PairCard, law, pair_backbones, rate_arm
from crashsolve.hinges._joint import COMMON, LEDGER, across, at_start, motion_of, release_rows
from crashsolve.hinges._law import LAW, PATH, growth_bound
from crashsolve.hinges._pair import PAIR, WORK, Motions
from crashsolve.hinges._sections import squash_load
from crashsolve.joints._card import FRAME, direction
from crashsolve.joints._constraint_rows import square_convective, square_jacobian, square_residual
from crashsolve.joints.basic import point, rows_of

if TYPE_CHECKING:
    from crashsolve.hinges._rows.biaxial import History, Output, Parameters

__all__ = ["LEDGER", "release_rows"]
CONSTRAINTS = (point,)
ROWS, ANGULAR = rows_of(CONSTRAINTS, True)
TANGENTS = 2
COUNTS_ROTATIONS = True
MOTIONS = (
    Motion("curve", "", "stiffness", "initial_angles", "failure_angle"),
    Motion("second_curve", "", "second_stiffness", "initial_angles", ""),
)
curves = partial(pair_backbones, MOTIONS)


class Biaxial(PairCard):
    """Bending hinge in two directions: b rotates about every axis across the beam."""

    side: Vec3 = word("direction of the first axis of bending, at right angles to `axis`")
    curve: MomentCurve = word("moment over angle about `side`, from [0, 0]")
    second_curve: MomentCurve | None = word(
        "the same about the axis x side direction; as curve when absent", default=None
    )
    stiffness: float | None = quantity(
        "N m/rad", "elastic, of curve; its first slope when absent", default=None, gt=0
    )
    second_stiffness: float | None = quantity(
        "N m/rad", "elastic, of second_curve; its first slope when absent", default=None, gt=0
    )
    initial_angles: tuple[float, float] = quantity(
        "rad",
        "rotation of b from the start at which there is no moment, about both axes",
        default=(0.0, 0.0),
    )
    failure_angle: float | None = quantity(
        "rad", "angle in any direction at which the hinge fails", default=None, gt=0, lt=FOLDED
    )
    buckling_load: float | None = quantity(
        "N", "compression along the beam above which the run warns at its end", default=None, gt=0
    )

    @model_validator(mode="after")
    def _both_of_a_direction(self) -> Biaxial:
        if self.second_stiffness is not None and self.second_curve is None:
            raise ValueError("second_stiffness: needs second_curve beside it")
        return self


PARAMETERS = (
    FRAME
    + LAW
    + PAIR
    + Record("""
        reference    1       4  q_a^-1 q_b at the start
        rate_arm     m or 1     speed of the factor over the rate
        axial_yield  N          N_p of the section, which the joint exceeds; infinite if unknown
        buckling     N          compression to warn of; infinite if there is none
    """)
)
HISTORY = (
    PATH
    + WORK
    + Record("""
        peak_axial        N  largest force along the beam so far, in magnitude
        peak_compression  N  largest compression along the beam so far
    """)
)
OUTPUT = COMMON + Record("""
    moment          N m    2  about side and about axis x side, positive rotates b back
    angle           rad    2  theta
    rate            rad/s  2  of the angle
    plastic_angle   rad    2  sum of plastic rotations in both directions
    residual_angle  rad    2  that would be left without moment
    peak_axial      N         largest force along the beam so far, in magnitude
""")


def build(card: Biaxial, scene: Scene) -> Columns:
    frame = dict(scene.joint_frame(card))
    beam, side = direction(card, scene, "axis"), across(card, "side", scene)
    for end in "ab":
        node = frame[f"node_{end}"]
        frame[f"side_{end}"] = scene.rotation_to_body(node, side)
        frame[f"third_{end}"] = scene.rotation_to_body(node, np.cross(beam, side))
    return (
        frame
        | law(card, MOTIONS, scene)
        | {
            "is_elliptic": card.interaction == "elliptic",
            "reference": relative(scene.q[frame["node_a"]], scene.q[frame["node_b"]]),
            "rate_arm": rate_arm(card),
            "axial_yield": squash_load(card.curve, scene),
            "buckling": card.buckling_load or np.inf,
        }
    )


def initial_history(card: Biaxial, p: np.void, scene: Scene) -> Columns:
    spin, A = motion_of(scene, p)[1], scene.matrix(p["node_a"])
    across = np.hypot(spin @ (A @ p["side_a"]), spin @ (A @ p["third_a"]))
    return at_start(p, float(p["rate_arm"] * across))


@kernel
def residual(p: Parameters, old: History, new: History, t, nodes, rows, curves):
    """Writes: rows.phi."""
    crossed = square_residual(p, p.side_a, p.third_b, nodes)
    rows[p.first_row + 3].phi = square_residual(p, p.third_a, p.side_b, nodes) - crossed


@kernel
def jacobian(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    row = rows[p.first_row + 3]
    D = row.D
    square_jacobian(p, p.side_a, p.third_b, nodes, row)
    x, y, z = D[3], D[4], D[5]
    square_jacobian(p, p.third_a, p.side_b, nodes, row)
    D[3], D[4], D[5] = D[3] - x, D[4] - y, D[5] - z
    D[9], D[10], D[11] = D[9] + x, D[10] + y, D[11] + z


@kernel
def convective(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    crossed = square_convective(p, p.side_a, p.third_b, nodes)
    rows[p.first_row + 3].gamma = square_convective(p, p.third_a, p.side_b, nodes) - crossed


@kernel
def deformation_of(p: Parameters, nodes):
    """Both angles, the world directions of their torques, |theta| [rad] and |T|^2."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    theta = rotation_vector(a, b, p.reference)
    size = norm(theta)
    c = tangent_factor(size)
    first, second = vec(p.side_a), vec(p.third_a)
    g, q = tangent_map(theta, c, 0.5, first), tangent_map(theta, c, 0.5, second)
    spin = matvec_t(a.A, sub(vec(b.w), vec(a.w)))
    x, y = dot(first, theta) - p.initial[0], dot(second, theta) - p.initial[1]
    rate, across = dot(g, spin), dot(q, spin)
    speed = p.rate_arm * sqrt(rate * rate + across * across)
    deformation = Motions(x, y, rate, across, speed, (sqrt(x * x + y * y), 0.0))
    stretch = (1.0 - c * size * size) ** 2 + 0.25 * size * size
    return deformation, arm(a, g), arm(a, q), size, stretch


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    deformation, g, q, size, stretch = deformation_of(p, nodes)
    if size > FOLDED:
        curves[0].fault, curves[0].x = p.backbone[0], size
    first, second, phi = _pair.response(p, old, new, out, deformation, curves)
    out.moment[0], out.moment[1] = first, second
    out.angle[0], out.angle[1] = deformation.x, deformation.y
    out.rate[0], out.rate[1] = deformation.rate, deformation.across
    for c in range(2):
        out.plastic_angle[c], out.residual_angle[c] = new.flow[c], new.plastic[c]
    a, b = nodes[p.node_a], nodes[p.node_b]
    axial = axial_force(p, a, rows)
    new.peak_axial = max(old.peak_axial, abs(axial))
    new.peak_compression = max(old.peak_compression, axial)
    out.peak_axial = new.peak_axial
    torque = add_scaled(scale(first, g), second, q)
    apply_torque(a, torque)
    apply_torque(b, scale(-1.0, torque))
    if new.failed == 0:
        moment = sqrt(first * first + second * second)
        drag = stretch * p.rate_arm * growth_bound(p, new.speed) * moment / phi
        for c in range(2):
            u = arm(a, vec(p.side_a if c == 0 else p.third_a))
            add_stiffness_bound(a, spin_mobility(a, u), stretch * p.stiffness[c], drag)
            add_stiffness_bound(b, spin_mobility(b, u), stretch * p.stiffness[c], drag)


@kernel
def axial_force(p: Parameters, a, rows):
    """Reaction on b of the point along the beam, of the last step; compression if positive [N]."""
    k = p.first_row
    reaction = (rows[k].reaction, rows[k + 1].reaction, rows[k + 2].reaction)
    return dot(reaction, arm(a, vec(p.axis_a)))


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    deformation, g, q, _, _ = deformation_of(p, nodes)
    one, other = _pair.tangent(p, state, deformation, curves)
    a, b = nodes[p.node_a], nodes[p.node_b]
    rotation_tangent(rows[first], a, b, add_scaled(scale(one[0], g), one[1], q), one[2], 0.0)
    rotation_tangent(
        rows[first + 1], a, b, add_scaled(scale(other[0], g), other[1], q), other[2], 0.0
    )


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the branch of the law on which the step began [rad]."""
    return _pair.beyond(p, old, h, deformation_of(p, nodes)[0], curves)
