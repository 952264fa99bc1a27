"""Claim: a known posture is found from pictures within the errors stated; bad ones are refused."""

import importlib.util
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.orientation import matrix
from crashsolve.photogrammetry.chain_fit import (
    Fit,
    FitError,
    _rotation_jacobian,
    rotation,
    rotation_vector,
)
from crashsolve.photogrammetry.command import posture
from crashsolve.photogrammetry.motion import rates
from crashsolve.photogrammetry.occupant import chain_of
from crashsolve.photogrammetry.points import measured
from crashsolve.photogrammetry.request import read_request
from crashsolve.photogrammetry.segments import fitted

DECKS = Path(__file__).resolve().parents[2] / "decks" / "occupants"
TABLES = ("targets.csv", "calibration.csv", "frames.csv")


def _synthetic() -> Any:
    spec = importlib.util.spec_from_file_location("synthetic", DECKS / "posture" / "synthetic.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def example(tmp_path: Path) -> Path:
    shutil.copytree(DECKS / "posture", tmp_path / "posture")
    shutil.copytree(DECKS / "shared", tmp_path / "shared")
    return tmp_path / "posture" / "driver.posture.yaml"


def posture_of(request: Path) -> tuple[Any, list[Fit]]:
    requested = read_request(request)
    chain, _ = chain_of(requested)
    return chain, fitted(requested, chain, measured(requested))


def errors_of(chain: Any, fit: Fit, time: float) -> np.ndarray:
    """Of joints' rotations, about axes of a, against those of true.yaml at a time."""
    true = {one["joint"]: one for one in _synthetic().posture_at(time)["joints"]}
    errors = []
    for link, q in zip(chain.links, chain.split(fit.q), strict=True):
        card = true[link.joint]
        if link.axis is not None:
            errors.append(q - card["angle"])
            continue
        axis = np.array(card["rotation"]["axis"], float)
        half = 0.5 * card["rotation"]["angle"]
        A = matrix((np.cos(half), *(np.sin(half) * axis / np.linalg.norm(axis))))
        errors.append(rotation_vector(rotation(q) @ A.T))
    return np.concatenate(errors)


@pytest.mark.long
def test_without_noise_the_posture_is_found_to_round_off(example: Path) -> None:
    synthetic = _synthetic()
    points = {time: synthetic.landmarks_at(time) for time in synthetic.TIMES}
    synthetic.write(example.parent, 0.0, 1, points, synthetic.grid())
    example.write_text(example.read_text("utf-8") + "image_error: 0.5\n", "utf-8")
    chain, fits = posture_of(example)
    for fit, time in zip(fits, synthetic.TIMES, strict=True):
        # the search ends on changes of 1e-12 of q, and so well within 1e-8 rad
        assert np.abs(errors_of(chain, fit, time)).max() < 1e-8
    card = synthetic.posture_at(synthetic.START)
    own = chain.split(rates(chain, fits, 1, 3).values)
    for link, rate in zip(chain.links, own, strict=True):
        true = next(one for one in card["joints"] if one["joint"] == link.joint)
        given = true["rate"] if link.axis is not None else true["angular_velocity"]
        # constant rates: what is left is the angles' error over 0.02 s
        np.testing.assert_allclose(rate, given, atol=1e-6)


def test_the_example_is_what_the_script_makes(example: Path, tmp_path: Path) -> None:
    synthetic = _synthetic()
    points = {time: synthetic.landmarks_at(time) for time in synthetic.TIMES}
    synthetic.write(tmp_path, 0.5, 11, points, synthetic.grid())
    for name in TABLES:
        assert (tmp_path / name).read_text("utf-8") == (example.parent / name).read_text("utf-8")


def test_with_noise_errors_have_the_covariance_stated(example: Path) -> None:
    chain, fits = posture_of(example)
    squares = []
    for fit, time in zip(fits, _synthetic().TIMES, strict=True):
        e = errors_of(chain, fit, time)
        squares.append(e @ np.linalg.solve(fit.covariance[6:, 6:], e))
    # chi-squared of 25 rotations; frames share errors of cameras: at worst their mean is as one
    # draw: 25 with a standard deviation of sqrt(50), of which three
    assert abs(np.mean(squares) - 25) < 3 * np.sqrt(50)


def test_frames_on_no_parabola_have_no_velocity(example: Path) -> None:
    """Five frames through which joints jerk: a velocity of them all would be that of no moment."""
    chain, fits = posture_of(example)
    rng = np.random.default_rng(2)
    # errors of q whose small rotations have the covariance stated
    to_q = np.linalg.inv(_rotation_jacobian(chain, fits[1].q))
    root = to_q @ np.linalg.cholesky(fits[1].covariance)

    def moved(jerk: float) -> list[Fit]:
        """At -2, ... 2 frames of 0.02 s; only a knee moves."""
        q, t = fits[1].q, 0.02 * np.arange(-2, 3)
        rate = np.zeros(len(q))
        rate[-1] = 1.0
        return [
            replace(
                fits[1],
                time=one,
                q=q + rate * (one + jerk * one**3) + root @ rng.normal(size=len(q)),
            )
            for one in t
        ]

    fitted_rates = rates(chain, moved(0.0), 2, 5)
    assert abs(fitted_rates.values[-1] - 1.0) < 4.0 * fitted_rates.deviations[-1]
    with pytest.raises(FitError, match="no parabola within its errors"):
        rates(chain, moved(3e3), 2, 5)


def test_the_card_that_is_written_can_be_included(example: Path) -> None:
    from crashsolve.deck.reading.deck import read_deck
    from crashsolve.model.scene import Scene

    lines = posture(example, example.parent / "out")
    assert any("23 points" in line for line in lines)
    deck = example.parent / "occupant.yaml"
    text = deck.read_text("utf-8").replace("include:\n", "include:\n  - out/posture.yaml\n")
    deck.write_text(text, "utf-8")
    scene = Scene(read_deck(deck))
    scene.raise_errors()
    node = scene.node("driver_lower_torso")
    # of true.yaml; a few times the 2 mm and 0.1 m/s that 0.5 pixels leave
    np.testing.assert_allclose(scene.r[node] - scene.matrix(node) @ scene.offset[node],
                               [0.2, -0.1, 0.45], atol=5e-3)  # fmt: skip
    assert np.linalg.norm(scene.v[node]) > 1.0


def without(path: Path, *words: str) -> None:
    lines = path.read_text("utf-8").splitlines()
    kept = [line for line in lines if not all(word in f",{line}," for word in words)]
    assert len(kept) < len(lines)
    path.write_text("\n".join(kept) + "\n", "utf-8")


def refusal(request: Path) -> str:
    with pytest.raises(DeckErrors) as caught:
        posture(request, request.parent / "out")
    return str(caught.value)


def test_a_point_seen_by_one_camera_is_refused(example: Path) -> None:
    for camera in (1, 2, 3):
        without(example.parent / "frames.csv", f",0.02,{camera},nose,")
    message = refusal(example)
    assert "frames.csv:" in message and "seen by one camera, '0', at 0.02 s; 2 are" in message


def test_coplanar_targets_are_refused(example: Path) -> None:
    for target in ("t1", "t2", "t4", "t5", "t7", "t8", "t10", "t11", "t13", "t14", "t16", "t17"):
        without(example.parent / "calibration.csv", f",2,{target},")
    message = refusal(example)
    assert "calibration.csv:" in message and "camera '2'" in message and "in a plane" in message


def test_targets_nearly_in_a_plane_are_refused(example: Path) -> None:
    """Their images have errors larger than the depth of the targets shows in a picture."""
    synthetic = _synthetic()
    targets = synthetic.grid()
    targets[:, 0] = 0.2 + 0.003 * (targets[:, 0] - 0.2)
    points = {time: synthetic.landmarks_at(time) for time in synthetic.TIMES}
    synthetic.write(example.parent, 0.5, 11, points, targets)
    message = refusal(example)
    assert "change its equations by" in message and "spread in all directions" in message


def test_too_few_targets_are_refused_with_the_count_needed(example: Path) -> None:
    for k in range(5, 18):
        without(example.parent / "calibration.csv", f",3,t{k},")
    assert "sees 5 targets; 6 that are not in one plane are needed" in refusal(example)


def test_targets_at_one_place_count_once(example: Path) -> None:
    for k in range(6, 18):
        without(example.parent / "calibration.csv", f",3,t{k},")
    path = example.parent / "targets.csv"
    lines = path.read_text("utf-8").splitlines()
    at = {line.split(",")[0]: line.partition(",")[2] for line in lines}
    path.write_text(
        "\n".join(f"t4,{at['t5']}" if line.startswith("t4,") else line for line in lines), "utf-8"
    )
    assert "sees 5 targets; 6 that are not in one plane are needed" in refusal(example)


def test_too_few_points_are_refused_with_the_count_needed(example: Path) -> None:
    for side in ("left", "right"):
        for name in ("wrist", "hand", "ankle", "toe", "elbow", "knee", "ear"):
            without(example.parent / "frames.csv", f",{name}_{side},")
    assert "at least 11 points are needed" in refusal(example)


@pytest.mark.long
def test_an_open_rotation_is_refused_by_its_joint(example: Path) -> None:
    without(example.parent / "frames.csv", ",larynx,")
    message = refusal(example)
    assert "driver_neck_base" in message or "driver_condyles" in message
    assert "larynx" in message and "frames.csv:" in message


def rewritten(path: Path, camera: str, target: str, column: int, change: float) -> None:
    """A table with one number changed."""
    lines = [line.split(",") for line in path.read_text("utf-8").splitlines()]
    (row,) = (row for row in lines if row[:2] == [camera, target] or row[0] == target)
    row[column] = f"{float(row[column]) + change}"
    path.write_text("\n".join(map(",".join, lines)) + "\n", "utf-8")


@pytest.mark.parametrize("given", ["", "image_error: 0.5\n"])
def test_a_wrong_picture_of_a_target_is_refused_by_its_name(example: Path, given: str) -> None:
    example.write_text(example.read_text("utf-8") + given, "utf-8")
    # ten times the error of 0.5 pixels
    rewritten(example.parent / "calibration.csv", "2", "t7", 2, 5.0)
    message = refusal(example)
    assert "calibration.csv:46:" in message and "camera '2': its targets contradict" in message
    assert "'t7' is 4." in message


@pytest.mark.parametrize("given", ["", "image_error: 0.5\n"])
def test_a_wrong_target_is_refused_by_its_name(example: Path, given: str) -> None:
    """All cameras see it, and agree with each other as well as with the points."""
    example.write_text(example.read_text("utf-8") + given, "utf-8")
    rewritten(example.parent / "targets.csv", "none", "t8", 1, 0.05)
    assert "its targets contradict each other: 't8' is" in refusal(example)


def test_one_camera_given_twice_is_refused(example: Path) -> None:
    for name, column in (("calibration.csv", 0), ("frames.csv", 1)):
        path = example.parent / name
        head, *rows = path.read_text("utf-8").splitlines()[1:]
        own = [row for row in rows if row.split(",")[column] == "0"]
        copies = [",".join("9" if i == column else cell for i, cell in enumerate(row.split(",")))
                  for row in own]  # fmt: skip
        path.write_text("\n".join([head, *own, *copies]) + "\n", "utf-8")
    assert "two cameras must see it from different directions" in refusal(example)


def test_a_camera_with_a_reversed_axis_is_refused(example: Path) -> None:
    """Its targets agree with each other: only its pictures of points do not fit the others."""
    path = example.parent / "calibration.csv"
    lines = [line.split(",") for line in path.read_text("utf-8").splitlines()]
    for row in lines:
        if row[0] == "1":
            row[3] = f"{1080 - float(row[3])}"
    path.write_text("\n".join(map(",".join, lines)) + "\n", "utf-8")
    message = refusal(example)
    assert "images of points contradict each other by" in message and "reversed axis" in message


def test_targets_in_another_unit_are_refused_at_once(example: Path) -> None:
    path = example.parent / "targets.csv"
    path.write_text(path.read_text("utf-8").replace("[m]", "[mm]"), "utf-8")
    message = refusal(example)
    assert "0.00" in message and "times as far apart as the landmarks" in message
    assert "wrong units" in message


def test_landmarks_in_another_unit_are_refused_by_line(example: Path) -> None:
    path = example.parent / "landmarks.csv"
    path.write_text(path.read_text("utf-8").replace("[mm]", "[m]"), "utf-8")
    message = refusal(example)
    assert "landmarks.csv:4: error: vertex: lies 165 m from the mass centre" in message
    assert "wrong unit" in message


def test_points_that_were_exchanged_are_refused(example: Path) -> None:
    path = example.parent / "frames.csv"
    text = path.read_text("utf-8").replace("0.02,1,knee_left,", "0.02,1,swapped,")
    text = text.replace("0.02,1,knee_right,", "0.02,1,knee_left,")
    path.write_text(text.replace("0.02,1,swapped,", "0.02,1,knee_right,"), "utf-8")
    assert "contradict each other" in refusal(example)
