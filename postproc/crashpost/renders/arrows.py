"""Arrows of forces and velocities as polygons."""

import numpy as np

from crashpost.renders.camera import Camera
from crashpost.renders.shapes import ARROW, Drawing, Surface

# largest arrow upwards, of the picture's height, and sideways, of its width or of four heights
UPWARDS, SIDEWAYS, HEIGHTS = 0.28, 0.25, 4.0
# thickness over half of the height; in pictures of more than this aspect it grows with the width
WIDTH, WIDE = 0.022, 3.0


def unit_length(vectors: np.ndarray, fitted_camera: Camera) -> float:
    """Length of an arrow for each unit [m], so that none of the vectors (n, 3) is too long."""
    height = 2.0 * fitted_camera.half_height
    limits = (
        SIDEWAYS * min(fitted_camera.width, HEIGHTS * height),
        UPWARDS * height,
        UPWARDS * height,
    )
    axes = np.array([fitted_camera.right, fitted_camera.up, fitted_camera.towards])
    largest = np.abs(vectors @ axes.T).max(axis=0)
    return float(min(limit / part for limit, part in zip(limits, largest, strict=True) if part))


def arrows_of(
    drawing: Drawing, fitted_camera: Camera, arrow: float, thickness: float = 1.0
) -> Drawing:
    """Only the arrows of a drawing, `arrow` [m] long for each unit, so many times as thick."""
    arrows = Drawing()
    for starts, vectors in drawing.arrows:
        width = (
            WIDTH
            * max(min(fitted_camera.aspect, 1.0), fitted_camera.aspect / WIDE)
            * fitted_camera.half_height
        )
        width *= thickness
        points, quads, triangles = arrow_polygons(starts, vectors, arrow, width)
        for corners in (quads, triangles):
            if len(corners):
                which = np.zeros(len(corners), int)
                arrows.surfaces.append(
                    Surface(points, corners, [ARROW], which, which, is_flat=True)
                )
    return arrows


def arrow_polygons(
    starts: np.ndarray, vectors: np.ndarray, unit_length: float, width: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, sides (quads) and heads (triangles) of arrows, `unit_length` [m] for each unit.

    All are `width` [m] thick; those shorter than their head are left out.
    """
    lengths = unit_length * np.linalg.norm(vectors, axis=1)
    selected = lengths > 2.0 * width
    starts, lengths = starts[selected], lengths[selected]
    along = vectors[selected] / np.linalg.norm(vectors[selected], axis=1)[:, None]
    helper = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    side = np.cross(along, helper)
    side /= np.linalg.norm(side, axis=1)[:, None]
    other = np.cross(along, side)
    n = 10
    angle = 2.0 * np.pi * np.arange(n) / n
    ring = side[:, None] * np.cos(angle)[:, None] + other[:, None] * np.sin(angle)[:, None]
    head = np.minimum(6.0 * width, 0.5 * lengths)[:, None, None]
    neck = (starts + along * lengths[:, None])[:, None] - along[:, None] * head
    tip = (starts + along * lengths[:, None])[:, None]
    cloud = np.concatenate(
        [
            starts[:, None] + 0.5 * width * ring,
            neck + 0.5 * width * ring,
            neck + 1.6 * width * ring,
            tip,
        ],
        axis=1,
    )
    base = np.arange(n)
    after = np.roll(base, -1)
    shaft = np.column_stack([base, after, after + n, base + n])
    head_points = np.column_stack([base + n, after + n, after + 2 * n, base + 2 * n])
    cone = np.column_stack([base + 2 * n, after + 2 * n, np.full(n, 3 * n)])
    first = (3 * n + 1) * np.arange(len(starts))[:, None, None]
    quads = (first + np.concatenate([shaft, head_points])).reshape(-1, 4)
    return cloud.reshape(-1, 3), quads, (first + cone).reshape(-1, 3)
