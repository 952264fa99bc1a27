"""Steps that resolve prescribed motions and loads: by the rate of change of their curves.

    h <= 2 pi / 40 / omega,   omega = max |f'''| / max |f''|   near the time
    h <= 2 pi / 32 / omega,   omega^2 = 2 max |f''| / range

omega is the circular frequency of a sine, and for a smooth pulse of width s about 2 / s; by the
second a parabola between two corners, whose f''' is 0, has as many steps as a half wave. A curve
may change as fast as it likes where that is below NOTHING of its range in a step, and no piece is
cut into more than four. Straight pieces have no frequency, and steps end at their corners
(corners.py): those that rise or fall are cut into four, or every run beside this one would take the
same step over them, and estimate no error of changes within it. Methods of order 2 miss work on
slopes of unequal steps: a lone pulse, of FEW_LINES pieces or fewer, is cut into LINE steps each.
Beside a corner, pieces by which a formula approaches its kink bend by round-off, and are not seen.
Time is halved until a part has no more than some steps; parts of like bounds are one.
Consequence to test: a pulse between two samples gives its impulse, wherever it lies; a load of the
frequency of the samples as well.
"""

from math import pi
from typing import NamedTuple

import numpy as np

from crashsolve.foundation.distinct import distinct
from crashsolve.model.corners import corners, curves_of_time
from crashsolve.model.model import Model

# steps in a period, and the share of the range of a curve that a step may miss
PER_PERIOD, NOTHING = 40, 1e-8
# steps in a period of a sine of the same range and bend: fewer, so that the first holds for sines
PER_ARC = 32
# a stated step of so many times the longest hardly resolves a curve, or misses it
COARSE, MISSED = 4.0, 16.0
# steps in a piece of a curve at least
CUTS = 4
# steps in a slope of a curve of so few straight pieces: the work of a load over slopes of unlike
# steps is wrong by up to 1 / LINE^2, which must be below control.energy_limit
LINE, FEW_LINES = 8, 16
# a part is halved down to so many of its steps, over a period, and this share of the curve; further
# only where that parts steps by this factor, as towards an end with infinite slope, to round-off
FEW, SHORTEST, UNEQUAL, ROUND_OFF = 100, 1.0 / 4096, 1.5, 1e-15
# [of the range] pieces as short as this, so near a corner, lead to the kink of a formula, which is
# cut to 1e-13 (SMALLEST of curves/formula.py): f''' is round-off, 1e-16 over their length cubed
KINK, BESIDE = 1e-8, 1e-7
# share of the run in which no load does anything: ten times that below which a step has collapsed
NO_TIME = 1e-11


class _Pieces(NamedTuple):
    """Cubics of a curve: where they end, and the derivatives that bound steps within them."""

    x: np.ndarray  # (n + 1,) [s]
    rise: np.ndarray  # (n,) change of f
    bend: np.ndarray  # (n,) largest |f''|
    third: np.ndarray  # (n,) |f'''|
    range: float


