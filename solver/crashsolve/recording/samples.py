"""Samples of the watched channels of a run, from memory or from its file."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.deck.words import choices
from crashsolve.output.channels import Family

# channels of glstat that measure the run and not the model: they are errors themselves
OF_THE_RUN: tuple[str, ...] = (
    "balance",
    "momentum_error",
    "angular_momentum_error",
    "residual",
    "step",
    "cycle",
)
OF_THE_RUN += ("energy.imbalance", "energy.largest")
# prefix of channels that contain the largest value of any step so far
LARGEST_SO_FAR = "peak_"


class Channel(NamedTuple):
    """Position of a channel: family, number of the entity, and the columns of its vector."""

    name: str
    family: Family
    entity: int
    column: int

    @property
    def unit(self) -> str:
        return self.family.columns[self.column].unit

    @property
    def siblings(self) -> list[int]:
        """The columns of the vector of which this is a component."""
        own = self.family.columns[self.column]
        return [
            i
            for i, column in enumerate(self.family.columns)
            if column.quantity == own.quantity
            and column.unit == own.unit
            and (bool(own.component) or i == self.column)
        ]

    @property
    def followed(self) -> "Channel | None":
        """The channel whose largest value this channel contains; None for other channels."""
        before, _, last = self.name.rpartition(".")
        if not last.startswith(LARGEST_SO_FAR):
            return None
        return _channel(f"{before}.{last.removeprefix(LARGEST_SO_FAR)}", [self.family])

    @property
    def is_of_the_run(self) -> bool:
        """Whether it measures the run and not the model."""
        return self.family.word == "glstat" and self.name.split(".", 2)[2] in OF_THE_RUN


@dataclass
class Samples:
    """Samples of channels during one run: times, values of each, and of the vector around it.

    `cycles` are its steps, `cpu` [s] its CPU time, `units` those of the channels; `step_times`
    are times of samples that are steps of this run (recording/resampling.py).
    """

    time: np.ndarray
    values: dict[str, np.ndarray]
    size: dict[str, np.ndarray] = field(default_factory=dict)
    cycles: int = 0
    cpu: float = 0.0
    units: dict[str, str] = field(default_factory=dict)
    step_times: np.ndarray = field(default_factory=lambda: np.empty(0))

    def series(self, expression: str) -> Series:
        """The history of a channel or an expression; raises ChannelError."""
        name = expression.strip()
        if name in self.values:
            return self._channel(name)
        from crashsolve.channels.expression import evaluate

        return evaluate(expression, self._channel)

    def _channel(self, name: str) -> Series:
        if name == "time":
            return Series(self.time, self.time, "s")
        return Series(self.time, self.values[name], self.units.get(name, ""))

    def at(self, times: np.ndarray, with_steps: bool = False) -> "Samples":
        """These samples at some of the times (n,) [s], and at its `step_times` if requested."""
        kept = are_among(self.time, times)
        if with_steps:
            kept |= are_among(self.time, self.step_times)
        values = {name: history[kept] for name, history in self.values.items()}
        return Samples(self.time[kept], values, {}, self.cycles, self.cpu, self.units)


def are_among(times: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Whether each of the times (n,) is one of the others (m,), which ascend.

    np.isin and np.intersect1d load numpy.ma, as np.unique does (foundation/distinct.py).
    """
    first = np.searchsorted(others, times)
    return first < np.searchsorted(others, times, side="right")


def find(expression: str, families: Sequence[Family]) -> list[Channel]:
    """The channels of an expression. Raises ValueError for a name that does not exist."""
    whole = _channel(expression.strip(), families)
    if whole is not None:
        return [whole]
    # most are names
    from crashsolve.channels.expression import channels_in

    channels = []
    for name in channels_in(expression):
        channel = _channel(name, families)
        if channel is None:
            raise ValueError(_unknown(name, families))
        channels.append(channel)
    return channels


def needed_for(channels: Iterable[Channel]) -> set[str]:
    """Names of channels with all components of their vectors, and of those that they follow."""
    followed = [(channel, channel.followed) for channel in channels]
    every = [channel for pair in followed for channel in pair if channel is not None]
    return {c.family.channel(c.entity, column) for c in every for column in c.siblings}


def gather(
    time: Iterable[float], blocks: Sequence[dict[str, np.ndarray]], channels: Sequence[Channel]
) -> Samples:
    """Samples of channels at times [s], from blocks (samples, ids, columns) as of Histories."""
    samples = Samples(np.array(list(time)), {})
    for channel in channels:
        parts = [values[channel.family.name][:, channel.entity] for values in blocks]
        block = np.concatenate(parts)
        _add(samples, channel, block)
    return samples


def read(path: Path, channels: Sequence[Channel]) -> Samples:
    """Samples of channels from the history of a run."""
    import h5py

    with h5py.File(path, "r") as file:
        times = file[channels[0].family.name]["time"][:]
        samples = Samples(times[np.isfinite(times)], {})
        # components of a vector have the same siblings
        known: dict[tuple[str, int], np.ndarray] = {}
        for channel in channels:
            columns = channel.family.columns
            block = np.zeros((len(samples.time), len(columns)))
            for i in channel.siblings:
                key = f"{channel.family.name}/{columns[i].path}", channel.entity
                if key not in known:
                    known[key] = file[key[0]][: len(block), channel.entity]
                block[:, i] = known[key]
            _add(samples, channel, block)
    return samples


def _add(samples: Samples, channel: Channel, block: np.ndarray) -> None:
    samples.values[channel.name] = block[:, channel.column]
    samples.size[channel.name] = np.linalg.norm(block[:, channel.siblings], axis=1)


def _channel(name: str, families: Sequence[Family]) -> Channel | None:
    word, _, rest = name.partition(".")
    entity, _, path = rest.partition(".")
    for family in families:
        if family.word == word and entity in family.ids:
            for i, column in enumerate(family.columns):
                if column.path.replace("/", ".") == path:
                    return Channel(name, family, family.ids.index(entity), i)
    return None


def _unknown(name: str, families: Sequence[Family]) -> str:
    """Message of a channel that does not exist, from its first wrong word."""
    word, _, rest = name.partition(".")
    entity, _, path = rest.partition(".")
    same = [family for family in families if family.word == word]
    if not same:
        known = sorted({family.word for family in families if family.ids})
        return f"'{name}': unknown family '{word}'; {choices(word, known, 'families')}"
    holders = [family for family in same if entity in family.ids]
    others = sorted({family.word for family in families if entity in family.ids})
    if not holders and others:
        return f"'{name}': no {word} of '{entity}', which has {' and '.join(others)}"
    if not holders:
        ids = [entity for family in same for entity in family.ids]
        return f"'{name}': no {word} of '{entity}'; {choices(entity, ids, 'names')}"
    paths = [column.path.replace("/", ".") for column in holders[0].columns]
    return f"'{name}': {word} has no '{path}'; {choices(path, paths, 'quantities')}"
