"""Energies and momenta of the whole model, found among the `glstat` channels by their units.

    balance = 100 imbalance / largest          drift = 100 max|p(t) - p(0)| / max|p(t)|

Momentum drifts only where something outside pushes: gravity, ground reactions, loads.
"""

from dataclasses import dataclass

import numpy as np

from crashpost.expression import Series
from crashpost.result import Channel, Result
from crashpost.statistic import statistic
from crashpost.units import factor

# columns of glstat that sum up or scale the others
SUMS = ("imbalance", "largest", "initial")


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

    @property
    def drift(self) -> float:
        """Largest departure from the first sample."""
        values = self.series.values
        return float(np.max(np.abs(values - values[:1]), initial=0.0))


def energies(result: Result) -> list[Entry]:
    """Every energy of the model that is not zero throughout."""
    entries = [entry for entry in _entries(result, "J") if entry.largest > 0]
    return [entry for entry in entries if entry.label not in SUMS]


def momenta(result: Result) -> list[Entry]:
    """Linear momenta, then angular momenta."""
    return [*_entries(result, "kg m/s"), *_entries(result, "N s"), *_entries(result, "kg m^2/s")]


def balance_channel(result: Result) -> str:
    """The channel, or ratio of channels, of what is missing from the energies; "" when unknown."""
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


def momentum_drift(result: Result, unit: str = "kg m/s") -> float | None:
    """The largest change of momentum in % of its largest size, None when unknown or at rest."""
    entries = [entry for entry in momenta(result) if entry.channel.unit == unit]
    largest = max([entry.largest for entry in entries], default=0.0)
    return 100 * max(entry.drift for entry in entries) / largest if largest else None


def _entries(result: Result, unit: str) -> list[Entry]:
    channels = [channel for channel in result.channels("glstat.*") if channel.unit == unit]
    return [Entry(channel, result.series(channel.name)) for channel in channels]
