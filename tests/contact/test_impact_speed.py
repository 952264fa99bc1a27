"""The impact speed of laws of restitution where a touch begins compressed, or others drive it."""

import json
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick
from small_runs import last
from touching import Contact, pressed_apart

from crashpost.results.result import Result
from crashsolve.contact.normal._restitution import damping_factor, returned
from crashsolve.model.nodes import NODE
from crashsolve.system.contact.initial_penetration import Touch, _masses

LAWS = (
    "lankarani_nikravesh",
    "hunt_crossley",
    "herbert_mcwhannell",
    "lee_wang",
    "gonthier",
    "flores",
    "hu_guo",
    "zhiying_qishao",
    "exact_restitution",
)
K, N, MASS = 1e6, 1.5, 1.0
FLOORED = "loaded below their speed_floor"


def law(folder: Path, name: str, e: float = 0.5) -> Contact:
    """A contact whose floor is out of the way."""
    contact = Contact(folder, f"{{type: {name}, stiffness: {K}, restitution: {e}}}")
    contact.p.speed_floor = 1e-9
    return contact


def work(chi: float, s: float) -> float:
    """Integral of u / (1 + chi u) from s to 1, by Gauss's rule: accurate to round-off here."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    u = 0.5 * (1 + s) + 0.5 * (1 - s) * nodes
    return float(0.5 * (1 - s) * (weights * u / (1 + chi * u)).sum())


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("e", (0.3, 0.9))
def test_every_state_of_a_free_impact_has_its_impact_speed(
    tmp_path: Path, name: str, e: float
) -> None:
    """A run that begins in the middle of an impact goes on as that impact does."""
    contact, v = law(tmp_path, name, e), 3.0
    chi = float(contact.p.chi)
    for s in (0.999, 0.5, 0.1, 0.0, -0.4 * returned(chi), -0.95 * returned(chi)):
        depth = ((N + 1) * MASS * v * v / K * work(chi, s)) ** (1 / (N + 1))
        contact.press(depth, s * v, mass=MASS)
        # round-off of differences of numbers of size one, over shares of a twentieth
        assert contact.new.damping_speed == pytest.approx(v, rel=1e-11)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("depth", (0.05, 0.15))
def test_an_initial_penetration_rebounds_as_the_impact_of_that_depth(
    tmp_path: Path, name: str, depth: float
) -> None:
    contact = law(tmp_path, name)
    chi, x = float(contact.p.chi), float(contact.p.returned)
    # (E2) and (E1) of theory/contact.md
    v = sqrt(K * depth ** (N + 1) / ((N + 1) * MASS * (1 / chi - np.log1p(chi) / chi**2)))
    speed = pressed_apart(contact, depth, 0.0, 2e-6, MASS)[0]
    # some 2000 steps of a method of order 2
    assert speed == pytest.approx(x * v, rel=1e-4)


@pytest.mark.parametrize("e", (0.2, 0.5, 0.9))
def test_slow_pressing_and_release_rebounds_alike_at_any_speed(tmp_path: Path, e: float) -> None:
    """It opens as fast as no free impact of the pressing speed does: 1 - chi x of the energy."""
    for slow in (1e-3, 1e-6):
        contact, depth = law(tmp_path, "exact_restitution", e), 0.05
        contact.press(1e-12, slow, mass=MASS)
        contact.accept()
        contact.press(depth, 0.0, h=1.0, mass=MASS)
        contact.accept()
        speed = pressed_apart(contact, depth, 0.0, 2e-6, MASS)[0]
        energy = K * depth ** (N + 1) / (N + 1)
        expected = sqrt(2 * energy * (1 - damping_factor(e) * e) / MASS)
        # the pressing speed is a thousandth of the other, or less
        assert speed == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("name", LAWS)
def test_results_are_continuous_as_a_gap_goes_to_zero(tmp_path: Path, name: str) -> None:
    """A ball strikes a ball that is a gap away from a wall: speeds of both in the end."""
    gaps = (1e-3, 1e-5, 1e-7, 1e-9, 0.0)
    speeds_of_gaps = [chain(tmp_path, name, gap) for gap in gaps]
    limit = speeds_of_gaps[-1]
    assert limit[0] > 0.0 and limit[1] > 0.0
    for gap, speeds in zip(gaps, speeds_of_gaps, strict=True):
        # the blow goes 6 mm deep: a gap counts by its share of that, 1/6e-3 per metre
        assert speeds == pytest.approx(limit, abs=200.0 * gap + 1e-9)


def chain(folder: Path, name: str, gap: float) -> list[float]:
    """Speeds away from the wall of both balls, after the first came at 1 m/s."""
    pair, wall, h = law(folder, name), law(folder, name), 1e-4
    # how far the first is into the second, and the second into the wall
    y = np.array([0.0, -gap])
    v = np.array([1.0, 0.0])
    pair.p.speed_floor = wall.p.speed_floor = 1e-3

    def forces(h: float) -> np.ndarray:
        f = []
        # closing speeds predicted by the forces of the step before
        a = push @ before / MASS
        for k, (contact, depth, mass) in enumerate(((pair, y[0], 0.5), (wall, y[1], 1.0))):
            u = v + 0.5 * h * a
            rate = (u[0] - u[1], u[1])[k]
            if depth > 0.0:
                f.append(contact.press(float(depth), float(rate), max(h, 1e-30), mass).force)
            else:
                contact.release(contact.group.normal)
                f.append(0.0)
        return np.array(f)

    push, before = np.array([[-1.0, 0.0], [1.0, -1.0]]), np.zeros(2)
    for _ in range(600):
        v = v + 0.5 * h * push @ before / MASS
        y = y + h * np.array([v[0] - v[1], v[1]])
        now = forces(h)
        v = v + 0.5 * h * push @ now / MASS
        before = now
        for contact in (pair, wall):
            contact.accept()
        if max(y) < 0.0 and v[1] < 0.0 and v[0] < v[1]:
            break
    return [-float(v[0]), -float(v[1])]


SLOW = """
title: a ball with restitution 0.2 comes slowly
control: {{end_time: 0.1, integrator: {method}, estimate: "off"}}
bodies:
  a:
    primitive: {{shape: sphere, radius: 0.1}}
    mass: 1
    position: [0, 0, {top:.9f}]
    velocity: [0, 0, {speed:.1e}]
