"""Claim: what the cubics of a formula miss of an acceleration is stated where a number reads it."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.estimate.estimator import estimate_in_memory
from crashsolve.estimate.formulas import acceleration_error


@pytest.mark.parametrize("pieces", [50, 333])
def test_the_error_of_a_second_derivative_is_found_from_the_cubics(pieces: int) -> None:
    x = np.linspace(0.0, 2.0 * pi, pieces + 1)
    # f'' of a cubic errs by h^2 f'''' / 12 at its ends
    exact = (x[1] - x[0]) ** 2 / 12.0
    error = acceleration_error(x, np.sin(x), np.cos(x), None)
    # f'''' of two cubics is that between them, and the largest f'' is its own
    assert error == pytest.approx(exact, rel=0.01)
    # about a root of sin, within three cubics of it
    near = acceleration_error(x, np.sin(x), np.cos(x), pi)
    assert near <= 4.0 * (x[1] - x[0]) * exact


def test_a_body_that_springs_carry_has_none_of_it(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text("""
control: {end_time: 0.35, integrator: radau_iia_5, tolerance: 1e-10}
bodies: {table: {mass: 0.5, inertia: [1, 1, 1]}, m: {mass: 5, inertia: [1, 1, 1]}}
curves: {p: {type: formula, expression: '0.01*(1 - cos(60*x))', from: 0, to: 1}}
joints:
  rail: {type: prismatic, b: table, at: [0, 0, 0], axis: [1, 0, 0]}
  drive: {type: translation_driver, joint: rail, curve: p}
springs: {s: {type: bushing, a: table, b: m, stiffness: [4500, 1, 1]}}
watch:
- {channel: rbdout.table.acceleration.x, statistic: final}
- {channel: rbdout.m.acceleration.x, statistic: final}
- {channel: jntforc.drive.force.x, statistic: final}
""")
    _, estimates, _ = estimate_in_memory(read_deck(path))
    t, forced, own, amplitude = 0.35, 60.0, 30.0, 0.01
    table = amplitude * forced**2 * np.cos(forced * t)
    # x'' + own^2 x = own^2 A (1 - cos(forced t)), from rest
    response = amplitude * own**2 / (own**2 - forced**2)
    mass = response * (forced**2 * np.cos(forced * t) - own**2 * np.cos(own * t))
    mass += amplitude * own**2 * np.cos(own * t)
    true = [table, mass, 0.5 * table + 5.0 * mass]
    for estimate, exact in zip(estimates, true, strict=True):
        assert estimate.value is not None and estimate.error is not None
        assert abs(estimate.value - exact) <= 10.0 * estimate.error
    assert ["accelerations" in estimate.how for estimate in estimates] == [True, False, True]
