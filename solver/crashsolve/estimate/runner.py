"""Estimates in a run: before it the steps an accuracy needs, after it the errors and their cost.

    pilots at 4 and 2 times a coarseness m predict the error at m:  e(m) = e(2m) / 2^q
    m <- m (aim / e)^(1/q), until the prediction is below the aim, half the accuracy

q is the method's order, 5 at most where the tolerance changes. The last pilots serve a run
of rattle as its companions. Where its own estimate then misses the accuracy, it is run again with m
smaller, at most twice; errors by gaps between samples are only reported, as no step reduces them.
"""

import time as clock
from collections.abc import Callable, Sequence
from math import floor, inf, isfinite, log10
from pathlib import Path

import numpy as np

from crashsolve.deck.reading.deck import Deck
from crashsolve.estimate.companion import Abandoned, coarsen
from crashsolve.estimate.error import Estimate
from crashsolve.estimate.estimator import COARSER, Estimator
from crashsolve.estimate.mesh import Meshes
from crashsolve.estimate.missed_contacts import (
    Missed,
    MissedCurve,
    MissedMotion,
    with_missed_contacts,
    with_missed_curves,
    with_missed_motions,
)
from crashsolve.estimate.rates import with_rates
from crashsolve.foundation.errors import DeckError, DeckErrors, RunStopped, SolverError
from crashsolve.output.channels import Family
from crashsolve.output.files import Json
from crashsolve.output.log import Log
from crashsolve.recording.engines import UNPREPARED, Prepared
from crashsolve.recording.samples import Samples, read
from crashsolve.recording.sampling import Schedule

TARGET_SHARE = 0.5
ROUNDS = 12
RERUNS = 2
# the coarseness changes by no more than this between two pilots
STRIDE = 8.0
# a run shorter than this [s of CPU] may cost less than the estimates of its errors
SHORT = 5.0
# and so many times its own cost, of which runs of a half and a quarter of the step take six,
# between these bounds [s of CPU]: a companion whose steps are too long may get stuck
TIMES_FOR_SHORT, MIN_FOR_SHORT, MAX_FOR_SHORT = 8.0, 1.0, 2.0 * SHORT
# what makes errors by time smaller
SHORTER = "shorter steps or a smaller control.tolerance"
# digits of a printed number, and those that state a double exactly
DIGITS, EXACT_DIGITS = 9, 17
# an error below this share of the scale is none to warn of, however near to zero the value is
SMALL = 1e-6


