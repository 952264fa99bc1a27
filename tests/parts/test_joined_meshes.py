"""Claim: given meshes whose elements lie in rows are made twice as coarse, others say why not."""

import numpy as np
import pytest

from crashsolve.meshes._joined import joined
from crashsolve.meshes._mesh import Mesh, net


def plate(nu: int, nv: int, closed: bool = False) -> Mesh:
    """A net with its nodes and elements in any order, on a bent surface."""
    at, quads, sides = net(nu, nv, closed)
    order = np.random.default_rng(3).permutation(len(at))
    points = np.empty((len(at), 3))
    angle = 2.0 * np.pi * at[:, 0]
    points[order] = np.column_stack([np.cos(angle), np.sin(angle), at[:, 1]])
    quads = np.random.default_rng(4).permutation(order[quads])
    turned = np.array([np.roll(quad, k % 4) for k, quad in enumerate(quads)])
    return Mesh(points, turned, {name: order[own] for name, own in sides.items()})


def outlines(mesh: Mesh) -> set[tuple[tuple[float, ...], ...]]:
    """Elements by the positions of their corners, from the least one on: their sense counts."""
    rings = set()
    for quad in mesh.quads:
        positions = [tuple(np.round(mesh.points[node], 9)) for node in quad]
        k = positions.index(min(positions))
        rings.add(tuple(positions[k:] + positions[:k]))
    return rings


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("factor", [2, 4])
def test_a_divided_mesh_that_is_joined_is_itself_again(closed: bool, factor: int) -> None:
    nu, nv = (5, 3) if not closed else (6, 3)
    coarse, fine = plate(nu, nv, closed), plate(factor * nu, factor * nv, closed)
    again = joined(fine, factor)
    assert outlines(again) == outlines(coarse)
    for name, own in coarse.sets.items():
        positions = {tuple(np.round(p, 9)) for p in again.points[again.sets[name]]}
        assert positions == {tuple(np.round(p, 9)) for p in coarse.points[own]}


def test_sets_of_elements_are_joined_unless_their_border_runs_through_a_joined_one() -> None:
    at, quads, sides = net(4, 2)
    points = np.column_stack([at, np.zeros(len(at))])
    x = points[quads, 0].mean(axis=1)
    halves = {"left": np.flatnonzero(x < 0.5), "right": np.flatnonzero(x > 0.5)}
    coarse = joined(Mesh(points, quads, sides, halves), 2)
    middle = coarse.points[coarse.quads, 0].mean(axis=1)
    for name, is_in in (("left", middle < 0.5), ("right", middle > 0.5)):
        assert coarse.element_sets[name].tolist() == np.flatnonzero(is_in).tolist()
    with pytest.raises(ValueError, match="border of element set 'first'"):
        joined(Mesh(points, quads, sides, {"first": np.flatnonzero(x < 0.25)}), 2)


def test_three_faces_around_a_corner_are_joined() -> None:
    # the faces of a cube at one of its corners, where three elements meet
    at, quads, _ = net(4, 4)
    x, y = at.T
    zero = np.zeros(len(at))
    faces = [np.column_stack(c) for c in ((x, y, zero), (y, zero, x), (zero, x, y))]
    points, number = np.unique(np.round(np.concatenate(faces), 9), axis=0, return_inverse=True)
    all_quads = np.concatenate([quads + k * len(at) for k in range(3)])
    coarse = joined(Mesh(points, number.ravel()[all_quads], {}), 2)
    assert (len(coarse.quads), len(coarse.points)) == (12, 19)


@pytest.mark.parametrize(
    ("mesh", "reported"),
    [
        (plate(5, 4), "rows of even numbers"),
        (plate(5, 4, True), "rows of even numbers"),
        (Mesh(np.eye(3), np.array([[0, 1, 2, 2]]), {}), "triangles"),
        (Mesh(plate(4, 4).points, plate(4, 4).quads, {"s": np.array([0])}), None),
    ],
)
def test_what_cannot_be_joined_says_why(mesh: Mesh, reported: str | None) -> None:
    if reported is None:
        # the one node of a set is none of the corners that stay
        kept = set(map(tuple, joined(Mesh(mesh.points, mesh.quads, {}), 2).points.tolist()))
        lost = next(k for k, p in enumerate(mesh.points.tolist()) if tuple(p) not in kept)
        mesh.sets["s"], reported = np.array([lost]), "set 's'"
    with pytest.raises(ValueError, match=reported):
        joined(mesh, 2)
