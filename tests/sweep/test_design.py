"""Claim: designs and distributions are what their names say; indices are those of closed forms."""

import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crashpost.sweeps import table as sweep_table
from crashpost.sweeps.effects import Indices, indices_of, main_effect
from crashpost.sweeps.effects_table import (
    EFFECTS,
    EFFECTS_HEADER,
    INDICES,
    INDICES_HEADER,
    write_tables,
)
from crashsolve.sweep.axis import Axis
from crashsolve.sweep.design import points_of
from crashsolve.sweep.plan import Design, Measure, Plan, PlanCard

MEASURE = Measure(channel="a.b.c", statistic="max")


def plan(design: Mapping[str, Any], **axes: Mapping[str, Any]) -> Plan:
    card = PlanCard.model_construct(design=Design(**design), measure=(MEASURE,))
    return Plan(Path("plan.yaml"), card, {name: Axis(**axis) for name, axis in axes.items()}, {})


def numbers(design: Mapping[str, Any], **axes: Mapping[str, Any]) -> np.ndarray:
    """Values of all runs, a column for each parameter."""
    points = points_of(plan(design, **axes))
    return np.array([[float(text) for text in point.values()] for point in points])


def test_a_grid_is_every_value_with_every_other() -> None:
    points = points_of(
        plan(
            {"type": "grid"},
            a={"values": ("x", 2, "3 mm")},
            b={"from": 1, "to": 100, "count": 3, "distribution": "log_uniform"},
            c={"from": 0, "to": 0.3, "count": 4},
        )
    )
    assert len(points) == 36
    assert [point["c"] for point in points[:5]] == ["0.0", "0.1", "0.2", "0.3", "0.0"]
    assert [point["b"] for point in points[:12:4]] == ["1.0", "10.0", "100.0"]
    assert [point["a"] for point in points[::12]] == ["x", "2", "3 mm"]


def test_a_list_takes_first_values_together() -> None:
    points = points_of(plan({"type": "list"}, a={"values": (1, 2)}, b={"values": ("p", True)}))
    assert points == [{"a": "1", "b": "p"}, {"a": "2", "b": "true"}]


def test_each_share_of_a_latin_hypercube_holds_one_value() -> None:
    n = 20
    design = {"type": "latin_hypercube", "runs": n}
    points = numbers(design, a={"from": 0, "to": 1}, b={"from": -1, "to": 3})
    assert sorted(np.floor(points[:, 0] * n)) == list(range(n))
    assert sorted(np.floor((points[:, 1] + 1) / 4 * n)) == list(range(n))


def test_a_sobol_sequence_fills_every_cell_and_grows_by_itself() -> None:
    axes: dict[str, Any] = {"a": {"from": 0, "to": 1}, "b": {"from": 0, "to": 1}}
    points = numbers({"type": "sobol", "runs": 64}, **axes)
    # a (0, 6, 2)-net in base 2: one point in every cell of 8 by 8
    assert len({(int(8 * a), int(8 * b)) for a, b in points}) == 64
    assert (numbers({"type": "sobol", "runs": 32}, **axes) == points[:32]).all()
    assert (numbers({"type": "sobol", "runs": 64, "seed": 2}, **axes) != points).any()


# fields of an axis; mean and deviation in closed form
DISTRIBUTIONS: dict[str, tuple[dict[str, Any], float, float]] = {
    "uniform": ({"from": 1, "to": 3}, 2.0, 2.0 / math.sqrt(12.0)),
    "log": (
        {"from": 1, "to": math.e, "distribution": "log_uniform"},
        *(math.e - 1.0, math.sqrt((math.e**2 - 1.0) / 2.0 - (math.e - 1.0) ** 2)),
    ),
    "normal": ({"distribution": "normal", "mean": 5, "deviation": 2}, 5.0, 2.0),
    # half of a normal distribution: Johnson, Kotz and Balakrishnan (1994), section 13.10
    "half": (
        {"distribution": "normal", "mean": 0, "deviation": 1, "from": 0},
        *(math.sqrt(2.0 / math.pi), math.sqrt(1.0 - 2.0 / math.pi)),
    ),
    "lognormal": ({"distribution": "lognormal", "mean": 3, "deviation": 1}, 3.0, 1.0),
    "triangular": (
        {"distribution": "triangular", "from": 0, "to": 4, "peak": 1},
        *(5.0 / 3.0, math.sqrt((16.0 + 1.0 - 4.0) / 18.0)),
    ),
    "whole": ({"from": 1, "to": 6, "whole": True}, 3.5, math.sqrt(35.0 / 12.0)),
}


