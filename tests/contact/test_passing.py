"""Claim: a body that passes the middle of what it strikes stops the run; holes are reported.

What pushes back by the right face is in decks/verification/contact/kept_face.yaml.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command import crashsolve
from touching import Contact

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build

SQUARE = "vertices: [[-0.05, -0.05, 0], [0.05, -0.05, 0], [0.05, 0.05, 0], [-0.05, 0.05, 0]]"
PLATE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * [
    5e-2,
    5e-2,
    1e-3,
]
FACES = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4]]
FACES += [[2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
BALL = "type: sphere, body: ball, radius: 2.5e-3"
POINT = "type: point_set, body: ball, points: [[0, 0, 0]]"
# what flies at 300 m/s, what it strikes, and the step, if it is not the automatic one
THROUGH = {
    "a ball, a plate": (BALL, "type: box, size: [0.1, 0.1, 0.002]", None),
    "a point, a plate": (POINT, "type: box, size: [0.1, 0.1, 0.002]", None),
    "a point in one long step": (POINT, "type: box, size: [0.1, 0.1, 0.002]", 1e-4),
    "a ball, a ball": (BALL, "type: sphere, radius: 2.5e-3", None),
    "a ball, a ball in short steps": (BALL, "type: sphere, radius: 2.5e-3", 1e-6),
    "a ball, a rod": (BALL, "type: cylinder, radius: 2e-3, length: 0.1, axis: [0, 1, 0]", None),
    "a ball, a lens": (BALL, "type: ellipsoid, semi_axes: [0.05, 0.05, 2e-3]", None),
    "a ball, an open mesh": (
        BALL,
        f"type: mesh, {SQUARE}, faces: [[0, 1, 2], [0, 2, 3]], thickness: 2e-3",
        None,
    ),
    "a ball, a closed mesh": (
        BALL,
        f"type: mesh, vertices: {PLATE.tolist()}, faces: {FACES}",
        None,
    ),
    "an egg, a lens": (
        "type: ellipsoid, body: ball, semi_axes: [3e-3, 3e-3, 2e-3]",
        "type: ellipsoid, semi_axes: [0.05, 0.05, 2e-3]",
        None,
    ),
    "an egg, an open mesh": (
        "type: ellipsoid, body: ball, semi_axes: [3e-3, 3e-3, 2e-3]",
        f"type: mesh, {SQUARE}, faces: [[0, 1, 2], [0, 2, 3]], thickness: 2e-3",
        None,
    ),
    "an egg, a closed mesh": (
        "type: ellipsoid, body: ball, semi_axes: [3e-3, 3e-3, 2e-3]",
        f"type: mesh, vertices: {PLATE.tolist()}, faces: {FACES}",
        None,
    ),
    "a block, a plate": (
        "type: box, body: ball, size: [3e-3, 3e-3, 2e-3]",
        "type: box, size: [0.1, 0.1, 2e-3]",
        None,
    ),
    "a block, an open mesh": (
        "type: box, body: ball, size: [3e-3, 3e-3, 2e-3]",
        f"type: mesh, {SQUARE}, faces: [[0, 1, 2], [0, 2, 3]], thickness: 2e-3",
        None,
    ),
    "a rod, an open mesh": (
        "type: cylinder, body: ball, radius: 2e-3, length: 4e-3, axis: [1, 0, 0]",
        f"type: mesh, {SQUARE}, faces: [[0, 1, 2], [0, 2, 3]], thickness: 2e-3",
        None,
    ),
}


@pytest.mark.parametrize("case", THROUGH)
def test_what_flies_through_something_stops_the_run(case: str, tmp_path: Path) -> None:
    striker, struck, step = THROUGH[case]
    done = fly(tmp_path, striker, struck, height=6e-3, speed=-300.0, step=step)
    assert done.returncode == 4
    message = "contact 'hit': 'ball' has passed the middle of what it strikes on the ground"
    assert message in done.stdout
    assert "make the contact stiffer" in done.stdout
    assert "E r r o r    t e r m i n a t i o n" in done.stdout


@pytest.mark.parametrize(
    "case",
    [
        "a ball, an open mesh",
        "an egg, an open mesh",
        "a block, an open mesh",
        "a rod, an open mesh",
    ],
)
def test_what_comes_from_behind_an_open_mesh_stops_the_run(case: str, tmp_path: Path) -> None:
    """It would meet its whole depth at once, and gain that energy."""
    striker, struck, _ = THROUGH[case]
    done = fly(tmp_path, striker, struck, height=-8e-3, speed=300.0, step=None)
    assert done.returncode == 4
    assert "'ball' has come from behind the open mesh on the ground" in done.stdout
    # neither stiffness nor steps can help
    assert "give the corners of the faces in the opposite order" in done.stdout
    assert "stiffer" not in done.stdout and "shorter step" not in done.stdout


def fly(
    folder: Path,
    striker: str,
    struck: str,
    height: float,
    speed: float,
    step: float | None,
    beside: float = 5e-4,
    stiffness: float = 1e6,
) -> Any:
    """A run as plain Python: half a gram flies a little beside the middle of what it strikes."""
    pace = {"step": step} if step else {}
    deck = {
        "control": {"end_time": 2e-4, "energy_limit": "off"} | pace,
        "bodies": {
            "ball": {
                "mass": 5e-4,
                "inertia": [2e-9, 2e-9, 2e-9],
                "position": [beside, 0, height],
                "velocity": [0, 0, speed],
            }
        },
        "surfaces": yaml.safe_load(f"{{striker: {{{striker}}}, struck: {{{struck}}}}}"),
        "contacts": {
            "hit": {
                "a": ["striker"],
                "b": ["struck"],
                "normal": {"type": "hertz", "stiffness": stiffness},
            }
        },
        "output": {"history": {"interval": 1e-4}, "states": {"interval": 2e-4}},
    }
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    return crashsolve(path, "-o", folder / "out", CRASHSOLVE_PLAIN="1")


def test_no_node_passes_a_hard_contact(tmp_path: Path) -> None:
    """The same ball against the same plate, a thousand times as stiff."""
    done = fly(tmp_path, BALL, "type: plane", height=4e-3, speed=-30.0, step=None)
    assert done.returncode == 0, done.stdout


def test_a_ball_that_slips_by_another_deep_within_it_is_reported(tmp_path: Path) -> None:
    """Flown by 2.5 mm beside the middle of two radii of 2.5 mm, it has been half of them deep."""
    ball = "type: sphere, radius: 2.5e-3"
    soft = fly(tmp_path, BALL, ball, height=6e-3, speed=-300.0, step=None, beside=2.5e-3)
    assert soft.returncode == 0 and "'hit': the penetration reached 50 % of" in soft.stdout
    # that stores 22 J before it is a quarter deep: it is thrown aside
    hard = fly(tmp_path, BALL, ball, 6e-3, -300.0, None, beside=2.5e-3, stiffness=1e10)
    assert hard.returncode == 0 and "pressed to" not in hard.stdout


SHELL = """
title: holes
control: {end_time: 1}
materials: {m: {type: elastic, young: 2e9, poisson: 0.3, density: 1200}}
parts:
  sheet:
    type: shell
    mesh: {type: grid, at: [0, 0, 0], along: [0.04, 0, 0], across: [0, 0.04, 0], elements: [4, 4]}
    thickness: 1e-3
    material: m
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 1]}}
surfaces:
  nodes: {type: nodes, part: sheet, radius: 5e-4}
  faces: {type: faces, part: sheet}
  row: {type: point_set, body: ball, points: [[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]]}
  %s
