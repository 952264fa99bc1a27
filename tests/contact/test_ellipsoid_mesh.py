"""Gaps between ellipsoids and meshes: spheres, planes at any depth, and the nearest triangle."""

from pathlib import Path

import numpy as np
import pytest
from bench import exponential
from test_mesh import HEAD, ball
from touching import Contact

from crashsolve.contact.narrow import _ellipsoid_face
from crashsolve.foundation.orientation import matrix

SQUARE = "[[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], faces: [[0, 1, 2], [0, 2, 3]]"


def over(folder: Path, shape: str, mesh: str) -> Contact:
    """A shape of body a over a mesh fixed in the ground."""
    surfaces = f"surfaces:\n  one: {{{shape}, body: a}}\n  mesh: {{type: mesh, vertices: {mesh}}}\n"
    return Contact(folder, surfaces=surfaces, sides="a: [one], b: [mesh]", bodies=HEAD)


@pytest.mark.parametrize("seed", range(3))
def test_with_equal_semi_axes_it_is_the_gap_of_a_sphere(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, faces = ball(1, rng)
    mesh = f"{points.tolist()}, faces: {faces.tolist()}"
    egg = over(tmp_path, "type: ellipsoid, semi_axes: [0.3, 0.3, 0.3]", mesh)
    sphere = over(tmp_path, "type: sphere, radius: 0.3", mesh)
    inside = 0
    for y in rng.uniform(-1.1, 1.1, (20, 3)):
        contacts = []
        for contact in (egg, sphere):
            contact.bench.move(1, r=y)
            contacts.append(contact.deepest())
        (depth, n, x), (expected, n_sphere, x_sphere) = contacts
        inside += expected > 0.3
        assert depth == pytest.approx(expected, abs=1e-13)
        # a foot on an edge is known to the root of round-off
        np.testing.assert_allclose(n, n_sphere, atol=1e-7)
        np.testing.assert_allclose(x, x_sphere, atol=1e-7)
    assert inside >= 2


@pytest.mark.parametrize("seed", range(4))
def test_on_a_face_it_is_as_deep_as_on_a_plane_at_any_depth(tmp_path: Path, seed: int) -> None:
    semi, rng = np.array([0.3, 0.15, 0.1]), np.random.default_rng(seed)
    contact = over(
        tmp_path, f"type: ellipsoid, semi_axes: {semi.tolist()}", f"{SQUARE}, thickness: 0.2"
    )
    q = exponential(rng.uniform(-1.5, 1.5, 3))
    A = matrix(q)
    reach = np.linalg.norm(semi * A[2])
    # down to where the exit sideways is shorter than that of the face, and behind the solid
    for height in (reach + 0.02, reach - 0.01, reach - 0.03, -0.25):
        # beside and on the edge between both triangles
        contact.bench.move(1, r=[0.1, 0.1 + 0.05 * (seed % 2), height], q=q)
        depth, n, x = contact.deepest()
        behind = height < -0.2
        assert depth == pytest.approx(0.2 + height if behind else reach - height, abs=1e-13)
        np.testing.assert_allclose(n, [0, 0, -1 if behind else 1], atol=1e-14)
        if not behind:
            assert x[2] == pytest.approx(height - reach, abs=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_the_nearest_triangle_is_that_of_a_search_over_all(tmp_path: Path, seed: int) -> None:
    semi, rng = (0.3, 0.15, 0.1), np.random.default_rng(seed)
    points, faces = ball(2, rng)
    mesh = f"{points.tolist()}, faces: {faces.tolist()}"
    contact = over(tmp_path, f"type: ellipsoid, semi_axes: {list(semi)}", mesh)
    apart = 0
    for y in rng.normal(size=(10, 3)):
        y *= rng.uniform(1.1, 1.6) / np.linalg.norm(y)
        q = exponential(rng.uniform(-1.5, 1.5, 3))
        contact.bench.move(1, r=y, q=q)
        corners = (points[faces] - y) @ matrix(q)
        least = min(
            _ellipsoid_face.nearest_by_newton(
                semi, 1e9, *(tuple(map(float, c)) for c in (i, j, k, k))
            )[2]
            for i, j, k in corners
        )
        depth, n, _ = contact.deepest()
        if depth > 0.1**2 / 0.3:
            # deeper than the least radius of curvature a face keeps its own exit
            assert depth >= -least - 1e-12
            continue
        apart += 1
        # on a face the formula of the plane, of which d differs by what its foot is known to
        assert depth == pytest.approx(-least, abs=1e-12)
        assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-14)
    assert apart >= 4
