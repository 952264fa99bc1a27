"""A driver who steers along a path: he aims at a point ahead, and his hands rotate a joint.

    X = X_0 + T V,   e: lateral offset of the path from the point X ahead of the vehicle
    delta = atan(2 L e / (X^2 + e^2)),  at most the limit:  the arc through that point of the path
    F = k (n delta - x) - c x_dot   in the joint, of travel or angle x

Where the path is farther aside than 3 X, or across his line of sight, he drives towards it at half
a right angle; between 2 X and 3 X his aim goes over from one to the other. He turns round where he
faces against the path.

Distances are taken in the plane at right angles to `up`, from a point of the vehicle between its
rear wheels: without slip of its tyres it holds a circle without error, at delta = atan(L / R). At
rest and in reverse he holds the joint at 0, and below 0.5 m/s he steers in proportion to the speed.
The force acts in the joint, and his work comes from outside. Consequence to test:
with tyres of cornering stiffness the offset on a circle is that of the bicycle model.

Reference: Coulter (1992), Implementation of the pure pursuit path tracking algorithm, Carnegie
Mellon University CMU-RI-TR-92-01.
"""

from __future__ import annotations

from importlib import import_module
from math import atan, atan2, cos, sqrt
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, CurveName, JointName, Vec3, quantity, word
from crashsolve.foundation.angles import angle_about, angle_gradient, counted
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_force,
    apply_torque,
    arm,
    mobility,
    point_at,
    point_velocity,
    spin_mobility,
    world_position,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, scale, sub, vec

if TYPE_CHECKING:
    from crashsolve.loads._rows.path_steering import History, Output, Parameters

# iterations of the search for the path, and where it is close enough, over the distance ahead
ITERATIONS, CLOSE = 20, 1e-12
# least cosine between path and line of sight of the search
LEAST_COSINE = 0.05
# distances of the path aside, over that ahead: up to which he aims at it, from which towards it
NEAR, FAR = 2.0, 3.0
# speed from which the driver steers without limit [m/s]
FULL_STEERING_SPEED = 0.5


class PathSteering(Card):
    """Driver who steers a joint so that a vehicle follows a path."""

    curve_axes: ClassVar = {"path": ("m", "m")}

    joint: JointName = word(
        "joint that the driver moves: its angle, or where it has none its travel, as of a rack"
    )
    vehicle: BodyName = word("body that is to follow the path")
    at: Vec3 = quantity(
        "m", "point of the vehicle on the path, between the rear wheels", (0.0, 0.0, 0.0)
    )
    forward: Vec3 = word(
        "direction of travel of the vehicle, in its frame; any length", (1.0, 0.0, 0.0)
    )
    path: CurveName = word("y(s), offset to the left over the distance along")
    origin: Vec3 = quantity("m", "point of the ground where s and y are 0", (0.0, 0.0, 0.0))
    along: Vec3 = word("direction of s, horizontal; any length", (1.0, 0.0, 0.0))
    up: Vec3 = word("normal of the plane of the path; any length", (0.0, 0.0, 1.0))
    wheelbase: float = quantity("m", "L, from front to rear wheels", gt=0)
    preview_time: float = quantity(
        "s", "T, preview time: the driver looks ahead by X_0 and T times the speed", 0.0, ge=0
    )
    preview_distance: float = quantity("m", "X_0, preview distance at rest", gt=0)
    ratio: float = quantity(
        "any", "n, coordinate of the joint per angle of the wheels to the left, m/rad or 1"
    )
    limit: float = quantity(
        "rad", "largest angle of the wheels that the driver commands", 0.6, gt=0, lt=1.5
    )
    stiffness: float = quantity(
        "any", "k, stiffness of the driver's hands, N/m or N m/rad of the joint", gt=0
    )
    damping: float = quantity(
        "any", "c, damping of the driver's hands, N s/m or N m s/rad", default=0.0, ge=0
    )


PARAMETERS = Record("""
    node_a      index              first body of the joint
    node_b      index              second body
    is_angle    flag               1: of its angle, 0: of its travel
    point_a     m               3  point of the joint from the mass centre of a, axes of a
    point_b     m               3  the same of b, axes of b
    axis_a      1               3  axis, axes of a
    side_a      1               3  at right angles to the axis, axes of a
    side_b      1               3  the same direction at the start, axes of b
    vehicle     index              body that follows the path
    at          m               3  its point on the path from its mass centre, body axes
    forward     1               3  body axes
    path        index              y(s)
    origin      m               3  where s and y are 0
    along       1               3  direction of s
    left        1               3  direction of y
    up          1               3  normal of the plane
    wheelbase   m                  L
    preview     s                  T
    ahead       m                  X_0
    ratio       m/rad or 1         n
    limit       rad                of delta
    stiffness   N/m or N m/rad     k
    relaxation  s                  c / k
""")
AMPLITUDE = "stiffness"
HISTORY = Record("angle  rad  of the joint, over all revolutions")
OUTPUT = Record("""
    force           N or N m      F, on the second body of the joint
    steering_angle  rad           delta, commanded by the driver
    target          m or rad      n delta
    coordinate      m or rad      x, of the joint since the start
    rate            m/s or rad/s  of it
    offset          m             of the vehicle from the path at its point, positive to the left
    preview_error   m             e, of the point that he aims at
""")


