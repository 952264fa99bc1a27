"""A posture places a chain through its joints, and refuses what it cannot place."""

from pathlib import Path

import numpy as np
import pytest
from bench import refusal
from scipy.spatial.transform import Rotation

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

CHAIN = """
title: chain
control: {end_time: 1}
bodies:
  trunk: {mass: 30, inertia: [1, 1, 2], position: [0.1, 0, 1], mass_centre: [0, 0.02, 0.3]}
  thigh:
    {mass: 8, inertia: [0.1, 0.2, 0.1], position: [0, 0.1, 0.8], mass_centre: [0, 0, -0.2],
    rotation: {axis: [1, 2, 3], angle: 0.4}}
  shank: {mass: 4, inertia: [0.1, 0.1, 0.1], position: [0, 0.1, 0.4]}
  foot: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [0, 0.1, 0]}
joints:
  hip: {type: spherical, a: trunk, b: thigh, at: [0, 0.1, -0.2], frame: trunk}
  knee: {type: revolute, a: thigh, b: shank, at: [0, 0, -0.4], axis: [0.2, 1, 0], frame: thigh}
  # the other way round
  ankle: {type: universal, a: foot, b: shank, at: [0, 0, 0.1], axis: [1, 0, 0],
          second_axis: [0, 1, 0], frame: foot}
  far: {type: revolute, a: ground, b: foot, at: [0, 0, 0], axis: [0, 1, 0]}
  mount: {type: spherical, b: trunk, at: [0, 0, 0], frame: trunk}
postures:
  p: POSTURE
"""
GOOD = (
    "{root: shank, position: [3, 2, 1], rotation: {axis: [1, 1, 0], angle: 1}, velocity: [1, 2, 3],"
    " angular_velocity: [0.5, -1, 2], joints: [{joint: hip, rotation: {euler: [0.3, -0.7, 0.2]}},"
    " {joint: knee, angle: 0.9}, {joint: ankle}]}"
)


def built(folder: Path, posture: str, without: tuple[str, ...] = ("  far", "  mount")) -> Engine:
    lines = CHAIN.replace("POSTURE", posture).splitlines()
    text = "\n".join(line for line in lines if not line.startswith(without))
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    return Engine(*build(read_deck(path)))


def test_all_joints_close_and_their_velocities_agree(tmp_path: Path) -> None:
    engine = built(tmp_path, GOOD)
    engine.start()
    assert engine.assembly_errors() == []
    # positions of some metres, in round-off
    assert np.abs(engine.state.rows["phi"]).max() < 1e-14
    nodes = engine.state.nodes
    w = [0.5, -1, 2]
    for node in nodes[1:]:
        expected = np.array([1, 2, 3]) + np.cross(w, node["r"] - [3, 2, 1])
        np.testing.assert_allclose(node["v"], expected, atol=1e-13)
        np.testing.assert_allclose(node["w"], w, atol=0)


def test_the_rotations_are_those_asked_for(tmp_path: Path) -> None:
    zero = built(tmp_path, GOOD.replace("euler: [0.3, -0.7, 0.2]", "euler: [0, 0, 0]")
                 .replace("angle: 0.9", "angle: 0"))  # fmt: skip
    posed = built(tmp_path, GOOD)
    names = {name: i for i, name in enumerate(posed.model.bodies)}

    def relative(engine: Engine, a: str, b: str) -> Rotation:
        A = [engine.state.nodes["A"][names[body]].reshape(3, 3) for body in (a, b)]
        return Rotation.from_matrix(A[0].T @ A[1])

    hip = relative(posed, "trunk", "thigh") * relative(zero, "trunk", "thigh").inv()
    wanted = Rotation.from_euler("XYZ", [0.3, -0.7, 0.2])
    assert (hip * wanted.inv()).magnitude() < 1e-14
    knee = relative(posed, "thigh", "shank") * relative(zero, "thigh", "shank").inv()
    axis = np.array([0.2, 1, 0]) / np.hypot(0.2, 1)
    assert (knee * Rotation.from_rotvec(0.9 * axis).inv()).magnitude() < 1e-14


