"""When a run is sampled: the k-th sample lies at k intervals, not at a sum of them."""

from dataclasses import dataclass

from crashsolve.deck.read import Deck


@dataclass(frozen=True)
class Schedule:
    """Times of the samples [s], the last one at the end."""

    start: float
    end: float
    interval: float

    @classmethod
    def of(cls, deck: Deck) -> "Schedule":
        """The schedule a deck asks for."""
        start, end = deck.control.start_time, deck.control.end_time
        count = deck.control.steps if deck.control.solution == "quasi_static" else 1000
        return cls(start, end, deck.output.history.interval or (end - start) / count or 1.0)

    def time(self, k: int) -> float:
        """Time of sample k."""
        target = self.start + k * self.interval
        return self.end if target > self.end - 1e-9 * self.interval else target

    def number(self, time: float) -> int:
        """Number of the last sample that is not after a time."""
        k = int((time - self.start) / self.interval + 1e-9)
        return k + 1 if time >= self.end and not self.is_end(k) else k

    def is_end(self, k: int) -> bool:
        """Whether sample k is the last."""
        return self.time(k) >= self.end
