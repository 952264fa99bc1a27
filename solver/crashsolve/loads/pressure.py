"""Pressure on a shell, along the normals of its elements as they move.

    f = -p / 4 (x_3 - x_1) x (x_4 - x_2) / 2   on each of four corners, -p / 3 of three

Positive pressure acts against the normal. Its work is that of the mean force of a step.
Consequence to test: a flat plate takes p A in all, and a closed body nothing.
"""

from typing import Any

from crashsolve.deck.card import Card, CurveName, PartName, quantity, word
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.motion import act_from_outside
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, add_to, cross, dot, put, scale, sub, vec


class Pressure(Card):
    """Pressure on all elements of a shell."""

    part: PartName = word("shell part")
    pressure: float = quantity("Pa", "p, against the normal where positive")
    curve: CurveName | None = word("factor over time; 1 when absent", default=None)


PARAMETERS = Record(
    pressure=("Pa", "p"),
    curve=("index", "factor over time; 0 for none"),
    first_corner=("index", "of the part's corners"),
    quads=("count", "quadrilaterals"),
    triangles=("count", "triangles, in the blocks after theirs"),
)
HISTORY = Record(pressure=("Pa", "pressure at the last step"))
OUTPUT = Record(force=("N", 3, "total"), pressure=("Pa", "present pressure"))


def build(card: Pressure, scene: Any) -> dict[str, Any]:
    if scene.can_fail(card.part):
        message = (
            f"the elements of '{card.part}' may be deleted (failure_strain): load its nodes instead"
        )
        raise scene.fail(message, "part")
    corner, quads, triangles = scene.faces(card.part, "part")
    return {
        "pressure": card.pressure,
        "curve": scene.curve(card.curve) if card.curve else 0,
        "first_corner": corner,
        "quads": quads,
        "triangles": triangles,
    }


@kernel
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: out, new."""
    factor = 1.0
    if p.curve > 0:
        factor, _, _ = curve_value(curves, p.curve, t)
    out.pressure = factor * p.pressure
    put(out.force, (0.0, 0.0, 0.0))
    out.stored = out.power = out.loss = 0.0
    new.pressure = out.pressure


@kernel
def force_on_points(p, old, new, out, t, h, nodes, curves, scene):
    """Writes: scene.points, nodes, out."""
    press(p.first_corner, p.quads, 4, old, out, h, nodes, scene)
    filled = (p.quads + LANES - 1) // LANES * LANES
    press(p.first_corner + 4 * filled, p.triangles, 3, old, out, h, nodes, scene)


@kernel
def press(first, count, sides, old, out, h, nodes, scene):
    """Elements of one number of sides. Writes: scene.points, nodes, out."""
    points, corners = scene.points, scene.corners
    share, zero = -0.5 / sides, (0.0, 0.0, 0.0)
    # sums in memory would wait for each other
    total, moment, loss = zero, zero, 0.0
    for i in range(count):
        lane = i % LANES
        at = first + 4 * (i - lane) + lane
        a, b = points[corners[at]], points[corners[at + LANES]]
        c, d = points[corners[at + 2 * LANES]], points[corners[at + 3 * LANES]]
        x, y = sub(vec(c.r), vec(a.r)), sub(vec(d.r), vec(b.r))
        f = scale(share * out.pressure, cross(x, y))
        # velocities are those of the step: before it, the diagonals were shorter by them
        x = add_scaled(x, -h, sub(vec(c.v), vec(a.v)))
        y = add_scaled(y, -h, sub(vec(d.v), vec(b.v)))
        mean = scale(0.5, add_scaled(f, share * old.pressure, cross(x, y)))
        place, way = zero, zero
        for k in range(sides):
            point = points[corners[at + k * LANES]]
            add_to(point.force, f)
            place, way = add(place, vec(point.r)), add(way, vec(point.v))
        total, moment = add(total, f), add(moment, cross(place, f))
        loss += dot(mean, way)
    out.loss += h * loss
    add_to(out.force, scale(sides, total))
    act_from_outside(nodes[0], scale(sides, total), moment)
