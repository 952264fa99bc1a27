"""The greatest value of a history, and its time, seen between the samples.

The top of the parabola through the greatest sample and its two neighbours. Where the history runs
straight on both sides, as an acceleration that follows a table, it is the corner at which the two
lines meet. Where a history stays at its extreme for three samples but for round-off, it has jumped
there, as a count does: no parabola, and the time is known to one sample.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from crashsolve.channels.series import Series

# a sample that stands out by more than this share of the range stands alone
SINGLE = 0.3
# of the change of slope at a corner: a smooth top, whose slope changes evenly, has half of it on
# each side
STRAIGHT = 0.2
ROUND_OFF = 1e-9
# of the range: round-off of an acceleration that is constant
EQUAL = 1e-11
# of the rise of a parabola over its largest sample: what it may miss of the top
PARABOLA = 0.1
# of the rise of a parabola: least that is missed where another is nearly as high
CHANCE = 0.25
# of the range: the rise over the largest of eight samples and more of a half wave
RESOLVED = 0.02
# samples on both sides of those that alternate: a vibration sampled at nearly twice its frequency
# alternates by little where the samples are near its zeros, and not at all beside a slow motion
BEAT = 8
# slopes beside a jump over its own; a smooth top with one neighbour as high has 1 on the other side
GENTLE = 0.2


def negative(series: Series) -> Series:
    """The history with its sign changed."""
    return series._replace(values=-series.values)


def magnitude(series: Series) -> Series:
    """The absolute values of a history."""
    return series._replace(values=np.abs(series.values))


def top(series: Series) -> tuple[float, float]:
    """Value and time [s] at the top: of the highest parabola by a sample and its neighbours, of the
    corner at which two straight sides meet, or of a straight side that ends in a jump.
    """
    time, values = series.time, series.values
    at = greatest(values)
    if len(values) < 3 or plateau(values, at) > at + 1:
        return float(values[at]), float(time[at])
    b, c, rises = parabolas(series)
    at = _highest(values, rises, at)
    plain = float(values[at]), float(time[at])
    other = jump(series, at) or corner(series, at) or corner(series, at - 1)
    if other is not None:
        return other
    # beside the first or last sample it is that through the three next to it
    middle = min(max(at, 1), len(values) - 2)
    if not c[middle - 1] < 0.0:
        return plain
    x = -b[middle - 1] / (2.0 * c[middle - 1])
    if not time[middle - 1] < time[middle] + x < time[middle + 1]:
        return plain
    return float(values[middle] + 0.5 * b[middle - 1] * x), float(time[middle] + x)


def parabolas(series: Series) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the parabola b x + c x^2 about each sample but the first and last: b, c (n - 2,), and the
    rise (n,) from every local maximum to its top, 0 elsewhere.
    """
    time, values = series.time, series.values
    left, right = time[:-2] - time[1:-1], time[2:] - time[1:-1]
    low, high = values[:-2] - values[1:-1], values[2:] - values[1:-1]
    c = (high / right - low / left) / (right - left)
    b = low / left - c * left
    rises = np.zeros(len(values))
    is_top = (low <= 0.0) & (high <= 0.0) & (c < 0.0)
    rises[1:-1][is_top] = b[is_top] ** 2 / (-4.0 * c[is_top])
    return b, c, rises


def _highest(values: np.ndarray, rises: np.ndarray, at: int) -> int:
    """The sample with the highest top, of `at` and of those whose parabolas rise a little."""
    is_resolved = rises <= RESOLVED * float(np.ptp(values))
    tops = np.where(is_resolved, values + rises, values)
    other = int(np.argmax(tops))
    return other if tops[other] > tops[at] else at


def heights(series: Series) -> np.ndarray:
    """What each sample may be the top of (n,): a local maximum that of its parabola, and a tenth of
    the rise to it more.
    """
    if len(series.values) < 3:
        return series.values
    heights: np.ndarray = series.values + (1.0 + PARABOLA) * parabolas(series)[2]
    return heights


def jump(series: Series, at: int) -> tuple[float, float] | None:
    """Value and time [s] of a jump beside sample `at`, half an interval from it; None without.

    The history has been straight up to there, or is so from there on: a parabola means nothing.
    """
    if not 2 <= at <= len(series.time) - 3:
        return None
    time, values = series.time[at - 2 : at + 3], series.values[at - 2 : at + 3]
    spans = np.diff(time)
    before, rise, fall, after = np.abs(np.diff(values) / spans)
    if max(before, rise, after) <= GENTLE * fall:
        return float(values[2] + 0.5 * rise * spans[2]), float(time[2] + 0.5 * spans[2])
    if max(before, fall, after) <= GENTLE * rise:
        return float(values[2] + 0.5 * fall * spans[1]), float(time[2] - 0.5 * spans[1])
    return None