def steps_by_curves(model: Model, parts: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] (n,) from which a step [s] (n,) is the longest that sees all curves of time.

    A stated step is cut within straight pieces alone; slopes of lone pulses into `parts`, if any.
    """
    control = model.control[0]
    is_stated = float(control["fixed_step"]) > 0.0
    shortest = NO_TIME * float(control["end"] - control["start"])
    curves, firsts = model.curves, sorted(curves_of_time(model))
    steps = [
        _of_straight(curves, first, CUTS if is_stated else parts)
        if is_stated or (parts and _is_lone_pulse(curves, first))
        else _steps(curves, first)
        for first in firsts
    ]
    steps = [(x, h) for x, h in steps if np.isfinite(h).any()]
    if not steps:
        return np.zeros(0), np.zeros(0)
    starts = distinct(np.concatenate([x for x, _ in steps]))
    each = [np.r_[np.inf, h][np.searchsorted(x, starts, side="right")] for x, h in steps]
    return _merged(starts, np.maximum(np.min(each, axis=0), shortest))


def unseen(model: Model) -> dict[str, tuple[float, float]]:
    """Curves that a stated step hardly sees: its share of the step they need, and when [s]."""
    control, shares_of = model.control[0], {}
    step, names = float(control["fixed_step"]), {k: name for name, k in model.curve_names.items()}
    for first in sorted(curves_of_time(model)) if step > 0.0 else ():
        starts, steps = _steps(model.curves, first, cuts_straight=False)
        overlaps = (starts < control["end"]) & (np.r_[starts[1:], np.inf] > control["start"])
        shares = np.where(overlaps, step / steps, 0.0)
        at = int(shares.argmax())
        if shares[at] > COARSE:
            shares_of[names[first]] = float(shares[at]), float(max(starts[at], control["start"]))
    return shares_of


def warn_of_unseen(model: Model) -> list[str]:
    """Curves of time of which a stated step takes too few points."""
    return [
        f"control.step takes {PER_PERIOD / share:.2g} points per period of curve '{name}', from "
        f"t = {when:.6g} s: it {'misses' if share > MISSED else 'hardly resolves'} the shape of "
        f"the curve; take {float(model.control[0]['fixed_step']) / share:.2g} s, or control.step: "
        "auto"
        for name, (share, when) in unseen(model).items()
    ]


def _of_straight(curves: np.ndarray, first: int, parts: float) -> tuple[np.ndarray, np.ndarray]:
    """The same of the straight pieces of a curve that rise or fall, cut into `parts` each."""
    points = curves[first : curves[first]["last"] + 1]
    x, c = points["x"].copy(), points["c"][:-1]
    is_cut = (c[:, 1] != 0.0) & (c[:, 2] == 0.0) & (c[:, 3] == 0.0)
    return _merged(x, np.r_[np.where(is_cut, np.diff(x) / parts, np.inf), np.inf])


def _is_lone_pulse(curves: np.ndarray, first: int) -> bool:
    """Whether a curve has few pieces, all of them straight."""
    c = curves[first : curves[first]["last"]]["c"]
    return len(c) <= FEW_LINES and not c[:, 2:].any()


def _steps(
    curves: np.ndarray, first: int, cuts_straight: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """The same of the curve that begins with point `first`; straight pieces are cut, or not."""
    points = curves[first : curves[first]["last"] + 1]
    x, c = points["x"].copy(), points["c"][:-1]
    length = np.diff(x)
    ends = np.abs([2 * c[:, 2], 2 * c[:, 2] + 6 * length * c[:, 3]])
    values = points["c"][:-1, 0]
    last = c[-1] @ length[-1] ** np.arange(4)
    values = np.r_[values, last]
    rise = np.abs(np.diff(values)) * cuts_straight
    sees, span = ~_are_beside_kinks(curves, first), float(np.ptp(values))
    pieces = _Pieces(x, sees * rise, sees * ends.max(axis=0), sees * 6 * np.abs(c[:, 3]), span)
    starts, steps = [x[0]], [np.inf]
    if pieces.range > 0.0:
        starts, steps = _halved(pieces, float(x[0]), float(x[-1]), (x[-1] - x[0]) * SHORTEST)
    # beyond its range it continues straight
    return _merged(np.r_[starts, x[-1]], np.r_[steps, np.inf])


def _are_beside_kinks(curves: np.ndarray, first: int) -> np.ndarray:
    """Which pieces (n - 1,) of a curve hold a kink of its formula or lead to one."""
    x = curves["x"][first : curves[first]["last"] + 1]
    at, reach = corners(curves, first), BESIDE * (x[-1] - x[0])
    # a corner within reach of either end
    after = np.searchsorted(at, x[:-1] - reach)
    is_near = after < np.searchsorted(at, x[1:] + reach, side="right")
    beside: np.ndarray = is_near & (np.diff(x) < KINK * (x[-1] - x[0]))
    return beside


def _halved(
    pieces: _Pieces, begin: float, end: float, least: float
) -> tuple[list[float], list[float]]:
    """Starts and steps of parts, each of a few steps or short."""
    step = _bound(pieces, begin, end)
    middle = 0.5 * (begin + end)
    if not np.isfinite(step) or end - begin <= FEW * step:
        return [begin], [step]
    if end - begin <= least and not _has_unlike_halves(pieces, begin, middle, end):
        return [begin], [step]
    halves = [_halved(pieces, *part, least) for part in ((begin, middle), (middle, end))]
    return halves[0][0] + halves[1][0], halves[0][1] + halves[1][1]


def _has_unlike_halves(pieces: _Pieces, begin: float, middle: float, end: float) -> bool:
    """Whether one half of a part takes much longer steps than the other."""
    if end - begin <= ROUND_OFF * max(abs(begin), abs(end), pieces.x[-1] - pieces.x[0]):
        return False
    one, other = _bound(pieces, begin, middle), _bound(pieces, middle, end)
    return max(one, other) > UNEQUAL * min(one, other)


def _bound(pieces: _Pieces, begin: float, end: float) -> float:
    """Longest step [s] between two times; infinite where the curve has nothing to see."""
    first = int(np.searchsorted(pieces.x, begin, side="right")) - 1
    last = max(int(np.searchsorted(pieces.x, end, side="left")), first + 1)
    bend, third = pieces.bend[first:last].max(), pieces.third[first:last].max()
    by_piece = float(np.diff(pieces.x[first : last + 1]).min()) / CUTS
    if bend == 0.0:
        return by_piece if pieces.rise[first:last].max() > 0.0 else np.inf
    by_shape = 2.0 * pi / PER_PERIOD * bend / third if third > 0.0 else np.inf
    by_shape = min(by_shape, 2.0 * pi / PER_ARC * float(np.sqrt(0.5 * pieces.range / bend)))
    by_size = float(np.sqrt(12.0 * NOTHING * pieces.range / bend))
    return max(by_shape, by_piece, by_size)


def _merged(starts: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours of like steps as one, of the smaller: powers of two of a second."""
    coarse = np.exp2(np.floor(np.log2(steps)))
    is_first = np.r_[True, coarse[1:] != coarse[:-1]]
    firsts = np.flatnonzero(is_first)
    return starts[firsts], np.minimum.reduceat(steps, firsts)
