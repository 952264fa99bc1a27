"""Claims of contact over areas: one depth, even pressure, friction of a spin and what it takes."""

from math import asinh, cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from touching import Contact

from crashsolve.contact.narrow import _ascent, _convex, _edged, _rounded, box_box
from crashsolve.contact.shape import box, cylinder
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build
from crashsolve.system.contact import areas

SHAPES = {
    "box": "type: box, body: %s, size: [0.6, 0.4, 0.5]",
    "cap": "type: cylinder, body: %s, radius: 0.2, length: 0.5",
    "lying": "type: cylinder, body: %s, radius: 0.25, length: 0.6, axis: [1, 0, 0]",
    "large": "type: box, body: %s, size: [2, 2, 0.5]",
    "rod": "type: cylinder, body: %s, radius: 0.055, length: 0.26",
    "sheet": "type: box, body: %s, size: [2.1, 0.55, 0.12]",
}
# mean distance from its middle of an evenly pressed rectangle of half sides 0.3 and 0.2
DIAGONAL = sqrt(0.3**2 + 0.2**2)
RECTANGLE = DIAGONAL / 3 + 0.3**2 / (6 * 0.2) * asinh(0.2 / 0.3) + 0.2**2 / (6 * 0.3) * asinh(1.5)


def pair(folder: Path, first: str, second: str) -> Contact:
    """Two shapes, the first on the second and 1e-4 m in it."""
    cards = f"surfaces:\n  a: {{{SHAPES[first] % 'a'}}}\n  b: {{{SHAPES[second] % 'b'}}}\n"
    contact = Contact(folder, surfaces=cards, sides="a: [a], b: [b]")
    stack(contact, 0.0)
    return contact


def stack(contact: Contact, angle: float) -> None:
    """Centre over centre, the first turned about the vertical."""
    height = 0.4999
    for body, table in ((1, contact.group.elements_a), (2, contact.group.elements_b)):
        half = np.array([cos(angle / 2), 0.0, 0.0, sin(angle / 2)])
        contact.bench.move(body, q=half if body == 1 else np.array([1.0, 0, 0, 0]))
        b = contact.bench.nodes[body]
        centre = np.array([0.0, 0.0, height])
        contact.bench.move(body, r=centre - b.A.reshape(3, 3) @ table["point"][0])
        height = 0.0


def patch(contact: Contact) -> tuple[float, float, np.ndarray, np.ndarray, np.ndarray]:
    """Depth, radius, centre of pressure, points and shares of the first pair."""
    depth, n, x = contact.gaps()[0]
    tables = (contact.group.elements_a, contact.group.elements_b)
    a, b = (as_rows(table)[0] for table in tables)
    data = (as_rows(contact.group.data[0]),)
    count, radius = _edged.patch(a, b, contact.bench.nodes, data, tuple(n), tuple(x))
    spots = data[0][:count]
    return depth, float(radius), x, spots.point.copy(), spots.share.copy()


@pytest.mark.parametrize(
    ("first", "second", "radius"),
    [
        ("box", "large", RECTANGLE),
        ("box", "box", RECTANGLE),
        ("cap", "large", 0.2 * 2 / 3),
        ("cap", "cap", 0.2 * 2 / 3),
        ("lying", "large", 0.15),
        ("lying", "lying", 0.15),
    ],
)
def test_flat_sides_press_evenly(first: str, second: str, radius: float, tmp_path: Path) -> None:
    depth, patch_radius, x, points, shares = patch(pair(tmp_path, first, second))
    assert depth == pytest.approx(1e-4, abs=1e-12)
    # a line is as wide as its rounding, 2.5e-4, which adds the square of that over its length
    assert patch_radius == pytest.approx(radius, rel=1e-5)
    assert shares.sum() == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(shares @ points, x, atol=1e-12)
    assert 4 <= len(points) <= 8


def test_boxes_that_cross_have_a_patch_of_eight_corners(tmp_path: Path) -> None:
    contact = pair(tmp_path, "box", "box")
    counts, radii = [], []
    for angle in np.linspace(0.0, pi / 2, 60):
        stack(contact, float(angle))
        depth, radius, _, points, shares = patch(contact)
        assert depth == pytest.approx(1e-4, abs=1e-12)
        assert shares.sum() == pytest.approx(1.0, abs=1e-14)
        counts.append(len(points))
        radii.append(radius)
    assert max(counts) == 8
    # corners come and go without a jump: 0.3 m times the angle bounds the change of a step
    assert max(abs(np.diff(radii))) < 0.3 * pi / 2 / 59


@pytest.mark.parametrize("seed", range(4))
def test_the_gap_is_that_of_the_general_routine(seed: int, tmp_path: Path) -> None:
    """Axes by cosines, fewer starts and better ones find the tops that 22 starts find."""
    rng = np.random.default_rng(seed)
    for first, second in (("box", "box"), ("box", "large"), ("cap", "box")):
        contact = pair(tmp_path, first, second)
        for _ in range(4):
            contact.bench.shake(int(rng.integers(1e6)), rotation=2.0)
            depth, n, _ = contact.gaps()[0]
            direction = depth - rng.uniform(-0.1, 0.02)
            contact.bench.move(1, r=contact.bench.nodes[1].r + direction * n)
            known, _, _ = general(contact)
            depth, n, x = contact.gaps()[0]
            assert depth == pytest.approx(known, abs=1e-12)
            assert bound(contact) >= depth - 1e-15