@pytest.mark.parametrize("name", DISTRIBUTIONS)
def test_drawn_values_have_mean_and_deviation_of_their_distribution(name: str) -> None:
    fields, mean, deviation = DISTRIBUTIONS[name]
    axis = Axis(**fields)
    n = 20_000
    x = np.array([float(axis.text((i + 0.5) / n)) for i in range(n)])
    # the midpoint rule of the quantile function; what it lacks of the tails is below 1e-3 here
    assert x.mean() == pytest.approx(mean, rel=1e-3)
    assert x.std() == pytest.approx(deviation, rel=2e-3)
    assert (np.diff(x) >= 0.0).all()


def ishigami(x: np.ndarray) -> np.ndarray:
    """Ishigami and Homma (1990): sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1."""
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def test_sobol_indices_of_a_known_function() -> None:
    axis = {"from": -math.pi, "to": math.pi}
    x = numbers({"type": "saltelli", "runs": 1024}, a=axis, b=axis, c=axis)
    y = ishigami(x)
    # a run that failed takes its block with it, and nothing else
    y[7] = np.nan
    analysis = indices_of(y, 3)
    assert isinstance(analysis, Indices)
    assert (analysis.blocks, analysis.lost) == (1023, 1)
    # in closed form; within three times half of the 95 % interval that goes with each
    first, total = (0.3139, 0.4424, 0.0), (0.5576, 0.4424, 0.2437)
    for known, values, errors in (
        (first, analysis.first, analysis.first_errors),
        (total, analysis.total, analysis.total_errors),
    ):
        assert np.abs(np.subtract(values, known)).max() < 3.0 * max(errors) < 0.3
    assert np.abs(np.subtract(values, known) / errors).max() < 3.0


def test_indices_are_not_reported_too_little() -> None:
    assert "the measure does not vary" in str(indices_of(np.ones(5 * 16), 3))
    y = np.arange(80.0)
    y[:: 5 * 2] = np.nan
    assert isinstance(indices_of(y, 3), Indices)
    y[::5] = np.nan
    assert "0 of 16 blocks of runs are complete" in str(indices_of(y, 3))


def test_main_effects_are_means_with_standard_errors_and_failures_do_not_count() -> None:
    effect = main_effect([1, 2, 1, 2, 1], [1.0, 4.0, 3.0, 4.0, math.nan])
    assert (effect.at, effect.means, effect.counts) == ([1.0, 2.0], [2.0, 4.0], [2, 2])
    assert effect.errors == [1.0, 0.0]
    words = main_effect(["b", "a", "b"], [1.0, 2.0, 5.0])
    assert (words.at, words.means) == (["b", "a"], [3.0, 2.0])
    assert math.isnan(words.errors[1])
    many = main_effect(list(range(80)), list(map(float, range(80))))
    assert many.counts == [10] * 8
    assert many.means == pytest.approx([4.5 + 10 * k for k in range(8)])


def test_indices_and_main_effects_are_tables(tmp_path: Path) -> None:
    """The numbers of the pictures, in files and in print."""
    span = {"from": 0.0, "to": 1.0}
    x = numbers({"type": "saltelli", "runs": 64}, a=span, b=span)
    axes = [sweep_table.Axis(name, "m", is_of_numbers=True, scale="linear") for name in "ab"]
    rows = [
        sweep_table.Row(k, list(map(float, row)), "finished", measured=[3.0 * float(row[0])])
        for k, row in enumerate(x, start=1)
    ]
    measures = [sweep_table.Measure("peak", {}, "N")]
    sweep = sweep_table.Sweep(tmp_path, "s", "saltelli", axes, measures, rows)
    said = "\n".join(write_tables(sweep, tmp_path))
    for name, header, count in ((EFFECTS, EFFECTS_HEADER, 16), (INDICES, INDICES_HEADER, 2)):
        with (tmp_path / name).open(newline="") as file:
            table = list(csv.reader(file))
        assert tuple(table[0]) == header and len(table) == count + 1
        assert str(tmp_path / name) in said and all(cell in said for cell in table[1])
    # only a acts: both of its indices are 1, those of b are 0
    first, total = ([float(row[k]) for row in table[1:]] for k in (2, 4))
    assert (first[0], total[0]) == pytest.approx((1.0, 1.0), abs=0.05) and total[1] == 0.0
    # a list of runs has no indices, and keeps none of another design
    sweep.design = "list"
    write_tables(sweep, tmp_path)
    assert (tmp_path / EFFECTS).exists() and not (tmp_path / INDICES).exists()
