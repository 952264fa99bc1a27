"""Drivers of velocity and acceleration: integrals of their curves, to round-off."""

from pathlib import Path

import numpy as np
import pytest
from quick import first_quick

from crashsolve.deck.reading.deck import read_deck
from crashsolve.estimate.estimator import estimate_in_memory
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build

METHODS = ("rattle", "dormand_prince_5", "radau_iia_5", "generalized_alpha")
RAIL = """\
control: {{end_time: 0.1, integrator: {method}}}
curves: {{x: {{type: file, file: pulse.csv}}}}
bodies: {{sled: {{mass: 500, inertia: [1, 2, 3], {moves}}}}}
joints:
  rail: {{type: {joint}, b: sled, at: [0, 0, 0], axis: [1, 0, 0]}}
  drive: {{{drive}, {kind}: x}}
watch:
  - {{channel: {channel}, statistic: final}}
"""


def pulse(folder: Path, first: float, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """A noisy pulse as measured: times [s], values."""
    t = np.linspace(0, 0.12, 121)
    y = -200 * np.sin(np.pi * t / 0.08).clip(0) + np.random.default_rng(seed).normal(0, 9, 121)
    y[0] = first
    (folder / "pulse.csv").write_text(
        "".join(f"{a!r}, {b!r}\n" for a, b in zip(t.tolist(), y.tolist(), strict=True))
    )
    return t, y


def integrals(t: np.ndarray, y: np.ndarray, end: float) -> tuple[float, float]:
    """Integral of straight lines, and integral of that, up to a point of the table."""
    n = int(np.argmin(np.abs(t - end)))
    h, a, b = np.diff(t)[:n], y[:n], y[1 : n + 1]
    area = np.concatenate([[0.0], np.cumsum(h * (a + b) / 2)])
    return float(area[-1]), float((h * area[:-1] + h * h * (a / 3 + b / 6)).sum())


def final(folder: Path, **words: str) -> float:
    path = folder / "deck.yaml"
    path.write_text(RAIL.format(**words))
    value = estimate_in_memory(read_deck(path))[1][0].value
    assert value is not None
    return value


SLIDE = {"joint": "prismatic", "drive": "type: translation_driver, joint: rail"}
POINT = {"joint": "prismatic", "drive": "type: point_driver, body: sled, axis: [2, 0, 0]"}
ROTATION_ABOUT_AXIS = {"joint": "revolute", "drive": "type: rotation_driver, joint: rail"}


@pytest.mark.parametrize("method", first_quick(METHODS))
@pytest.mark.parametrize("words", [SLIDE, pytest.param(POINT, marks=pytest.mark.long)])
def test_a_measured_acceleration_gives_its_velocity_and_stroke(
    method: str, words: dict[str, str], tmp_path: Path
) -> None:
    t, a = pulse(tmp_path, 0.0)
    area, stroke = integrals(t, a, 0.1)
    moves = {"moves": "velocity: [15, 0, 0]", "method": method, "kind": "acceleration"} | words
    # joints are closed to 1e-10 of the model's size
    v = final(tmp_path, channel="rbdout.sled.velocity.x", **moves)
    assert v == pytest.approx(15 + area, rel=1e-10)
    x = final(tmp_path, channel="rbdout.sled.position.x", **moves)
    assert x == pytest.approx(1.5 + stroke, abs=1e-9)


@pytest.mark.parametrize("method", first_quick(METHODS))
def test_a_measured_velocity_gives_its_stroke(method: str, tmp_path: Path) -> None:
    t, v = pulse(tmp_path, 3.0)
    words = {"moves": "velocity: [3, 0, 0]", "method": method, "kind": "velocity"} | SLIDE
    x = final(tmp_path, channel="rbdout.sled.position.x", **words)
    assert x == pytest.approx(integrals(t, v, 0.1)[0], abs=1e-9)


@pytest.mark.long
def test_a_measured_spin_is_that_of_a_turn(tmp_path: Path) -> None:
    t, a = pulse(tmp_path, 0.0)
    words = {"moves": "angular_velocity: [4, 0, 0]", "method": "rattle", "kind": "acceleration"}
    w = final(tmp_path, channel="rbdout.sled.angular_velocity.x", **(words | ROTATION_ABOUT_AXIS))
    assert w == pytest.approx(4 + integrals(t, a, 0.1)[0], rel=1e-9)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("joint: rail", "give one of curve, velocity, acceleration"),
        ("joint: rail, curve: x, velocity: x", "give one of curve, velocity, acceleration"),
        ("joint: rail, velocity: x, relative: false", "needs a curve of the coordinate"),
    ],
)
def test_a_driver_has_one_curve(words: str, message: str, tmp_path: Path) -> None:
    pulse(tmp_path, 0.0)
    plain = RAIL.format(
        method="rattle",
        joint="prismatic",
        moves="velocity: [0, 0, 0]",
        drive="type: translation_driver",
        kind="KIND",
        channel="rbdout.sled.velocity.x",
    )
    path = tmp_path / "deck.yaml"
    path.write_text(plain.replace("KIND: x", words))
    with pytest.raises(DeckErrors, match=message):
        build(read_deck(path))


@pytest.mark.parametrize("kind", ["acceleration", "velocity"])
def test_a_run_may_begin_before_a_pulse_that_holds_its_first_value(
    kind: str, tmp_path: Path
) -> None:
    t, y = pulse(tmp_path, 2.0)
    area, stroke = integrals(t, y, 0.1)
    moves = "velocity: [2, 0, 0]" if kind == "velocity" else "velocity: [0, 0, 0]"
    words = SLIDE | {"kind": kind, "moves": moves, "method": "rattle, start_time: -0.05"}
    with pytest.raises(DeckErrors, match="or extrapolate: hold"):
        final(tmp_path, channel="rbdout.sled.velocity.x", **words)
    text = RAIL.format(**words, channel="rbdout.sled.position.x")
    text = text.replace("file: pulse.csv", "file: pulse.csv, extrapolate: hold")
    (tmp_path / "deck.yaml").write_text(text)
    x = estimate_in_memory(read_deck(tmp_path / "deck.yaml"))[1][0].value
    # 0.05 s at the first value, then the pulse
    before, v = (2.0 * 0.05, 0.0) if kind == "velocity" else (2.0 * 0.05**2 / 2, 2.0 * 0.05)
    expected = before + (area if kind == "velocity" else v * 0.1 + stroke)
    assert x == pytest.approx(expected, rel=1e-10)