surfaces: {{a: {{type: sphere, body: a, radius: 0.1}}, f: {{type: plane}}}}
contacts:
  c: {{a: [a], b: [f], {floor}
    normal: {{type: exact_restitution, stiffness: 1.0e+9, restitution: 0.2}}}}
"""


@pytest.mark.parametrize(
    ("speed", "floor", "method"),
    first_quick(
        [
            (1e-4, 1e-3, "rattle"),
            (3e-4, 1e-3, "dormand_prince_5"),
            (2e-3, 1e-3, "rattle"),
            (1e-5, None, "rattle"),
            (1e-6, 1.0, "generalized_alpha"),
        ],
        2,
    ),
)
def test_a_free_impact_below_the_speed_floor_has_the_stated_restitution(
    speed: float, floor: float | None, method: str, tmp_path: Path
) -> None:
    deck, words = tmp_path / "deck.yaml", f"speed_floor: {floor:.1e}," if floor else ""
    top = 0.1 + 1e-2 * speed
    deck.write_text(SLOW.format(top=top, speed=-speed, floor=words, method=method), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    assert FLOORED not in done.stdout
    # steps of the default length err by less than 1e-3
    back = last(Result(tmp_path / "out"), "rbdout.a.velocity.z") / speed
    assert back == pytest.approx(0.2, abs=1e-3)


PRESSED = """
title: a ball is pressed on slowly by a driver
control: {end_time: 1, estimate: "off"}
curves: {v: {points: [[0, 1.0e-5], [1, 1.0e-5]]}}
bodies:
  a:
    primitive: {shape: sphere, radius: 0.1}
    mass: 1
    position: [0, 0, 0.1]
    velocity: [0, 0, -1.0e-5]