contacts:
  hit: {a: [%s], b: [%s], normal: {type: penalty, stiffness: 1e5}}
"""
# the side that is met, by which points, and whether it fits between them. Four nodes 10 mm apart
# leave a hole of 7.07 mm; a row of points 100 mm apart one of 50 mm
HOLES = [
    ("small: {type: sphere, body: ball, radius: 4e-3}", "nodes", "small", "0.00707"),
    ("small: {type: sphere, body: ball, radius: 6.5e-3}", "nodes", "small", "0.00707"),
    ("large: {type: sphere, body: ball, radius: 6.6e-3}", "nodes", "large", None),
    ("needle: {type: box, body: ball, size: [0.1, 5e-3, 5e-3]}", "nodes", "needle", "0.00707"),
    ("plate: {type: box, body: ball, size: [0.1, 0.1, 5e-3]}", "nodes", "plate", None),
    ("floor: {type: plane, at: [0, 0, -1]}", "nodes", "floor", None),
    ("small: {type: sphere, radius: 49e-3}", "row", "small", "0.05"),
    ("small: {type: sphere, radius: 51e-3}", "row", "small", None),
    ("small: {type: sphere, body: ball, radius: 4e-3}", "small", "faces", None),
]


@pytest.mark.parametrize("surface, points, other, radius", HOLES)
def test_holes_between_points_are_reported(
    surface: str, points: str, other: str, radius: str | None, tmp_path: Path
) -> None:
    for a, b in ((points, other), (other, points)):
        path = tmp_path / "deck.yaml"
        path.write_text(SHELL % (surface, a, b), "utf-8")
        model, _ = build(read_deck(path))
        reported = [text for text in model.warnings if "may pass without being touched" in text]
        assert len(reported) == (radius is not None)
        if radius is not None:
            assert f"the points of '{points}' leave holes of radius {radius}" in reported[0]


def test_an_end_that_begins_crushed_has_lost_nothing(tmp_path: Path) -> None:
    contact = Contact(tmp_path, "{type: crush_curve, curve: stiff, unloading_stiffness: 2e5}")
    assert contact.press(0.02, 0.0).loss == 0.0
    contact.accept()
    assert contact.press(0.021, 0.0, h=1e-3).loss > 0.0
