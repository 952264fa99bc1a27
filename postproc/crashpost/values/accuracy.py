"""Estimated errors, steps and cost that a run has left in status.json."""

from collections.abc import Callable

from crashpost.results.result import Result
from crashpost.results.status import Json
from crashpost.results.table import number, text_table
from crashsolve.channels.display import factor
from crashsolve.channels.series import Window

HEADER = ("watched channel", "value", "unit", "error", "of its scale", "how")
# key in status.json, meaning, unit
COSTS = (
    ("cycle", "steps accepted", ""),
    ("rejected", "steps rejected", ""),
    ("constraint_position", "constraint error in position, over the model's size", ""),
    ("constraint_velocity", "constraint error in velocity, over the model's size", "1/s"),
    ("energy_balance", "energy balance at the end", "%"),
    ("real_time_factor", "CPU time per simulated second", "s"),
)


def watched(result: Result) -> list[Json]:
    """The entries of the watched channels; none of a run that estimated nothing."""
    entries = result.status.get("watched")
    return [e for e in entries if isinstance(e, dict)] if isinstance(entries, list) else []


def error_of(result: Result, channel: str, statistic: str, during: Window | None) -> float | None:
    """Estimated error of a statistic in SI; None where it was not estimated."""
    for entry in watched(result):
        window = tuple(entry.get("during") or ())
        if (entry.get("channel"), entry.get("statistic"), window) == (
            channel,
            statistic,
            during or (),
        ):
            error = entry.get("error")
            return float(error) if isinstance(error, int | float) else None
    return None


def accuracy_table(result: Result) -> str:
    """The watched channels as text, empty without any."""
    rows = accuracy_rows(result)
    return text_table(HEADER, rows) if rows else ""


def accuracy_rows(
    result: Result, shown: Callable[[str], tuple[str, float]] = lambda unit: (unit, 1.0)
) -> list[list[str]]:
    """A row for each watched channel, under HEADER.

    `shown` gives for a unit the one to show numbers in, and their factor.
    """
    return [_row(entry, shown) for entry in watched(result)]


def worst_error(result: Result) -> float | None:
    """Largest estimated error over the scale of its channel; None where nothing was estimated."""
    shares = [_relative(entry) for entry in watched(result)]
    return max((share for share in shares if share is not None), default=None)


def cost_rows(result: Result, time_unit: str) -> list[list[str]]:
    """Steps, errors of the constraints and CPU time [s], each with its name; those that exist."""
    status = result.status
    rows = [[label, _reported(status.get(key), unit)] for key, label, unit in COSTS]
    steps, size = status.get("average_step") or {}, factor("s", time_unit)
    rows += [
        [f"average step {phase} contact", _reported(step * size, time_unit)]
        for phase, step in steps.items()
        if isinstance(step, int | float)
    ]
    stages = status.get("cpu_stages") or {}
    rows += [[f"CPU time, {stage}", _reported(seconds, "s")] for stage, seconds in stages.items()]
    return [row for row in rows if row[1]]


def _row(entry: Json, shown: Callable[[str], tuple[str, float]]) -> list[str]:
    error, relative = entry.get("error"), _relative(entry)
    name = f"{entry.get('channel')} {entry.get('statistic')}"
    if entry.get("during"):
        time_unit, size = shown("s")
        name += " from {:g} to {:g} ".format(*(t * size for t in entry["during"])) + time_unit
    value = entry.get("value")
    unit, size = shown(str(entry.get("unit") or ""))
    return [
        name,
        "-" if value is None else number(value * size),
        unit or "-",
        "-" if error is None else f"{error * size:.1e}",
        "-" if relative is None else f"{relative:.1e}",
        str(entry.get("how", "")),
    ]


def _relative(entry: Json) -> float | None:
    """Error over scale."""
    error, scale = entry.get("error"), entry.get("scale")
    return None if error is None or not scale else float(error) / float(scale)


def _reported(value: object, unit: str) -> str:
    """A number with its unit, empty where the run has none."""
    if not isinstance(value, int | float):
        return ""
    return f"{value if isinstance(value, int) else number(value)} {unit}".rstrip()
