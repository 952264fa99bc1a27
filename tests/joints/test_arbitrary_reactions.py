"""Claims of redundant joints: the split of a force that the equations leave open is reported."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.results.result import Result
from crashsolve.channels.statistic import statistic

DOOR = """
title: A door turns on two supports and bears its weight on both, or on the upper one
control: {{end_time: 0.05}}
bodies:
  door: {{mass: 20, primitive: {{shape: box, size: [0.8, 0.04, 2]}}, position: [0.4, 0, 0],
          angular_velocity: [0, 0, 1], velocity: [0, 0.4, 0]}}
joints:
  upper: {{type: {upper}, b: door, at: [0, 0, 0.8]{axis}}}
  lower: {{type: {lower}, b: door, at: [0, 0, -0.8], axis: [0, 0, 1]}}
loads: {{weight: {{type: gravity}}}}
sensors: {{upper_force: {{type: section_force, joint: upper, axes: door}}}}
watch: [{{channel: {channel}, statistic: final}}]
"""
WORDS = "not determined"
AXIS = ", axis: [0, 0, 1]"


def run(folder: Path, channel: str, upper: str, lower: str, axis: str) -> tuple[str, Result]:
    deck = folder / "door.yaml"
    deck.write_text(DOOR.format(channel=channel, upper=upper, lower=lower, axis=axis), "utf-8")
    done = crashsolve(deck, "-o", folder / "results")
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr, Result(folder / "results")


def test_reactions_of_two_hinges_are_arbitrary(tmp_path: Path) -> None:
    said, result = run(tmp_path, "jntforc.upper.force.z", "revolute", "revolute", AXIS)
    assert WORDS in said
    assert "'upper', 'lower'" in said
    total = sum(
        statistic(result.series(f"jntforc.{j}.force.z"), "final") for j in ("upper", "lower")
    )
    # the sum is a result: m g
    assert abs(total) == pytest.approx(196.2, rel=1e-9)


def test_a_sensor_of_such_a_joint_is_doubted_too(tmp_path: Path) -> None:
    said, _ = run(tmp_path, "secforc.upper_force.force.z", "revolute", "revolute", AXIS)
    assert WORDS in said
    assert "reactions of 'upper' are" in said


def test_other_channels_of_the_same_door_are_not_doubted(tmp_path: Path) -> None:
    said, _ = run(tmp_path, "rbdout.door.angular_velocity.z", "revolute", "revolute", AXIS)
    assert WORDS not in said
    assert "share of a force is arbitrary" in said


@pytest.mark.long
def test_a_door_without_redundant_rows_is_not_doubted(tmp_path: Path) -> None:
    said, result = run(tmp_path, "jntforc.upper.force.z", "spherical", "point_on_line", "")
    assert WORDS not in said
    assert "arbitrary" not in said
    # the line lets the door slide: all weight is on the ball
    weight = statistic(result.series("jntforc.upper.force.z"), "final")
    assert abs(weight) == pytest.approx(196.2, rel=1e-9)
