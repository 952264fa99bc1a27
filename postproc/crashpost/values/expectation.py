"""The deck's own test: the value expected by each `expect:` entry and that of the run.

passed  <=>  |computed - value| <= tolerance             (absolute)
             |computed - value| <= tolerance |value|     (relative)

Value and tolerance are compared and shown in the unit of the value found.
"""

from dataclasses import dataclass, replace

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.results.status import Json
from crashpost.results.table import number, text_table
from crashpost.values.accuracy import error_of
from crashsolve.channels.display import factor
from crashsolve.channels.series import Window
from crashsolve.channels.statistic import statistic, unit_of


@dataclass(frozen=True)
class Expectation:
    """One entry as stored in the result; without a unit its numbers are in the channel's own."""

    channel: str
    statistic: str
    value: float
    tolerance: float
    relative: bool = False
    unit: str = ""
    during: Window | None = None
    because: str = ""
    source: str = ""
    line: int = 0

    @property
    def allowed(self) -> float:
        """The largest deviation that passes."""
        return self.tolerance * abs(self.value) if self.relative else self.tolerance

    @property
    def tolerance_text(self) -> str:
        """The tolerance as people write it."""
        return f"{100 * self.tolerance:.4g} %" if self.relative else number(self.tolerance)

    @property
    def statistic_text(self) -> str:
        """The statistic with its time window."""
        return self.statistic_over("s")

    def statistic_over(self, time_unit: str) -> str:
        """The statistic with its time window in a unit."""
        if self.during is None:
            return self.statistic
        start, end = (time * factor("s", time_unit) for time in self.during)
        return f"{self.statistic}, {start:g} to {end:g} {time_unit}"

    def in_unit(self, unit: str) -> "Expectation":
        """The expectation in another unit; raises PostError where that measures something else."""
        size = factor(self.unit, unit) if self.unit else 1.0
        tolerance = self.tolerance * (1.0 if self.relative else size)
        return replace(self, value=self.value * size, tolerance=tolerance, unit=unit)


@dataclass(frozen=True)
class Verdict:
    """An expectation, the value found, and the reason where there is none."""

    expected: Expectation
    computed: float | None
    unit: str
    problem: str = ""
    error: float | None = None  # estimated by the run, in the same unit

    @property
    def deviation(self) -> float | None:
        """Found minus expected."""
        return None if self.computed is None else self.computed - self.expected.value

    def in_unit(self, unit: str, size: float) -> "Verdict":
        """The verdict with its numbers multiplied by `size`, for another unit."""
        expected, is_relative = self.expected, self.expected.relative
        tolerance = expected.tolerance * (1.0 if is_relative else size)
        expected = replace(expected, value=expected.value * size, tolerance=tolerance)
        computed, error = (None if v is None else v * size for v in (self.computed, self.error))
        return replace(self, expected=expected, computed=computed, error=error, unit=unit)

    @property
    def passed(self) -> bool:
        """Whether the deviation is within tolerance; never when nothing was found."""
        return self.deviation is not None and abs(self.deviation) <= self.expected.allowed


def expectations(result: Result) -> list[Expectation]:
    """The entries stored with a result; raises PostError when they are not as specified."""
    entries = result.stored_json("expect", list) or []
    try:
        return [_read(entry) for entry in entries]
    except (AttributeError, TypeError, ValueError, KeyError, OverflowError) as error:
        raise PostError(f"{result.file}: broken expect entry ({error})") from error


def check_expectations(result: Result) -> list[Verdict]:
    """All entries evaluated; a channel that does not exist is a failure with its reason."""
    return [_verdict(result, entry) for entry in expectations(result)]


def verdict_table(verdicts: list[Verdict]) -> str:
    """The verdicts as text, one line each, failures explained below."""
    header = (
        "channel statistic found error expected tolerance deviation unit because source verdict"
    )
    rows = [_row(verdict) for verdict in verdicts]
    table = text_table(header.split(), rows)
    problems = [f"FAIL {v.expected.channel}: {v.problem}" for v in verdicts if v.problem]
    return "\n".join([table, *problems])


def _read(entry: Json) -> Expectation:
    given = {name: part for name, part in entry.items() if part is not None}
    known = {name: given[name] for name in Expectation.__annotations__ if name in given}
    known["value"], known["tolerance"] = (float(known["value"]), float(known["tolerance"]))
    for name in ("channel", "statistic", "unit", "because", "source"):
        if not isinstance(known.get(name, ""), str):
            raise TypeError(f"{name} is no text")
    if "during" in known:
        first, last = known["during"]
        known["during"] = (float(first), float(last))
    return Expectation(**known)


def _verdict(result: Result, expected: Expectation) -> Verdict:
    try:
        series = result.series(expected.channel)
        value = statistic(series, expected.statistic, expected.during)
        unit = unit_of(expected.statistic, series.unit)
        error = error_of(result, expected.channel, expected.statistic, expected.during)
        return Verdict(expected.in_unit(unit), value, unit, error=error)
    except PostError as error:
        return Verdict(expected, None, "", str(error))


def _row(verdict: Verdict) -> list[str]:
    expected = verdict.expected
    return [
        expected.channel,
        expected.statistic_text,
        "-" if verdict.computed is None else f"{verdict.computed:.8g}",
        "-" if verdict.error is None else f"{verdict.error:.1e}",
        f"{expected.value:.8g}",
        expected.tolerance_text,
        "-" if verdict.deviation is None else f"{verdict.deviation:.2e}",
        verdict.unit,
        expected.because,
        expected.source,
        "pass" if verdict.passed else "FAIL",
    ]
