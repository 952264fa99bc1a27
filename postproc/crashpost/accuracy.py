"""The estimated errors that a run has left in status.json, beside the numbers they belong to."""

from typing import Any

from crashpost.result import Result
from crashpost.statistic import Window
from crashpost.table import number, text_table

HEADER = ("watched channel", "value", "unit", "error", "of its scale", "how")


def watched(result: Result) -> list[dict[str, Any]]:
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
    rows = [_row(entry) for entry in watched(result)]
    return text_table(HEADER, rows) if rows else ""


def _row(entry: dict[str, Any]) -> list[str]:
    error, scale = entry.get("error"), entry.get("scale")
    relative = f"{error / scale:.1e}" if error is not None and scale else "-"
    name = f"{entry.get('channel')} {entry.get('statistic')}"
    if entry.get("during"):
        name += " from {:g} to {:g} s".format(*entry["during"])
    value = entry.get("value")
    return [
        name,
        "-" if value is None else number(value),
        str(entry.get("unit") or "-"),
        "-" if error is None else f"{error:.1e}",
        relative,
        str(entry.get("how", "")),
    ]
