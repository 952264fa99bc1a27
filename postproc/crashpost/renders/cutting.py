"""Sectional views: a drawing without the parts on one side of a plane, `y<0` or `x > 100 mm`."""

import re
from dataclasses import replace

import numpy as np

from crashpost.errors import PostError
from crashpost.renders.shapes import Drawing, Surface
from crashsolve.channels.display import factor

_WORDS = re.compile(r"\s*([xyz])\s*([<>])\s*([-+.\deE]+)\s*([a-z]*)\s*")

# outward normal (3,) and offset [m]: kept is where normal . x <= offset
Half = tuple[np.ndarray, float]


def half_space(text: str) -> Half:
    """Half space that a sectional view keeps, from words; raises PostError."""
    match = _WORDS.fullmatch(text)
    try:
        if match is None:
            raise ValueError
        axis, side, digits, unit = match.groups()
        value = float(digits) * factor(unit or "m", "m")
    except (ValueError, PostError):
        raise PostError(
            f"cut '{text}': write what is kept, such as 'y<0' or 'x > 100 mm'"
        ) from None
    sign = 1.0 if side == "<" else -1.0
    return sign * np.eye(3)["xyz".index(axis)], sign * value


def clamped(points: np.ndarray, half: Half) -> np.ndarray:
    """Points (n, 3), those that are cut off moved straight to the plane."""
    normal, offset = half
    beyond = np.maximum(points @ normal - offset, 0.0)
    moved: np.ndarray = points - beyond[:, None] * normal
    return moved


def cut(drawing: Drawing, half: Half) -> Drawing:
    """The part of a drawing within a half space."""
    normal, offset = half
    kept = Drawing([s for one in drawing.surfaces for s in _surfaces(one, half)])
    for lines in drawing.lines:
        # a segment that is cut off has no length, so that each keeps its value
        ends = lines.ends.copy()
        above = ends @ normal - offset
        for one, other in ((0, 1), (1, 0)):
            crosses = (above[:, one] > 0) & (above[:, other] <= 0)
            share = above[crosses, one] / (above[crosses, one] - above[crosses, other])
            along = lines.ends[crosses, other] - lines.ends[crosses, one]
            ends[crosses, one] += share[:, None] * along
        gone = (above > 0).all(axis=1)
        ends[gone, 1] = ends[gone, 0] = lines.ends[gone, 0]
        values = lines.values if lines.values is None else lines.values[~gone]
        kept.lines.append(replace(lines, ends=ends[~gone], values=values))
    for dots in drawing.dots:
        kept.dots.append(replace(dots, points=dots.points[dots.points @ normal <= offset]))
    for starts, vectors in drawing.arrows:
        selected = starts @ normal <= offset
        kept.arrows.append((starts[selected], vectors[selected]))
    return kept


def _crossing(points: np.ndarray, above: np.ndarray, edge: tuple[int, int]) -> np.ndarray:
    """The point (3,) of an edge in the plane."""
    one, other = edge
    share = above[one] / (above[one] - above[other])
    crossings: np.ndarray = (1.0 - share) * points[one] + share * points[other]
    return crossings


def _surfaces(surface: Surface, half: Half) -> list[Surface]:
    """Whole polygons and the pieces of those that the plane crosses.

    One surface for each number of corners where edges are drawn; elsewhere one of triangles, in
    which neighbours share their edges.
    """
    normal, offset = half
    above = surface.points @ normal - offset
    is_out = above[surface.corners] > 0
    whole = np.flatnonzero(~is_out.any(axis=1))
    crossed = np.flatnonzero(is_out.any(axis=1) & ~is_out.all(axis=1))
    points, pieces = _pieces(surface, above, crossed)
    rows = [*whole, *crossed]
    polygons = [*surface.corners[whole].tolist(), *pieces]
    if not surface.edges:
        rows = [row for row, p in zip(rows, polygons, strict=True) for _ in p[2:]]
        polygons = [[p[0], p[k], p[k + 1]] for p in polygons for k in range(1, len(p) - 1)]
    halves = []
    for count in sorted({surface.corners.shape[1] if surface.edges else 3, *map(len, polygons)}):
        own = [k for k, polygon in enumerate(polygons) if len(polygon) == count]
        selected = np.array([rows[k] for k in own], int)
        halves.append(
            replace(
                surface,
                points=points,
                corners=np.array([polygons[k] for k in own], int).reshape(-1, count),
                which=surface.which[selected],
                rows=surface.rows[selected],
                values=None if surface.values is None else surface.values[selected],
            )
        )
    return halves


def _pieces(
    surface: Surface, above: np.ndarray, crossed: np.ndarray
) -> tuple[np.ndarray, list[list[int]]]:
    """All points, with those in the plane, and the corners of the remaining parts of crossed
    polygons.
    """
    # polygons that share an edge share the point at which it is cut
    points, pieces, known = list[np.ndarray](), list[list[int]](), dict[tuple[int, int], int]()
    for row in crossed:
        piece = []
        around = surface.corners[row].tolist()
        for one, other in zip(around, [*around[1:], around[0]], strict=True):
            if above[one] <= 0:
                piece.append(one)
            if (above[one] <= 0) != (above[other] <= 0):
                edge = (min(one, other), max(one, other))
                if edge not in known:
                    known[edge] = len(surface.points) + len(points)
                    points.append(_crossing(surface.points, above, edge))
                piece.append(known[edge])
        pieces.append(piece)
    return np.concatenate([surface.points, np.reshape(points, (-1, 3))]), pieces
