"""One number of a result, in the requested unit, with its remark."""

from typing import NamedTuple

from crashpost.results.history import History
from crashsolve.channels.display import factor
from crashsolve.channels.series import Window
from crashsolve.channels.statistic import remark, statistic, unit_of


class Answer(NamedTuple):
    """A number with its unit; `remark` states its basis, where it is not samples alone."""

    value: float
    unit: str
    remark: str = ""


def answer(
    result: History, channel: str, word: str, during: Window | None = None, unit: str | None = None
) -> Answer:
    """The statistic `word` of a channel or expression, in `unit`; raises PostError."""
    series = result.series(channel)
    value, own = statistic(series, word, during), unit_of(word, series.unit)
    size = factor(own, unit) if unit else 1.0
    return Answer(value * size, unit or own, remark(series, word))
