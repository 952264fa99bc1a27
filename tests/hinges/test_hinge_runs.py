"""Claim: hinges remember over a restart, and what fails flies on."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command import crashsolve, datasets
from small_runs import last, run

from crashpost.cli import main as crashpost
from crashpost.results.result import Result


def scene(**hinge: object) -> dict[str, Any]:
    """A rotor on an arm, beside one in two directions, each on hinges that soften."""
    points = [[0, 0], [0.002, 300], [0.05, 400], [0.06, 200], [1, 150]]
    rotor = {"mass": 2, "inertia": [1, 1, 2], "position": [0.5, 0, 0], "velocity": [0, 4, 0]}
    both = {"mass": 2, "inertia": [1, 2, 2], "position": [5, 0, 0], "angular_velocity": [0, 6, 5]}
    bending = {"type": "bending", "b": "rotor", "at": [0, 0, 0], "axis": [0, 0, 1]}
    biaxial = {"type": "biaxial", "b": "both", "at": [5, 0, 0], "axis": [1, 0, 0]}
    return {
        "title": "hinges",
        "curves": {"fold": {"points": points}},
        "bodies": {"rotor": rotor | {"angular_velocity": [0, 0, 8]}, "both": both},
        "hinges": {
            "rotor": bending | {"curve": "fold", "cyclic": "peak_oriented"} | hinge,
            "both": biaxial | {"side": [0, 1, 0], "curve": "fold", "rate": {"speed": "start"}},
        },
    }


@pytest.mark.long
def test_a_restart_goes_on_to_the_same_bits(tmp_path: Path) -> None:
    deck, ends = tmp_path / "deck.yaml", {}
    for name, stops in (("whole", (0.02,)), ("twice", (0.01, 0.02))):
        for end in stops:
            control = {"end_time": end, "step": 2e-4, "energy_limit": "off"}
            output = {"history": {"interval": 0.01}, "restart": {"every": 0.01}}
            text = yaml.safe_dump({"control": control, "output": output} | scene())
            deck.write_text(text, "utf-8")
            more = ["--restart"] * (end == 0.02 and name == "twice")
            done = crashsolve(deck, "-o", tmp_path / name, *more)
            assert done.returncode == 0, done.stdout + done.stderr
        result = Result(tmp_path / name)
        channels = [c.name for c in result.channels("hinge.*")]
        ends[name] = {channel: last(result, channel) for channel in channels}
    assert ends["whole"]["hinge.rotor.plastic_angle"] > 0.05
    assert ends["twice"] == ends["whole"]
    # hinges of all types have entries of their own in the table of energies
    taken = sum(ends["whole"][f"hinge.{name}.energy"] for name in ("rotor", "both"))
    booked = [
        last(result, f"glstat.model.energy.hinge_{word}") for word in ("stored", "dissipated")
    ]
    assert sum(booked) == pytest.approx(taken, rel=1e-12)
    assert last(result, "glstat.model.energy.plastic") == 0.0
    check_balls(tmp_path / "whole", ends["whole"])


def check_balls(folder: Path, known: dict[str, float]) -> None:
    """Pictures have a ball in every hinge, with its plastic angle."""
    mesh, state = (datasets(path) for path in (folder / "mesh.h5", last_state(folder)))
    points = (mesh["hinges/points"] + state["hinges/displacement"]).reshape(2, -1, 3)
    # in the order of types; both stay; the points of a ball lie evenly about its centre
    np.testing.assert_allclose(points.mean(axis=1), [[5, 0, 0], [0, 0, 0]], atol=1e-6)
    drawn = state["hinges/plastic_angle"].reshape(2, -1)[:, 0]
    both = np.hypot(*(known[f"hinge.both.plastic_angle.{k}"] for k in (1, 2)))
    # single precision
    np.testing.assert_allclose(drawn, [both, known["hinge.rotor.plastic_angle"]], rtol=1e-6)


def last_state(folder: Path) -> Path:
    return max((folder / "states").glob("*.h5"))


@pytest.mark.long
def test_what_fails_flies_on(tmp_path: Path) -> None:
    result = run(tmp_path, scene(failure_angle=0.05), 0.012, 2e-4, plain=True)
    assert last(result, "hinge.rotor.failed") == 1.0
    assert last(result, "hinge.rotor.moment") == 0.0
    v = [last(result, f"rbdout.rotor.velocity.{k}") for k in "xyz"]
    forces = [last(result, f"jntforc.rotor.force.{k}") for k in "xyz"]
    assert forces == [0.0, 0.0, 0.0]
    # its energy is what it had less what the hinge took, but for the moment over a last step
    energy = v[0] ** 2 + v[1] ** 2 + last(result, "rbdout.rotor.angular_velocity.z") ** 2
    left = 16.0 + 64.0 - last(result, "hinge.rotor.energy")
    assert abs(energy - left) < 400.0 * 8.0 * 2e-4
    other = run(tmp_path, scene(failure_angle=0.05, after_failure="loose"), 0.012, 2e-4, plain=True)
    # still an arm about the pivot: v = w x r
    spin = last(other, "rbdout.rotor.angular_velocity.z")
    speed = np.hypot(*(last(other, f"rbdout.rotor.velocity.{k}") for k in "xy"))
    assert np.isclose(speed, 0.5 * spin, rtol=1e-9)
    assert last(other, "hinge.rotor.failed") == 1.0


@pytest.mark.long
def test_an_angle_beyond_the_curve_stops_the_run(tmp_path: Path) -> None:
    known = scene()
    known["curves"]["fold"]["points"] = known["curves"]["fold"]["points"][:3]
    deck = tmp_path / "deck.yaml"
    control = {"end_time": 0.02, "step": 2e-4, "energy_limit": "off"}
    deck.write_text(yaml.safe_dump({"control": control} | known, sort_keys=False), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 4
    reported = r"hinge 'rotor': deformed to 0\.0\d+, beyond the end of its curve, 0\.0473333"
    assert re.search(reported, done.stdout + done.stderr)


@pytest.mark.long
@pytest.mark.parametrize(
    "method", ["dormand_prince_5", "dormand_prince_8", "generalized_alpha", "radau_iia_5"]
)
def test_every_integrator_stops_hinges_of_all_types_where_theory_says(
    tmp_path: Path, method: str
) -> None:
    """The deck's own expectations; of generalized alpha within errors of its second order."""
    deck = Path(__file__).resolve().parents[2] / "decks" / "verification" / "hinges" / "stops.yaml"
    words = (f"control.integrator={method}", "control.step=1e-4", "control.estimate=off")
    sets = [text for word in words for text in ("--set", word)]
    done = crashsolve(deck, "-o", tmp_path, *sets)
    assert done.returncode == 0, done.stdout + done.stderr
    if method != "generalized_alpha":
        assert crashpost(["expect", str(tmp_path)]) == 0
    result = Result(tmp_path)
    # corners within steps of 1e-4 s at 12 rad/s: (w h)^2 / 8 of 0.1 rad, a few times
    for hinge in ("rotor", "shaft", "bent"):
        largest = result.series(f"hinge.{hinge}.angle").values.max()
        assert largest == pytest.approx(0.48 + 300 / 2 / 3e5, abs=3e-5)


