"""Claim: steps end at the corners of curves of time, so that no pulse is half seen."""

import re
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command import crashsolve

import crashsolve as package
from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.corners import corners, corners_in_time

PULSE = [[0.0, 0.0], [0.0123, 1.0], [0.0377, 0.0]]
TIMES = [x for x, _ in PULSE]
SMOOTH = [[0.0, 0.0], [0.006, 0.0], [0.0123, 0.003], [0.0377, 0.01], [0.06, 0.01], [0.2, 0.01]]
SCENE: dict[str, Any] = {
    "bodies": {
        "struck": {"mass": 1.0, "inertia": [1.0] * 3},
        "driven": {"mass": 1.0, "inertia": [1.0] * 3, "position": [0, 1, 0]},
    },
    "curves": {
        "pulse": {"points": PULSE, "extrapolate": "hold"},
        "motion": {"points": SMOOTH, "interpolation": "smooth"},
    },
    "loads": {"impulse": {"type": "force", "body": "struck", "force": [1, 0, 0], "curve": "pulse"}},
    "joints": {"path": {"type": "point_driver", "body": "driven", "axis": [1, 0, 0],
                        "curve": "motion"}},
}  # fmt: skip


def written(folder: Path, scene: Mapping[str, Any], **control: Any) -> Path:
    path = folder / "deck.yaml"
    given = {"end_time": 0.1, "estimate": "off", "energy_limit": "off"} | control
    # a sample would cut the steps
    output = {"history": {"interval": 0.1}, "states": {"interval": 0.1}}
    path.write_text(yaml.safe_dump({"control": given, "output": output, **scene}))
    return path


@pytest.mark.parametrize(
    ("method", "step"),
    [("rattle", "auto"), ("rattle", 0.01), ("dormand_prince_8", "auto"), ("radau_iia_5", "auto")],
)
def test_a_pulse_of_straight_lines_gives_its_impulse(
    method: str, step: float | str, tmp_path: Path
) -> None:
    deck = written(tmp_path, SCENE, integrator=method, step=step)
    done = crashsolve(deck, "-o", tmp_path / "out", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    result = Result(tmp_path / "out")
    speed = result.series("rbdout.struck.velocity.x").values[-1]
    # round-off: every method is exact on a straight line
    assert speed == pytest.approx(0.5 * TIMES[2], rel=1e-13)
    direction = 0.5 * TIMES[2] * (0.1 - (TIMES[1] + TIMES[2]) / 3.0)
    if method != "rattle":
        assert result.series("rbdout.struck.position.x").values[-1] == pytest.approx(
            direction, rel=1e-12
        )
    # three corners of the pulse and six of the motion, and hardly a step more; steps that stiffness
    # alone would bound are some seventy, to see how the motion bends
    most = 80 if method == "rattle" and step == "auto" else 30
    assert result.series("glstat.model.cycle").values[-1] < most
    # a joint is closed to control.constraint_tolerance, 1e-10 of a metre
    assert result.series("rbdout.driven.position.x").values[-1] == pytest.approx(0.01, abs=1e-10)


# a bar is drawn to twice its yield force and let go between two samples
DRAWN = """
control: {end_time: 1, solution: quasi_static, steps: 1, tolerance: 1e-9}
materials:
  steel: {type: elastoplastic, young: 1e9, poisson: 0, density: 1000, yield_stress: 1e6, hardening: 1e8}
sections: {bar: {type: rectangle, width: 0.01, height: 0.01}}
parts:
  bar: {type: fibre_beam, section: bar, material: steel, side: [0, 1, 0], fibres: [2, 2],
        mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 1}}
curves: {pull: {points: [[0, 0], [0.5, 1], [1, 0]]}}
joints: {wall: {type: weld, b: bar_start, at: [0, 0, 0]}}
loads: {pull: {type: force, body: bar_end, force: [200, 0, 0], curve: pull}}
"""  # noqa: E501


@pytest.mark.long
def test_equilibria_do_not_pass_by_the_top_of_a_load(tmp_path: Path) -> None:
    (tmp_path / "deck.yaml").write_text(DRAWN)
    done = crashsolve(tmp_path / "deck.yaml", "-o", tmp_path, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stdout + done.stderr
    end = Result(tmp_path).series("rbdout.bar_end.position.x").values[-1]
    # the plastic strain, Y / H where the stress is 2 Y; large strains leave a few percent
    assert end - 1.0 == pytest.approx(1e6 / 1e8, rel=0.05)


def points_of(curve: Mapping[str, object], folder: Path) -> np.ndarray:
    scene = SCENE | {"curves": SCENE["curves"] | {"pulse": curve}}
    model, _ = build(read_deck(written(folder, scene)))
    return corners(model.curves, model.curve_names["pulse"])


def test_corners_are_those_of_the_curve(tmp_path: Path) -> None:
    assert points_of({"points": PULSE, "extrapolate": "hold"}, tmp_path).tolist() == TIMES
    # going on straight is no corner
    assert points_of({"points": PULSE, "extrapolate": "linear"}, tmp_path).tolist() == [TIMES[1]]
    spline = {"points": PULSE, "interpolation": "cubic", "extrapolate": "linear"}
    assert len(points_of(spline, tmp_path)) == 0
    formula = {"type": "formula", "from": 0, "to": 0.2, "extrapolate": "linear"}
    # ten periods in 200 pieces
    assert len(points_of(formula | {"expression": "sin(100 * pi * x)"}, tmp_path)) == 0
    kinked = points_of(formula | {"expression": "abs(sin(10 * pi * (x - 0.0334)))"}, tmp_path)
    # the pieces next to its two kinks, at 0.0334 and 0.1334; its ends, where it is bent as well
    kinked = kinked[1:-1]
    near = np.minimum(np.abs(kinked - 0.0334), np.abs(kinked - 0.1334))
    assert 4 <= len(kinked) <= 12
    assert near.max() < 3e-3


def test_a_model_without_curves_of_time_has_no_corners(tmp_path: Path) -> None:
    curve = {"points": [[-1, -1], [0, 0], [1, 5]]}
    spring = {"type": "curve", "a": "ground", "b": "struck", "curve": "pulse"}
    scene = {"bodies": {"struck": SCENE["bodies"]["struck"] | {"position": [1, 0, 0]}},
             "curves": {"pulse": curve}, "springs": {"s": spring}}  # fmt: skip
    model, _ = build(read_deck(written(tmp_path, scene)))
    assert len(corners_in_time(model)) == 0


def test_every_law_that_reads_a_curve_of_time_declares_it() -> None:
    root = Path(package.__file__).parent
    laws = 0
    for family in ("loads", "joints", "springs", "sensors", "contact/normal", "friction", "parts"):
        for path in (root / family).glob("*.py"):
            columns = set(re.findall(r"curve_value\(curves, p\.(\w+), t\)", path.read_text()))
            # of drivers, what _driven.py reads
            columns |= {"curve"} if "driven(p, curves, t)" in path.read_text() else set()
            if not columns or path.stem.startswith("_"):
                continue
            laws += 1
            module = import_module(f"crashsolve.{family.replace('/', '.')}.{path.stem}")
            assert columns == set(module.CURVES_OF_TIME), path
    assert laws >= 4
    # those that take their kernels from others
    for name in ("loads.force", "loads.torque", "joints.point_driver"):
        assert import_module(f"crashsolve.{name}").CURVES_OF_TIME == ("curve",)