def build(card: PathSteering, scene: Scene) -> Columns:
    scene.refuse_joint(card.joint, ("travel", "angle"), "joint")
    if card.ratio == 0.0:
        raise scene.fail("must not be 0: the driver would never steer", "ratio")
    vehicle = scene.node(card.vehicle)
    if vehicle == 0:
        raise scene.fail("the ground follows no path; name a body", "vehicle")
    along, up = scene.unit(card.along, "along"), scene.unit(card.up, "up")
    if abs(along @ up) > 1e-6:
        raise scene.fail("along and up must be at right angles", "along")
    forward = scene.unit(card.forward, "forward")
    if np.linalg.norm(np.cross(scene.matrix(vehicle) @ forward, up)) < 0.1:
        raise scene.fail("points along `up` at the start; a vehicle drives across it", "forward")
    free = import_module(scene.joint_entry(card.joint).module_name).FREE
    frame = scene.joints[card.joint].frame
    none = np.zeros(3)
    return {
        **{name: frame.get(name, none) for name in ("side_a", "side_b", "point_a", "point_b")},
        "node_a": frame["node_a"],
        "node_b": frame["node_b"],
        "axis_a": frame["axis_a"],
        "is_angle": int("angle" in free),
        "vehicle": vehicle,
        "at": scene.from_mass_centre(vehicle, card.at),
        "forward": forward,
        "path": scene.curve(card.path),
        "origin": np.array(card.origin),
        "along": along,
        "left": np.cross(up, along),
        "up": up,
        "wheelbase": card.wheelbase,
        "preview": card.preview_time,
        "ahead": card.preview_distance,
        "ratio": card.ratio,
        "limit": card.limit,
        "stiffness": card.stiffness,
        "relaxation": card.damping / card.stiffness,
    }


@kernel
def lateral_offset(p: Parameters, target, side, X, curves):
    """e of the path from the point ahead, along `side` [m], and whether it is near."""
    e = 0.0
    for _ in range(ITERATIONS):
        probe = add_scaled(target, e, side)
        y, slope, _ = curve_value(curves, p.path, dot(probe, vec(p.along)))
        across = dot(side, vec(p.left)) - slope * dot(side, vec(p.along))
        gap = y - dot(probe, vec(p.left))
        if abs(gap) < CLOSE * X:
            return e, across > LEAST_COSINE and abs(e) < FAR * X
        # towards a path across his line of sight, or along it, there is none
        e += gap / max(across, LEAST_COSINE)
    return e, False


@kernel
def steering_target(p: Parameters, nodes, curves):
    """delta of the driver [rad], offset of the point he aims at [m], that of the vehicle [m]."""
    body, up = nodes[p.vehicle], vec(p.up)
    x = sub(world_position(body, vec(p.at)), vec(p.origin))
    forward = arm(body, vec(p.forward))
    forward = add_scaled(forward, -dot(forward, up), up)
    forward = scale(1.0 / norm(forward), forward)
    side = cross(up, forward)
    V = dot(forward, point_velocity(body, arm(body, vec(p.at))))
    X = p.ahead + p.preview * max(V, 0.0)
    y, slope, _ = curve_value(curves, p.path, dot(x, vec(p.along)))
    cosine = cos(atan(slope))
    offset = (dot(x, vec(p.left)) - y) * cosine
    e, is_near = lateral_offset(p, add_scaled(x, X, forward), side, X, curves)
    far = max((abs(e) / X - NEAR) / (FAR - NEAR), 0.0) if is_near else 1.0
    ahead, aside = X, e
    if far > 0.0:
        # along the path, and towards it by half a right angle at most
        tangent = scale(cosine, add_scaled(vec(p.along), slope, vec(p.left)))
        towards = add_scaled(tangent, -max(min(offset / X, 1.0), -1.0), cross(up, tangent))
        ahead = (1.0 - far) * X + far * X * dot(towards, forward)
        aside = far * X * dot(towards, side)
        if far < 1.0:
            aside += (1.0 - far) * e
        if ahead < 0.0:
            # behind him: the tightest arc
            aside = sqrt(ahead * ahead + aside * aside) * (1.0 if aside >= 0.0 else -1.0)
            ahead = 0.0
    delta = atan2(2.0 * p.wheelbase * aside, ahead * ahead + aside * aside)
    moves = max(min(V / FULL_STEERING_SPEED, 1.0), 0.0)
    return moves * max(min(delta, p.limit), -p.limit), aside, offset


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    out.steering_angle, out.preview_error, out.offset = steering_target(p, nodes, curves)
    out.target = p.ratio * out.steering_angle
    k, c = p.stiffness, p.relaxation * p.stiffness
    new.angle = 0.0
    if p.is_angle == 1:
        out.coordinate = counted(angle_about(a, b, p.axis_a, p.side_a, p.side_b), old.angle)
        new.angle = out.coordinate
        g = angle_gradient(a, b, p.axis_a, p.side_b)
        out.rate = dot(g, sub(vec(b.w), vec(a.w)))
        out.force = k * (out.target - out.coordinate) - c * out.rate
        apply_torque(b, scale(out.force, g))
        apply_torque(a, scale(-out.force, g))
        add_stiffness_bound(a, spin_mobility(a, g), k, c)
        add_stiffness_bound(b, spin_mobility(b, g), k, c)
    else:
        u, d_b = arm(a, vec(p.axis_a)), arm(b, vec(p.point_b))
        x = sub(point_at(b, d_b), point_at(a, arm(a, vec(p.point_a))))
        # the point of a where b is
        d_a = add(arm(a, vec(p.point_a)), x)
        out.coordinate = dot(u, x)
        out.rate = dot(u, sub(point_velocity(b, d_b), point_velocity(a, d_a)))
        out.force = k * (out.target - out.coordinate) - c * out.rate
        apply_force(b, scale(out.force, u), d_b)
        apply_force(a, scale(-out.force, u), d_a)
        add_stiffness_bound(a, mobility(a, d_a, u), k, c)
        add_stiffness_bound(b, mobility(b, d_b, u), k, c)
    out.stored = 0.0
    out.power = out.force * out.rate
    out.loss = 0.0
