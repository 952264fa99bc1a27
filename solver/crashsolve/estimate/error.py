"""The estimated error of one watched number, from coarser runs, a finer one, and its own samples.

    two coarser runs    error = |x1 - x2| / ((h2/h1)^p - 1), the observed order p as in a study;
                        at least a quarter of the value of |x2 - x4| by the method's order,
                        all of it where p is none; more where p is greater than any order of the
                        method: as many times as the last difference is too small, up to four
    one coarser run     the same with the method's order
    finer runs          error = |x1 - xf| / (1 - (hf/h1)^2), the largest, enough for any order
                        from 2 on
    samples             refined - plain, added with its sign where that of the rest is known
                        (channels/statistic.py)

h is the average step. Where the differences do not shrink, the larger one is the error. Consequence
to test: x = 1 + h^p gives the error h^p, for each of the three.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf

import numpy as np

from crashsolve.channels.expression import gives_sample_times, is_sampled
from crashsolve.channels.series import Series, within
from crashsolve.channels.statistic import (
    is_a_time,
    is_of_a_moment,
    plain,
    refined,
    scale,
    unit_of,
    unresolved,
)
from crashsolve.channels.statistics._top import greatest, heights, plateau
from crashsolve.deck.run_cards.statistic import PATH
from crashsolve.recording.samples import Channel, Samples, are_among
from crashsolve.study.convergence import NEAR, Convergence, analyse, distance
from crashsolve.study.watch import Watch

# a run with fewer steps than this many times those of another is as fine as that
SAME = 1.15
# where the last difference is small by chance, the error is still this share of that by the
# difference before it
CHANCE_MARGIN = 0.25
# an order that the method cannot have is a last difference small by chance: of 15 impacts of a few
# steps each, errors of orders beyond 4 in place of 2 were up to four times what the difference
# before says
IMPOSSIBLE = 4.0
# errors of opposite sign never cancel to less than this share of the two
REST = 0.1
EXTREMES = ("argmax", "argmin")
# statistics of a largest value so far that are that value at the end
LATCHED = ("final", "max", "abs_max")
# a step that stands this little out of the samples is one of them
SAME_POSITION = 1e-9
# a sum below this share of its parts counts as zero
CANCELS = 1e-6
SAME_STEPS = "no further run took different steps"
# numbers below this share of their scale are round-off
DIGITS = 1e-13


@dataclass(frozen=True)
class Estimate:
    """A watched number with its error: both in `unit`, as is the `scale` of relative errors.

    `error` is None where it is not known; `how` states the method, or the cause.
    """

    watch: Watch
    value: float | None
    unit: str
    error: float | None
    scale: float
    how: str
    steps: float = 0.0  # the part of the error that the steps make; infinite where no run shows it
    sampling_error: float = 0.0  # and that of the gaps between samples
    is_wanted: bool = True  # False for channels that measure the run's own errors
    mesh: float | None = None  # the part of the mesh; infinite where meshes state none

    @property
    def relative(self) -> float | None:
        """The error over the scale; None where there is no error or no scale."""
        return None if self.error is None or not self.scale else self.error / self.scale


@dataclass(frozen=True)
class _Steps:
    """The error by the length of steps: its size, its signed value where known, and how found."""

    size: float
    signed: float | None
    how: str


class NumberErrors:
    """Estimates the errors of the watched numbers of a run from companions."""

    def __init__(self, channels: dict[str, list[Channel]], order: float | None) -> None:
        self.channels, self.order = channels, order

    def estimate(self, watch: Watch, main: Samples, others: Sequence[Samples]) -> Estimate:
        """The number of the run and its error, `others` being companions in any order."""
        resolved = self._resolved(watch, main)
        units = {c.name: c.unit for channels in self.channels.values() for c in channels}
        main, *rest = (replace(samples, units=units) for samples in (main, *others))
        return replace(self._estimate(resolved, main, rest), watch=watch)

    def numbers(self, watch: Watch, runs: Sequence[Samples]) -> list[np.ndarray]:
        """The value (n,) of each run by which runs are compared: a number, or a common history.

        Raises ValueError for samples from which it cannot be computed.
        """
        resolved = self._resolved(watch, runs[0])
        units = {c.name: c.unit for channels in self.channels.values() for c in channels}
        times = runs[0].time
        for run in runs[1:]:
            times = times[are_among(times, run.time)]
        has_steps = watch.statistic != PATH
        return [_value(resolved, replace(run, units=units).at(times, has_steps)) for run in runs]

    def history(self, watch: Watch, main: Samples) -> Series:
        """The watched history of a run, in its window. Raises ValueError as `numbers` does."""
        units = {c.name: c.unit for channels in self.channels.values() for c in channels}
        return series_of(watch, replace(main, units=units))

    def _resolved(self, watch: Watch, main: Samples) -> Watch:
        """The watch from which a largest value of any step is refined.

        That is the history where samples have met the largest value, otherwise the last sample:
        a largest value over all steps misses nothing between samples. Other numbers are unchanged.
        """
        (channel, *others) = self.channels[watch.channels[0]]
        followed = channel.followed
        is_plain = not others and watch.channels[0].strip() == channel.name
        if followed is None or not is_plain or watch.statistic not in LATCHED or watch.during:
            return watch
        value, top = main.values[channel.name][-1], np.max(main.values[followed.name])
        if value > top * (1.0 + SAME_POSITION):
            return replace(watch, statistic="final")
        self.channels.setdefault(followed.name, [followed])
        seen = replace(watch, channels=(followed.name,), statistic="max")
        series = series_of(seen, main)
        # steps see more of a peak that one sample alone shows, unless samples there are the steps;
        # a force that begins with a jump has its peak there
        at = max(int(np.argmax(series.values)), 1)
        are_steps = are_among(series.time[at - 1 : at + 2], main.step_times).any()
        is_jump = series.values[at - 1] == 0.0
        is_alone = unresolved(series, "max") > 0.0 and (is_jump or not are_steps)
        return replace(watch, statistic="final") if is_alone else seen

    def _estimate(self, watch: Watch, main: Samples, others: Sequence[Samples]) -> Estimate:
        channels = self.channels[watch.channels[0]]
        try:
            series = series_of(watch, main)
            value = _number(watch, series)
            unit = _unit(watch, series)
            size = _scale(watch, channels, main, series)
        except ValueError as problem:
            return Estimate(watch, None, "", None, 0.0, f"not estimated: {problem}")
        if any(channel.is_of_the_run for channel in channels):
            how = "not estimated: it measures the errors of the run itself"
            return Estimate(watch, value, unit, None, size, how, is_wanted=False)
        try:
            sampling_error = _sampling_error(watch, series, main)
            steps = self._of_steps(watch, main, others)
        except ValueError as problem:
            # such as a filter that needs all samples
            how = f"not estimated: with fewer samples {problem}"
            return Estimate(watch, value, unit, None, size, how)
        if steps is None:
            return Estimate(watch, value, unit, None, size, f"not estimated: {SAME_STEPS}", inf)
        error, how = _sum(steps, sampling_error) + DIGITS * abs(value), steps.how
        if abs(sampling_error) > 0.1 * error:
            how += f"; gaps between samples {abs(sampling_error):.2g} {unit}".rstrip()
        if watch.statistic in EXTREMES:
            other = self._ambiguity_of_time(watch, series, main, others)
            if other > error:
                error, how = other, "another peak is as large within its error"
        return Estimate(watch, value, unit, error, size, how, steps.size, abs(sampling_error))

    def _ambiguity_of_time(
        self, watch: Watch, series: Series, main: Samples, others: Sequence[Samples]
    ) -> float:
        """Time from an extreme to the farthest sample that may be the extreme as well."""
        height = replace(watch, statistic=watch.statistic.removeprefix("arg"))
        error = self.estimate(height, main, others).error or 0.0
        signed = series.values if watch.statistic == "argmax" else -series.values
        at = greatest(signed)
        candidates = heights(series._replace(values=signed)) >= signed[at] - error
        # samples beside it that are as large belong to the same extreme
        candidates[at : plateau(signed, at) + 1] = False
        return float(np.max(np.abs(series.time[candidates] - series.time[at]), initial=0.0))

    def _of_steps(self, watch: Watch, main: Samples, others: Sequence[Samples]) -> _Steps | None:
        """Error by the length of the steps; None without another run. Raises ValueError for samples
        from which the number cannot be computed.
        """
        if not main.cycles:
            # a run that ends where it begins has no error of steps
            return None
        coarse = [o for o in others if o.cycles > 0 and not is_as_fine(o.cycles, main.cycles)]
        fine = [o for o in others if not is_as_fine(main.cycles, o.cycles)]
        # of two that corners and samples cut into as many steps, one is enough
        coarse = list({o.cycles: o for o in coarse}.values())
        used = [*sorted(coarse, key=_cycles)[-2:], main] if coarse else [main, *fine]
        if len(used) < 2:
            return None
        times = used[0].time
        for samples in used[1:]:
            times = times[are_among(times, samples.time)]
        has_steps = watch.statistic != PATH
        values = [_value(watch, samples.at(times, has_steps)) for samples in used]
        steps = [1.0 / samples.cycles for samples in used]
        if not coarse:
            return self._of_finer(steps, values, used)
        differences = distance(*values[-2:])
        if len(used) == 2:
            size = differences / ((steps[0] / steps[1]) ** (self.order or 1.0) - 1.0)
            return _Steps(size, None, f"a coarser run of {used[0].cycles} steps")
        if any(channel.followed for channel in self.channels[watch.channels[0]]):
            return _of_largest(steps, values)
        return self._of_three(steps, values)

    def _of_finer(
        self, steps: Sequence[float], values: Sequence[np.ndarray], used: Sequence[Samples]
    ) -> _Steps:
        """The larger error by the finer runs, after that of the run itself."""
        order = min(self.order or 1.0, 2.0)
        sizes = [
            distance(values[0], value) / (1.0 - (step / steps[0]) ** order)
            for step, value in zip(steps[1:], values[1:], strict=True)
        ]
        counts = " and ".join(str(samples.cycles) for samples in used[1:])
        runs = "a finer run" if len(sizes) == 1 else "2 finer runs"
        return _Steps(max(sizes), None, f"{runs} of {counts} steps")

    def _of_three(self, steps: Sequence[float], values: Sequence[np.ndarray]) -> _Steps:
        convergence = analyse(steps, values, self.order)
        # an order near zero gives an error of any size: at most the largest difference of the runs
        differences = [distance(a, b) for a, b in pairwise(values)]
        size, how = min(convergence.error, max(differences)), _reported(convergence, self.order)
        signed = float((values[-1] - convergence.value)[0]) if len(values[-1]) == 1 else None
        if convergence.stalls is None and self.order:
            a, b, c = (step**self.order for step in steps)
            least = _margin(convergence, self.order) * differences[0] * c / (a - b)
            if least > size:
                size, signed = least, None
        return _Steps(size, signed if convergence.is_extrapolated else None, how)


def _margin(convergence: Convergence, order: float) -> float:
    """Factor [1] on the error by the difference before the last, below which no error is given."""
    if convergence.order <= order + NEAR:
        return CHANCE_MARGIN
    # where the last difference is round-off, the one before is no evidence of chance
    if convergence.has_floor or not np.isfinite(convergence.order):
        return 1.0
    return float(min(2.0 ** (convergence.order - order), IMPOSSIBLE))


def _of_largest(steps: Sequence[float], values: Sequence[np.ndarray]) -> _Steps:
    """Error of a largest value over all steps: random, within a bound that falls with h^2."""
    *coarse, last = zip(steps, values, strict=True)
    sizes = [distance(last[1], v) / ((h / last[0]) ** 2 - 1.0) for h, v in coarse]
    return _Steps(max(sizes), None, "2 coarser runs, whose steps meet the peak at other moments")


def is_as_fine(cycles: int, others: int) -> bool:
    """Whether a run of so many steps is as fine as one of `others`."""
    return cycles * SAME > others


def _cycles(samples: Samples) -> int:
    return samples.cycles


def _number(watch: Watch, series: Series) -> float:
    """The number itself, of a history its largest magnitude. Raises ValueError without one."""
    if watch.statistic == PATH:
        return float(np.max(np.abs(series.values)))
    value = plain(series, watch.statistic)
    if not np.isfinite(value):
        raise ValueError(f"division by zero in '{watch.channels[0]}'")
    return value


def _sampling_error(watch: Watch, series: Series, main: Samples) -> float:
    """Difference of the number from that of the continuous history."""
    if watch.statistic == PATH:
        return _sampling_error_inside(watch, main)
    missed = unresolved(series, watch.statistic)
    difference = plain(series, watch.statistic) - refined(series, watch.statistic)
    # a chatter of the last digits on a smooth top is not all that its samples miss
    return missed if missed > abs(difference) else difference + _sampling_error_inside(watch, main)


def _sum(steps: _Steps, sampling_error: float) -> float:
    """Both errors together: where the signs are known they may take from each other."""
    if steps.signed is None:
        return steps.size + abs(sampling_error)
    return abs(steps.signed + sampling_error) + REST * (abs(steps.signed) + abs(sampling_error))


def _reported(convergence: Convergence, order: float | None) -> str:
    """Method of the error estimate, in words."""
    if convergence.stalls is not None:
        return "2 coarser runs: differences do not shrink, the larger one is taken"
    if convergence.is_extrapolated:
        return f"2 coarser runs, order {convergence.order:.2f}"
    if np.isfinite(convergence.order):
        return f"2 coarser runs, order {convergence.order:.2f} where the method has {order:g}"
    return "2 coarser runs, differences are round-off"


def series_of(watch: Watch, samples: Samples) -> Series:
    """The watched history in its window. Raises ValueError where it lacks a requested value.

    A statistic of one moment does not need the others.
    """
    series = within(samples.series(watch.channels[0]), watch.during)
    is_whole = watch.statistic == PATH or not is_of_a_moment(watch.statistic)
    if is_whole and not np.isfinite(series.values).all():
        raise ValueError(f"division by zero in '{watch.channels[0]}'")
    return series


def _value(watch: Watch, samples: Samples) -> np.ndarray:
    """The value by which runs are compared: the refined number, or the history."""
    if not len(samples.time):
        raise ValueError("no samples")
    series = series_of(watch, samples)
    if watch.statistic == PATH:
        return series.values
    return np.array([refined(series, watch.statistic)])


def _sampling_error_inside(watch: Watch, main: Samples) -> float:
    """Error by samples of an expression that integrates or differentiates; 0 for others."""
    if not is_sampled(watch.channels[0]):
        return 0.0
    if gives_sample_times(watch.channels[0]):
        return float(np.max(np.diff(main.time)))
    half = main.at(main.time[::2])
    if watch.statistic == PATH:
        return distance(_value(watch, main.at(half.time)), series_of(watch, half).values) / 3.0
    return (
        abs(
            refined(series_of(watch, main), watch.statistic)
            - refined(series_of(watch, half), watch.statistic)
        )
        / 3.0
    )


def _scale(watch: Watch, channels: list[Channel], main: Samples, series: Series) -> float:
    """Scale of relative errors: the largest magnitude of the history, or of its vector.

    A sum counts by itself, unless its parts cancel.
    """
    if watch.statistic != PATH and is_a_time(watch.statistic):
        return float(main.time[-1] - main.time[0])
    largest = float(np.nanmax(np.abs(series.values)))
    if not set(watch.channels[0]) & set("*/") and not is_sampled(watch.channels[0]):
        size = max(float(np.max(main.size[c.name], initial=0.0)) for c in channels)
        is_plain = watch.channels[0].strip().lstrip("-").strip("' ") == channels[0].name
        largest = max(largest, size if is_plain else CANCELS * size)
    if watch.statistic == PATH:
        return largest
    return scale(series, watch.statistic, largest)


def _unit(watch: Watch, series: Series) -> str:
    """Unit of the number in SI; empty for a pure number."""
    return series.unit if watch.statistic == PATH else unit_of(watch.statistic, series.unit)
