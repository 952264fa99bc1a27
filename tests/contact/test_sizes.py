"""Claim: a plane and a box of any size beneath are the same ground, wherever a body falls on it."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from bench import exponential
from quick import first_quick
from touching import Contact

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.recording.engines import engine_of

# as their cards say it: a body of 0.2 x 0.1 x 0.1 m, or 0.1 m across and high
SHAPES = {
    "box": "type: box, size: [0.2, 0.1, 0.1]",
    "cap": "type: cylinder, radius: 0.05, length: 0.1",
    "lying": "type: cylinder, radius: 0.05, length: 0.2, axis: [1, 0, 0]",
    "ellipsoid": "type: ellipsoid, semi_axes: [0.1, 0.05, 0.05]",
}
DECK = """
control: {{end_time: {end}, integrator: rattle, estimate: "off"}}
bodies:
  p: {{mass: 2, primitive: {{shape: box, size: [0.2, 0.1, 0.1]}}, position: [{x!r}, 0, 0.07]}}
surfaces:
  ground: {{{ground}}}
  p: {{{shape}, body: p}}
contacts:
  c:
    a: [p]
    b: [ground]
    normal: {{type: kelvin_voigt, stiffness: 1e6, damping: 2e3}}
    friction: {{type: bristle, stiffness: 1e6, static: 1, dynamic: 1}}
loads: {{weight: {{type: gravity}}}}
"""
END, LOOKS = 0.3, 30
# width and thickness of the ground [m]: cubes, plates, sheets
GROUNDS = [
    (0.5, 0.5),
    *(pytest.param(*ground, marks=pytest.mark.long) for ground in ((0.5, 0.02), (1.0, 0.5))),
    (40.0, 20.0),
    *(pytest.param(*ground, marks=pytest.mark.long) for ground in ((10.0, 1.0), (1000.0, 500.0))),
]


@cache
def fall(shape: str, ground: str, x: float) -> tuple[float, float, np.ndarray]:
    """First touch [s], largest spin [rad/s], where the body comes to lie from x [m] (3,)."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "deck.yaml"
        path.write_text(DECK.format(end=END, shape=SHAPES[shape], ground=ground, x=x))
        deck = read_deck(path)
    model, state = build(deck)
    engine, spin = engine_of(deck, model, state), 0.0
    engine.start()
    for k in range(1, LOOKS + 1):
        engine.reach(END * k / LOOKS)
        spin = max(spin, float(np.linalg.norm(state.nodes["w"][1])))
    card = state.card_history[int(engine.clock["current"]), 0]
    return float(card["first_touch"]), spin, state.nodes["r"][1] - (x, 0.0, 0.0)


@pytest.mark.parametrize("offset", first_quick([0.1, 0.7]))
@pytest.mark.parametrize(("width", "thick"), GROUNDS)
@pytest.mark.parametrize("shape", first_quick(SHAPES))
def test_a_box_of_any_size_is_a_plane(
    shape: str, width: float, thick: float, offset: float
) -> None:
    # `offset` in half widths, less the half length of the body
    x = offset * (0.5 * width - 0.1)
    ground = f"type: box, at: [0, 0, {-0.5 * thick}], size: [{width}, {width}, {thick}]"
    touch, spin, position = fall(shape, ground, x)
    expected, none, where = fall(shape, "type: plane", 0.0)
    assert none < 1e-12
    # what a face is lower off its middle: its rounding e times 1 - sqrt(1 - r^2), r = 0.7; e is
    # 1e-5 of the least semi-axis of 5 cm beside ellipsoids, and 1e-9 of the enclosing sphere; else
    # 1e-9 of the half width or less than 1e-3 of 5 cm by (0.1 / half width)^4
    share = 5e-7 if shape == "ellipsoid" else 5e-5 * (0.2 / width) ** 4
    edge = 1e-9 * width + share
    lower = edge * (1.0 - np.sqrt(1.0 - offset**2))
    # it falls at 0.63 m/s
    assert touch == pytest.approx(expected, abs=2.0 * lower / 0.6 + 1e-9)
    # the face tilts by e r / half width; a body of rounding d and half length s is off its centre
    # of pressure by s^2 / d of it, of an ellipsoid s: up to a mm of these turns it by 0.4 mrad/s
    assert spin < 4e-4
    assert position == pytest.approx(where, abs=2.0 * lower + 1e-6)


@pytest.mark.parametrize("thick", [0.1, 1.0])
@pytest.mark.parametrize("beyond", [-1e-3, 1e-3])
def test_a_mass_centre_a_millimetre_within_the_edge_stays(beyond: float, thick: float) -> None:
    ground = f"type: box, at: [-0.5, 0, {-0.5 * thick}], size: [1, 1, {thick}]"
    _, spin, _ = fall("box", ground, beyond)
    # 1 mm beyond, m g 1 mm over the inertia about the edge, 0.0083 kg m^2 + m (0.05 m)^2, makes
    # 1.4 rad/s^2; within, what is left is the impact on a lever of a millimetre and less
    assert (spin < 0.15) == (beyond < 0.0), spin


EDGE = """
surfaces:
  one: {{type: ellipsoid, body: a, semi_axes: [0.1, 0.06, 0.04]}}
  other: {{type: box, body: b, size: [{s}, {s}, {s}], at: [{h}, {h}, {h}]}}
"""
AT_REST = """
title: bench
control: {end_time: 1}
bodies:
  a: {mass: 2, inertia: [0.5, 0.6, 0.4]}
  b: {mass: 3, inertia: [0.7, 0.5, 0.9]}
"""


@pytest.mark.parametrize("width", [40.0, 1000.0])
def test_edges_are_as_sharp_of_any_box(width: float, tmp_path: Path) -> None:
    near, wide = (
        Contact(tmp_path, surfaces=EDGE.format(s=size, h=-0.5 * size), bodies=AT_REST)
        for size in (1.0, width)
    )
    rng = np.random.default_rng(3)
    for _ in range(60):
        r, q = rng.uniform(-0.12, 0.12, 3), exponential(2.0 * rng.normal(size=3))
        for contact in (near, wide):
            contact.bench.move(1, r=r, q=q)
        depth = near.deepest()[0]
        # deeper there are several exits of equal length
        if -0.05 < depth < 0.02:
            # a corner of three edges is off by less than four roundings, 1e-5 of 4 cm or 1e-9
            assert wide.deepest()[0] == pytest.approx(depth, abs=4.0 * (4e-7 + 1e-9 * width))
