"""Words for one number of a channel, and the time window in which it is looked for."""

import re

from crashsolve.deck.laws import choices
from crashsolve.deck.mistakes import refuse

STATISTICS = ("max", "min", "abs_max", "mean", "final", "integral", "argmax", "argmin")
PATH = "path"  # no one number, but the whole history
Window = tuple[float, float]

_AT = re.compile(r"at:[0-9]+\.?[0-9]*([eE][-+]?[0-9]+)?")


def known_statistic(text: str) -> str:
    """The word itself; refused when it names no statistic."""
    if text not in STATISTICS and not _AT.fullmatch(text):
        refuse(f"unknown statistic '{text}'", choices(text, (*STATISTICS, "at:T"), "statistics"))
    return text


def is_of_a_moment(statistic: str) -> bool:
    """Whether a statistic reads one moment of a history."""
    return statistic == "final" or statistic.startswith("at:")


def check_window(statistic: str, during: Window | None) -> None:
    """Raises ValueError for a window that is empty, or of a statistic that reads one moment."""
    if during is None:
        return
    if not during[0] < during[1]:
        raise ValueError("during: must be [from, to], the earlier time first")
    if is_of_a_moment(statistic):
        raise ValueError(f"during: '{statistic}' reads one moment, which no window limits")
