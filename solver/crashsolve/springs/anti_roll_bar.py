"""Anti-roll bar: a bar that turns in two bearings of a body, with an arm and a link at each end.

    T = k theta,   theta = phi_left - phi_right;   N = T / m   in the left link, -T / m in the right
    |x - e(phi)| = l  gives phi,   m = u . (a x r)

phi is the angle of an arm about the axis a of the bar since the start, e its end and r that from
the axis; l is the length of the link to the point x of the other body, u the unit vector along it
and m its lever on the bar. Bar and links have no mass, and the bearings carry the remaining forces.
Consequence to test: with arms r, links at right angles to them and points at the half track s the
bar adds 4 k s^2 / r^2 to the stiffness in roll, and nothing to that in bounce.
"""

from __future__ import annotations

from math import acos, atan2, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.angles import counted
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import add_stiffness_bound, apply_force, arm, mobility, point_at
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import ZERO, Vector, add, cross, dot, norm, scale, sub, vec
from crashsolve.springs._several import MAX_POINTS, PARTS, POINTS, arm_of

if TYPE_CHECKING:
    from crashsolve.springs._rows.anti_roll_bar import History, Output, Parameters

# lever of a link over its arm, below which it is at its dead centre
DEAD_CENTRE = 1e-3
# points of the left link and of the right one: of the other body, and the end of the arm
LEFT, LEFT_END, RIGHT_END, RIGHT = range(4)


class Link(Card):
    """An end of the bar: its arm, and the point that the link goes to."""

    arm: Vec3 = quantity("m", "end of the arm at the start, in the frame of the bar's body")
    body: BodyName = word("body at the other end of the link", default="ground")
    at: Vec3 = quantity("m", "point of that body, in its frame", default=(0.0, 0.0, 0.0))


class AntiRollBar(Card):
    """Torsion bar in bearings of a body; it resists relative motion of its two links."""

    body: BodyName = word("body with the bearings")
    at: Vec3 = quantity("m", "a point on the axis of the bar, in the frame of the body")
    axis: Vec3 = word("direction of the bar, in the frame of the body; any length", (0.0, 1.0, 0.0))
    left: Link = word("first end of the bar")
    right: Link = word("other end of the bar")
    stiffness: float = quantity("N m/rad", "k, of the bar with its arms: G J / L", gt=0)


PARAMETERS = POINTS + Record("""
    axis       1        3  a, axes of the body
    pivot      m        6  foot of each arm on the axis from the mass centre, axes of the body
    lever      m        6  arm from there to its end at the start, the same axes
    length     m        2  l of each link
    side       1        2  on which side of its dead centre a link is
    stiffness  N m/rad     k
""")
HISTORY = Record()
TANGENTS = 1
OUTPUT = Record("""
    force   N       of the left link, tension positive
    right   N       of the right link
    torque  N m     T, of the bar
    twist   rad     theta
    angles  rad  2  phi of both arms
""")


def build(card: AntiRollBar, scene: Scene) -> Columns:
    node = scene.node(card.body)
    if node == 0:
        raise scene.fail("the ground does not roll; name the body that does", "body")
    left, right = _end("left", card, scene), _end("right", card, scene)
    more = MAX_POINTS - 4
    return {
        "count": 4,
        "node": np.array([left.node, node, node, right.node] + more * [right.node]),
        "point": np.concatenate([left.point, left.arm, right.arm] + (more + 1) * [right.point]),
        "axis": scene.unit(card.axis, "axis"),
        "pivot": np.concatenate([left.pivot, right.pivot]),
        "lever": np.concatenate([left.arm - left.pivot, right.arm - right.pivot]),
        "length": np.array([left.length, right.length]),
        "side": np.array([left.side, right.side]),
        "stiffness": card.stiffness,
    }


class End(NamedTuple):
    """An end of a bar at the start; arm and pivot from the mass centre of its body, body axes."""

    node: int  # at the other end of the link
    point: np.ndarray  # of that, from its mass centre, in its axes [m]
    arm: np.ndarray  # end of the arm [m]
    pivot: np.ndarray  # its foot on the axis [m]
    length: float  # of the link [m]
    side: float


def _end(name: str, card: AntiRollBar, scene: Scene) -> End:
    """Raises a refusal of a link that cannot turn its arm."""
    link: Link = getattr(card, name)
    bar, far = scene.node(card.body), scene.node(link.body)
    if far == bar:
        raise scene.fail("is the body of the bar; name what moves against it", f"{name}.body")
    axis, on_axis = scene.unit(card.axis, "axis"), scene.from_mass_centre(bar, card.at)
    arm_end = scene.from_mass_centre(bar, link.arm)
    pivot = on_axis + axis * (axis @ (arm_end - on_axis))
    point = scene.from_mass_centre(far, link.at)
    x = scene.r[far] + scene.matrix(far) @ point - scene.r[bar]
    rod, lever = scene.rotation_to_body(bar, x) - arm_end, arm_end - pivot
    r, length = float(np.linalg.norm(lever)), float(np.linalg.norm(rod))
    moment = float(rod @ np.cross(axis, lever))
    if abs(moment) <= DEAD_CENTRE * r * length:
        raise scene.fail(
            f"its arm is {r:.3g} m and its link {length:.3g} m long, with no lever on the bar; "
            "arm and link must not be in one plane with its axis",
            f"{name}.arm",
        )
    return End(far, point, arm_end, pivot, length, -float(np.sign(moment)))


