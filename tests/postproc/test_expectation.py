"""The deck's own test, evaluated."""

import json
from pathlib import Path

import pytest
from small_results import SPEED, Command, expectation, two_cars, write_result, write_status

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.values.expectation import Expectation, Verdict, check_expectations, expectations

# masses 2 : 1, so an elastic impact leaves a third of the speed and gives four thirds
LEFT_OVER = expectation("rbdout.A.velocity.x", "final", SPEED / 3, 1e-9)


def result_expecting(folder: Path, *entries: object) -> Path:
    write_result(folder, two_cars(), expect=json.dumps(entries))
    write_status(folder)
    return folder


def test_a_run_that_meets_all_exits_with_0(tmp_path: Path, crashpost: Command) -> None:
    common = expectation("rbdout.A.velocity.x - 'rbdout.car-b.velocity.x'", "final", -SPEED, 1e-9)
    code, out, _ = crashpost("expect", result_expecting(tmp_path, LEFT_OVER, common))
    assert code == 0
    assert out.endswith("2 of 2 expectations met\n")


def test_one_failure_exits_with_1_and_shows_the_deviation(
    tmp_path: Path, crashpost: Command
) -> None:
    wrong = expectation("rbdout.A.velocity.x", "final", 4.0, 0.5, source="a guess")
    code, out, _ = crashpost("expect", result_expecting(tmp_path, LEFT_OVER, wrong))
    assert code == 1
    line = next(line for line in out.splitlines() if "a guess" in line)
    assert line.split()[2:7] == ["5", "-", "4", "0.5", "1.00e+00"]
    assert line.endswith("FAIL")
    assert out.endswith("1 of 2 expectations met\n")


@pytest.mark.parametrize(
    ("channel", "statistic"), [("rbdout.A.speed", "max"), ("rbdout.A.velocity.x", "at:9")]
)
def test_what_cannot_be_evaluated_fails_with_its_reason(
    tmp_path: Path, crashpost: Command, channel: str, statistic: str
) -> None:
    entry = expectation(channel, statistic, 0.0, 1e9)
    code, out, _ = crashpost("expect", result_expecting(tmp_path, entry))
    assert code == 1
    assert f"FAIL {channel}: " in out


def test_a_deck_that_expects_nothing_passes_and_says_so(cars: Path, crashpost: Command) -> None:
    assert crashpost("expect", cars) == (0, "the deck has no expectations\n", "")


@pytest.mark.parametrize("state", ["running", "stopped", "failed"])
def test_an_unfinished_run_is_judged_only_when_asked(
    tmp_path: Path, crashpost: Command, state: str
) -> None:
    folder = result_expecting(tmp_path, LEFT_OVER)
    write_status(folder, state)
    code, out, err = crashpost("expect", folder)
    assert (code, out) == (2, "")
    assert f"the run is not finished (state: {state})" in err
    assert crashpost("expect", folder, "--partial")[0] == 0


@pytest.mark.parametrize(
    ("value", "tolerance", "relative", "computed", "passed"),
    [
        (100.0, 1.0, False, 101.0, True),
        (100.0, 1.0, False, 101.0001, False),
        (100.0, 0.01, True, 99.0, True),
        (-100.0, 0.01, True, -101.5, False),
        (0.0, 0.0, False, 0.0, True),
        (1.0, 1e9, False, float("nan"), False),
        (1.0, 1e9, False, None, False),
    ],
)
def test_tolerances_are_closed_and_nothing_passes_without_a_number(
    value: float, tolerance: float, relative: bool, computed: float | None, passed: bool
) -> None:
    entry = Expectation("a.b.c", "max", value, tolerance, relative)
    assert Verdict(entry, computed, "m").passed is passed


@pytest.mark.parametrize(
    ("unit", "value", "tolerance", "passed"),
    [
        # the channel is in %, and its largest value is set to 5
        ({}, 5.05, 0.1, True),
        ({"unit": "1"}, 0.0505, 0.001, True),
        ({"unit": "1"}, 0.052, 0.001, False),
        ({"unit": "1"}, 5.0, 0.1, False),
        ({"unit": "1", "relative": True}, 0.0505, 0.02, True),
        ({"unit": "1", "relative": True}, 0.052, 0.02, False),
    ],
)
def test_a_channel_in_percent_is_judged_in_the_unit_of_the_entry(
    tmp_path: Path, unit: object, value: float, tolerance: float, passed: bool
) -> None:
    families = two_cars()
    families["glstat"][1]["energy/balance"][2][7] = 5.0
    entry = expectation("glstat.model.energy.balance", "max", value, tolerance, **unit)
    folder = write_result(tmp_path, families, expect=json.dumps([entry]))
    (verdict,) = check_expectations(Result(folder))
    assert verdict.passed is passed
    assert (verdict.computed, verdict.unit) == (5.0, "%")


@pytest.mark.parametrize(
    ("statistic", "unit", "passed"),
    [("max", "m/s", True), ("max", "m", False), ("argmax", "s", True), ("integral", "m", True)],
)
def test_a_value_of_another_dimension_fails_however_wide_the_tolerance(
    tmp_path: Path, statistic: str, unit: str, passed: bool
) -> None:
    entry = expectation("rbdout.A.velocity.x", statistic, 0.0, 1e9, unit=unit)
    (verdict,) = check_expectations(Result(result_expecting(tmp_path, entry)))
    assert verdict.passed is passed
    assert ("measure different things" in verdict.problem) is not passed


def test_a_time_window_limits_what_is_judged_and_is_shown(
    tmp_path: Path, crashpost: Command
) -> None:
    whole = expectation("rbdout.A.velocity.x", "min", SPEED / 3, 1e-9)
    early = expectation("rbdout.A.velocity.x", "min", 0.0, SPEED / 2, during=[0, 0.01])
    late = expectation("rbdout.A.velocity.x", "max", SPEED / 3, 0.1, during=[0.135, 0.1404])
    code, out, _ = crashpost("expect", result_expecting(tmp_path, whole, early, late))
    lines = out.splitlines()[2:]
    assert [line.split()[-1] for line in lines[:3]] == ["pass", "FAIL", "pass"]
    assert (code, "max, 0.135 to 0.1404 s" in lines[2]) == (1, True)


def test_a_window_the_run_has_not_reached_fails(tmp_path: Path, crashpost: Command) -> None:
    entry = expectation("rbdout.A.velocity.x", "max", 0.0, 1e9, during=[0, 0.2])
    code, out, _ = crashpost("expect", result_expecting(tmp_path, entry))
    assert code == 1
    assert "0 s to 0.2 s is outside the samples, 0 s to 0.140496 s" in out


def test_entries_may_hold_more_than_crashpost_reads(tmp_path: Path) -> None:
    entry = {**LEFT_OVER, "unit": None, "line": 12}
    (verdict,) = check_expectations(Result(result_expecting(tmp_path, entry)))
    assert verdict.passed
    assert verdict.expected.line == 12


@pytest.mark.parametrize(
    "entry", [{"channel": "a"}, {**LEFT_OVER, "value": "soon"}, {**LEFT_OVER, "during": [1]}, 3]
)
def test_broken_entries_are_refused(tmp_path: Path, entry: object) -> None:
    with pytest.raises(PostError, match="broken expect entry"):
        expectations(Result(result_expecting(tmp_path, entry)))
