"""What springs share: where their ends are, how they move, and how a force acts on both."""

from typing import Protocol

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.foundation.angles import angle_about, angle_gradient, counted
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    Line,
    add_stiffness_bound,
    apply_force,
    arm,
    mobility,
    point_at,
    point_velocity,
    relative,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, dot, norm, scale, sub, vec

# below this length a line has no direction; the spring then pulls along x, with its rate zero
SHORTEST = 1e-12

POINTS = Record("""
    node_a   index     first body
    node_b   index     second body
    point_a  m      3  attachment from the mass centre of a, axes of a
    point_b  m      3  attachment from the mass centre of b, axes of b
""")
SLIDE = POINTS + Record("axis_a  1  3  direction in which b slides, axes of a")


def start_offset(scene: Scene, ends: Columns) -> np.ndarray:
    """Attachment of b from that of a at the start, axes of a [m]."""
    a, b = ends["node_a"], ends["node_b"]
    x_a = scene.r[a] + scene.matrix(a) @ ends["point_a"]
    x_b = scene.r[b] + scene.matrix(b) @ ends["point_b"]
    return np.asarray(scene.rotation_to_body(a, x_b - x_a))


class Sprung(Protocol):
    """A card of a spring."""

    @property
    def length(self) -> float | None: ...


def rest_length(card: Sprung, scene: Scene, ends: Columns) -> float:
    """Length without force [m]; one is refused that has no direction at the start."""
    start = scene.distance(ends)
    length = start if card.length is None else card.length
    if start < SHORTEST < length:
        raise scene.fail(
            f"both ends are in one position at the start, so a spring {length:g} m long has no "
            "direction to push in; move an end, or set length: 0",
            "length",
        )
    return float(length)


@kernel
def line_of_action(p, nodes):
    """The Line (foundation/motion.py) between both attachments; one of no length is along x."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    d_a, d_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    x, x_dot = relative(a, d_a, b, d_b)
    length = norm(x)
    if length < SHORTEST:
        return Line((1.0, 0.0, 0.0), length, 0.0, d_a, d_b)
    u = scale(1.0 / length, x)
    return Line(u, length, dot(u, x_dot), d_a, d_b)


@kernel
def spring_and_damper(p, out, x, rate):
    """Force of a linear spring x [m or rad] long beyond its rest, and its damper. Writes: out."""
    out.rate = rate
    out.stored = 0.5 * p.stiffness * x * x
    out.power = p.damping * rate * rate
    out.loss = 0.0
    return p.stiffness * x + p.damping * rate


@kernel
def rotated(p, before, nodes):
    """Angle of b about the axis of a [rad], counted from `before`, its rate, and its gradient g."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    angle = counted(angle_about(a, b, p.axis_a, p.side_a, p.side_b), before)
    g = angle_gradient(a, b, p.axis_a, p.side_b)
    return angle, dot(g, sub(vec(b.w), vec(a.w))), g


@kernel
def relative_position(p, nodes):
    """Attachment of b from that of a [m] and its rate, axes of a; its arms in a and b [m]."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    d_a, d_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    x = sub(point_at(b, d_b), point_at(a, d_a))
    d_a = add(d_a, x)
    v = sub(point_velocity(b, d_b), point_velocity(a, d_a))
    return matvec_t(a.A, x), matvec_t(a.A, v), d_a, d_b


@kernel
def push(p, nodes, f, d_a, d_b):
    """Force f (axes of a) on b, and its reaction on a in the same point. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    force = arm(a, f)
    apply_force(b, force, d_b)
    apply_force(a, scale(-1.0, force), d_a)


@kernel
def add_stiffness_bound_along(p, nodes, direction, d_a, d_b, stiffness, damping):
    """Report a spring along a direction of a to the step control. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    u = arm(a, vec(direction))
    add_stiffness_bound(a, mobility(a, d_a, u), stiffness, damping)
    add_stiffness_bound(b, mobility(b, d_b, u), stiffness, damping)
