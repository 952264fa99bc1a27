"""Springs among several bodies: a line through any number of points, and its length.

    l = sum |x_{j+1} - x_j|,   dl = -sum s_j . dx_j,   s_j = u_{j,j-1} + u_{j,j+1}

s_j is the sum of the unit vectors from point j to its neighbours: a tension T acts on each body
with T s_j. The rows of the tangent take two points each, one in either half of a row, and share one
multiplier. Consequence to test: forces are in balance, and rows are the derivative of the force.
"""

from typing import NamedTuple

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_force,
    arm,
    point_at,
    point_velocity,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import ZERO, Vector, add, cross, dot, norm, scale, sub, vec
from crashsolve.springs._between import SHORTEST

# points of one line, and rows of its tangent that take two of them each
MAX_POINTS, PARTS = 8, 4
POINTS = Record(f"""
    count  count          how many points
    node   index  {MAX_POINTS}  body of each point; the last is repeated
    point  m      {3 * MAX_POINTS}  each point from the mass centre, body axes
""")


class Guide(Card):
    """A point of a body through which the line runs, or at which it ends."""

    body: BodyName = word("body of the point", default="ground")
    at: Vec3 = quantity("m", "point in the frame of the body", default=(0.0, 0.0, 0.0))


def points_of(guides: tuple[Guide, ...], field: str, scene: Scene) -> Columns:
    """Columns POINTS. Raises the scene's errors for too few or many, and for lines of no use."""
    if not 2 <= len(guides) <= MAX_POINTS:
        raise scene.fail(f"has {len(guides)} points; from 2 to {MAX_POINTS} are possible", field)
    for k in range(1, len(guides)):
        if guides[k].body == guides[k - 1].body:
            message = (
                f"goes from '{guides[k].body}' to the same body, where its length never changes"
            )
            raise scene.fail(f"{message}; leave one of both out", f"{field}.{k}")
    nodes = [scene.node(guide.body) for guide in guides]
    points = [
        scene.from_mass_centre(node, guide.at) for node, guide in zip(nodes, guides, strict=True)
    ]
    more = MAX_POINTS - len(nodes)
    return {
        "count": len(nodes),
        "node": np.array(nodes + more * nodes[-1:]),
        "point": np.concatenate(points + more * points[-1:]),
    }


def start_length(columns: Columns, scene: Scene) -> float:
    """Length of the line at the start [m]."""
    points = columns["point"].reshape(-1, 3)
    positions = [
        scene.r[node] + scene.matrix(node) @ point
        for node, point in zip(columns["node"], points, strict=True)
    ]
    return float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum())


class Span(NamedTuple):
    """The line from one point to one of its neighbours."""

    u: Vector  # unit vector there; nothing where both meet
    length: float  # [m]
    v: Vector  # velocity of the neighbour against the point [m/s]


@kernel
def arm_of(p, j, nodes):
    """Point j from the mass centre of its body, world axes [m]."""
    return arm(nodes[p.node[j]], (p.point[3 * j], p.point[3 * j + 1], p.point[3 * j + 2]))


@kernel
def span(p, j, k, nodes):
    """The Span from point j to point k."""
    a, b = nodes[p.node[j]], nodes[p.node[k]]
    d_a, d_b = arm_of(p, j, nodes), arm_of(p, k, nodes)
    x = sub(point_at(b, d_b), point_at(a, d_a))
    v = sub(point_velocity(b, d_b), point_velocity(a, d_a))
    length = norm(x)
    if length < SHORTEST:
        return Span(ZERO, length, v)
    return Span(scale(1.0 / length, x), length, v)


@kernel
def length_and_rate(p, nodes):
    """Length of the whole line and its rate [m, m/s]."""
    length, rate = 0.0, 0.0
    for j in range(p.count - 1):
        piece = span(p, j, j + 1, nodes)
        length += piece.length
        rate += dot(piece.u, piece.v)
    return length, rate


@kernel
def direction(p, j, nodes):
    """s_j: along which a tension of 1 N acts on point j."""
    s = ZERO
    if j > 0:
        s = add(s, span(p, j, j - 1, nodes).u)
    if j < p.count - 1:
        s = add(s, span(p, j, j + 1, nodes).u)
    return s


@kernel
def pull_along(p, nodes, tension, stiffness, damping):
    """Tension of the line on all its bodies, with its stiffness and damping. Writes: nodes."""
    # a row moves all of them at once: its rate is the sum over the points, not twice the largest
    share = 0.5 * p.count
    for j in range(p.count):
        body, d, s = nodes[p.node[j]], arm_of(p, j, nodes), direction(p, j, nodes)
        apply_force(body, scale(tension, s), d)
        rotation = cross(d, s)
        mobility = body.mass_inv * dot(s, s) + dot(rotation, matvec(body.W, rotation))
        add_stiffness_bound(body, mobility, share * stiffness, share * damping)
        # a tension resists motion across its line, and turns arms
        spins = body.W[0] + body.W[4] + body.W[8]
        across, arm_length = body.mass_inv + dot(d, d) * spins, norm(d)
        if j > 0:
            per = tension / max(span(p, j, j - 1, nodes).length, SHORTEST)
            add_stiffness_bound(body, across, per, 0.0)
        if j < p.count - 1:
            per = tension / max(span(p, j, j + 1, nodes).length, SHORTEST)
            add_stiffness_bound(body, across, per, 0.0)
        add_stiffness_bound(body, spins * arm_length, tension, 0.0)


@kernel
def tangent_along(p, nodes, rows, first, stiffness, damping):
    """Tangent of a force that depends on length and rate of the line. Writes: rows."""
    for k in range(PARTS):
        row = rows[first + k]
        row.stiffness, row.damping = stiffness, damping
        for c in range(12):
            row.D[c] = row.G[c] = 0.0
    for j in range(p.count):
        row, c = rows[first + j // 2], 6 * (j % 2)
        if j > 0:
            add_span(row, c, p, j, j - 1, nodes)
        if j < p.count - 1:
            add_span(row, c, p, j, j + 1, nodes)


@kernel
def add_span(row, c, p, j, k, nodes):
    """Add the span from point j to point k to the columns of j from c on. Writes: row."""
    body, d, piece = nodes[p.node[j]], arm_of(p, j, nodes), span(p, j, k, nodes)
    u = piece.u
    per = 1.0 / piece.length if piece.length >= SHORTEST else 0.0
    u_dot = scale(per, sub(piece.v, scale(dot(u, piece.v), u)))
    moment, swung = cross(d, u), cross(d, add(u_dot, cross(u, vec(body.w))))
    for i in range(3):
        row.D[c + i] += u[i]
        row.D[c + 3 + i] += moment[i]
        row.G[c + i] += u_dot[i]
        row.G[c + 3 + i] += swung[i]
