"""Pressure on a shell, along the normals of its elements as they move.

    f = -p / 4 (x_3 - x_1) x (x_4 - x_2) / 2   on each of four corners, -p / 3 of three

Positive pressure acts against the normal. Its work is that of the mean force of a step.
Consequence to test: a flat plate takes p A in all, and a closed body nothing.
"""

from typing import Any, ClassVar

from crashsolve.deck.card import Card, CurveName, PartName, quantity, word
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.lanes import EIGHT, NEXT, add_forces, take_motion
from crashsolve.foundation.motion import act_from_outside
from crashsolve.foundation.point import LANES, first_half
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, put, scale, sub


class Pressure(Card):
    """Pressure on all elements of a shell."""

    curve_axes: ClassVar = {"curve": ("s", "1")}

    part: PartName = word("shell part")
    pressure: float = quantity("Pa", "p, against the normal where positive")
    curve: CurveName | None = word("factor over time; 1 when absent", default=None)


CURVES_OF_TIME = ("curve",)
PARAMETERS = Record(
    pressure=("Pa", "p"),
    curve=("index", "factor over time; 0 for none"),
    first_corner=("index", 2, "of the corners of each half of the part"),
    quads=("count", 2, "quadrilaterals there"),
    triangles=("count", 2, "triangles there, in the blocks after theirs"),
)
AMPLITUDE = "pressure"
HISTORY = Record(pressure=("Pa", "pressure at the last step"))
OUTPUT = Record(force=("N", 3, "total"), pressure=("Pa", "present pressure"))
# rows of `work` behind those that motion is taken to: force on a corner; sums over the blocks of
# it, of its moment and of its work; torques NEXT rows behind forces, and loads, of which none is
FORCE, TOTAL, MOMENT, LOSS = (3 * NEXT + k for k in (0, 3, 6, 9))
EMPTY = FORCE + NEXT + 3


def build(card: Pressure, scene: Any) -> dict[str, Any]:
    if scene.can_fail(card.part):
        message = (
            f"the elements of '{card.part}' may be deleted (failure_strain): load its nodes instead"
        )
        raise scene.fail(message, "part")
    corner, quads, triangles = scene.faces(card.part, "part")
    head, n, m = first_half(quads, triangles)
    return {
        "pressure": card.pressure,
        "curve": scene.curve(card.curve) if card.curve else 0,
        "first_corner": (corner, corner + 4 * LANES * head),
        "quads": (n, quads - n),
        "triangles": (m, triangles - m),
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
def load_half(p, half, old, out, h, scene):
    """The elements of one half of the part. Writes: scene.points, work."""
    clear(scene.work)
    first, quads = p.first_corner[half], p.quads[half]
    press(first, quads, 4, old, out, h, scene)
    filled = (quads + LANES - 1) // LANES * LANES
    press(first + 4 * filled, p.triangles[half], 3, old, out, h, scene)


@kernel
def add_up(out, h, nodes, work):
    """What loading a half of the part has left in `work`. Writes: nodes, out."""
    total = sum_three(work, TOTAL)
    out.loss += h * sum_lanes(work, LOSS)
    add_to(out.force, total)
    act_from_outside(nodes[0], total, sum_three(work, MOMENT))


@kernel
def press(first, count, sides, old, out, h, scene):
    """Elements of one number of sides, by blocks. Writes: scene.points, work."""
    points, corners, work, done, share = scene.points, scene.corners, scene.work, 0, -0.5 / sides
    while done < count:
        corner, live = first + 4 * done, min(LANES, count - done)
        for c in range(4):
            for e in range(0, LANES, EIGHT):
                take_motion(points, corners, corner + LANES * c + e, work, LANES * 3 * c + e)
        press_block(work, live, sides, h, share * out.pressure, share * old.pressure)
        for c in range(sides):
            for e in range(0, LANES, EIGHT):
                rows = (LANES * FORCE + e, LANES * EMPTY + e)
                add_forces(
                    points, corners, corner + LANES * c + e, work, rows[0], rows[1], live - e
                )
        done += LANES


@blockwise
def clear(work):
    """No forces yet, and no torques and loads ever. Writes: work."""
    for e in range(LANES * (EMPTY + 2 - FORCE)):
        work[LANES * FORCE + e] = 0.0


@inlined
def row_of(work, quantity, c, e):
    """Place or velocity of a corner."""
    at = LANES * (NEXT * quantity + 3 * c) + e
    return work[at], work[at + LANES], work[at + 2 * LANES]


@blockwise
def press_block(work, live, sides, h, now, before):
    """Force on each corner of a block, and what it adds to the sums. Writes: work.

    `now` and `before` are shares of a corner in the pressure over the cross product of diagonals.
    """
    fourth = 1.0 if sides == 4 else 0.0
    for e in range(LANES):
        a, b = row_of(work, 0, 0, e), row_of(work, 0, 1, e)
        c, d = row_of(work, 0, 2, e), row_of(work, 0, 3, e)
        v_a, v_b = row_of(work, 1, 0, e), row_of(work, 1, 1, e)
        v_c, v_d = row_of(work, 1, 2, e), row_of(work, 1, 3, e)
        x, y = sub(c, a), sub(d, b)
        f = scale(now if e < live else 0.0, cross(x, y))
        # velocities are those of the step: before it, the diagonals were shorter by them
        x, y = add_scaled(x, -h, sub(v_c, v_a)), add_scaled(y, -h, sub(v_d, v_b))
        mean = scale(0.5, add_scaled(f, before if e < live else 0.0, cross(x, y)))
        place = add_scaled(add(add(a, b), c), fourth, d)
        way = add_scaled(add(add(v_a, v_b), v_c), fourth, v_d)
        turn = cross(place, f)
        for k in range(3):
            work[LANES * (FORCE + k) + e] = f[k]
            work[LANES * (TOTAL + k) + e] += sides * f[k]
            work[LANES * (MOMENT + k) + e] += turn[k]
        work[LANES * LOSS + e] += dot(mean, way)


@kernel
def sum_lanes(work, row):
    """Sum over a row."""
    total = 0.0
    for e in range(LANES):
        total += work[LANES * row + e]
    return total


@kernel
def sum_three(work, row):
    """Sums over three rows."""
    return sum_lanes(work, row), sum_lanes(work, row + 1), sum_lanes(work, row + 2)
