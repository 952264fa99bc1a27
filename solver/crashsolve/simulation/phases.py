"""Average time step before, during and after contact, to the nearest sample.

    average = simulated time / steps,   summed over the samples of a phase

An interval between two samples counts as contact when something touches at its end, or when it saw
an onset or the end of a contact; "after" is every other interval after the first onset.
"""

from crashsolve.system.engine import Engine

PHASES = ("before", "during", "after")


class ContactPhases:
    """Counts steps and time by phase, from the start of a run or from its restart."""

    def __init__(self, engine: Engine) -> None:
        state = engine.state
        self._clock, self._touching = state.clock, state.cards["touching"]
        self._onsets = state.card_history["onsets"]
        self._steps = dict.fromkeys(PHASES, 0)
        self._time = dict.fromkeys(PHASES, 0.0)
        self._last = self._look()

    def count(self) -> None:
        """Add the interval since the last sample."""
        now = self._look()
        time, cycle, onsets, touching = now
        phase = "after" if onsets else "before"
        if touching or self._last[3] or onsets > self._last[2]:
            phase = "during"
        self._time[phase] += time - self._last[0]
        self._steps[phase] += cycle - self._last[1]
        self._last = now

    def cycles(self) -> int:
        """Steps counted so far."""
        return sum(self._steps.values())

    def simulated(self) -> float:
        """Time counted so far [s]."""
        return sum(self._time.values())

    def averages(self) -> dict[str, float | None]:
        """Average step [s] of each phase; None of one without steps."""
        return {
            phase: self._time[phase] / self._steps[phase] if self._steps[phase] else None
            for phase in PHASES
        }

    def average_steps(self) -> dict[str, str]:
        """The average step as the log says it, by phase where anything ever touched."""
        if not self._steps["during"]:
            return {"average step": f"{self.simulated() / self.cycles():.4g} s"}
        texts = ["-" if step is None else f"{step:.4g} s" for step in self.averages().values()]
        return {"average step before, during, after contact": ", ".join(texts)}

    def _look(self) -> tuple[float, int, int, bool]:
        """Time [s], steps, onsets of contact so far, and whether anything touches."""
        clock = self._clock[0]
        onsets = int(self._onsets[clock["current"]].sum())
        return float(clock["time"]), int(clock["cycle"]), onsets, bool(self._touching.any())