class Estimating:
    """The estimates of one run, reported in its log; `cpu` [s] is their cost.

    Raises DeckErrors for a channel that does not exist, or an accuracy of none.
    """

    def __init__(
        self,
        deck: Deck,
        families: Sequence[Family],
        stopped: Callable[[], bool],
        log: Log,
        prepared: Prepared = UNPREPARED,
    ) -> None:
        self.estimator = Estimator(deck, families, stopped, prepared)
        if deck.control.accuracy is not None and not self.estimator.measures_the_model:
            raise _unmeasured_accuracy(deck)
        self.accuracy, self.log = deck.control.accuracy, log
        self.is_full = deck.control.estimate == "full"
        self.interval = Schedule.of(deck).interval
        self.coarseness, self.cpu, self.reruns = 1.0, 0.0, 0
        self.estimates: list[Estimate] = []
        self.problems: list[str] = []
        self._companions: list[Samples] = []

    def set_steps(self, control: np.ndarray, coarseness: float | None) -> None:
        """Find the steps an accuracy needs, or take those of a dump. Writes: control.

        Raises SolverError when no step will do, RunStopped.
        """
        start_time = clock.process_time()
        if coarseness is not None:
            self.coarseness = coarseness
        elif self.accuracy is not None:
            try:
                self.coarseness = self._calibrate(self.accuracy)
            except Abandoned:
                raise RunStopped("stopped on request before the run began") from None
        self.set_control(control)
        self.cpu += clock.process_time() - start_time

    def set_control(self, control: np.ndarray) -> None:
        """Writes: control."""
        coarsen(control, self.coarseness, self.interval, self.estimator.order)

    def estimate(
        self,
        history: Path,
        cycles: int,
        cpu_time: float,
        missed: Sequence[Missed] = (),
        mass: dict[str, float] | None = None,
        curves: Sequence[MissedCurve] = (),
        motions: Sequence[MissedMotion] = (),
    ) -> bool:
        """Estimate the errors of a finished run; whether it must be run again with other steps.

        `cycles` are its steps and `cpu_time` [s] its CPU time; `missed` the contacts whose peaks no
        sample shows (simulation/missed.py), `mass` [kg] those of the bodies, `curves` the loads and
        prescribed motions whose range no sample shows, `motions` the bodies that move between
        samples as none of them shows.
        """
        start_time = clock.process_time()
        main = read(history, self.estimator.all_channels)
        main.cycles = cycles
        self.problems = []
        compares = self.estimator.measures_the_model
        try:
            if compares and not (self._companions and self.estimator.compares_with_coarser):
                is_free = self.accuracy is not None or self.is_full
                budget = inf if is_free or cpu_time < SHORT else cpu_time
                limit = inf if is_free else _limit_for_short(cpu_time)
                self._companions = self.estimator.companion_runs(
                    self.coarseness, cycles, self.problems, budget, limit
                )
        except Abandoned:
            self.problems.append("asked to stop")
        meshes = self._meshes(cpu_time) if compares else None
        estimates = self.estimator.estimates(main, self._companions, meshes)
        estimates = with_rates(estimates, self.estimator.channels, history)
        estimates = with_missed_contacts(estimates, missed, mass or {})
        estimates = with_missed_curves(estimates, curves)
        self.estimates = with_missed_motions(estimates, motions)
        self._companions.append(main)
        self.cpu += clock.process_time() - start_time
        self._report(cpu_time)
        return self._needs_rerun()

    def _meshes(self, cpu_time: float) -> Meshes | None:
        """Runs on coarser meshes. Writes: problems, why there are none or what they leave out."""
        try:
            meshes = self.estimator.mesh_runs(self.coarseness, cpu_time)
        except Abandoned:
            self.problems.append("asked to stop")
            return None
        self.problems += meshes.remarks
        return meshes

    def entries(self) -> list[Json]:
        """The estimates as status.json keeps them."""
        return [
            {
                "channel": e.watch.channels[0],
                "statistic": e.watch.statistic,
                "during": e.watch.during,
                "value": e.value,
                "unit": e.unit,
                "error": e.error,
                "mesh": e.mesh if e.mesh is None or isfinite(e.mesh) else None,
                "scale": e.scale,
                "how": e.how,
            }
            for e in self.estimates
        ]

    def _calibrate(self, accuracy: float) -> float:
        """The coarseness at which the predicted errors are below the aim."""
        estimator, m, pilots = self.estimator, 1.0, {}
        gain = 2.0**estimator.power
        message = "the pilot runs do not reach the end"
        for _ in range(ROUNDS):
            try:
                for factor in COARSER:
                    if factor * m not in pilots:
                        pilots[factor * m] = estimator.companions.run(factor * m)
            except SolverError as error:
                message = f"the pilot runs stop: {error.cause}"
                m /= 2.0
                continue
            estimates = estimator.estimates(pilots[2.0 * m], [pilots[4.0 * m]])
            worst = max(estimates, key=_of_steps)
            predicted = _of_steps(worst) / gain
            self.log.line(
                f"pilot runs: {pilots[2.0 * m].cycles} steps, error {gain * predicted:.2g} of "
                f"{worst.watch.name}; predicted for steps half as long: {predicted:.2g}"
            )
            if predicted <= TARGET_SHARE * accuracy:
                self._companions = [pilots[factor * m] for factor in COARSER]
                return m
            message = f"{worst.watch.name} still has an error of {predicted:.2g}"
            wanted = (TARGET_SHARE * accuracy / predicted) ** (1.0 / estimator.power)
            m *= min(max(0.9 * wanted, 1.0 / STRIDE), 0.7)
        raise _unreachable(accuracy, message)

    def _needs_rerun(self) -> bool:
        """Whether the steps are too long for the accuracy, and another run may reach it.

        Writes: the coarseness of that run.
        """
        if self.accuracy is None or not self.estimates or "asked to stop" in self.problems:
            return False
        worst = max(self.estimates, key=_of_steps)
        error = _of_steps(worst)
        if error <= self.accuracy:
            sampling_error = max(
                (e.sampling_error / e.scale for e in self.estimates if e.scale and e.error),
                default=0.0,
            )
            if sampling_error > self.accuracy:
                self.log.warning(
                    f"accuracy {self.accuracy:g} missed by {sampling_error:.2g} between samples; "
                    "give a shorter output.history.interval"
                )
            return False
        if self.reruns == RERUNS or not isfinite(error):
            self.log.warning(f"accuracy {self.accuracy:g} missed: {worst.watch.name}, {error:.2g}")
            return False
        self.reruns += 1
        self.coarseness *= max(
            0.9 * (TARGET_SHARE * self.accuracy / error) ** (1 / self.estimator.power), 0.1
        )
        self.log.line(f"accuracy {self.accuracy:g} missed by {worst.watch.name}: running again")
        return True

    def _report(self, cpu_time: float) -> None:
        """Write a line per watched number, and the cost of the estimates `cpu_time` [s] of CPU."""
        lines = [_line(estimate) for estimate in self.estimates]
        self.log.section("watched channels", lines)
        for e in self.estimates:
            # peaks between samples have a warning of their own
            is_missed = "' between samples" in e.how
            if not e.error or e.value is None or is_missed:
                continue
            if e.error > max(abs(e.value), SMALL * e.scale):
                by_mesh = e.mesh is not None and e.mesh > 0.5 * e.error
                advice = "smaller elements" if by_mesh else SHORTER
                self.log.warning(
                    f"{e.watch.name}: the estimated error, {e.error:.2g}, is larger than the "
                    f"value, {e.value:.2g}: take {advice}"
                )
        for problem in self.problems:
            self.log.line(f"  {problem}")
        share = 100.0 * self.cpu / cpu_time if cpu_time > 0.0 else 0.0
        pilots = ", with pilot runs and earlier ones," if self.accuracy else ""
        self.log.line(
            "  cost of the error estimates"
            f"{pilots} {self.cpu:.3g} s of CPU, {share:.0f} % of the run's"
        )


