"""Cylinders that stand all but upright: the lowest point of the rim is nearly any of it."""

from pathlib import Path

import numpy as np
import pytest
from bench import exponential
from command import crashsolve
from small_runs import last
from touching import Contact

from crashpost.results.result import Result

BASES = {
    "plane": "{type: plane, body: b}",
    "mesh": "{type: mesh, body: b, vertices: [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]],"
    " faces: [[0, 1, 2], [0, 2, 3]], thickness: 2}",
}
CYLINDER = """
surfaces:
  one: {{type: cylinder, body: a, radius: 0.3, length: 0.4}}
  other: {base}
"""
BODIES = """
title: bench
control: {end_time: 1}
bodies:
  a: {mass: 2, inertia: [0.5, 0.6, 0.4], position: [0.1, 0.2, 0.19]}
  b: {mass: 3, inertia: [0.7, 0.5, 0.9]}
"""


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("tilt", [0.0, 1e-7, 3e-6, 2e-5, 1e-4, 3e-3, 0.0099, 0.02])
def test_depths_change_as_the_material_points_move(base: str, tilt: float, tmp_path: Path) -> None:
    contact = Contact(tmp_path, surfaces=CYLINDER.format(base=BASES[base]), bodies=BODIES)
    rng = np.random.default_rng(7)
    r, v, w = np.array([0.1, 0.2, 0.19]), rng.normal(size=3), rng.normal(size=3)
    upright = tilt * np.array([0.6, 0.8, 0.0])
    depths = []
    for time in (-1e-8, 0.0, 1e-8):
        contact.bench.move(1, r=r + time * v, q=exponential(upright + time * w))
        depths.append(contact.gaps())
    # the last on a mesh is that of its edges, which are 9 m away
    for k, (_, n, x) in enumerate(depths[1][:7]):
        rate = (depths[2][k][0] - depths[0][k][0]) / 2e-8
        # round-off 1e-16 / 1e-8; a rotation of 1e-8 over the square of the lean, 1e-5
        assert rate == pytest.approx(-(v + np.cross(w, x - r)) @ n, abs=2e-6)


@pytest.mark.parametrize("base", BASES)
def test_an_elastic_impact_keeps_its_energy(base: str, tmp_path: Path) -> None:
    # as deep as the tilt is high: 1e-4 of the radius
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        f"""
title: an upright cylinder, tilted by next to nothing, falls on its cap
control: {{end_time: 1.0e-3, safety: 0.02, estimate: "off"}}
bodies:
  a:
    mass: 1
    primitive: {{shape: cylinder, radius: 0.3, length: 0.4}}
    position: [0, 0, 0.2001]
    rotation: {{axis: [3, 1, 0], angle: 2.0e-5}}
    velocity: [0.3, 0, -1]
surfaces:
  a: {{type: cylinder, body: a, radius: 0.3, length: 0.4}}
  f: {BASES[base].replace(", body: b", "")}
contacts:
  c:
    a: [a]
    b: [f]
    normal: {{type: hertz, stiffness: 1.0e+9, exponent: 1}}
    friction: {{type: bristle, stiffness: 1.0e+9, static: 0.4, dynamic: 0.4}}
"""
    )
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    result = Result(tmp_path / "out")
    kinetic = last(result, "glstat.model.energy.kinetic")
    lost = last(result, "glstat.model.energy.friction_dissipated")
    # second order: 600 steps in a contact
    assert kinetic + lost == pytest.approx(0.5 * 1.09, rel=1e-4)
    assert last(result, "rcforc.c.touches") > 0


def test_wide_caps_touch_when_they_meet(tmp_path: Path) -> None:
    # of a disc of 20 m the digits of the extent along its axis are those of 0.4 mm of rounding
    deck = tmp_path / "deck.yaml"
    deck.write_text("""
title: a wide cylinder comes down slowly on a wider one
control: {end_time: 1.2, safety: 0.05, estimate: "off"}
output: {history: {interval: 0.12}}
bodies:
  a:
    mass: 1.3e+5
    primitive: {shape: cylinder, radius: 2.791, length: 7.513}
    position: [0, 0, 3.75654]
    velocity: [0, 0, -0.0013]
surfaces:
  a: {type: cylinder, body: a, radius: 2.791, length: 7.513}
  f: {type: cylinder, at: [0, 0, -16.1], radius: 20.2, length: 32.2}
contacts: {c: {a: [a], b: [f], normal: {type: kelvin_voigt, stiffness: 4.0e+7, restitution: 0.3}}}
""")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    # second order: 8e-5 of the speed by steps half as long as the default
    assert last(Result(tmp_path / "out"), "rbdout.a.velocity.z") == pytest.approx(
        0.3 * 0.0013, abs=1e-4 * 0.0013
    )
