"""What every gap promises: the true depth, and a normal and point that move as it changes."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from bench import exponential, product
from numpy.typing import ArrayLike
from touching import Contact

from crashsolve.contact import narrow
from crashsolve.contact.shape.box import ROUNDING
from crashsolve.foundation.rows import as_rows

# each shape as a card on body %s, and how far it reaches along directions u (n, 3) in its body
AXES = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3.0
ROTATED = "rotation: {axis: [1, 1, 1], angle: 60 deg}"
OCTAHEDRON = 0.3 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
CARDS = {
    "sphere": "type: sphere, body: %s, radius: 0.25, at: [0.1, 0, 0.05]",
    "plane": "type: plane, body: %s, normal: [1, 2, 2], at: [0.1, 0, 0.05]",
    "ellipsoid": f"type: ellipsoid, body: %s, semi_axes: [0.4, 0.2, 0.3], {ROTATED},"
    " at: [0.1, 0, 0.05]",
    "cylinder": "type: cylinder, body: %s, radius: 0.2, length: 0.6, axis: [2, -1, 2],"
    " at: [0.1, 0, 0.05]",
    "box": f"type: box, body: %s, size: [0.6, 0.4, 0.5], at: [0.1, 0, 0.05], {ROTATED}",
    "mesh": f"type: mesh, body: %s, vertices: {OCTAHEDRON.tolist()}, at: [0.1, 0, 0.05], {ROTATED},"
    " faces: [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5],"
    " [0, 3, 5]]",
}
REACH: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "sphere": lambda u: np.full(len(u), 0.25),
    "ellipsoid": lambda u: np.linalg.norm(u @ AXES * [0.4, 0.2, 0.3], axis=1),
    "cylinder": lambda u: (
        0.2 * np.sqrt(np.maximum(1 - (u @ AXES[:, 2]) ** 2, 0)) + 0.3 * np.abs(u @ AXES[:, 2])
    ),
    "box": lambda u: np.abs(u @ AXES) @ [0.3, 0.2, 0.25],
    "mesh": lambda u: (u @ AXES @ OCTAHEDRON.T).max(axis=1),
}
PAIRS = sorted(p.stem for p in Path(narrow.__path__[0]).glob("[!_]*.py"))
LEAST = 0.2  # smallest half size of all shapes, which the rounding is a share of


class Pair(Contact):
    """Two shapes on the bodies a and b."""

    def __init__(self, folder: Path, word: str, rotated: bool = False) -> None:
        self.shapes = word.split("_")
        cards = "".join(
            f"  {body}: {{{CARDS[shape] % body}}}\n"
            for body, shape in zip("ab", self.shapes, strict=True)
        )
        sides = "a: [b], b: [a]" if rotated else "a: [a], b: [b]"
        super().__init__(folder, surfaces=f"surfaces:\n{cards}", sides=sides)

    def approach(self, seed: int) -> None:
        """Any configurations, near to each other: some apart, some overlapping by a little."""
        rng = np.random.default_rng(seed)
        self.bench.shake(seed, rotation=2.0)
        n = rng.normal(size=3)
        self.bench.move(1, r=self.bench.nodes[2].r + 3.0 * n / np.linalg.norm(n))
        # along the normal of a gap the depth grows one for one, to first order
        for aim in (rng.uniform(-0.2, 0.03),) * 4:
            depth, normal, _ = self.deepest()
            self.bench.move(1, r=self.bench.nodes[1].r + (depth - aim) * normal)

    def centre(self, body: int) -> np.ndarray:
        """World position of the centre of the shape."""
        b = self.bench.nodes[body]
        offset = ([0.05, 0, 0.1], [0, -0.1, 0])[body - 1]
        return b.r + b.A.reshape(3, 3) @ (np.array([0.1, 0, 0.05]) - offset)


@pytest.fixture(params=PAIRS)
def pair(request: pytest.FixtureRequest, tmp_path: Path) -> Pair:
    return Pair(tmp_path, request.param)


BOUNDED = [word for word in PAIRS if hasattr(import_module(f"{narrow.__name__}.{word}"), "bound")]


@pytest.mark.parametrize("word", BOUNDED)
def test_no_depth_exceeds_its_bound(word: str, tmp_path: Path) -> None:
    """What is skipped is apart: a bound below a depth would hide a touch."""
    pair = Pair(tmp_path, word)
    group = pair.group
    a, b = as_rows(group.elements_a), as_rows(group.elements_b)
    apart = 0
    for seed in range(30):
        pair.approach(seed)
        bound = group.narrow.bound(a[0], b[0], pair.bench.nodes, group.data)
        depth = pair.deepest()[0]
        # with its round-off: a pair that touches by it and is skipped never touches
        assert bound >= depth
        apart += bound < 0.0
    assert apart > 5


def test_the_rotation_of_the_cards_is_that_of_the_reach() -> None:
    q = exponential(np.full(3, np.deg2rad(60.0) / np.sqrt(3.0)))
    np.testing.assert_allclose(rotated(q, np.eye(3)).T, AXES, atol=1e-15)


def rotated(q: np.ndarray, points: np.ndarray) -> np.ndarray:
    from crashsolve.foundation.orientation import matrix

    return points @ matrix(q).T


@pytest.mark.parametrize("seed", range(6))
def test_depth_is_the_largest_separation_of_all_directions(pair: Pair, seed: int) -> None:
    """Apart: the distance; overlapping: the shortest exit. By brute force over directions."""
    pair.approach(seed)
    depth, _, _ = pair.deepest()
    first, second = pair.shapes
    if second == "plane":
        n = pair.bench.nodes[2].A.reshape(3, 3) @ np.array([1.0, 2.0, 2.0]) / 3.0
        largest = -separation(pair, n[None], plane=True)[0]
    else:
        largest = -search(lambda n: separation(pair, n), seed)
    # the search ends within 1e-6; edges are rounded inwards, by at most four roundings a body
    rounded = {"cylinder", "box"} & set(pair.shapes) and not {"sphere", "mesh"} & set(pair.shapes)
    allowed = 8 * ROUNDING * LEAST if rounded and pair.shapes != ["box", "plane"] else 0.0
    assert largest - allowed - 2e-6 <= depth <= largest + 2e-6


def separation(pair: Pair, n: np.ndarray, plane: bool = False) -> np.ndarray:
    """Gap between the two shapes seen along unit vectors n (k, 3), from b to a."""
    A, B = (pair.bench.nodes[k].A.reshape(3, 3) for k in (1, 2))
    gap = n @ (pair.centre(1) - pair.centre(2)) - REACH[pair.shapes[0]](-n @ A)
    return gap if plane else gap - REACH[pair.shapes[1]](n @ B)


def search(value: Callable[[np.ndarray], np.ndarray], seed: int) -> float:
    """Largest value over all directions: an even net, then ever closer random ones."""
    rng, k = np.random.default_rng(seed), np.arange(20000) + 0.5
    height, angle = 1 - k / 10000, np.pi * (1 + np.sqrt(5)) * k
    flat = np.sqrt(1 - height**2)
    n = np.stack([flat * np.cos(angle), flat * np.sin(angle), height], axis=1)
    best, width = n[value(n).argmax()], 0.03
    while width > 1e-9:
        n = np.vstack([best, best + width * rng.normal(size=(200, 3))])
        n /= np.linalg.norm(n, axis=1)[:, None]
        at = int(value(n).argmax())
        best, width = n[at], width * (0.7 if at == 0 else 1.0)
    return float(value(best[None])[0])


@pytest.mark.parametrize("seed", range(6))
def test_depth_changes_as_the_material_points_move(pair: Pair, seed: int) -> None:
    """d(depth)/dt = -(v_a - v_b).n at the point of contact: else contact would make energy."""
    pair.approach(seed)
    nodes, start = pair.bench.nodes, pair.bench.state()
    before = pair.gaps()
    depths = []
    for time in (-1e-6, 1e-6):
        nodes[:] = start
        for body in (1, 2):
            b = start[body]
            pair.bench.rotation(body, time * b.w)
            pair.bench.move(body, r=b.r + time * b.v)
        depths.append([depth for depth, _, _ in pair.gaps()])
    nodes[:] = start
    for k, (_, n, x) in enumerate(before):
        speed = [nodes[i].v + np.cross(nodes[i].w, x - nodes[i].r) for i in (1, 2)]
        rate = (depths[1][k] - depths[0][k]) / 2e-6
        # central difference: round-off 1e-16/1e-6, and the square of 1e-6 times the curvature of
        # a rounding, 1e3 times that of the body
        assert rate == pytest.approx(-(speed[0] - speed[1]) @ n, abs=1e-6)
        assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_common_motion_of_both_bodies_has_no_effect(pair: Pair, seed: int) -> None:
    pair.approach(seed)
    before = pair.gaps()
    rotation, direction = np.array([0.3, -1.1, 0.7]), np.array([5.0, -3.0, 2.0])
    q = exponential(rotation)
    for body in (1, 2):
        b = pair.bench.nodes[body]
        pair.bench.move(body, r=rotated(q, b.r) + direction, q=product(q, b.q))
    for (depth, n, x), (depth_after, n_after, x_after) in zip(before, pair.gaps(), strict=True):
        # round-off of numbers of size 5, a thousand times that in directions at rounded edges
        assert depth_after == pytest.approx(depth, abs=1e-13)
        np.testing.assert_allclose(n_after, rotated(q, n), atol=1e-11)
        np.testing.assert_allclose(x_after, rotated(q, x) + direction, atol=1e-9)


@pytest.mark.parametrize("word", PAIRS)
def test_the_sides_of_the_card_do_not_matter(tmp_path: Path, word: str) -> None:
    straight, crossed = Pair(tmp_path, word), Pair(tmp_path, word, rotated=True)
    straight.approach(1)
    crossed.bench.nodes[:] = straight.bench.nodes
    a, b = straight.deepest(), crossed.deepest()
    # force on side a of the card: along n when the gap's first shape is on that side
    assert b[0] == pytest.approx(a[0], abs=1e-13)
    flipped = -float(crossed.p.order) * b[1]
    np.testing.assert_allclose(flipped, float(straight.p.order) * a[1], atol=1e-8)


def test_points_inside_a_box_leave_by_the_nearest_face(tmp_path: Path) -> None:
    pair = Pair(tmp_path, "sphere_box")
    for centre, depth, n in (
        ((0.28, 0, 0), 0.27, (1, 0, 0)),
        ((0, -0.15, 0.1), 0.30, (0, -1, 0)),
        ((0.1, 0.05, -0.24), 0.26, (0, 0, -1)),
    ):
        exit_of_ball = from_inside(pair, centre)
        assert exit_of_ball[0] == pytest.approx(depth, abs=1e-14)
        np.testing.assert_allclose(exit_of_ball[1], AXES @ n, atol=1e-14)


def test_points_inside_an_ellipsoid_leave_by_the_nearest_point(tmp_path: Path) -> None:
    pair = Pair(tmp_path, "sphere_ellipsoid")
    # from the centre by the shortest axis; on the long axis up to (a^2 - b^2)/a sideways
    for centre, depth in (((0, 0, 0), 0.2), ((0.39, 0, 0), 0.01), ((0, 0.19, 0), 0.01)):
        exit_of_ball = from_inside(pair, centre)
        assert exit_of_ball[0] == pytest.approx(0.25 + depth, abs=1e-13)
        assert np.linalg.norm(exit_of_ball[1]) == pytest.approx(1.0, abs=1e-14)


def from_inside(pair: Pair, centre: ArrayLike) -> tuple[float, np.ndarray, np.ndarray]:
    """Gap with the sphere's centre at a point of the other shape; normal in axes of body b."""
    nodes = pair.bench.nodes
    pair.bench.move(1, r=np.zeros(3), q=np.array([1.0, 0, 0, 0]))
    pair.bench.move(2, r=np.zeros(3), q=np.array([1.0, 0, 0, 0]))
    nodes[1].r = pair.centre(2) + AXES @ np.array(centre) - pair.centre(1)
    return pair.deepest()


def test_two_spheres_in_one_position_still_have_a_normal(tmp_path: Path) -> None:
    pair = Pair(tmp_path, "sphere_sphere")
    depth, n, _ = from_inside(pair, (0, 0, 0))
    assert depth == pytest.approx(0.5, abs=1e-15)
    assert np.linalg.norm(n) == 1.0
