"""Energies and momenta of the whole model, found among the `glstat` channels by their quantity.

    balance = 100 imbalance / largest

What is missing from the momenta is stored by the run, which knows the impulses from outside.
"""

from dataclasses import dataclass

import numpy as np

from crashpost.results.result import Channel, Result
from crashsolve.channels.display import factor, measure_the_same
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import statistic

MOMENTUM, ANGULAR_MOMENTUM = "N s", "N m s"
# columns of glstat that sum up or scale the others
SUMS = ("imbalance", "largest", "initial")
# present energies and their sum, then losses, then the work from outside
ORDER = (
    *("kinetic", "potential", "internal", "elastic", "hourglass", "drilling"),
    *("spring stored", "hinge stored", "joint stored", "brake stored"),
    *("contact stored", "friction stored"),
    "mechanical",
    *("plastic", "part damping", "eroded", "spring dissipated", "hinge dissipated"),
    *("joint dissipated", "brake dissipated", "contact dissipated", "friction dissipated"),
    *("external work", "driver work"),
)


@dataclass(frozen=True)
class Entry:
    """One conserved or exchanged quantity over the run."""

    channel: Channel
    series: Series

    @property
    def label(self) -> str:
        """The last word of the channel name, in plain words."""
        return self.channel.name.rsplit(".", 1)[-1].replace("_", " ")

    @property
    def largest(self) -> float:
        """Largest size over the run."""
        return float(np.max(np.abs(self.series.values), initial=0.0))


def energies(result: Result) -> list[Entry]:
    """Every energy of the model that is not zero throughout."""
    entries = [entry for entry in _entries(result, "J") if entry.largest > 0]
    entries = [entry for entry in entries if entry.label not in SUMS]
    return sorted(entries, key=lambda e: ORDER.index(e.label) if e.label in ORDER else len(ORDER))


def momenta(result: Result, unit: str = MOMENTUM) -> list[Entry]:
    """Components of the linear or angular momentum that are not zero throughout."""
    return [entry for entry in _entries(result, unit) if entry.largest > 0]


def balance_channel(result: Result) -> str:
    """The channel, or ratio of channels, of the error of the energy balance; "" when unknown."""
    percent = [e for e in _entries(result, "%") if "balance" in e.channel.name]
    if percent:
        return percent[0].channel.name
    sums = {entry.label: entry for entry in _entries(result, "J")}
    if not {"imbalance", "largest"} <= sums.keys() or not np.all(sums["largest"].series.values):
        return ""
    return f"'{sums['imbalance'].channel.name}' / '{sums['largest'].channel.name}'"


def worst_balance(result: Result) -> float | None:
    """The largest imbalance in %, None when unknown."""
    channel = balance_channel(result)
    if not channel or not len(result.time):
        return None
    series = result.series(channel)
    return statistic(series, "abs_max") * factor(series.unit, "%")


def worst_momentum(result: Result, name: str = "momentum_error") -> float | None:
    """The largest momentum not accounted for, in % of its largest size; None when unknown."""
    channel = next(result.channels(f"glstat.*.{name}"), None)
    if channel is None or not len(result.time):
        return None
    return statistic(result.series(channel.name), "abs_max") * factor(channel.unit, "%")


def _entries(result: Result, unit: str) -> list[Entry]:
    channels = [c for c in result.channels("glstat.*") if measure_the_same(c.unit, unit)]
    return [Entry(channel, result.series(channel.name)) for channel in channels]
