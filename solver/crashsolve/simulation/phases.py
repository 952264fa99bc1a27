"""Average time step before, during and after contact, to the nearest sample.

    average = simulated time / steps,   summed over the samples of a phase

An interval between two samples counts as contact when something touches at its end, or when it saw
an onset or the end of a contact; "after" is every other interval after the first onset.
"""

from crashsolve.recording.marching import March

PHASES = ("before", "during", "after")


class ContactPhases:
    """Steps and time by phase, as `march` counts them from the start of a run or its restart."""

    def __init__(self, march: March) -> None:
        self._counted = march.phase
        march.restart_count()

    @property
    def _steps(self) -> dict[str, int]:
        return dict(zip(PHASES, self._counted["steps"][0].tolist(), strict=True))

    @property
    def _time(self) -> dict[str, float]:
        return dict(zip(PHASES, self._counted["spans"][0].tolist(), strict=True))

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
        """The average step as in the log, by phase where there was contact."""
        if not self._steps["during"]:
            return {"average step": f"{self.simulated() / self.cycles():.4g} s"}
        texts = ["-" if step is None else f"{step:.4g} s" for step in self.averages().values()]
        return {"average step before, during, after contact": ", ".join(texts)}
