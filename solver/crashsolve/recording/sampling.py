"""When a run is sampled: the k-th sample lies at k intervals, not at a sum of them.

The times that `expect` and `watch` ask for, by `at:T` and as ends of a window, are sampled as well.
"""

from bisect import bisect_left
from typing import NamedTuple

import numpy as np

from crashsolve.channels.statistic import requested_moment
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.run_cards.expect import Expect
from crashsolve.deck.run_cards.statistic import PATH
from crashsolve.deck.run_cards.watch import Watch

# a time this near to a sample, in intervals, is that sample
SAME = 1e-9


class Schedule(NamedTuple):
    """Times of the samples [s], the last one at the end; `requested` lie between the others."""

    start: float
    end: float
    interval: float
    requested: tuple[float, ...] = ()
    numbers: tuple[int, ...] = ()  # of these samples among all

    @classmethod
    def of(cls, deck: Deck) -> "Schedule":
        """The schedule of a deck."""
        start, end = deck.control.start_time, deck.control.last_time
        plain = cls(start, end, deck.sample_interval or 1.0)
        return plain.with_times(_requested(deck) | _ends_of_phases(deck))

    def with_times(self, times: set[float]) -> "Schedule":
        """This schedule with further samples at the given times [s]."""
        inside = sorted(t for t in times if self.start < t < self.end and not self._is_met(t))
        numbers = tuple(self._before(t) + j for j, t in enumerate(inside))
        return Schedule(self.start, self.end, self.interval, tuple(inside), numbers)

    def time(self, k: int) -> float:
        """Time of sample k [s]."""
        j = bisect_left(self.numbers, k)
        if j < len(self.numbers) and self.numbers[j] == k:
            return self.requested[j]
        return self._plain(k - j)

    def times(self, k: int, most: int) -> np.ndarray:
        """Times [s] of sample k and those after it, up to the end or so many."""
        last = bisect_left(self.numbers, k + most)
        if bisect_left(self.numbers, k) == last:
            targets = self.start + np.arange(k - last, k - last + most) * self.interval
            targets[targets > self.end - SAME * self.interval] = self.end
        else:
            targets = np.array([self.time(i) for i in range(k, k + most)])
        return targets[: int(np.searchsorted(targets, self.end)) + 1]

    def number(self, time: float) -> int:
        """Number of the sample nearest to a time [s]."""
        k = round((time - self.start) / self.interval) + bisect_left(self.requested, time)
        near = range(max(k - 2, 0), k + 3)
        return min(near, key=lambda i: (abs(self.time(i) - time), i))

    def has(self, time: float) -> bool:
        """Whether there is a sample at a time."""
        return bool(self.have(np.array([time]))[0])

    def have(self, times: np.ndarray) -> np.ndarray:
        """Whether there is a sample at each of many times (n,)."""
        plain = self.start + np.rint((times - self.start) / self.interval) * self.interval
        plain[plain > self.end - SAME * self.interval] = self.end
        others = np.array([*self.requested, self.end])
        farther = np.abs(times[:, None] - others).min(axis=1)
        nearest: np.ndarray = np.minimum(np.abs(times - plain), farther)
        return nearest <= SAME * self.interval

    def last_until(self, time: float) -> int:
        """Number of the last sample that is not after a time, be it of another schedule."""
        k = self.number(time)
        return k - 1 if self.time(k) > time + SAME * self.interval else k

    def is_end(self, k: int) -> bool:
        """Whether sample k is the last."""
        return self.time(k) >= self.end

    def plain_number(self, k: int) -> int | None:
        """Number of intervals from the start to sample k; None for a requested one."""
        j = bisect_left(self.numbers, k)
        return None if k in self.numbers[j : j + 1] else k - j

    def _plain(self, k: int) -> float:
        target = self.start + k * self.interval
        return self.end if target > self.end - SAME * self.interval else target

    def _before(self, time: float) -> int:
        """Number of regular samples before a time."""
        k = max(int((time - self.start) / self.interval) - 1, 0)
        while self._plain(k) < time:
            k += 1
        return k

    def _is_met(self, time: float) -> bool:
        k = self._before(time)
        return min(abs(self._plain(i) - time) for i in (max(k - 1, 0), k)) <= SAME * self.interval


def _ends_of_phases(deck: Deck) -> set[float]:
    """Times [s] at which phases end, but for the last."""
    times = (entry.card.end_time for entry in deck.entries["phases"].values())
    return {time for time in times if time is not None}


def _requested(deck: Deck) -> set[float]:
    """Moments [s] named by the cards expect and watch."""
    moments: set[float] = set()
    cards: list[Expect | Watch] = [*deck.expect, *deck.watch]
    for card in cards:
        moment = None if card.statistic == PATH else requested_moment(card.statistic)
        if moment is not None:
            moments.add(moment)
        moments |= set(card.during or ())
    return moments
