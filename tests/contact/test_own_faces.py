"""Own faces that a node never meets: by distance along the surface, and by rings."""

import numpy as np
import pytest

from crashsolve.model.contact.near_faces import (
    faces_around,
    merged,
    points_along,
    spare,
    spare_along,
)
from crashsolve.model.contact.node_to_surface import FOLDED


def strip(
    across: int, along: int, size: float, fold: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Points and faces of a strip; folded, its second half lies back over the first."""
    i, j = np.meshgrid(np.arange(along + 1), np.arange(across + 1), indexing="ij")
    points = np.stack([i * size, j * size, 0.0 * i], axis=-1).reshape(-1, 3)
    if fold:
        middle = 0.5 * along * size
        over = points[:, 0] > middle
        points[over, 0] = 2.0 * middle - points[over, 0]
        points[over, 2] = 1e-3
    n = across + 1
    first = (np.arange(along)[:, None] * n + np.arange(across)).ravel()
    return points, np.stack([first, first + n, first + n + 1, first + 1], axis=1)


@pytest.mark.parametrize("size", (1.0, 0.5, 0.25))
def test_points_are_found_along_the_surface(size: float) -> None:
    points, quads = strip(int(6 / size), int(6 / size), size)
    owners, reached = points_along(points, quads, 2.0)
    distance = np.linalg.norm(points[owners] - points[reached], axis=1)
    # ways along sides and diagonals of squares are longer by 1 / cos(pi/8) at most
    assert distance.max() < 2.0
    everyone = np.linalg.norm(points[:, None] - points, axis=2)
    sure = everyone < 2.0 * np.cos(np.pi / 8)
    found = np.zeros_like(sure)
    found[owners, reached] = True
    assert found[sure].all()


def test_a_wall_that_is_near_but_far_along_the_surface_is_met() -> None:
    points, quads = strip(1, 40, 1.0, fold=True)
    owners, reached = points_along(points, quads, 3.5)
    # points of a row of two have consecutive numbers: rows state how far along they are
    assert (np.abs(owners // 2 - reached // 2) <= 3).all()


def test_faces_are_left_out_by_distance_and_by_rings() -> None:
    points, quads = strip(1, 20, 1.0)
    around = faces_around(quads, len(points))
    node, gap = 20, 1.0  # in row 10, between faces 9 and 10
    for reach, ring, faces in (
        (FOLDED * gap, 0, range(7, 13)),
        (FOLDED * gap, 3, range(6, 14)),
        (0.5, 0, range(9, 11)),
        (0.5, 1, range(8, 12)),
    ):
        first, spared = merged(
            spare(quads, around, ring), spare_along(points, quads, around, reach)
        )
        assert list(spared[first[node] : first[node + 1]]) == list(faces)