def general(contact: Contact) -> Any:
    """Gap by the sums of ellipsoids that know nothing of boxes."""
    tables = []
    for table in (contact.group.elements_a, contact.group.elements_b):
        e = table[0]
        sizes = {
            "half": e["half"],
            "radius": e["half"][0],
            "half_length": e["half"][2],
            "edge": e["edge"],
        }
        shape = cylinder if e["is_round"] else box
        names = ("node", "point", "axes")
        row = _convex.expand([{name: e[name] for name in names} | sizes], shape)[0]
        made = np.zeros(1, _convex.PARAMETERS.dtype)
        for name, value in row.items():
            made[0][name] = value
        tables.append(as_rows(made)[0])
    return _convex.gap(*tables, contact.bench.nodes, ())


def bound(contact: Contact) -> float:
    a, b = as_rows(contact.group.elements_a), as_rows(contact.group.elements_b)
    return float(_edged.bound(a[0], b[0], contact.bench.nodes, ()))


@pytest.mark.parametrize("seed", range(2))
def test_a_rod_over_a_wide_sheet_is_as_deep_as_its_lowest_point(seed: int, tmp_path: Path) -> None:
    """Edges of the sheet are a billionth of its width: the search must cross their normals."""
    rng, contact = np.random.default_rng(seed), pair(tmp_path, "rod", "sheet")
    rod, sheet = contact.group.elements_a[0], contact.group.elements_b[0]
    contact.bench.move(2, q=np.array([1.0, 0, 0, 0]), r=-sheet["point"])
    for _ in range(25):
        q = rng.normal(size=4)
        contact.bench.move(1, q=q / np.linalg.norm(q))
        A = contact.bench.nodes[1].A.reshape(3, 3)
        axis = A @ rod["axes"].reshape(3, 3)[:, 2]
        reach = 0.13 * abs(axis[2]) + 0.055 * sqrt(1.0 - axis[2] ** 2)
        known = rng.uniform(-0.05, 0.05)
        # no nearer to an edge of the face than it is deep
        x, y = rng.uniform(-0.85, 0.85), rng.uniform(-0.08, 0.08)
        contact.bench.move(1, r=np.array([x, y, 0.06 + reach - known]) - A @ rod["point"])
        # by the rounding alone
        edges = rod["edge"] + sheet["edge"]
        assert contact.gaps()[0][0] == pytest.approx(known, abs=4.0 * edges)
        # wherever it starts a search ends on a maximum: another from there gains round-off alone
        for start in rng.normal(size=(4, 3)):
            first, n = maximum(contact, start / np.linalg.norm(start))
            second, _ = maximum(contact, np.array(n))
            assert second == pytest.approx(first, abs=1e-12)


def maximum(contact: Contact, n: np.ndarray) -> Any:
    """Separation [m] and direction that Newton's method reaches from direction n."""
    a, b = (as_rows(t)[0] for t in (contact.group.elements_a, contact.group.elements_b))
    nodes = contact.bench.nodes
    u, w = (_ascent.axes_of(shape, nodes[i]) for i, shape in ((1, a), (2, b)))
    centres = [nodes[i].r + nodes[i].A.reshape(3, 3) @ s.point for i, s in ((1, a), (2, b))]
    c = tuple(centres[0] - centres[1])
    return _ascent.find_maximum(_rounded, a, b, u, w, c, tuple(n), _edged.last_step(a, b))


def test_friction_of_slip_and_spin_dissipates_its_work() -> None:
    """Power of force and torque on both bodies is that of the three components."""
    rng, zero = np.random.default_rng(1), np.zeros
    a, b = (type("Body", (), {"w": rng.normal(size=3), "v": rng.normal(size=3)})() for _ in "ab")
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    velocity = a.v - b.v
    slip = velocity - (velocity @ n) * n
    sliding = areas.combined_slip(a, b, tuple(slip), tuple(n), 0.07)
    friction_force = -0.3 * np.array(sliding) / np.linalg.norm(sliding)
    force = np.array(areas.along_surface(tuple(friction_force), tuple(n)))
    for body in (a, b):
        body.torque, body.deferred_torque = zero(3), zero(3)
    areas.twist(a, b, tuple(friction_force), tuple(n), 0.07, 1.0)
    power = force @ velocity + a.torque @ a.w + b.torque @ b.w
    assert power == pytest.approx(friction_force @ sliding, rel=1e-14)
    np.testing.assert_allclose(a.torque, -b.torque)


def test_a_torsion_radius_without_friction_is_refused(tmp_path: Path) -> None:
    def deck(words: str) -> Any:
        path = tmp_path / "deck.yaml"
        path.write_text(
            "control: {end_time: 1}\nbodies:\n  ball: {mass: 1, inertia: [1, 1, 1]}\n"
            "surfaces:\n  ball: {type: sphere, body: ball, radius: 0.1}\n  floor: {type: plane}\n"
            "contacts:\n  touch: {a: [ball], b: [floor], torsion_radius: 0.01,\n"
            f"    normal: {{type: hertz, stiffness: 1e6}}{words}}}\n"
        )
        return build(read_deck(path))

    friction = (
        ", friction: {type: coulomb, friction_coefficient: 0.3, none_below: 0, full_above: 0.01}"
    )
    assert deck(friction)[0].contact_groups[0].resists_spin
    with pytest.raises(DeckErrors, match="needs a law of friction"):
        deck("")


def test_boxes_share_the_group_of_their_gap() -> None:
    assert box_box.gap is _edged.gap
