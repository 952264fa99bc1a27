"""Route of a belt: the fittings in bodies that it runs through, and where its segments lie.

Segment i runs from fitting i to fitting i + 1. At a ring the belt turns by beta, the angle between
its directions before and behind it.
"""

from math import atan2
from typing import Any

import numpy as np
from pydantic import model_validator

from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_force,
    arm,
    mobility,
    point_at,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import cross, dot, norm, scale, sub

MOST = 10  # fittings of one belt
SEGMENTS = MOST - 1
# of the route: a segment shorter than this is taken as this long, where it pulls
SHORT = 1e-3
# cosine of the angle between segments beyond which a route doubles back
BACK = -0.9999


class Anchor(Card):
    """Point of a body that holds an end of the belt."""

    body: BodyName = word("body that holds the belt", default="ground")
    at: Vec3 = quantity("m", "in the frame of the body", default=(0.0, 0.0, 0.0))


class Ring(Card):
    """Slip ring, D-ring or buckle: the webbing runs through a point of a body."""

    body: BodyName = word("body of the ring", default="ground")
    at: Vec3 = quantity("m", "in the frame of the body", default=(0.0, 0.0, 0.0))
    friction: float = quantity("1", "mu between webbing and ring", default=0.0, ge=0, le=5)


class Fitting(Card):
    """One point of the route."""

    anchor: Anchor | None = word("end of the belt", default=None)
    ring: Ring | None = word("the belt slips through it", default=None)

    @model_validator(mode="after")
    def _one(self) -> "Fitting":
        if (self.anchor is None) == (self.ring is None):
            raise ValueError("needs one of anchor and ring")
        return self

    @property
    def held(self) -> Any:
        """What it is."""
        return self.anchor or self.ring

    @property
    def kind(self) -> str:
        return "anchor" if self.anchor else "ring"


ROUTE = Record(f"""
    segments  count          how many
    node      index  {MOST}  body of each fitting; the last is repeated
    point     m      {3 * MOST}  each fitting from the mass centre, body axes
    friction  1      {MOST}  mu of rings
    shortest  m              length below which a segment is taken as that long
""")


def check_route(route: tuple[Fitting, ...]) -> None:
    """Raises ValueError for fittings that make no belt."""
    if len(route) > MOST:
        raise ValueError(f"route: has {len(route)} fittings, and may have {MOST}")
    if len(route) < 2 or route[0].anchor is None or route[-1].anchor is None:
        raise ValueError(
            "route: must begin and end with an anchor; a ring needs webbing on both sides"
        )
    for i, fitting in enumerate(route[1:-1], start=2):
        if fitting.anchor is not None:
            raise ValueError(f"route: fitting {i} is an anchor within the belt; make it a ring")


def route_columns(route: tuple[Fitting, ...], scene: Any) -> dict[str, Any]:
    """Columns of ROUTE."""
    nodes, points = np.zeros(MOST, int), np.zeros((MOST, 3))
    positions = np.zeros((len(route), 3))
    for i, fitting in enumerate(route):
        nodes[i] = scene.node(fitting.held.body)
        points[i] = scene.from_mass_centre(nodes[i], fitting.held.at)
        positions[i] = scene.world_point(nodes[i], fitting.held.at)
    nodes[len(route) :], points[len(route) :] = nodes[len(route) - 1], points[len(route) - 1]
    lengths = refuse_route(route, positions, nodes, scene)
    friction = np.zeros(MOST)
    friction[: len(route)] = [f.ring.friction if f.ring else 0.0 for f in route]
    return {
        "segments": len(route) - 1,
        "node": nodes,
        "point": points.ravel(),
        "friction": friction,
        "shortest": SHORT * float(lengths.sum()),
    }


def refuse_route(
    route: tuple[Fitting, ...], positions: np.ndarray, nodes: np.ndarray, scene: Any
) -> np.ndarray:
    """Lengths (n,) of the segments at the start [m]; what makes no route is refused."""
    legs = np.diff(positions, axis=0)
    lengths: np.ndarray = np.linalg.norm(legs, axis=1)
    for i, length in enumerate(lengths):
        if not length > 2.0 * SHORT * lengths.sum():
            message = f"is {length:.3g} m from the fitting before it, on a route of "
            message += f"{lengths.sum():.3g} m; a segment needs more than {2 * SHORT:g} of it"
            raise scene.fail(message, f"route.{i + 1}.{route[i + 1].kind}.at")
    if len(set(nodes[: len(route)])) == 1:
        raise scene.fail("all fittings are in one body, which it cannot pull", "route")
    units = legs / lengths[:, None]
    for i in range(1, len(route) - 1):
        if units[i - 1] @ units[i] < BACK:
            message = "the belt doubles back on itself in it; move it, or leave it out"
            raise scene.fail(message, f"route.{i}.ring.at")
    return lengths


@kernel
def fitting_arm(p, j, nodes):
    """World vector from the mass centre of its body to fitting j."""
    k = 3 * j
    return arm(nodes[p.node[j]], (p.point[k], p.point[k + 1], p.point[k + 2]))


@kernel
def lay(p, new, out, nodes):
    """Lengths and directions of the segments, and the angles at rings. Writes: new, out."""
    position = point_at(nodes[p.node[0]], fitting_arm(p, 0, nodes))
    before = (0.0, 0.0, 0.0)
    for i in range(p.segments):
        there = point_at(nodes[p.node[i + 1]], fitting_arm(p, i + 1, nodes))
        leg = sub(there, position)
        length = norm(leg)
        u = scale(1.0 / length, leg) if length > 1e-12 else (1.0, 0.0, 0.0)
        for k in range(3):
            new.along[3 * i + k] = u[k]
        out.length[i] = length
        out.angle[i] = atan2(norm(cross(before, u)), dot(before, u)) if i > 0 else 0.0
        position, before = there, u


@kernel
def pull_segments(p, new, out, nodes):
    """Forces of all segments on the bodies of their fittings. Writes: nodes."""
    for i in range(p.segments):
        u = (new.along[3 * i], new.along[3 * i + 1], new.along[3 * i + 2])
        stiffness = p.steepest / new.webbing[i]
        f = scale(out.force[i], u)
        a, b = nodes[p.node[i]], nodes[p.node[i + 1]]
        d_a, d_b = fitting_arm(p, i, nodes), fitting_arm(p, i + 1, nodes)
        apply_force(a, f, d_a)
        apply_force(b, scale(-1.0, f), d_b)
        add_stiffness_bound(a, mobility(a, d_a, u), stiffness, 0.0)
        add_stiffness_bound(b, mobility(b, d_b, u), stiffness, 0.0)
