"""Display surfaces: closed, outward, and of nearly the true volume."""

from collections import Counter

import numpy as np
import pytest

from crashsolve.output import shapes
from crashsolve.output.shapes import Surface

CLOSED = {
    "sphere": (shapes.sphere(2.0), 4 / 3 * np.pi * 8),
    "ellipsoid": (shapes.ellipsoid(1.0, 2.0, 3.0), 4 / 3 * np.pi * 6),
    "cylinder": (shapes.cylinder(0.5, 2.0), np.pi * 0.25 * 4),
    "box": (shapes.box(1.0, 2.0, 3.0), 48.0),
    "prism": (
        shapes.prism(
            np.array([[2.0, -1.0], [0.0, 3.0], [-2.0, -1.0]]),
            np.array([[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]),
            np.eye(3)[:, 1:],
        ),
        32.0,
    ),
}


@pytest.mark.parametrize("name", CLOSED)
def test_surface_is_closed_and_turned_outward(name: str) -> None:
    (points, triangles), _ = CLOSED[name]
    edges = Counter(
        (int(triangle[corner]), int(triangle[corner - 2]))
        for triangle in triangles
        for corner in range(3)
    )
    # every edge is walked once each way
    assert set(edges.values()) == {1}
    assert all((end, start) in edges for start, end in edges)
    assert sorted(set(triangles.ravel())) == list(range(len(points)))
    # the shapes are convex about the origin
    assert (_normals((points, triangles)) * points[triangles].mean(axis=1)).sum(axis=1).min() > 0


@pytest.mark.parametrize("name", CLOSED)
def test_volume_is_right_and_inscribed(name: str) -> None:
    surface, volume = CLOSED[name]
    points, triangles = surface
    enclosed = (_normals(surface) * points[triangles[:, 0]]).sum() / 6
    assert 0.95 * volume < enclosed <= volume * (1 + 1e-12)


def test_points_lie_on_the_ellipsoid() -> None:
    points, _ = shapes.ellipsoid(1.0, 2.0, 3.0)
    np.testing.assert_allclose(((points / [1, 2, 3]) ** 2).sum(axis=1), 1.0)


def test_cylinder_reaches_its_ends() -> None:
    points, _ = shapes.cylinder(0.5, 2.0)
    np.testing.assert_allclose(points.min(axis=0), [-0.5, -0.5, -2.0])
    np.testing.assert_allclose(points.max(axis=0), [0.5, 0.5, 2.0])


def test_plane_faces_up() -> None:
    surface = shapes.plane(4.0)
    np.testing.assert_array_equal(_normals(surface), [[0, 0, 16], [0, 0, 16]])


def _normals(surface: Surface) -> np.ndarray:
    """Twice the area times the outward normal of every triangle."""
    points, triangles = surface
    first, second, third = (points[triangles[:, corner]] for corner in range(3))
    return np.cross(second - first, third - first)
