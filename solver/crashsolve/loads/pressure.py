"""Pressure on a shell, along the normals of its elements as they move.

    f = -p / 4 (x_3 - x_1) x (x_4 - x_2) / 2   on each of four corners, -p / 3 of three

Positive pressure acts against the normal. Its work is that of the mean force of a step.
Consequence to test: a flat plate takes p A in all, and a closed body nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, NamedTuple

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, PartName, quantity, word
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import apart, blockwise, inlined, kernel
from crashsolve.foundation.lanes import EIGHT, NEXT, add_forces, gather_motion
from crashsolve.foundation.motion import act_from_outside
from crashsolve.foundation.point import BLOCKS, LANES
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, put, scale, sub, vec

if TYPE_CHECKING:
    from crashsolve.loads._rows.pressure import History, Output, Parameters


class Pressure(Card):
    """Pressure on all elements of a shell."""

    curve_axes: ClassVar = {"curve": ("s", "1")}

    part: PartName = word("shell part")
    pressure: float = quantity("Pa", "p, against the normal where positive")
    curve: CurveName | None = word("factor over time; 1 when absent", default=None)


CURVES_OF_TIME = ("curve",)
PARAMETERS = BLOCKS + Record("""
    pressure  Pa     p
    curve     index  factor over time; 0 for none
""")
AMPLITUDE = "pressure"
HISTORY = Record("pressure  Pa  pressure at the last step")
OUTPUT = Record("""
    force     N   3  total
    pressure  Pa     present pressure
""")
# rows of `work` behind those that motion is taken to: force on a corner; force, moment and work of
# an element; torques NEXT rows behind forces, and loads, of which none is
FORCE, TOTAL, MOMENT, WORK = (3 * NEXT + k for k in (0, 3, 6, 9))
EMPTY = FORCE + NEXT + 3


def build(card: Pressure, scene: Scene) -> Columns:
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
        "aside": 0,
        "quads": quads,
        "triangles": triangles,
        "first_block": 0,
    }


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: out, new."""
    factor = 1.0
    if p.curve > 0:
        factor, _, _ = curve_value(curves, p.curve, t)
    out.pressure = factor * p.pressure
    put(out.force, (0.0, 0.0, 0.0))
    out.stored = out.power = out.loss = 0.0
    new.pressure = out.pressure


class Elements(NamedTuple):
    """Elements of a part that have the same number of sides."""

    sides: int
    number: int
    first: int  # of the corners of their first block
    block: int  # the first of their sums


@kernel
def load_elements(p: Parameters, old: History, out: Output, h, scene):
    """Forces on blocks of elements. Writes: scene.points, work, block_sums."""
    clear(scene.work)
    filled = (p.quads + LANES - 1) // LANES
    now, before = out.pressure, old.pressure
    quads = Elements(4, p.quads, p.first_corner, p.first_block)
    press(quads, p.aside, now, before, h, scene)
    first = p.first_corner + 4 * LANES * filled
    triangles = Elements(3, p.triangles, first, p.first_block + filled)
    press(triangles, p.aside, now, before, h, scene)


@kernel
def add_up(p: Parameters, out: Output, h, nodes, block_sums):
    """Sum the values of all blocks in order. Writes: nodes, out."""
    total = moment = (0.0, 0.0, 0.0)
    work = 0.0
    blocks = (p.quads + LANES - 1) // LANES + (p.triangles + LANES - 1) // LANES
    for k in range(blocks):
        one = block_sums[k]
        total, moment = add(total, vec(one.force)), add(moment, vec(one.moment))
        work += one.work
    out.loss += h * work
    add_to(out.force, total)
    act_from_outside(nodes[0], total, moment)


