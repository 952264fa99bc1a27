"""Profiles of roads in pictures: strips below the wheels, as far as these may get."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.distinct import distinct
from crashsolve.model.model import Model

if TYPE_CHECKING:
    from crashsolve.simulation.body_shapes import Piece

# radii of a wheel that a strip reaches beyond it, more than a car has before its wheels; share of
# the way of all wheels that it reaches to either side; parts of its length that curves are drawn by
BESIDE, ASIDE, PARTS = 8.0, 0.5, 400


def profiles(model: Model, nodes: np.ndarray, span: float) -> list[Piece]:
    """A strip for every profile, over the way of its wheels in `span` [s] at their first speeds.

    `nodes` are those at the start.
    """
    tyres = [p for g in model.force_groups() if g.keyword == "tyres" for p in g.parameters]
    if not tyres:
        return []
    # of scenes with tyres alone
    from crashsolve.tyres._road import PROFILE

    wheels: dict[tuple[bytes, int], list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {}
    for p in tyres:
        for i in np.flatnonzero(p["kind"][: int(p["roads"])] == PROFILE):
            at, axes = (p[name].reshape(len(p["kind"]), -1)[i] for name in ("road_at", "road_axes"))
            wheel, axes = nodes[int(p["node"])], axes.reshape(3, 3)
            start = axes @ (wheel["r"] - at)
            end = start + axes @ wheel["v"] * span
            reach = BESIDE * float(p["radius"])
            low, high = np.minimum(start, end) - reach, np.maximum(start, end) + reach
            key = at.tobytes() + axes.tobytes(), int(p["road_root"][i])
            wheels.setdefault(key, []).append((np.array([low, high]), at, axes))
    return [_strip(model.curves, root, some) for (_, root), some in wheels.items()]


def _strip(
    curves: np.ndarray, root: int, wheels: list[tuple[np.ndarray, np.ndarray, np.ndarray]]
) -> Piece:
    """The piece of one profile, whose first point is `root`; ranges, point and axes of wheels."""
    from crashsolve.springs._resistance import read

    rows = curves[root : int(curves["last"][root]) + 1]
    _, at, axes = wheels[0]
    low = np.min([bounds[0] for bounds, _, _ in wheels], axis=0)
    high = np.max([bounds[1] for bounds, _, _ in wheels], axis=0)
    aside = ASIDE * (high[0] - low[0])
    # beyond its ends a profile is level, or may not be read
    first, last = np.clip((low[0], high[0]), rows["x"][0], rows["x"][-1])
    first, last = (first, last) if first < last else (rows["x"][0], rows["x"][-1])
    s = np.linspace(first, last, PARTS + 1) if np.any(rows["c"][:, 2:]) else [first, last]
    inside = rows["x"][(rows["x"] > first) & (rows["x"] < last)]
    s = distinct(np.concatenate([s, inside]))
    z = read(curves, root, s)
    sides = [np.column_stack([s, np.full_like(s, y), z]) for y in (low[1] - aside, high[1] + aside)]
    points = at + np.concatenate(sides) @ axes
    k, n = np.arange(len(s) - 1), len(s)
    cells = np.concatenate(
        [np.column_stack([k, k + 1, n + k + 1]), np.column_stack([k, n + k + 1, n + k])]
    )
    return 0, points, cells
