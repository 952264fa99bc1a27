"""Ends of bars that are hinged to their point, or offset from it: separate nodes, and joints.

    rotations free  none    one        two          three
    joint           weld    revolute   universal    spherical

The joint holds the bar's end at its position on the node of the point, so that a moment which is
not passed on is exactly zero and an offset is a rigid arm, for any rotation of both. Consequence to
test: two clamped arms hinged to each other bend as two cantilevers; a pull beside the axis bends by
P e.
"""

from collections.abc import Sequence
from typing import Literal, Protocol

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.foundation.orientation import perpendicular

OneAxis = Literal["rotation_x", "rotation_y", "rotation_z"]
JOINTS = ("weld", "revolute", "universal", "spherical")


class End(Card):
    """An end of a bar with a separate node, P_barK_start or P_barK_end for bar K of part P."""

    bar: int = word("number of the bar, from 1", ge=1)
    point: int = word("number of the point at this end of the bar", ge=1)
    free: tuple[OneAxis, ...] = word(
        "rotations about the bar's axes without a moment; x along the bar", default=()
    )
    offset: Vec3 = quantity(
        "m", "vector from the point to the bar's end, world axes", default=(0.0, 0.0, 0.0)
    )


class Bars(Protocol):
    """Fields of a frame's card that its ends need."""

    @property
    def points(self) -> Sequence[Vec3]: ...
    @property
    def bars(self) -> Sequence[tuple[int, int]]: ...
    @property
    def ends(self) -> Sequence[End]: ...
    @property
    def side(self) -> Vec3 | None: ...


def is_first(card: Bars, end: End) -> bool:
    """Whether this is the first end of its bar."""
    return bool(card.bars[end.bar - 1][0] == end.point)


def names(card: Bars, part: str) -> list[str]:
    """Names of the nodes of released ends."""
    names_of_joints = []
    for end in card.ends:
        known = end.bar <= len(card.bars)
        side = "start" if known and is_first(card, end) else "end"
        names_of_joints.append(f"{part}_bar{end.bar}_{side}")
    return names_of_joints


def position(card: Bars, end: End) -> np.ndarray:
    """Position (3,) of an end at the start [m]."""
    return np.asarray(card.points[end.point - 1]) + np.asarray(end.offset)


def bar_end(card: Bars, bar: int, point: int) -> np.ndarray:
    """Position (3,) of the end of a bar, number from 1, at a point [m]."""
    own = [end for end in card.ends if (end.bar, end.point) == (bar, point)]
    return position(card, own[0]) if own else np.asarray(card.points[point - 1])


def start(card: Bars, bar: int) -> np.ndarray:
    """Position (3,) of the beginning of a bar [m]."""
    return bar_end(card, bar, card.bars[bar - 1][0])


def along(card: Bars, bar: int) -> np.ndarray:
    """Vector (3,) from the beginning to the end of a bar [m]."""
    return bar_end(card, bar, card.bars[bar - 1][1]) - start(card, bar)


def fault(card: Bars) -> str:
    """Message on the first error in the ends; empty without one."""
    pairs = set()
    count = len(card.points)
    if not all(1 <= point <= count for bar in card.bars for point in bar):
        return f"bars join points that do not exist: points are 1 to {count}"
    for end in card.ends:
        if end.bar > len(card.bars) or end.point not in card.bars[end.bar - 1]:
            return f"bar {end.bar} does not end in point {end.point}"
        if (end.bar, end.point) in pairs:
            return f"bar {end.bar} at point {end.point} is given twice"
        pairs.add((end.bar, end.point))
    for point in range(1, len(card.points) + 1):
        bars = [k for k, bar in enumerate(card.bars, start=1) if point in bar]
        if bars and all((k, point) in pairs for k in bars):
            advice = "leave one bar without an entry: the others rotate relative to it"
            return f"every bar at point {point} has an end of its own; {advice}"
    return ""


def joints(card: Bars, part: str) -> dict[str, tuple[str, Columns]]:
    """Joints between the ends and their points: type and words by name."""
    columns_of: dict[str, tuple[str, Columns]] = {}
    if fault(card):
        # refused where the part is built
        return columns_of
    for end, name in zip(card.ends, names(card, part), strict=True):
        axes = {
            f"rotation_{k}": axis.tolist() for k, axis in zip("xyz", _axes(card, end), strict=True)
        }
        free = sorted(set(end.free))
        words = {"a": f"{part}_{end.point}", "b": name, "at": position(card, end).tolist()}
        if len(free) == 1:
            words["axis"] = axes[free[0]]
        elif len(free) == 2:
            words["axis"], words["second_axis"] = (axes[rotation] for rotation in free)
        columns_of[name] = (JOINTS[len(free)], words)
    return columns_of


def _axes(card: Bars, end: End) -> np.ndarray:
    """Axes of the bar as rows; unit axes where the bar has none, which is refused elsewhere."""
    x = along(card, end.bar)
    length = float(np.linalg.norm(x))
    if not length > 0.0:
        return np.eye(3)
    x = x / length
    y = np.asarray(perpendicular(x) if card.side is None else card.side, float)
    y = y - x * float(x @ y)
    if not np.linalg.norm(y) > 0.0:
        return np.eye(3)
    y = y / np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])