class Reach(NamedTuple):
    """Position of an arm at which its link has its length."""

    phi: float  # [rad]
    d: Vector  # end of the arm from the mass centre of the bar's body, world axes [m]
    far: Vector  # point of the other body from its mass centre, world axes [m]
    u: Vector  # unit vector along the link, from the arm
    m: float  # lever of the link on the bar [m]


@kernel
def reach(p: Parameters, i, nodes):
    """The Reach of link i: 0 left, 1 right. The lever is 0 where the link is too short or long."""
    j = RIGHT if i == 1 else LEFT
    body, other = nodes[p.node[LEFT_END]], nodes[p.node[j]]
    axis = arm(body, vec(p.axis))
    pivot = arm(body, (p.pivot[3 * i], p.pivot[3 * i + 1], p.pivot[3 * i + 2]))
    lever = arm(body, (p.lever[3 * i], p.lever[3 * i + 1], p.lever[3 * i + 2]))
    far = arm_of(p, j, nodes)
    x = sub(point_at(other, far), point_at(body, pivot))
    across = cross(axis, lever)
    # on the circle of the arm: A cos(phi) + B sin(phi) = C
    A, B = dot(x, lever), dot(x, across)
    C = 0.5 * (dot(x, x) + dot(lever, lever) - p.length[i] * p.length[i])
    most = sqrt(A * A + B * B)
    if not abs(C) < most:
        return Reach(0.0, add(pivot, lever), far, ZERO, 0.0)
    phi = counted(atan2(B, A) + p.side[i] * acos(C / most), 0.0)
    # cos and sin of phi, without asking for them: the foot of C on the line through (A, B)
    rest = p.side[i] * sqrt(max(most * most - C * C, 0.0))
    c, s = (A * C - B * rest) / (most * most), (B * C + A * rest) / (most * most)
    r = add(scale(c, lever), scale(s, across))
    u = scale(1.0 / p.length[i], sub(x, r))
    return Reach(phi, add(pivot, r), far, u, dot(u, cross(axis, r)))


@kernel
def is_at_dead_centre(p: Parameters, i, at):
    """Whether a link is at its dead centre, where the bar cannot turn its arm any further."""
    return not abs(at.m) > DEAD_CENTRE * arm_length(p, i)


@kernel
def arm_length(p: Parameters, i):
    """r [m]."""
    return norm((p.lever[3 * i], p.lever[3 * i + 1], p.lever[3 * i + 2]))


@kernel
def draw(p: Parameters, i, nodes, torque, at):
    """Torque of link i on its arm, and its stiffness. Writes: nodes. Returns N."""
    tension = torque / at.m
    body, other = nodes[p.node[LEFT_END]], nodes[p.node[RIGHT if i == 1 else LEFT]]
    apply_force(body, scale(tension, at.u), at.d)
    apply_force(other, scale(-tension, at.u), at.far)
    # both links move at once: four points, of which two are of one body
    k = 2.0 * p.stiffness / (at.m * at.m)
    # the lever changes as the arm turns, and the link
    r, length = arm_length(p, i), p.length[i]
    k += abs(torque) / (at.m * at.m) * ((abs(at.m) + r) / length + r / abs(at.m))
    add_stiffness_bound(body, mobility(body, at.d, at.u), k, 0.0)
    add_stiffness_bound(other, mobility(other, at.far, at.u), k, 0.0)
    return tension


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out, curves[0].fault and x."""
    left, right = reach(p, 0, nodes), reach(p, 1, nodes)
    # both angles end at half a revolution, and one arm passes it before the other
    out.twist = counted(left.phi - right.phi, 0.0)
    out.torque = p.stiffness * out.twist
    out.angles[0], out.angles[1] = left.phi, right.phi
    out.stored = 0.5 * p.stiffness * out.twist * out.twist
    out.power = out.loss = 0.0
    out.force = out.right = 0.0
    if is_at_dead_centre(p, 0, left) or is_at_dead_centre(p, 1, right):
        # negative: a link, not an angle
        curves[0].fault = -p.node[LEFT if is_at_dead_centre(p, 0, left) else RIGHT]
        curves[0].x = -1.0
        return
    out.force = draw(p, 0, nodes, out.torque, left)
    out.right = draw(p, 1, nodes, -out.torque, right)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    for k in range(PARTS):
        row = rows[first + k]
        row.stiffness, row.damping = p.stiffness, 0.0
        for c in range(12):
            row.D[c] = row.G[c] = 0.0
    for i in range(2):
        at = reach(p, i, nodes)
        if is_at_dead_centre(p, i, at):
            continue
        sign = 1.0 if i == 0 else -1.0
        # in the left part the link is the first body, in the right part the second
        c = 0 if i == 0 else 6
        put_half(rows[first + i].D, c, scale(sign / at.m, at.u), at.far)
        put_half(rows[first + i].D, 6 - c, scale(-sign / at.m, at.u), at.d)


@kernel
def put_half(D, c, u, d):
    """A motion along u of the point d. Writes: columns c to c + 5 of D."""
    moment = cross(d, u)
    for k in range(3):
        D[c + k] = u[k]
        D[c + 3 + k] = moment[k]