surfaces: {a: {type: sphere, body: a, radius: 0.1}, f: {type: plane}}
joints: {j: {type: point_driver, body: a, at: [0, 0, 0.1], axis: [0, 0, -1], velocity: v}}
contacts:
  c: {a: [a], b: [f], normal: {type: exact_restitution, stiffness: 1.0e+9, restitution: 0.2}}
"""


@pytest.mark.long
def test_what_is_pressed_on_below_the_floor_is_at_rest_and_named(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(PRESSED, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    assert FLOORED in done.stdout
    status = json.loads((tmp_path / "out/status.json").read_text("utf-8"))
    assert status["below_floor"] == ["c"]
    # K delta^1.5 (1 + chi delta_dot / v_0), v_0 at the floor of 1 mm/s; round-off of the position
    force = 1e9 * 1e-5**1.5 * (1.0 + damping_factor(0.2) * 1e-2)
    assert last(Result(tmp_path / "out"), "rcforc.c.force.z") == pytest.approx(force, rel=1e-6)


WELDED = """
title: a light ball on a heavy one comes slowly
control: {{end_time: 0.1, estimate: "off"}}
bodies:
  a: {{primitive: {{shape: sphere, radius: 0.1}}, mass: 1, position: [0, 0, 0.1000001], {v}}}
  b: {{primitive: {{shape: sphere, radius: 0.1}}, mass: 9, position: [0, 0, 0.4], {v}}}
surfaces: {{a: {{type: sphere, body: a, radius: 0.1}}, f: {{type: plane}}}}
joints: {{w: {{type: weld, a: b, b: a, at: [0, 0, 0.2]}}}}
contacts:
  c: {{a: [a], b: [f], normal: {{type: exact_restitution, stiffness: 1.0e+9, restitution: 0.2}}}}
"""


@pytest.mark.long
def test_bodies_within_joints_have_the_floor_of_a_slow_model(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(WELDED.format(v="velocity: [0, 0, -5.0e-4]"), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    assert FLOORED not in done.stdout
    back = last(Result(tmp_path / "out"), "rbdout.a.velocity.z") / 5e-4
    # steps of the default length err by less than 1e-3
    assert back == pytest.approx(0.2, abs=1e-3)


def test_depths_without_any_force_come_with_the_mass_of_others(tmp_path: Path) -> None:
    """1e-300 m to the power of 1.5 is zero: as deep as nothing, but a touch."""
    nodes = np.zeros(2, NODE.dtype)
    nodes["mass_inv"] = [1.0, 0.5]
    group = law(tmp_path, "exact_restitution").group
    arms = np.zeros(3), np.zeros(3)
    masses = [
        _masses(nodes, [Touch(group, 0, (1, 2), depth, 0.0, 1.0, np.eye(3)[2], arms)])
        for depth in (1e-300, 1e-3)
    ]
    assert masses[0] == pytest.approx(masses[1], rel=1e-14)


@pytest.mark.parametrize("depth", [0.004, 0.02])
def test_the_force_of_a_touch_at_the_start_is_that_of_its_law(depth: float, tmp_path: Path) -> None:
    """Also of a layer on a core, which adds to it beyond 10 mm."""
    words = "{type: layered, stiffness: 1e6, layer: 0.01, core_stiffness: 1e7, restitution: 0.2}"
    group, zero = Contact(tmp_path, words).group, np.zeros(3)
    touch = Touch(group, 0, (1, 2), depth, -1.0, 1.0, zero, (zero, zero))
    core = 1e7 * max(depth - 0.01, 0.0) ** 1.5
    assert touch.spring == pytest.approx(1e6 * depth**1.5 + core, rel=1e-14)