def corner(series: Series, at: int) -> tuple[float, float] | None:
    """Value and time [s] where straight lines, up to sample `at` and from the next one on, meet.

    None where they do not meet between these samples, or where the history is not straight there.
    """
    if not 2 <= at <= len(series.time) - 4:
        return None
    time, values = series.time[at - 2 : at + 4], series.values[at - 2 : at + 4]
    before, rise, _, fall, after = np.diff(values) / np.diff(time)
    change = rise - fall
    if max(abs(rise - before), abs(after - fall)) > STRAIGHT * change or not rise > 0.0 > fall:
        return None
    # of sides that bend a little: their slopes half an interval on, at these samples
    rise, fall = rise + 0.5 * (rise - before), fall - 0.5 * (after - fall)
    span = time[3] - time[2]
    x = (values[3] - values[2] - fall * span) / (rise - fall)
    # a corner at a sample, to the last digits
    is_between = -ROUND_OFF * span <= x <= (1.0 + ROUND_OFF) * span
    return (float(values[2] + rise * x), float(time[2] + x)) if is_between else None


def greatest(values: np.ndarray) -> int:
    """First of the samples that are the greatest but for round-off."""
    return int(np.argmax(values >= np.max(values) - EQUAL * np.ptp(values)))


def plateau(values: np.ndarray, at: int) -> int:
    """Last of the samples from `at` on that are equal but for round-off."""
    after = np.flatnonzero(np.abs(values[at:] - values[at]) > EQUAL * np.ptp(values))
    return at + int(after[0]) - 1 if len(after) else len(values) - 1


def between(series: Series) -> float:
    """Possible error of a largest value that may lie between samples; else 0."""
    return max(isolated(series), above(series, float(np.max(series.values)), top(series)[0]))


def alternating(values: np.ndarray) -> np.ndarray:
    """By how much the history may leave each of the samples (n,) that a vibration of nearly two
    samples a period does not resolve: the largest change between two that are both turning points,
    among those next to it; 0 where there are none.
    """
    changes = np.diff(values)
    is_extreme = changes[:-1] * changes[1:] < 0.0
    sizes = np.zeros(len(values))
    if len(values) > 3:
        between = np.where(is_extreme[:-1] & is_extreme[1:], np.abs(changes[1:-1]), 0.0)
        padded = np.pad(between, BEAT + 2)
        sizes = sliding_window_view(padded, 2 * BEAT + 2).max(axis=1)
    return sizes


def above(series: Series, largest: float, refined: float) -> float:
    """How far the continuous history may rise above the `largest` sample between samples that do
    not resolve a half wave: up to the highest parabola, and as far as any rises that is nearly as
    high as `refined`; by CHANCE of the rise of one that is less so, and of any where the largest is
    the first or last sample; by the vibration that alternating samples show. 0 where all are
    resolved.
    """
    if len(series.values) < 3:
        return 0.0
    values, rises = series.values, parabolas(series)[2]
    is_unresolved = rises > RESOLVED * float(np.ptp(values))
    # beside a constant, a jump
    is_flat = np.abs(np.diff(values)) <= EQUAL * float(np.ptp(values))
    is_unresolved[:-2] &= ~(is_flat[:-1] & is_flat[1:])
    is_unresolved[2:] &= ~(is_flat[:-1] & is_flat[1:])
    heights, rises = values + (1.0 + PARABOLA) * rises, np.where(is_unresolved, rises, 0.0)
    rivals = is_unresolved & (heights + rises > refined)
    most = float(np.max(np.maximum(rises, heights - largest)[rivals], initial=0.0))
    # the parabola by the largest may rise little by chance, and the first and last have none
    has_none = largest in (values[0], values[-1], -values[0], -values[-1])
    others = is_unresolved & (has_none | (heights + rises / CHANCE > refined))
    least = CHANCE * float(np.max(rises[others], initial=0.0))
    return max(most, least, float(np.max(values + alternating(values))) - largest)


def isolated(series: Series) -> float:
    """Possible error of a largest value that one sample alone shows; else 0."""
    values = series.values
    at = int(np.argmax(values))
    if not 0 < at < len(values) - 1:
        return 0.0
    drop = float(values[at] - max(values[at - 1], values[at + 1]))
    # a parabola through three such samples means nothing
    return drop if drop > SINGLE * float(np.ptp(values)) else 0.0


def jumped(series: Series) -> float:
    """Time [s] by which the moment of the greatest value is unknown when it was jumped to."""
    at = greatest(series.values)
    is_jump = at > 0 and plateau(series.values, at) > at + 1
    return float(series.time[at] - series.time[at - 1]) if is_jump else 0.0
