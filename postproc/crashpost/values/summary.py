"""One screen about a result: status, model, energies, balances, peaks, warnings."""

from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

from crashpost.results import ledger, logbook
from crashpost.results.result import Result
from crashpost.results.table import number, text_table
from crashpost.values.accuracy import accuracy_table
from crashsolve.channels.display import factor

MAX_PEAKS = 40
# times of contacts, and what extremes are of
MOMENTS = ("first_touch", "last_release")
BASIS = "extremes of the samples; those named peak_ are of all steps"


def summary(result: Result) -> str:
    """The whole summary as text."""
    parts = [_heading(result), _model(result), _energies(result), _balances(result)]
    parts += [accuracy_table(result), _peaks(result), _warnings(result)]
    return "\n\n".join(part for part in parts if part)


def status_line(result: Result, time_unit: str = "s") -> str:
    """State, time reached and cost of the run in one line."""
    status = result.status
    words = [str(status.get("state", "unknown"))]
    if isinstance(status.get("time"), int | float):
        size = factor("s", time_unit)
        ends = (
            f"{number(t * size)} {time_unit}" for t in (status["time"], status.get("end_time") or 0)
        )
        words.append("t = " + " of ".join(ends))
    if status.get("cycle") is not None:
        words.append(f"{status['cycle']} cycles")
    if isinstance(status.get("cpu"), int | float):
        words.append(f"{status['cpu']:.2f} s CPU")
    return ", ".join(words)


class Peak(NamedTuple):
    """The extremes of a channel with the first time of each."""

    channel: str
    unit: str
    least: float
    least_time: float
    greatest: float
    greatest_time: float

    @property
    def cells(self) -> list[str]:
        """The row of a table."""
        return [self.channel, self.unit, *map(number, self[2:])]


def peaks(result: Result) -> Iterator[Peak]:
    """The peaks of every channel that moves, one by one as there may be many."""
    for family in result.families.values() if len(result.time) else ():
        columns = [(column, result.extremes(family, column)) for column in family.columns]
        for at, entity in enumerate(family.ids):
            for column, own in columns:
                # moments before the run stand for what has not been; events have the others
                if column.name not in MOMENTS and own.least[at] != own.greatest[at]:
                    name = f"{family.word}.{entity}.{column.name}"
                    least, greatest = float(own.least[at]), float(own.greatest[at])
                    times = result.time[own.least_row[at]], result.time[own.greatest_row[at]]
                    yield Peak(name, column.unit, least, times[0], greatest, times[1])


def _heading(result: Result) -> str:
    lines = [result.title, f"status   {status_line(result)}"]
    if result.status.get("message"):
        lines.append(f"message  {result.status['message']}")
    return "\n".join(lines)


def _model(result: Result) -> str:
    width = max(map(len, result.families), default=0)
    lines = [
        f"  {family.name:{width}} {len(family.ids):6} x {len(family.columns)} channels"
        for family in result.families.values()
    ]
    span = (
        f", {number(result.time[0])} s to {number(result.time[-1])} s" if len(result.time) else ""
    )
    chosen = [f"  by output.history.channels: {', '.join(result.chosen_channels)}"]
    lines += chosen if result.chosen_channels else []
    count = f"{len(result.time)} sample" + "s" * (len(result.time) != 1)
    return "\n".join([f"history  {count}{span}", *lines])


def _energies(result: Result) -> str:
    rows = [
        [
            entry.label,
            *map(number, (entry.series.values[0], entry.series.values[-1], entry.largest)),
        ]
        for entry in ledger.energies(result)
    ]
    return text_table(("energy", "initial J", "final J", "largest J"), rows) if rows else ""


def _balances(result: Result) -> str:
    names = {
        "energy balance": ledger.worst_balance(result),
        "momentum balance": ledger.worst_momentum(result),
        "angular momentum balance": ledger.worst_momentum(result, "angular_momentum_error"),
    }
    lines = [f"{name:24} {value:.3g} %" for name, value in names.items() if value is not None]
    return "\n".join(lines)


def _peaks(result: Result) -> str:
    moving = (peak for peak in peaks(result) if not peak.channel.startswith("glstat."))
    rows = [peak.cells for peak in islice(moving, MAX_PEAKS + 1)]
    if not rows:
        return ""
    table = text_table(("channel", "unit", "min", "at s", "max", "at s"), rows[:MAX_PEAKS])
    table += f"\n{BASIS}" if any(".peak_" in row[0] for row in rows) else ""
    return table + ("\n... and more; see peaks.txt" if len(rows) > MAX_PEAKS else "")


def _warnings(result: Result) -> str:
    lines = [f"{count:6} x  {text}" for count, text in logbook.warnings(result.log)]
    return "\n".join(["warnings", *lines]) if lines else "no warnings"
