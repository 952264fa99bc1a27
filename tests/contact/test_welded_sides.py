"""A contact on a body that welds fix to others meets the inertia of all of them."""

from pathlib import Path

import pytest
from command import crashsolve
from small_runs import last

from crashpost.results.result import Result

LAWS = (
    "{type: exact_restitution, stiffness: 1.2e+8, restitution: 0.15}",
    "{type: kelvin_voigt, stiffness: 5.0e+6, restitution: 0.3}",
)
# a light tip on a heavy body; two pads, of which one strikes off the middle
DECK = """
title: A light tip on a heavy body strikes a wall
control: {{end_time: 0.03, estimate: "off", step: 1.0e-5}}
output: {{history: {{interval: 1.0e-4}}}}
bodies:
  car: {{mass: 980, inertia: [300, 1000, 900], velocity: [13.4, 0, 0]}}
  tip:
    {part_of}
    mass: 1.8
    inertia: [0.01, 0.02, 0.03]
    position: [1, 0.2, 0]
    velocity: [13.4, 0, 0]
{joints}
surfaces:
  low: {{type: sphere, body: {tip}, at: {low}, radius: 0.025}}
  high: {{type: sphere, body: {tip}, at: {high}, radius: 0.025}}
  wall: {{type: plane, at: [1.05, 0, 0], normal: [-1, 0.1, 0]}}
contacts:
  blow:
    a: [low, high]
    b: [wall]
    normal: {normal}
    friction: {{type: coulomb, friction_coefficient: 0.3, none_below: 0.01, full_above: 0.1}}
"""
WELDED = {
    "part_of": "",
    "joints": "joints: {held: {type: weld, a: car, b: tip, at: [1, 0.2, 0]}}",
    "tip": "tip",
    "low": [0, 0.1, -0.1],
    "high": [0, 0.1, 0.1],
}
WHOLE = {
    "part_of": "part_of: car",
    "joints": "",
    "tip": "car",
    "low": [1, 0.3, -0.1],
    "high": [1, 0.3, 0.1],
}


@pytest.mark.parametrize("normal", LAWS)
def test_a_welded_tip_strikes_as_the_whole(normal: str, tmp_path: Path) -> None:
    results = []
    for words in (WELDED, WHOLE):
        deck = tmp_path / f"{words['tip']}.yaml"
        deck.write_text(DECK.format(normal=normal, **words), "utf-8")
        done = crashsolve(deck, "-o", tmp_path / words["tip"])
        assert done.returncode == 0, done.stdout + done.stderr
        results.append(Result(tmp_path / words["tip"]))
    welded, whole = results
    for channel in (
        "rbdout.car.angular_velocity.z",
        "rcforc.blow.peak_normal",
        "glstat.model.energy.contact_dissipated",
        "glstat.model.energy.friction_dissipated",
    ):
        # one step of a body and that of two differ by the error of the step: by 1e-5 at most here
        assert last(welded, channel) == pytest.approx(last(whole, channel), rel=1e-4), channel


# a surface of the tip, rotated by a quarter turn, and the same of the car: x of the tip is y
# of the car, its y is -x
TURNED = """
title: A tip that is part of a car strikes a wall
control: {{end_time: 5.0e-3, estimate: "off", step: 1.0e-5}}
output: {{history: {{interval: 1.0e-4}}}}
bodies:
  car: {{mass: 980, inertia: [300, 1000, 900], position: [-1, 0, 0], velocity: [13.4, 0, 0]}}
  tip:
    part_of: car
    mass: 1.8
    inertia: [0.01, 0.02, 0.03]
    mass_centre: [0.05, 0.01, 0]
    position: [0, 0.2, 0]
    rotation: {{axis: [0, 0, 1], angle: 90 deg}}
    velocity: [13.4, 0, 0]
surfaces:
  nose: {{{nose}}}
  wall: {{{wall}}}
contacts: {{blow: {{a: [nose], b: [wall], normal: {{type: penalty, stiffness: 1.0e+6}}}}}}
"""
PLANE = "type: plane, at: [0.06, 0, 0], normal: [-1, 0.1, 0.05]"
BALL = "type: sphere, at: [0.12, 0.3, -0.1], radius: 0.05"
SHAPES = {
    "sphere": (
        "type: sphere, body: tip, at: [0.1, 0, -0.1], radius: 0.05",
        "type: sphere, body: car, at: [1, 0.3, -0.1], radius: 0.05",
        PLANE,
    ),
    "box": (
        "type: box, body: tip, at: [0.1, 0, -0.1], size: [0.2, 0.1, 0.04]",
        "type: box, body: car, at: [1, 0.3, -0.1], size: [0.1, 0.2, 0.04]",
        PLANE,
    ),
    "cylinder": (
        "type: cylinder, body: tip, at: [0.1, 0, -0.1], axis: [1, 0, 0], radius: 0.05, length: 0.2",
        "type: cylinder, body: car, at: [1, 0.3, -0.1], axis: [0, 1, 0], radius: 0.05, length: 0.2",
        PLANE,
    ),
    "ellipsoid": (
        "type: ellipsoid, body: tip, at: [0.1, 0, -0.1], semi_axes: [0.2, 0.05, 0.04]",
        "type: ellipsoid, body: car, at: [1, 0.3, -0.1], semi_axes: [0.05, 0.2, 0.04]",
        PLANE,
    ),
    "point_set": (
        "type: point_set, body: tip, points: [[0.1, -0.05, 0], [0.2, -0.05, 0.1]]",
        "type: point_set, body: car, points: [[1.05, 0.3, 0], [1.05, 0.4, 0.1]]",
        PLANE,
    ),
    "plane": (
        "type: plane, body: tip, at: [0, -0.05, 0], normal: [0.1, -1, 0]",
        "type: plane, body: car, at: [1.05, 0.2, 0], normal: [1, 0.1, 0]",
        BALL,
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_surface_may_be_given_on_a_part_of_a_body(shape: str, tmp_path: Path) -> None:
    *noses, wall = SHAPES[shape]
    results = []
    for k, nose in enumerate(noses):
        deck = tmp_path / f"{k}.yaml"
        deck.write_text(TURNED.format(nose=nose, wall=wall), "utf-8")
        done = crashsolve(deck, "-o", tmp_path / str(k))
        assert done.returncode == 0, done.stdout + done.stderr
        results.append(Result(tmp_path / str(k)))
    for channel in ("rbdout.car.angular_velocity.z", "rcforc.blow.peak_normal"):
        one, other = (last(result, channel) for result in results)
        # the frame of the tip goes through cosines of a quarter turn
        assert one == pytest.approx(other, rel=1e-10), channel
        assert one != 0.0
