"""Halves: parts with points cut in two, so that two threads can each do the elements of one.

A half is a row of the part's parameters with fewer points and elements, the blocks of the first
half before those of the second. A corner of the second at a point of the first gets a point of its
own, behind all others, that stands for it: no two threads add to one place.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from crashsolve.foundation.point import LANES, POINT, RIDES, first_half
from crashsolve.foundation.record import Record
from crashsolve.model.clock import CLOCK
from crashsolve.model.model import Model, State

JOB = Record(
    number=("index", "what the second thread is to do"),
    h=("s", "step"),
    entry=("index", "for which load"),
    current=("index", "of its history"),
)
LOAN = Record(
    point=("index", "that a point stands for"),
    slows=("flag", "whether its element has damping"),
)
HOLD = Record(point=("index", "that is held"))
QUADS = ("one_point", "four_points")


@dataclass
class Halves:
    """What two threads need beside the tables of one."""

    rows: tuple[dict[str, np.ndarray], dict[str, np.ndarray]]  # parameters of groups by word
    loads: dict[str, np.ndarray]  # those of loads on elements, as the second half has them
    corners: np.ndarray  # of the second half
    points: np.ndarray  # all of them, those that stand for others behind
    loans: np.ndarray  # for which
    holds: np.ndarray  # points that are held
    second_clock: np.ndarray

    @property
    def lent(self) -> np.ndarray:
        """Points that stand for others."""
        return self.points[len(self.points) - len(self.loans) :]


def halve(model: Model, state: State) -> Halves:
    """All parts with points in two halves. Writes: state.points, a view of a longer table."""
    rows: tuple[dict[str, np.ndarray], dict[str, np.ndarray]] = ({}, {})
    corners: list[np.ndarray] = []
    loans: list[np.ndarray] = []
    moved: dict[int, int] = {}
    elements, count = model.elements, len(state.points)
    assert elements is not None
    for g in model.element_groups():
        pairs = [
            _cut(row, elements.parts[name]) for name, row in zip(g.names, g.parameters, strict=True)
        ]
        for k in range(2):
            rows[k][g.word] = np.array([pair[k] for pair in pairs])
        for row, first, second in zip(g.parameters, rows[0][g.word], rows[1][g.word], strict=True):
            own, lent = _border(row, first, second, elements.corners, count)
            own[own >= count] += sum(map(len, loans))
            moved[int(second["first_corner"])] = sum(map(len, corners))
            second["first_corner"] = sum(map(len, corners))
            corners.append(own)
            loan = np.zeros(len(lent), LOAN.dtype)
            loan["point"], loan["slows"] = lent, row["slows"]
            loans.append(loan)
    table = np.zeros(count + sum(map(len, loans)), POINT.dtype)
    table[:count] = state.points
    state.points = table[:count]
    held = np.flatnonzero((state.points["held"] > 0) & (state.points["held"] < RIDES))
    return Halves(
        rows,
        {g.word: _moved(g.parameters, moved) for g in model.element_loads()},
        np.concatenate(corners),
        table,
        np.concatenate(loans),
        held.astype(HOLD.dtype),
        np.zeros(1, CLOCK.dtype),
    )


def _moved(rows: np.ndarray, moved: dict[int, int]) -> np.ndarray:
    """Rows of loads on elements whose second half begins at a corner of its own table."""
    found = rows.copy()
    found["first_corner"][:, 1] = [moved[int(corner)] for corner in rows["first_corner"][:, 1]]
    return found


def _blocks(elements: int) -> int:
    """Blocks that hold so many elements."""
    return -(-elements // LANES)


def _cut(row: Any, meshed: Any) -> tuple[Any, Any]:
    """Rows of both halves of a part; the corners of the second are still those of the part."""
    first, second = row.copy(), row.copy()
    triangles = int(row["triangles"])
    quads = int(row["element_count"]) - triangles
    filled = _blocks(quads)
    head, n, m = first_half(quads, triangles)
    for kind in QUADS:
        own = n if row[kind] else 0
        first[kind], second[kind] = own, row[kind] - own
    first["triangles"], second["triangles"] = m, triangles - m
    first["element_count"], second["element_count"] = n + m, quads + triangles - n - m
    second["first"] += min(head, filled) * meshed.stride + max(head - filled, 0) * meshed.stride_of(
        1
    )
    second["first_corner"] += 4 * LANES * head
    second["first_element"] += n + m
    # what drag takes is summed point by point: one thread does them all
    points = int(row["point_count"])
    half = points if row["drag"] > 0.0 else (points + 1) // 2
    first["point_count"], second["point_count"] = half, points - half
    second["first_point"] += half
    return first, second


def _border(
    row: Any, first: Any, second: Any, corners: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the second half, and the points that those stand for which begin at `count`."""
    begin, cut = int(row["first_corner"]), int(second["first_corner"])
    end = cut + 4 * LANES * (_blocks_of(second))
    mine = np.zeros(count, bool)
    mine[corners[begin:cut]] = True
    own = corners[cut:end].copy()
    # block by block and corner by corner, as forces are added
    table = own.reshape(-1, 4, LANES)
    shared = mine[table] & _live(second)[:, None, :]
    lent = table[shared]
    table[shared] = count + np.arange(len(lent))
    return own, lent


def _blocks_of(half: Any) -> int:
    triangles = int(half["triangles"])
    return _blocks(int(half["element_count"]) - triangles) + _blocks(triangles)


def _live(half: Any) -> np.ndarray:
    """Which lanes of the blocks of a half hold an element (blocks, lanes)."""
    triangles = int(half["triangles"])
    counts = (int(half["element_count"]) - triangles, triangles)
    lanes = [np.arange(LANES * _blocks(n)) < n for n in counts]
    return np.concatenate(lanes).reshape(-1, LANES)
