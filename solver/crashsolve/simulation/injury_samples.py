"""What the samples of a run are worth for measures of injury: filters, and the Severity Index.

The error of an index is the largest difference to that of every second sample, as of the measures
of crashpost.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crashsolve.channels.coarse import every_second
from crashsolve.channels.display import Product
from crashsolve.channels.functions import cfc, si
from crashsolve.channels.roles import CLASSES
from crashsolve.channels.term import Term
from crashsolve.deck.reading.deck import Deck
from crashsolve.output.files import Json

# an error beyond a twentieth of the index, or of a tenth of the limit of 1000, is a warning
LARGE_SHARE, SMALL_INDEX = 0.05, 100.0
ACCELERATION = Product.parse("m/s^2")


class Index(NamedTuple):
    """Severity Index of an accelerometer on a head, and its error by the samples."""

    sensor: str
    value: float
    error: float

    @property
    def is_uncertain(self) -> bool:
        return self.error > LARGE_SHARE * max(self.value, SMALL_INDEX)

    def words(self, interval: float) -> str:
        """The warning."""
        return (
            f"sensor '{self.sensor}': its Severity Index is {self.value:.4g}, and by every second "
            f"sample {self.error:.2g} off: the samples every {1e3 * interval:.4g} ms are too few; "
            "give a shorter output.history.interval"
        )


class InjurySamples:
    """Remarks and warnings of a finished run, whose files are in a folder."""

    def __init__(self, deck: Deck, folder: Path, interval: float) -> None:
        """`interval` [s] of the samples."""
        self._interval = interval
        sensors = deck.entries["sensors"].items()
        self._roles = {name: getattr(entry.card, "role", None) or "" for name, entry in sensors}
        self._indices = self._severity(folder / "history.h5")

    def remarks(self) -> Json:
        """Entries of status.json."""
        severity = [f"{one.sensor} {one.value:.5g} +- {one.error:.2g}" for one in self._indices]
        return {"severity": severity, "unfiltered": self._unfiltered()}

    def warnings(self) -> list[str]:
        """Heads whose index the samples do not give."""
        return [one.words(self._interval) for one in self._indices if one.is_uncertain]

    def _unfiltered(self) -> list[str]:
        """Sensors with a role whose filter class needs more samples, by class, in words."""
        sensors: dict[int, list[str]] = {}
        for name, role in self._roles.items():
            least = CLASSES.get(role)
            if least and self._interval > (1.0 + cfc.EQUAL) / (cfc.RATE * least):
                sensors.setdefault(least, []).append(name)
        return [
            f"CFC {least} needs {1e3 / (cfc.RATE * least):.3g} ms: {', '.join(names)}"
            for least, names in sorted(sensors.items())
        ]

    def _severity(self, history: Path) -> list[Index]:
        """The index of every head."""
        heads = [name for name, role in self._roles.items() if role == "head"]
        if not heads or not history.exists():
            return []
        return [
            Index(name, *_index(time, values))
            for name, time, values in _resultants(history, heads)
            if len(time) > 2
        ]


def _resultants(history: Path, heads: list[str]) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Name, times and resultant acceleration of each head."""
    import h5py

    with h5py.File(history) as file:
        for family in (file[name] for name in file if name.partition("-")[0] == "nodout"):
            for number, name in enumerate(family["ids"].asstr()):
                if name in heads and "resultant" in family:
                    time = family["time"][:]
                    rows = np.count_nonzero(np.isfinite(time))
                    yield str(name), time[:rows], family["resultant"][:rows, number]


def _index(time: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    lines = [every_second(time, values, first) for first in (0, 1)]
    own, *others = (_severity(time, one) for one in (values, *lines))
    return own, max(abs(other - own) for other in others)


def _severity(time: np.ndarray, values: np.ndarray) -> float:
    return float(si.apply(time, Term(values, ACCELERATION)).over(time)[-1])
