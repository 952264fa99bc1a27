"""One number of a time history, by its word: `max`, `mean`, `at:0.25`.

A word is a file of the folder `statistics`. What such a file may hold:

    value(series)        the number of the samples as they are
    refined(series)      the number of the smooth history behind them; value where absent
    unresolved(series)   uncertainty of it by sampling; 0 where absent
    unit(unit)           unit of the number; that of the values where absent
    scale(series, size)  reference value of errors of the number, `size` being the largest
                         magnitude of the history; `size` where absent
    remark(series)       note shown beside the number; none where absent
    IS_OF_A_MOMENT       it reads one moment, which no time window limits
    IS_A_TIME            the number is a time of the history
    ARGUMENT             meaning of the number after the word and a colon [s]: the second argument
    of all functions

The difference of value and refined is the estimated error of sampling.
"""

import math
from types import ModuleType

import numpy as np

from crashsolve.channels.errors import ChannelError, unknown
from crashsolve.channels.folder import STATISTICS, module_of, words_in
from crashsolve.channels.series import Series, Window, covered


def words() -> list[str]:
    """All statistics as a user writes them, such as `max` and `at:T`."""
    return [_written(word) for word in words_in(STATISTICS)]


def _written(word: str) -> str:
    argument = getattr(module_of(STATISTICS, word), "ARGUMENT", "")
    return f"{word}:{argument}" if argument else word


def check(text: str) -> None:
    """Raises ChannelError for a text that names no statistic."""
    _read(text)


def statistic(series: Series, text: str, during: Window | None = None) -> float:
    """The number called `text` of a series or its part in a window; raises ChannelError."""
    module, arguments = _read(text)
    if during and is_of_a_moment(text):
        raise ChannelError(f"'{text}' reads one moment, which no time window limits")
    series = covered(series, during)
    if not len(series.values):
        raise ChannelError("the channel holds no samples yet")
    if is_of_a_moment(text):
        value = float(module.value(series, *arguments))
        if math.isnan(value):
            raise ChannelError("division by zero at that time")
        return value
    undefined = np.flatnonzero(np.isnan(series.values))
    if len(undefined):
        moment = series.time[undefined[0]]
        raise ChannelError(
            f"division by zero at t = {moment:g} s; ask for a time window without it"
        )
    return float(module.value(series, *arguments))


def plain(series: Series, text: str) -> float:
    """The number of the samples as they are, NaN where they have none; raises ChannelError."""
    module, arguments = _read(text)
    return float(module.value(series, *arguments))


def refined(series: Series, text: str) -> float:
    """The number of the smooth history behind the samples; raises ChannelError."""
    module, arguments = _read(text)
    return float(getattr(module, "refined", module.value)(series, *arguments))


def unresolved(series: Series, text: str) -> float:
    """Uncertainty of the number by sampling, in its unit; 0 without any."""
    module, arguments = _read(text)
    function = getattr(module, "unresolved", None)
    return float(function(series, *arguments)) if function else 0.0


def scale(series: Series, text: str, size: float) -> float:
    """Scale of relative errors of the number; `size` is the history's largest magnitude."""
    module, _ = _read(text)
    function = getattr(module, "scale", None)
    return float(function(series, size)) if function else size


def remark(series: Series, text: str) -> str:
    """Remark to show beside the number; "" for most."""
    module, arguments = _read(text)
    function = getattr(module, "remark", None)
    return str(function(series, *arguments)) if function else ""


def unit_of(text: str, unit: str) -> str:
    """The unit of a statistic of a channel that has `unit`."""
    function = getattr(_read(text)[0], "unit", None)
    return str(function(unit)) if function else unit


def is_of_a_moment(text: str) -> bool:
    """Whether a statistic reads one moment of a history."""
    return bool(getattr(_read(text)[0], "IS_OF_A_MOMENT", False))


def is_a_time(text: str) -> bool:
    """Whether a statistic is a time of the history."""
    return bool(getattr(_read(text)[0], "IS_A_TIME", False))


def requested_moment(text: str) -> float | None:
    """The time [s] that a statistic such as at:0.25 names; None of others."""
    module, arguments = _read(text)
    return arguments[0] if arguments and is_of_a_moment(text) else None


def _read(text: str) -> tuple[ModuleType, tuple[float, ...]]:
    """The file of a statistic and its argument, if any; raises ChannelError."""
    word, colon, given = text.partition(":")
    if word not in words_in(STATISTICS):
        raise unknown("statistic", text, words())
    module = module_of(STATISTICS, word)
    argument = getattr(module, "ARGUMENT", "")
    if not argument:
        if colon:
            raise unknown("statistic", text, words())
        return module, ()
    try:
        number = float(given)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ChannelError(f"'{text}' is not a time; write for instance {word}:0.25 (seconds)")
    return module, (number,)
