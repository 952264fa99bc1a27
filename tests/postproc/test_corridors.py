"""Corridors: how long a history is inside and how far it leaves, beside closed forms."""

import math
from pathlib import Path

import numpy as np
import pytest
from small_results import Command, write_result

from crashpost.compare.corridors import compare_with_corridor
from crashpost.compare.references import comparisons
from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.values.figure import Figure, Reference

X = np.linspace(0.0, 1.0, 2001)
SINE = X, np.sin(2.0 * math.pi * X)


def border(level: float) -> tuple[np.ndarray, np.ndarray]:
    return np.array([0.0, 1.0]), np.array([level, level])


def test_a_sine_between_levels() -> None:
    rated = compare_with_corridor(SINE, border(-0.5), border(2.0))
    # sin < -1/2 for a third of the period; lines between samples err by (pi h)^2 / 2 = 1.2e-6
    assert rated.inside == pytest.approx(2.0 / 3.0, abs=2e-6)
    assert rated.excess == pytest.approx(0.5, abs=2e-6)
    assert rated.at == pytest.approx(0.75, abs=1e-9)


def test_one_that_never_leaves_and_one_that_is_never_inside() -> None:
    assert compare_with_corridor(SINE, border(-1.0), border(1.0)).inside == 1.0
    assert compare_with_corridor(SINE, border(-1.0), border(1.0)).excess == 0.0
    outside = compare_with_corridor(SINE, border(3.0), border(4.0))
    assert (outside.inside, outside.excess) == (0.0, pytest.approx(4.0))


def test_corners_of_borders_count_where_there_are_no_samples() -> None:
    peak = np.array([0.0, 0.25, 1.0]), np.array([0.0, 2.0, 0.0])
    flat = np.array([0.0, 1.0]), np.array([1.0, 1.0])
    # the lower border is above 1 from 1/8 to 5/8
    rated = compare_with_corridor(flat, peak, border(9.0))
    assert (rated.inside, rated.excess, rated.at) == (0.5, 1.0, 0.25)


def test_only_the_time_that_both_cover_counts() -> None:
    early = np.array([-5.0, 0.75]), np.array([-0.5, -0.5])
    # of 0 to 3/4, sin is below -1/2 from 7/12 on
    assert compare_with_corridor(SINE, early, border(2.0)).inside == pytest.approx(
        7.0 / 9.0, abs=2e-6
    )
    assert compare_with_corridor(SINE, border(-0.5), border(2.0), (0.0, 0.5)).inside == 1.0
    with pytest.raises(PostError, match="no time in common"):
        compare_with_corridor(SINE, (np.array([2.0, 3.0]), np.zeros(2)), border(2.0))


def sine_result(folder: Path) -> Path:
    values = 1000.0 * SINE[1][:, None]
    write_result(folder, {"rcforc": (["wall"], {"normal": ("N", "", values)})}, X)
    return folder


def test_a_reference_of_a_figure_is_compared(tmp_path: Path) -> None:
    points = ((0.0, -0.5), (1000.0, -0.5)), ((0.0, 2.0), (1000.0, 2.0))
    reference = Reference(
        "tests", "corridor", points=points[0], upper=points[1], channel="rcforc.wall.normal"
    )
    figure = Figure("Wall", (), x_unit="ms", y_unit="kN", reference=(reference,))
    (compared,) = comparisons(Result(sine_result(tmp_path)), figure)
    assert compared.computed == pytest.approx(0.5, abs=2e-6)
    assert compared.unit == "kN"
    assert compared.missed is True
    assert "inside for 66.67 % of the time" in compared.label


def test_compare_says_how_a_result_keeps_to_the_corridor_of_a_test(
    crashpost: Command, tmp_path: Path
) -> None:
    folder = sine_result(tmp_path / "run.results")
    test = tmp_path / "sled.csv"
    test.write_text("time [ms], lower [kN], upper [kN]\n0, -0.5, 2\n1000, -0.5, 2\n", "utf-8")
    code, reported, _ = crashpost("compare", folder, "rcforc.wall.normal", "--test", test)
    assert code == 1
    assert "66.67 %" in reported
    test.write_text("time [ms], lower [kN], upper [kN]\n0, -2, 2\n1000, -2, 2\n", "utf-8")
    code, reported, _ = crashpost("compare", folder, "rcforc.wall.normal", "--test", test)
    assert (code, "100 %" in reported) == (0, True)
