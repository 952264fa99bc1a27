"""Moments of a run in words: `0`, `50ms`, `end`, `max:rcforc.buffers.normal`."""

import re
from typing import NamedTuple

import numpy as np

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashsolve.channels.display import factor
from crashsolve.channels.statistic import statistic

PEAKS = {"max": "argmax", "min": "argmin", "abs_max": "argmax"}
_NUMBER = re.compile(r"\s*([-+0-9.eE]+)\s*([A-Za-zµ]*)\s*$")


class Moment(NamedTuple):
    """A time [s], and in words why it was chosen; nothing for a plain time."""

    time: float
    reason: str


def strongest_contact(result: Result) -> str:
    """The channel of the contact with the largest force of all steps; none where nothing touches.

    Of samples alone where a result has no peaks of steps.
    """
    largest: dict[str, float] = {}
    for family in (f for f in result.families.values() if f.word == "rcforc"):
        for column in (c for c in family.columns if c.name in ("normal", "peak_normal")):
            peaks = result.extremes(family, column).greatest if len(result.time) else ()
            for entity, peak in zip(family.ids, peaks, strict=bool(len(peaks))):
                largest[str(entity)] = max(largest.get(str(entity), 0.0), float(peak))
    name = max(largest, key=lambda n: largest[n], default="")
    return f"rcforc.{name}.normal" if name and largest[name] > 0 else ""


def split(text: str) -> list[str]:
    """The moments of a list with commas; a comma within brackets or quotes divides nothing."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if letter in "'\"" and quote in ("", letter):
            quote = "" if quote else letter
        depth += {"(": 1, ")": -1}.get(letter, 0) if not quote else 0
        if letter == "," and depth == 0 and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def moment(result: Result, text: str, end: float) -> Moment:
    """Time that a word means; `end` is the last time that can be shown. Raises PostError."""
    word, colon, expression = text.strip().partition(":")
    if colon and word in PEAKS:
        series = result.series(f"abs({expression})" if word == "abs_max" else expression)
        size = {"max": "largest", "min": "least", "abs_max": "largest"}[word]
        return Moment(statistic(series, PEAKS[word]), f"{size} {expression.strip()}")
    if word in ("start", "end"):
        return Moment(float(result.time[0]) if word == "start" and len(result.time) else end, "")
    match = _NUMBER.match(text)
    try:
        time = float(match[1]) * factor(match[2] or "s", "s") if match else np.nan
    except ValueError:
        time = np.nan
    if not np.isfinite(time):
        raise PostError(
            f"'{text}' is no moment; write 0.05, 50ms, start, end, or max:, min: or abs_max: "
            "before a channel"
        )
    return Moment(time, "")