@kernel
def kick_rate(p: Parameters, out: Output, scene):
    """f . M^-1 F of the pressure f on its points and all forces F on them [W/s]."""
    filled = (p.quads + LANES - 1) // LANES
    quads = Elements(4, p.quads, p.first_corner, p.first_block)
    first = p.first_corner + 4 * LANES * filled
    triangles = Elements(3, p.triangles, first, p.first_block + filled)
    return -out.pressure * (
        swept_acceleration(quads, scene.points, scene.corners)
        + swept_acceleration(triangles, scene.points, scene.corners)
    )


@kernel
def swept_acceleration(elements, points, corners):
    """Sum of the areas of elements times their mean accelerations along the normals [m^3/s^2]."""
    total, fourth = 0.0, 1.0 if elements.sides == 4 else 0.0
    for i in range(elements.number):
        at = elements.first + 4 * LANES * (i // LANES) + i % LANES
        a, b = points[corners[at]], points[corners[at + LANES]]
        c, d = points[corners[at + 2 * LANES]], points[corners[at + 3 * LANES]]
        area = scale(0.5, cross(sub(vec(c.r), vec(a.r)), sub(vec(d.r), vec(b.r))))
        v_dot = add_scaled(scale(a.mass_inv, vec(a.force)), b.mass_inv, vec(b.force))
        v_dot = add_scaled(v_dot, c.mass_inv, vec(c.force))
        v_dot = add_scaled(v_dot, fourth * d.mass_inv, vec(d.force))
        total += dot(area, v_dot) / elements.sides
    return total


@apart
def press(elements, aside, now, before, h, scene):
    """Elements of one number of sides, by blocks. Writes: scene.points, work, block_sums.

    `now` and `before` are the pressure and that of the step before [Pa].
    """
    sides, count, first, block = elements
    points, corners, work, done, share = scene.points, scene.corners, scene.work, 0, -0.5 / sides
    while done < count:
        corner, live = first + 4 * done, min(LANES, count - done)
        for c in range(4):
            for e in range(0, LANES, EIGHT):
                gather_motion(points, corners, corner + LANES * c + e, work, LANES * 3 * c + e)
        press_block(work, live, sides, h, share * now, share * before)
        for c in range(sides):
            for e in range(0, LANES, EIGHT):
                at, rows = corner + aside + LANES * c + e, (LANES * FORCE + e, LANES * EMPTY + e)
                add_forces(points, corners, at, work, rows[0], rows[1], live - e)
        one = scene.block_sums[block + done // LANES]
        put(one.force, sum_three(work, TOTAL))
        put(one.moment, sum_three(work, MOMENT))
        one.work = sum_lanes(work, WORK)
        done += LANES


@blockwise
def clear(work):
    """No forces yet, and no torques and loads ever. Writes: work."""
    for e in range(LANES * (EMPTY + 2 - FORCE)):
        work[LANES * FORCE + e] = 0.0


@inlined
def row_of(work, quantity, c, e):
    """Position [m] or velocity [m/s] of a corner."""
    at = LANES * (NEXT * quantity + 3 * c) + e
    return work[at], work[at + LANES], work[at + 2 * LANES]


@blockwise
def press_block(work, live, sides, h, now, before):
    """Force on each corner of a block, and the resultants. Writes: work.

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
        position = add_scaled(add(add(a, b), c), fourth, d)
        velocity = add_scaled(add(add(v_a, v_b), v_c), fourth, v_d)
        rotation = cross(position, f)
        for k in range(3):
            work[LANES * (FORCE + k) + e] = f[k]
            work[LANES * (TOTAL + k) + e] = sides * f[k]
            work[LANES * (MOMENT + k) + e] = rotation[k]
        work[LANES * WORK + e] = dot(mean, velocity)


@kernel
def sum_lanes(work, row):
    """Sum over a row."""
    total = 0.0
    for e in range(LANES):
        total += work[LANES * row + e]
    return total


@kernel
def sum_three(work, row):
    """Sums (3) over three rows."""
    return sum_lanes(work, row), sum_lanes(work, row + 1), sum_lanes(work, row + 2)
