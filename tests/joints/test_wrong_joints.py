"""Joints that cannot be meant are refused, with the reason."""

from pathlib import Path

import pytest
from bench import Bench

from crashsolve.foundation.errors import DeckErrors

GOOD = """
curves:
  wave: {type: formula, expression: 0.2 + 0.1*sin(x), from: 0, to: 1}
  late: {type: formula, expression: x, from: 0.5, to: 1}
joints:
  hinge: {type: revolute, a: a, b: b, at: [0, 0, 0], axis: [0, 0, 1]}
  rail: {type: prismatic, b: a, at: [0, 0, 0], axis: [0, 0, 1]}
  ball: {type: spherical, a: a, b: b, at: [0, 0, 0]}
"""
WRONG = {
    "b: joins 'a' with itself; a and b must differ": ("{type: weld, a: a, b: a, at: [0, 0, 0]}"),
    "frame: unknown body 'arm'": "{type: weld, b: a, at: [0, 0, 0], frame: arm}",
    "axis: a direction needs a length; give for instance [0, 0, 1]": (
        "{type: planar, b: a, at: [0, 0, 0], axis: [0, 0, 0]}"
    ),
    "second_axis: must be at right angles to axis; their cosine is 0.707": (
        "{type: universal, b: a, at: [0, 0, 0], axis: [0, 0, 1], second_axis: [0, 1, 1]}"
    ),
    "length: is 2 m, but the points are 0.916515138991 m": (
        "{type: distance, a: a, b: b, at_a: [0, 0, 0], at_b: [0, 0, 0], length: 2}"
    ),
    "at_b: the two points coincide; use a spherical joint": (
        "{type: distance, b: a, at_a: [0.1, 0.2, -0.1], at_b: [0, 0, 0]}"
    ),
    "joint: 'ball' is of type spherical and has no angle; name one of type": (
        "{type: rotation_driver, joint: ball, curve: wave}"
    ),
    "joint: 'hinge' is of type revolute and has no travel; name one of type": (
        "{type: translation_driver, joint: hinge, curve: wave}"
    ),
    "curve: is 0.2 at the start, where the coordinate is 0;": (
        "{type: rotation_driver, joint: hinge, curve: wave, relative: false}"
    ),
    "curve: 'late' reaches from 0.5 to 1 s; the run starts at 0 s": (
        "{type: translation_driver, joint: rail, curve: late}"
    ),
    "curve: is 0.2 at the start, where the coordinate is 0.1;": (
        "{type: point_driver, body: a, axis: [1, 0, 0], curve: wave, relative: false}"
    ),
    "body: the ground cannot be moved; name another body": (
        "{type: point_driver, body: ground, axis: [1, 0, 0], curve: wave}"
    ),
    "second: couples a joint with itself; name another": (
        "{type: gear, first: hinge, second: hinge, ratio: 2}"
    ),
    "ratio: must not be 0": "{type: gear, first: hinge, second: hinge2, ratio: 0}",
    "second: 'rail' is of type prismatic and has no angle; name one of type": (
        "{type: gear, first: hinge, second: rail, ratio: 2}"
    ),
    "pinion: 'rail' is of type prismatic and has no angle; name one of type": (
        "{type: rack, pinion: rail, rack: rail, radius: 1}"
    ),
    "radius: must not be 0": "{type: rack, pinion: hinge, rack: rail, radius: 0}",
}


@pytest.mark.parametrize("message", WRONG)
def test_a_wrong_joint_is_refused(tmp_path: Path, message: str) -> None:
    other = "  hinge2: {type: revolute, b: b, at: [0, 0, 0], axis: [0, 0, 1]}\n"
    with pytest.raises(DeckErrors) as caught:
        Bench(tmp_path, f"{GOOD}{other}  wrong: {WRONG[message]}\n")
    assert message in str(caught.value)


def test_a_joint_that_cannot_be_built_is_not_explained_twice(tmp_path: Path) -> None:
    broken = "  broken: {type: revolute, a: b, b: b, at: [0, 0, 0], axis: [0, 0, 1]}\n"
    with pytest.raises(DeckErrors) as caught:
        Bench(
            tmp_path,
            f"{GOOD}{broken}  motor: {{type: rotation_driver, joint: broken, curve: wave}}\n",
        )
    assert str(caught.value).count("joins 'b' with itself") == 1
    assert "joint 'motor': joint: 'broken' cannot be built" in str(caught.value)