WRONG = {
    "joints.joint: 'knee' is not connected to 'trunk'": "{root: trunk, joints: [{joint: knee}]}",
    "joints.joint: 'far' is given in the world": (
        "{root: trunk, joints: [{joint: hip}, {joint: far}]}"
    ),
    "joints.angle: 'hip' has no axis to rotate about": (
        "{root: trunk, joints: [{joint: knee}, {joint: hip, angle: 1}]}"
    ),
    "root: the ground cannot be placed": "{root: ground, joints: [{joint: hip}]}",
    "joints.joint: 'hip' is named twice": ("{root: trunk, joints: [{joint: hip}, {joint: hip}]}"),
    "joints.joint: 'mount' joins the chain to the ground": (
        "{root: trunk, joints: [{joint: hip}, {joint: mount, rotation: {euler: [0.5, 0, 0]}}]}"
    ),
    "give one of: angle, rotation": (
        "{root: thigh, joints: [{joint: knee, angle: 1, rotation: {euler: [0, 0, 0]}}]}"
    ),
    "unknown joint 'elbow'": "{root: thigh, joints: [{joint: elbow}]}",
    # else the joint would be mounted anew, on a shank that is bent sideways
    "joints.rotation: 'knee' rotates about its axis alone; give an angle": (
        "{root: thigh, joints: [{joint: knee, rotation: {axis: [1, 0, 0], angle: 0.9}}]}"
    ),
    "joints.angular_velocity: 'knee' rotates about its axis alone": (
        "{root: thigh, joints: [{joint: knee, angular_velocity: [1, 0, 0]}]}"
    ),
    "joints.angle: 'ankle' leaves no rotation that a posture can give it": (
        "{root: shank, joints: [{joint: ankle, angle: 0.2}]}"
    ),
    "joints: 'thigh' is placed by the posture of 'thigh' too": (
        "{root: thigh, joints: [{joint: knee}]}\n  q: {root: trunk, joints: [{joint: hip}]}"
    ),
}


@pytest.mark.parametrize("message", WRONG)
def test_a_posture_that_cannot_be_taken_is_refused(tmp_path: Path, message: str) -> None:
    assert message in refusal(tmp_path, CHAIN.replace("POSTURE", WRONG[message]))


def test_an_angle_past_the_range_is_refused_with_how_far(tmp_path: Path) -> None:
    stop = (
        "\nsprings: {s: {type: rotation_stop, joint: knee, lower: 0, upper: 0.5, stiffness: 9}}\n"
    )
    posture = "{root: thigh, joints: [{joint: hip}, {joint: ankle}, {joint: knee, angle: 0.9}]}"
    turned = posture.replace("thigh", "shank").replace(
        "angle: 0.9", "rotation: {axis: [0.4, 2, 0], angle: 0.9}"
    )
    for words in (posture, turned):
        text = CHAIN.replace("POSTURE", words) + stop
        assert "rotates 'knee' to 0.9 rad, 0.4 rad past the range" in refusal(tmp_path, text)


LEFT_BEHIND = {
    # knee and what hangs on it stay where their cards have them, the foot with the shank
    "{root: trunk, position: [3, 0, 0], joints: [{joint: hip}]}": "'thigh' and 'shank' and not the",
    # the same place, turned about the common point
    "{root: shank, position: [0, 0.1, 0.4], rotation: {axis: [0, 0, 1], angle: 1}, joints: "
    "[{joint: knee}, {joint: hip}]}": "'foot' and 'shank' and not the",
}


@pytest.mark.parametrize("posture", LEFT_BEHIND)
def test_a_joint_that_a_posture_omits_is_refused_where_it_would_tear(
    tmp_path: Path, posture: str
) -> None:
    text = CHAIN.replace("POSTURE", posture)
    text = "\n".join(line for line in text.splitlines() if not line.startswith("  far"))
    message = refusal(tmp_path, text)
    assert LEFT_BEHIND[posture] in message and "name this joint in the posture" in message


