"""Histories as a table of pandas: a row for each sample, a column for each channel."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from crashpost.errors import PostError
from crashpost.results.choice import channels
from crashpost.results.history import History

if TYPE_CHECKING:
    from pandas import DataFrame


def frame(result: History, words: Sequence[str]) -> "DataFrame":
    """The channels that the words name over time [s]; `attrs["units"]` has their units.

    NaN where an expression divides by zero. Raises PostError for a word that names nothing, and
    without pandas.
    """
    try:
        import pandas as pd
    except ImportError:
        raise PostError("tables need pandas: pip install 'crashsolve[frame]'") from None
    series = {name: result.series(name) for name in channels(result, words)}
    table = pd.DataFrame(
        {name: one.values for name, one in series.items()},
        index=pd.Index(result.time, name="time"),
    )
    table.attrs["units"] = {name: one.unit for name, one in series.items()}
    return table
