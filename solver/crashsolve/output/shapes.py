"""Triangulated surfaces of primitives for display, in body axes about the shape's centre.

Every function returns points (n, 3) and triangles (m, 3), corners counter-clockwise seen from
outside.
"""

from functools import cache

import numpy as np

Surface = tuple[np.ndarray, np.ndarray]

SEGMENTS = 24
RINGS = 12


def sphere(radius: float) -> Surface:
    """Sphere of a radius [m] with its poles on the z axis: points (n, 3) [m], triangles (m, 3)."""
    return ellipsoid(radius, radius, radius)


def ellipsoid(a: float, b: float, c: float) -> Surface:
    """Ellipsoid with semi-axes a, b, c [m] along x, y, z."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, RINGS + 1)[1:-1]
    # rings of circles between the two poles
    return _revolved(np.cos(latitude), np.sin(latitude), -1.0, 1.0, scale=(a, b, c))


def cylinder(radius: float, half_length: float) -> Surface:
    """Capped cylinder along z, by its radius and half its length [m]."""
    radii = np.array([radius, radius])
    heights = np.array([-half_length, half_length])
    return _revolved(radii, heights, -half_length, half_length)


def box(hx: float, hy: float, hz: float) -> Surface:
    """Box with half lengths hx, hy, hz [m]."""
    corners = np.array([[x, y, z] for z in (-hz, hz) for y in (-hy, hy) for x in (-hx, hx)])
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, np.array([half for i, j, k, m in sides for half in ((i, j, k), (i, k, m))])


def prism(outline: np.ndarray, ends: np.ndarray, axes: np.ndarray) -> Surface:
    """Bar between two points, ends (2, 3) [m], of a convex section.

    `outline` (n, 2) [m] goes counter-clockwise about the bar; `axes` (3, 2) are its y and z.
    """
    n = len(outline)
    edge = np.arange(n)
    following, fan = np.roll(edge, -1), edge[1:-1]
    corners = np.concatenate([end + outline @ axes.T for end in ends])
    sides = [
        np.column_stack([edge, following, n + following]),
        np.column_stack([edge, n + following, n + edge]),
    ]
    caps = [
        np.column_stack([np.zeros_like(fan), fan + 1, fan]),
        n + np.column_stack([np.zeros_like(fan), fan, fan + 1]),
    ]
    return corners, np.concatenate([*sides, *caps])


def plane(size: float) -> Surface:
    """Square of a side [m] in the xy plane, outside being +z."""
    half = size / 2
    corners = np.array(
        [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]]
    )
    return corners, np.array([[0, 1, 2], [0, 2, 3]])


def _revolved(
    radii: np.ndarray,
    heights: np.ndarray,
    bottom: float,
    top: float,
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> Surface:
    """Surface through circles of given radii and heights, closed by a bottom and a top point."""
    angle = 2 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(SEGMENTS)], axis=1)
    rings = radii[:, None, None] * circle + heights[:, None, None] * np.array([0.0, 0.0, 1.0])
    poles = np.array([[0.0, 0.0, bottom], [0.0, 0.0, top]])
    points = np.concatenate([rings.reshape(-1, 3), poles]) * np.array(scale)
    return points, _between(len(radii))


@cache
def _between(circles: int) -> np.ndarray:
    """Triangles between so many circles and the two poles; not to be changed."""
    base = np.arange(SEGMENTS)
    after = np.roll(base, -1)
    last = (circles - 1) * SEGMENTS
    south, north = circles * SEGMENTS, circles * SEGMENTS + 1
    triangles = [np.stack([np.full(SEGMENTS, south), after, base], axis=1)]
    for start in range(0, last, SEGMENTS):
        low, low_after = start + base, start + after
        triangles.append(np.stack([low, low_after, low_after + SEGMENTS], axis=1))
        triangles.append(np.stack([low, low_after + SEGMENTS, low + SEGMENTS], axis=1))
    triangles.append(np.stack([np.full(SEGMENTS, north), last + base, last + after], axis=1))
    joined = np.concatenate(triangles)
    joined.flags.writeable = False
    return joined
