"""Own faces that a node never meets: by distance along the surface, and by rings."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.contact import near_faces
from crashsolve.model.contact.near_faces import (
    excluded_faces,
    faces_around,
    faces_within_reach,
    merged,
    points_along,
)
from crashsolve.model.contact.node_to_surface import FOLDED, THICKEST


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
    expected = everyone < 2.0 * np.cos(np.pi / 8)
    is_reached = np.zeros_like(expected)
    is_reached[owners, reached] = True
    assert is_reached[expected].all()


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
        first, excluded = merged(
            excluded_faces(quads, around, ring), faces_within_reach(points, quads, around, reach)
        )
        assert list(excluded[first[node] : first[node + 1]]) == list(faces)


def test_the_price_of_distances_along_a_surface_is_that_of_the_pairs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """However few points are looked at together, the pairs are the same."""
    points, quads = strip(12, 12, 1.0, fold=True)
    whole = points_along(points, quads, 4.5)
    monkeypatch.setattr(near_faces, "TABLE", 5 * len(points))
    for one, other in zip(whole, points_along(points, quads, 4.5), strict=True):
        assert (one == other).all()


TUBE = """control: {end_time: 1e-3}
materials: {s: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
parts:
  tube: {type: shell, thickness: "${t}", material: s, layers: 3,
         mesh: {type: tube, width: 0.06, length: 0.09, elements: [6, 6, 9]}}
parameters: {t: 1e-3}
surfaces: {nodes: {type: nodes, part: tube, radius: "${t/2}"}, walls: {type: faces, part: tube}}
contacts: {folds: {a: [nodes], b: [walls], normal: {type: penalty}}}
"""


@pytest.mark.parametrize(
    ("times", "answer"), [(3.9, ""), (4.1, "4 times as thick"), (6.1, "6 times as far")]
)
def test_walls_many_times_thicker_than_their_elements_are_said(
    times: float, answer: str, tmp_path: Path
) -> None:
    """Elements are 10 mm wide; at six times that a self-contact is refused."""
    (tmp_path / "deck.yaml").write_text(TUBE)
    deck = read_deck(tmp_path / "deck.yaml", {"t": str(0.01 * times)})
    if times > THICKEST:
        with pytest.raises(DeckErrors, match=answer):
            build(deck)
    else:
        assert answer in " ".join(build(deck)[0].warnings)
        assert bool(answer) == ("times as thick" in " ".join(build(deck)[0].warnings))


def test_faces_of_large_meshes_are_those_around_their_points() -> None:
    """Meshes have numbers of 32 bits; products of two beyond 46,340 have more."""
    points, quads = strip(1, 60_000, 1.0)
    first, faces = faces_around(quads.astype(np.int32), len(points))
    # point 2 i + k lies between the faces i - 1 and i
    middle = np.arange(2, len(points) - 2)
    assert (np.diff(first)[middle] == 2).all()
    assert (faces[first[middle]] == middle // 2 - 1).all()
    assert (faces[first[middle] + 1] == middle // 2).all()
    owners, reached = points_along(points, quads.astype(np.int32), 1.2)
    assert len(owners) == len(points) * 4 - 4
    assert (np.abs(points[owners] - points[reached]).sum(axis=1) <= 1.0).all()
