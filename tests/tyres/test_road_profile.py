"""Claims: a road by ISO 8608 has its spectrum, and a wheel follows its transfer function."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.results.result import Result
from crashsolve.curves.iso_8608 import Iso8608, build, waves

LENGTH, SPEED = 200.0, 20.0
MASS, STIFFNESS, DAMPING, GRAVITY = 300.0, 2.2e5, 3000.0, 9.81
WORDS = {"length": LENGTH, "n_max": 0.5, "seed": 3}
DECK = f"""title: Wheel on a road of class B
control: {{end_time: 9.5, step: 5.0e-4, start: equilibrium, estimate: "off"}}
output: {{history: {{interval: 5.0e-3}}, states: {{interval: 5}}}}
curves: {{road: {{type: iso_8608, grade: B, length: {LENGTH}, n_max: 0.5, seed: 3}}}}
bodies:
  slider: {{mass: 1, inertia: [1, 1, 1], position: [1, 0, 0.3], velocity: [{SPEED}, 0, 0]}}
  mast: {{mass: {MASS - 15}, inertia: [9, 9, 9], position: [1, 0, 0.3], velocity: [{SPEED}, 0, 0]}}
  wheel: {{mass: 15, inertia: [0.5, 0.9, 0.5], position: [1, 0, 0.3], velocity: [{SPEED}, 0, 0],
    angular_velocity: [0, {SPEED / 0.29}, 0]}}
joints:
  rail: {{type: prismatic, b: slider, at: [1, 0, 0.3], axis: [1, 0, 0]}}
  up: {{type: prismatic, a: slider, b: mast, at: [1, 0, 0.3], axis: [0, 0, 1]}}
  hub: {{type: revolute, a: mast, b: wheel, at: [1, 0, 0.3], axis: [0, 1, 0]}}
tyres:
  t: {{type: gim, wheel: wheel, profile: {{curve: road}}, radius: 0.3, stiffness: {STIFFNESS},
    damping: {DAMPING}, friction_max: 0.9, slip_stiffness: 8.0e4, cornering_stiffness: 6.0e4}}
loads: {{g: {{type: gravity, acceleration: [0, 0, {-GRAVITY}]}}}}
"""


def heights(card: Iso8608, s: np.ndarray) -> np.ndarray:
    """The curve that is built, at positions of its range."""
    x, c, _ = build(card, None)
    i = np.clip(np.searchsorted(x, s, "right") - 1, 0, len(c) - 1)
    t, c = s - x[i], c[i].T
    return np.asarray(c[0] + t * (c[1] + t * (c[2] + t * c[3])))


@pytest.mark.parametrize("grade, roughness", [("A", 16e-6), ("B", 64e-6), ("C", 256e-6)])
@pytest.mark.parametrize("exponent", [2.0, 2.5])
def test_the_spectrum_of_a_period_is_that_of_the_class(
    grade: str, roughness: float, exponent: float
) -> None:
    card = Iso8608(length=100.0, grade=grade, exponent=exponent, seed=5)
    count = 1 << 13
    z = heights(card, np.arange(count) * 100.0 / count)
    amplitude = 2.0 * np.abs(np.fft.rfft(z)) / count
    spectrum = amplitude**2 / 2.0 * 100.0
    n = np.fft.rfftfreq(count, 100.0 / count)
    inside = (n >= 0.0199) & (n <= 2.8301)
    expected = roughness * (n[inside] / 0.1) ** -exponent
    # cubics err by 6e-5 of the height of the shortest wave, twice that in its square, and by
    # waves of theirs that others fold onto
    np.testing.assert_allclose(spectrum[inside], expected, rtol=2e-3)
    outside = n > 2.84
    assert spectrum[outside].max() < 1e-6 * expected.min()


def test_a_seed_is_a_road() -> None:
    s = np.linspace(0.0, LENGTH, 5001)
    first, again, other = (
        heights(Iso8608(grade="B", length=LENGTH, seed=seed), s) for seed in (1, 1, 2)
    )
    assert (first == again).all()
    assert abs(np.corrcoef(first, other)[0, 1]) < 0.9


def test_a_level_start_is_level_and_its_waves_grow_to_their_height() -> None:
    s = np.linspace(0.0, LENGTH, 20001)
    plain = heights(Iso8608(grade="B", **WORDS), s)
    led = heights(Iso8608(grade="B", level=10.0, rise=20.0, **WORDS), s)
    assert not led[s <= 10.0].any()
    np.testing.assert_array_equal(led[s >= 30.0], plain[s >= 30.0])


WRONG = {
    "needs one of grade and roughness": {"length": 50.0},
    "n_min: must be below n_max": {"length": 50.0, "grade": "A", "n_min": 3.0},
    "length: has no whole wave": {"length": 0.3, "grade": "A"},
    "length: needs more than": {"length": 1e5, "grade": "A"},
    "rise: must be above 0": {"length": 50.0, "grade": "A", "level": 3.0},
    "level: the roughness has not": {"length": 50.0, "grade": "A", "level": 30.0, "rise": 25.0},
}


@pytest.mark.parametrize("message", WRONG)
def test_a_road_that_cannot_be_meant_is_refused(message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Iso8608(**WRONG[message])


def test_a_wheel_bears_what_its_transfer_function_says(tmp_path: Path) -> None:
    deck, out = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(DECK, "utf-8")
    done = crashsolve(deck, "-o", out)
    assert done.returncode == 0, done.stdout + done.stderr
    force, travel = (
        Result(out).series(name) for name in ("tyrout.t.normal", "rbdout.wheel.position.x")
    )
    t, s = np.asarray(force.time), np.asarray(travel.values)
    # the search left it on the slope, and did not move it to the crest 0.17 m behind
    assert s[0] == pytest.approx(1.0, abs=0.05)
    expected = np.full_like(t, MASS * GRAVITY)
    for n, height, phase in zip(*waves(Iso8608(grade="B", **WORDS)), strict=True):
        w = 2.0 * np.pi * n * SPEED
        H = (STIFFNESS + 1j * w * DAMPING) / (STIFFNESS - MASS * w * w + 1j * w * DAMPING)
        wave = height * np.exp(1j * (2.0 * np.pi * n * s + phase))
        expected += np.real(-MASS * w * w * H * wave)
    late = t > 3.0
    # the start has decayed by exp(-5 * 3); slopes of 4e-3 turn the normal, and the speed changes
    # by as much
    error = np.std((force.values - expected)[late]) / np.std(expected[late])
    assert error < 0.01
    assert np.std(expected[late]) > 100.0