TURNED = """
title: A bar turns on hinges by more than 1 rad
control: {{end_time: 0.5, step: 1.0e-3, estimate: off}}
materials:
  steel: {{type: elastoplastic, young: 2.0e+11, poisson: 0.3, density: 7850, yield_stress: 3.0e+8}}
sections:
  tube: {{type: rectangular_tube, width: 0.02, height: 0.02, thickness: 0.001}}
curves: {{short: {{points: [[0, 0], [0.01, 200], [0.5, 150]], extrapolate: hold}}}}
bodies: {{bar: {{mass: 1, inertia: [1, 30, 30], angular_velocity: [0, 0, 4.5]}}}}
hinges:
  foot: {{type: biaxial, b: bar, at: [0, 0, 0], axis: [1, 0, 0], side: [0, 1, 0], {curves}}}
"""
PLASTIC = "{{section: tube, material: steel, about: {axis}, model: plastic, length: 1}}"


@pytest.mark.parametrize("end", [None, "given"])
def test_only_curves_with_an_end_are_read_beyond_it(tmp_path: Path, end: str | None) -> None:
    """A constant plastic moment has no range; of a curve that is given, the hinge is named."""
    sections = [PLASTIC.format(axis=axis) for axis in "yz"]
    curves = "curve: short" if end else "curve: {}, second_curve: {}".format(*sections)
    deck = tmp_path / "deck.yaml"
    deck.write_text(TURNED.format(curves=curves), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert last(Result(tmp_path / "out"), "hinge.foot.plastic_angle.2") > 1.0
    log = (tmp_path / "out" / "log.txt").read_text("utf-8")
    assert ("beyond the end of its" in log) == bool(end)
    assert ("hinge 'foot' deformed to" in log) == bool(end)
