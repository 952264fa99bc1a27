"""A results folder, opened for reading: its history, and the views that scripts take of it.

`Result("trains.results").series("rcforc.left.force.normal")` is all a script needs.
"""

from typing import TYPE_CHECKING

from crashpost.results.answer import answer
from crashpost.results.frame import frame
from crashpost.results.history import Channel, Column, Family, History
from crashpost.results.meshes import scene
from crashsolve.channels.series import Window

if TYPE_CHECKING:
    from pandas import DataFrame
    from pyvista import MultiBlock

__all__ = ["Channel", "Column", "Family", "Result"]


class Result(History):
    """The result of one run; raises PostError when it cannot be read."""

    def value(
        self, channel: str, statistic: str, during: Window | None = None, unit: str = ""
    ) -> float:
        """A statistic such as max of a channel or expression, in `unit`; raises PostError."""
        return answer(self, channel, statistic, during, unit).value

    def frame(self, *channels: str) -> "DataFrame":
        """Channels, by name, pattern or expression, as a table of pandas over time [s]."""
        return frame(self, channels or ["*"])

    def mesh(self, time: float | None = None) -> "MultiBlock":
        """The model as meshes of pyvista in the state nearest to a time [s], or in the last."""
        return scene(self, time)