def test_bodies_may_be_joined_where_a_posture_has_put_them(tmp_path: Path) -> None:
    """A point in the world says where; a joint with the ground does; omitted ones may close."""
    near = "{root: trunk, position: [0.1, 0, 1], joints: [{joint: hip}]}"
    built(tmp_path, near)
    head, _, tail = CHAIN.partition("  knee:")
    tail = tail[tail.index("  far:") :].replace("b: foot, at: [0, 0, 0]", "b: foot, at: [0, 0, 1]")
    hold = "  hold: {type: spherical, a: trunk, b: foot, at: [0, 0, 0]}\n"
    text = (head + hold + tail).replace("POSTURE", near.replace("0.1, 0, 1", "9, 0, 1"))
    path = tmp_path / "joined.yaml"
    path.write_text(text, "utf-8")
    engine = Engine(*build(read_deck(path)))
    engine.start()
    assert engine.assembly_errors() == []


@pytest.mark.parametrize("angle", ["", ", angle: 0"])
def test_the_zero_posture_past_a_range_is_refused(tmp_path: Path, angle: str) -> None:
    stop = "{type: rotation_stop, joint: knee, lower: 0.2, upper: 0.5, stiffness: 9}"
    posture = f"{{root: thigh, joints: [{{joint: hip}}, {{joint: ankle}}, {{joint: knee{angle}}}]}}"
    text = CHAIN.replace("POSTURE", posture) + f"\nsprings: {{s: {stop}}}\n"
    assert "rotates 'knee' to 0 rad, 0.2 rad past the range" in refusal(tmp_path, text)


def test_an_angle_at_its_limit_but_for_round_off_is_taken(tmp_path: Path) -> None:
    stop = "{type: rotation_stop, joint: knee, lower: 0, upper: 150 deg, stiffness: 9}"
    # 150 degrees, 2e-10 rad past them
    posture = (
        "{root: thigh, joints: [{joint: hip}, {joint: ankle}, {joint: knee, angle: 2.6179938782}]}"
    )
    text = CHAIN.replace("POSTURE", posture) + f"\nsprings: {{s: {stop}}}\n"
    text = "\n".join(line for line in text.splitlines() if not line.startswith("  far"))
    path = tmp_path / "deck.yaml"
    path.write_text(text, "utf-8")
    assert build(read_deck(path))[0].warnings == []


RATES = (
    "{{root: shank, position: [{p}, 2, 1], rotation: {{axis: [0, 0, 1], angle: {z}}}, "
    "velocity: [1, 0, 0], angular_velocity: [0, 0, 2], joints: [{{joint: hip, rotation: "
    "{{axis: [1, 0, 0], angle: {hip}}}, angular_velocity: [-0.7, 0, 0]}}, "
    "{{joint: knee, angle: {knee}, rate: 1.5}}, {{joint: ankle}}]}}"
)


def test_rates_move_the_segments_as_their_angles_do(tmp_path: Path) -> None:
    def at(t: float) -> Engine:
        values = {"p": 3 + t, "z": 0.4 + 2 * t, "hip": 0.3 - 0.7 * t, "knee": 0.9 + 1.5 * t}
        return built(tmp_path, RATES.format(**values))

    h = 1e-5
    before, now, after = at(-h), at(0.0), at(h)
    for b, n, a in zip(
        before.state.nodes[1:], now.state.nodes[1:], after.state.nodes[1:], strict=True
    ):
        # central differences: h^2 of the third derivative, some 10 m/s^3, and round-off over h
        np.testing.assert_allclose((a["r"] - b["r"]) / (2 * h), n["v"], atol=1e-8)
        rate = (a["A"].reshape(3, 3) - b["A"].reshape(3, 3)) / (2 * h) @ n["A"].reshape(3, 3).T
        spins = [rate[2, 1], rate[0, 2], rate[1, 0]]
        np.testing.assert_allclose(spins, n["w"], atol=1e-8)