def _limit_for_short(cpu_time: float) -> float:
    """What the companions of a short run of `cpu_time` [s] may take [s of CPU]."""
    return min(max(TIMES_FOR_SHORT * cpu_time, MIN_FOR_SHORT), MAX_FOR_SHORT)


def _unmeasured_accuracy(deck: Deck) -> DeckErrors:
    """The error of an accuracy where no watched number has an error of its own."""
    message = "accuracy: every watched channel is itself a measure of the run's errors"
    advice = "watch a quantity of the model, such as rbdout.BODY.position.x"
    return DeckErrors([DeckError(str(deck.path), None, None, "control", message, advice)])


def _of_steps(estimate: Estimate) -> float:
    """Relative error by the length of steps, without channels that measure the run itself."""
    if estimate.error is None and estimate.mesh is None:
        return inf if estimate.is_wanted else 0.0
    return estimate.steps / estimate.scale if estimate.scale else 0.0


def _line(estimate: Estimate) -> str:
    if estimate.value is None:
        return f"{estimate.watch.name}: {estimate.how}"
    digits = _digits(estimate.value, estimate.error)
    text = f"{estimate.watch.name} = {estimate.value:.{digits}g} {estimate.unit}".rstrip()
    if estimate.error is None:
        return f"{text} ({estimate.how})"
    relative = "" if estimate.relative is None else f", {estimate.relative:.1e} of its scale"
    return f"{text} +- {estimate.error:.2g}{relative} ({estimate.how})"


def _digits(value: float, error: float | None) -> int:
    """Digits of a number, nine or as many as put the last one below its error, 17 at most."""
    if not value or not error:
        return DIGITS
    below = floor(log10(abs(value))) - floor(log10(error)) + 2
    return min(max(DIGITS, below), EXACT_DIGITS)


def _unreachable(accuracy: float, message: str) -> SolverError:
    return SolverError(
        0.0,
        0,
        "the model",
        f"no step reaches the accuracy {accuracy:g}: {message}",
        "watch statistics that converge (crashsolve study shows which), or ask for less accuracy",
    )
