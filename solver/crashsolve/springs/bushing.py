"""Bushing: springs and dampers in six directions, along and about the axes of a.

    f = K (x - x_0) + C x_dot,   x = A_a^T (x_b - x_a)
    m = K_r theta + C_r theta_dot,   theta = log(A_a^T A_b A_b0^T A_a0)
    theta_dot = T w,   T = I - theta~ / 2 + c theta~ theta~,   c = 1 / phi^2 - cot(phi / 2) / 2 phi

w is the spin of b over a in axes of a, phi = |theta|. The torque on b is -T^T m, so that power and
energy agree in every configuration; about one axis it is stiffness times angle. theta is defined up
to half a revolution. The force of both bodies acts in the point of b. Consequence to test: stored
energy is (x K x + theta K_r theta) / 2 and its gradient the force, in any configuration.

Reference: Bauchau and Trainelli (2003), The vectorial parameterization of rotation, Nonlinear
Dynamics 32, 71-92.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity
from crashsolve.foundation.angles import (
    check_rotation_limit,
    relative_rotation,
    rotation_vector,
    tangent_factor,
    tangent_map,
)
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_torque,
    arm,
    axis_tangent,
    rotation_tangent,
    spin_mobility,
)
from crashsolve.foundation.orientation import relative
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import ZERO, dot, scale, sub, vec
from crashsolve.springs._between import (
    POINTS,
    add_stiffness_bound_along,
    push,
    relative_position,
    start_offset,
)
from crashsolve.springs._card import PointSpringCard

if TYPE_CHECKING:
    from crashsolve.springs._rows.bushing import History, Output, Parameters


class Bushing(PointSpringCard):
    """Springs and dampers in six directions, along and about the axes of a."""

    stiffness: Vec3 = quantity("N/m", "along x, y, z of a", ge=0)
    damping: Vec3 = quantity("N s/m", "along x, y, z of a", default=ZERO, ge=0)
    rotational_stiffness: Vec3 = quantity("N m/rad", "about x, y, z of a", default=ZERO, ge=0)
    rotational_damping: Vec3 = quantity("N m s/rad", "about x, y, z of a", default=ZERO, ge=0)
    offset: Vec3 | None = quantity(
        "m", "b from a without force, axes of a; that at the start when absent", default=None
    )


PARAMETERS = POINTS + Record("""
    stiffness             N/m        3  diagonal of K
    damping               N s/m      3  diagonal of C
    rotational_stiffness  N m/rad    3  diagonal of K_r
    rotational_damping    N m s/rad  3  diagonal of C_r
    offset                m          3  x_0
    reference             1          4  q_a^-1 q_b at the start
    rotates               flag          whether it resists rotations, which end at half a revolution
""")
HISTORY = Record()
TANGENTS = 6
OUTPUT = Record("""
    force         N    3  f, on a, axes of a
    torque        N m  3  m, on a, axes of a
    displacement  m    3  x - x_0, axes of a
    angle         rad  3  theta, axes of a
""")


def build(card: Bushing, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    return ends | {
        "stiffness": card.stiffness,
        "damping": card.damping,
        "rotational_stiffness": card.rotational_stiffness,
        "rotational_damping": card.rotational_damping,
        "rotates": any(card.rotational_stiffness),
        "offset": start_offset(scene, ends) if card.offset is None else card.offset,
        "reference": relative(scene.q[ends["node_a"]], scene.q[ends["node_b"]]),
    }


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    x, x_dot, d_a, d_b = relative_position(p, nodes)
    x = sub(x, vec(p.offset))
    a, b = nodes[p.node_a], nodes[p.node_b]
    theta = rotation_vector(a, b, p.reference)
    if p.rotates == 1:
        check_rotation_limit(curves, p.node_b, relative_rotation(a, b, p.reference)[0])
    c = tangent_factor(sqrt(dot(theta, theta)))
    spin = matvec_t(a.A, sub(vec(b.w), vec(a.w)))
    theta_dot = tangent_map(theta, c, -0.5, spin)
    out.stored = out.power = out.loss = 0.0
    for k in range(3):
        out.displacement[k] = x[k]
        out.angle[k] = theta[k]
        out.force[k] = p.stiffness[k] * x[k] + p.damping[k] * x_dot[k]
        out.torque[k] = (
            p.rotational_stiffness[k] * theta[k] + p.rotational_damping[k] * theta_dot[k]
        )
        out.stored += 0.5 * p.stiffness[k] * x[k] ** 2
        out.stored += 0.5 * p.rotational_stiffness[k] * theta[k] ** 2
        out.power += p.damping[k] * x_dot[k] ** 2 + p.rotational_damping[k] * theta_dot[k] ** 2
    push(p, nodes, scale(-1.0, vec(out.force)), d_a, d_b)
    torque = arm(a, tangent_map(theta, c, 0.5, vec(out.torque)))
    apply_torque(a, torque)
    apply_torque(b, scale(-1.0, torque))
    phi2 = dot(theta, theta)
    stretch = (1.0 - c * phi2) ** 2 + 0.25 * phi2
    for k in range(3):
        add_stiffness_bound_about(p, nodes, k, d_a, d_b, stretch)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    _, _, d_a, d_b = relative_position(p, nodes)
    a, b = nodes[p.node_a], nodes[p.node_b]
    theta = rotation_vector(a, b, p.reference)
    c = tangent_factor(sqrt(dot(theta, theta)))
    for k in range(3):
        e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        axis_tangent(rows[first + k], a, b, arm(a, e), d_a, d_b, p.stiffness[k], p.damping[k])
        g = arm(a, tangent_map(theta, c, 0.5, e))
        rotation_tangent(
            rows[first + 3 + k], a, b, g, p.rotational_stiffness[k], p.rotational_damping[k]
        )


@kernel
def add_stiffness_bound_about(p: Parameters, nodes, k, d_a, d_b, stretch):
    """Report the springs along and about one axis of a to the step control. Writes: nodes.

    `stretch` is |T|^2, 1 at small angles.
    """
    e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
    add_stiffness_bound_along(p, nodes, e, d_a, d_b, p.stiffness[k], p.damping[k])
    a, b = nodes[p.node_a], nodes[p.node_b]
    u = arm(a, e)
    stiffness, damping = stretch * p.rotational_stiffness[k], stretch * p.rotational_damping[k]
    add_stiffness_bound(a, spin_mobility(a, u), stiffness, damping)
    add_stiffness_bound(b, spin_mobility(b, u), stiffness, damping)
