"""Words for one number of a channel, and the time window in which it is looked for."""

from crashsolve.channels import statistic as known
from crashsolve.channels.errors import ChannelError
from crashsolve.channels.folder import FUNCTIONS, STATISTICS, words_in
from crashsolve.channels.series import Window
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.words import choices

PATH = "path"  # no one number, but the whole history


def channel_reported() -> str:
    """Description of a channel of a question, for the manual."""
    functions = ", ".join(f"{word}()" for word in words_in(FUNCTIONS))
    return f"channel, or arithmetic of channels with {functions}; see theory/channels.md"


def words_reported() -> str:
    """The statistics as the manual lists them, without importing them."""
    words = ", ".join(words_in(STATISTICS))
    return f"{words}; `at` takes a time in seconds, as in at:0.25"


def known_statistic(text: str) -> str:
    """The word itself; refused when it names no statistic."""
    try:
        known.check(text)
    except ChannelError:
        refuse(f"unknown statistic '{text}'", choices(text, known.words(), "statistics"))
    return text


def check_window(statistic: str, during: Window | None) -> None:
    """Raises ValueError for a window that is empty, or of a statistic that reads one moment."""
    if during is None:
        return
    if not during[0] < during[1]:
        raise ValueError("during: must be [from, to], the earlier time first")
    if statistic and statistic != PATH and known.is_of_a_moment(statistic):
        raise ValueError(f"during: '{statistic}' reads one moment, which no window limits")
