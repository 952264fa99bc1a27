"""Curve from a formula of x, in SI, as cubics that keep to it within a stated tolerance.

    y(x) = expression, y'(x) its derivative, both exact at breakpoints;
    between two of them |cubic - expression| <= 1e-9 of the largest |y| there, or 1e-21 of the
    largest of all (1e-15 in a formula of many cubics), beside round-off; of a motion that drives a
    joint also |cubic'' - expression''| <= 1e-6 of the largest |y''|, of a velocity that does
    |cubic' - expression'| <= 1e-6 of the largest |y'|

Breakpoints halve until that holds, kinks included. `segments` is their initial number; every one
is evaluated at many points. Between them the formula is bounded (`_enclosures.py`), and where the
bounds leave room for more than a thousandth of the largest value, intervals are halved until there
is none: so the narrowest pulse is found, also on top of another function.
Consequence to test: a power, a root and a fast sine have their own values everywhere; a pulse has
its area.
References: de Boor, A Practical Guide to Splines (1978), chapter IV.
"""

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from pydantic import ValidationInfo, model_validator

from crashsolve.curves._card import EXTRAPOLATE, CurveCard, check_axis
from crashsolve.curves._derivatives import Jet, round_off, with_derivative
from crashsolve.curves._enclosures import Mask, deviation
from crashsolve.curves._piecewise import Array, hermite
from crashsolve.deck.building import Scene
from crashsolve.deck.card import word
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.numbers import Context, number_in
from crashsolve.deck.reading.expressions import Expression, ExpressionError
from crashsolve.foundation.distinct import distinct

# error of the cubics over the value, or over this share of the largest value; and the largest error
# of those that need too many
TOLERANCE, FLOOR, LOOSEST, ROUND_OFF = 1e-9, 1e-6, 2e-4, 1e-15
# the share of the largest value where so few cubics as these hold the formula: halving near a root
# of it takes some cubics for each factor of two
LOW_FLOOR, FEW = 1e-12, 20_000
# points at which a formula is evaluated, in each piece at least so many; and the most cubics
EVALUATIONS, LEAST, MAX_CUBICS = 65_536, 5, 450_000
# [of the range] the shortest cubic, which holds a kink; and least size of a jump, of the largest
# value
SMALLEST, JUMP = 1e-13, 1e-3
# [of the largest] error of the acceleration where a formula drives a joint; pieces that are
# shorter than this share of the range hold kinks
MOTION, SHORT = 1e-6, 1e-6
# [of the largest value] the least of what is sought between breakpoints, and the most searches
HIDDEN, SEARCHES = 1e-3, 10
# [of the largest value over the range, or its square] rates below that are those of round-off
SLOW = 2e-4
# against division by zero
TINY = 1e-300
TOO_FAST = f"needs more than {MAX_CUBICS} cubics over its range", "give a shorter range"
CANCELS = (
    "cancels: round-off is more than the differences that are left",
    "write it without differences of nearly equal terms",
)


class Formula(CurveCard):
    """Curve from a formula of x, such as `0.1*sin(2*pi*x)`; x and the result are in SI."""

    expression: str = word("formula of x")
    from_: float = word("lower end of the range, in SI or with a unit")
    to: float = word("upper end of the range, in SI or with a unit")
    segments: int = word(
        "initial number of cubics; they are halved until the error is below 1e-9",
        200,
        ge=1,
        le=100_000,
    )

    @model_validator(mode="before")
    @classmethod
    def _ends_to_si(cls, given: object, info: ValidationInfo) -> object:
        if not isinstance(given, Mapping):
            return given
        context = info.context or Context()
        ends = {}
        for name in ("from", "to"):
            if name in given:
                ends[name], unit = number_in(given[name], None, context, (name,))
                check_axis(unit, 0, name, context)
        return {**given, **ends}

    @model_validator(mode="after")
    def _can_be_sampled(self) -> "Formula":
        if self.to <= self.from_:
            raise ValueError("to: must be greater than from")
        try:
            sample(self)
        except ExpressionError as error:
            refuse(error.message, error.advice, within=("expression",))
        return self


def sample(card: Formula, order: int = 0) -> tuple[Array, Array, Array, float]:
    """Breakpoints, values and slopes (n,), and the tolerance kept. Raises ExpressionError.

    `order` is that of the highest derivative that is read.
    """
    return _sample(card.expression, card.from_, card.to, card.segments, order)


@lru_cache(maxsize=32)
def _sample(
    expression: str, start: float, end: float, segments: int, order: int
) -> tuple[Array, Array, Array, float]:
    """The samples of a formula, computed once for the check of the card and its build."""
    formula = Expression(expression)
    # a formula that cannot be evaluated is reported by the plain evaluation
    formula.value({"x": start})
    x = np.linspace(start, end, segments + 1)
    evaluations = max(math.ceil(EVALUATIONS / segments), LEAST)
    samples = _refined(formula, x, evaluations, order)
    for _ in range(SEARCHES):
        hidden = _hidden(formula, *samples[:3])
        if not len(hidden):
            break
        x = distinct(np.concatenate([x, hidden]))
        samples = _refined(formula, x, evaluations, order)
    if len(samples[0]) > FEW:
        return samples
    finer = _refined(formula, samples[0], LEAST, order, LOW_FLOOR)
    return finer if finer[3] <= samples[3] else samples


def _hidden(formula: Expression, x: Array, y: Array, slopes: Array) -> Array:
    """Positions (n,) where the formula is far from the cubics between these breakpoints."""
    far = HIDDEN * float(np.abs(y).max())
    left, right, done, midpoints = x[:-1], x[1:], 0, [x[:0]]
    while len(left) and done < MAX_CUBICS:
        middle = 0.5 * (left + right)
        may_be_far = (deviation(formula, left, right) > far) & (left < middle) & (middle < right)
        left, right, middle = left[may_be_far], right[may_be_far], middle[may_be_far]
        k = np.searchsorted(x, middle) - 1
        h, a, b = x[k + 1] - x[k], Jet(y[k], slopes[k]), Jet(y[k + 1], slopes[k + 1])
        cubic = _cubic(h, a, b, ((middle - x[k]) / h)[:, None])[:, 0]
        is_far = np.abs(with_derivative(formula, middle).y - cubic) > far
        midpoints.append(middle[is_far])
        left, right, middle = left[~is_far], right[~is_far], middle[~is_far]
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
        done += len(left)
    return np.concatenate(midpoints)


def _refined(
    formula: Expression, x: Array, evaluations: int, order: int, floor: float = FLOOR
) -> tuple[Array, Array, Array, float]:
    """Breakpoints that begin with x, values and slopes (n,), and the tolerance kept.

    `floor` is the share of the largest value below which errors are compared with it.
    """
    start, end = float(x[0]), float(x[-1])
    largest, fastest, tolerance = 0.0, 0.0, TOLERANCE
    done: list[Array] = []
    blurs: list[Array] = []
    left, right = x[:-1], x[1:]
    ends = _known(formula, x)
    a, b = Jet(ends.y[:-1], ends.slope[:-1]), Jet(ends.y[1:], ends.slope[1:])
    least = SMALLEST * max(end - start, abs(start), abs(end))
    count = len(left)
    while len(left):
        inside = _points_within(evaluations)
        positions = left[:, None] + (right - left)[:, None] * inside
        y, slope = (u.reshape(positions.shape) for u in with_derivative(formula, positions.ravel()))
        size = np.max(np.abs(np.column_stack([y, a.y, b.y])), axis=1)
        largest = max(largest, float(size.max()))
        error = np.max(np.abs(y - _cubic(right - left, a, b, inside)), axis=1)
        _refuse_jump(left, right, a.y, b.y, least, largest)
        scale = np.maximum(size, max(floor * largest, TINY))
        noise = np.maximum(round_off(formula, left), round_off(formula, right))
        own = largest if floor == FLOOR else size
        within = _round_off(own, np.maximum(np.abs(left), np.abs(right)), a, b) + noise
        error -= within
        rate_error = np.zeros_like(error)
        if order:
            rate_error, rate = _rates(right - left, a, b, slope, inside, within, order)
            is_long = right - left > SHORT * (end - start)
            rate_error *= is_long
            fastest = max(fastest, float(rate[is_long].max(initial=0.0)))
        rate_share = rate_error / max(motion_tolerance(1.0) * fastest, TINY)
        is_rough, tolerance = _rough(
            (
                np.maximum(error / scale, rate_share),
                np.maximum(error / max(largest, TINY), rate_share),
            ),
            right - left > least,
            MAX_CUBICS - count,
            tolerance,
        )
        done.append(left[~is_rough])
        fast = max(fastest, SLOW * largest / (end - start) ** order, TINY)
        blur = _blur(noise, right - left, a.slope - b.slope, (largest, fast), order)
        blurs.append(blur[~is_rough])
        left, right, a, b = _halved(formula, left, right, a, b, is_rough)
        count += len(left) // 2
        evaluations = max((evaluations + 1) // 2, LEAST)
    x = np.concatenate([np.sort(np.concatenate(done)), [end]])
    jet = _known(formula, x)
    # of most pieces: those at a kink are short
    blur = float(np.median(np.concatenate(blurs)))
    if max(tolerance, blur) > LOOSEST:
        raise ExpressionError(*(CANCELS if blur > LOOSEST else TOO_FAST))
    return x, jet.y, jet.slope, max(tolerance, blur)


def _rough(
    errors: tuple[Array, Array], is_divisible: Mask, room: int, tolerance: float
) -> tuple[Mask, float]:
    """Which intervals are halved, and the tolerance: a looser one where there is too little room.

    `errors` (n,): over the values of each, and, where that asks for too many, over the largest of
    all. None is halved where no tolerance is loose enough.
    """
    is_rough: Mask = is_divisible & (errors[0] > tolerance)
    while is_rough.sum() > room and tolerance <= LOOSEST:
        tolerance *= 10.0
        is_rough &= errors[1] > tolerance
    return is_rough & (tolerance <= LOOSEST), tolerance


def _round_off(values: float | Array, size: Array, a: Jet, b: Jet) -> Array:
    """Round-off (n,) of `values` from a to b, also that of x of this size in a steep formula."""
    steepest = np.maximum(np.abs(a.slope), np.abs(b.slope))
    with np.errstate(over="ignore"):
        return np.asarray(ROUND_OFF * (values + size * steepest))


def _points_within(count: int) -> Array:
    """Positions (n,) in an interval from 0 to 1; a fast sine could be a multiple of equidistant
    ones.
    """
    even = np.linspace(0.0, 1.0, count + 2)[1:-1]
    positions: Array = even + 0.3 / (count + 1) * np.sin(17.0 * even)
    return positions


def _halved(
    formula: Expression, left: Array, right: Array, a: Jet, b: Jet, which: Mask
) -> tuple[Array, Array, Jet, Jet]:
    """Both halves of some intervals, with the formula at their ends."""
    left, right = left[which], right[which]
    a, b = (Jet(j.y[which], j.slope[which]) for j in (a, b))
    middle = 0.5 * (left + right)
    m = _known(formula, middle)
    a, b = (
        Jet(*(np.concatenate(pair) for pair in zip(*pairs, strict=True)))
        for pairs in ((a, m), (m, b))
    )
    return np.concatenate([left, middle]), np.concatenate([middle, right]), a, b


def _blur(noise: Array, h: Array, change: Array, of: tuple[float, float], order: int) -> Array:
    """Tolerances (n,) that round-off of the values of cubics of length h (n,) leaves.

    At both ends of a cubic it changes the slope by 3 / h of it, the second derivative by 12 / h^2;
    where the slope does not change, nothing reads that. `of`: the largest value and rate.
    """
    blur: Array = noise / max(of[0], TINY)
    if order:
        share = noise * (3.0 / h if order == 1 else 12.0 / h**2) / of[1]
        share[change == 0.0] = 0.0
        blur = np.maximum(blur, share / motion_tolerance(1.0))
    return blur


def _known(formula: Expression, x: Array) -> Jet:
    """Values and slopes at positions; by a difference where the formula has no slope."""
    jet = with_derivative(formula, x)
    slope = jet.slope.copy()
    slope[~np.isfinite(slope)] = 0.0
    return Jet(jet.y, slope)


def _cubic(h: Array, a: Jet, b: Jet, part: Array) -> Array:
    """Values (n, m) of cubics of length h (n,) at parts (m,) of it."""
    h, secant = h[:, None], (b.y - a.y)[:, None]
    first, last = h * a.slope[:, None], h * b.slope[:, None]
    bend = first + last - 2.0 * secant
    value: Array = a.y[:, None] + part * (first + part * (secant - first - bend + part * bend))
    return value


def _rates(
    h: Array, a: Jet, b: Jet, slopes: Array, part: Array, round_off: Array, order: int
) -> tuple[Array, Array]:
    """Errors of the derivatives of this order, 1 or 2, of cubics (n,), by slopes (n, m) at parts of
    them; and the largest of these derivatives. `round_off` (n,) is that of the values.

    Of a fourth derivative q the slope errs by q h^3 / 125 at most, the second one by q h^2 / 12.
    """
    h, secant = h[:, None], (b.y - a.y)[:, None] / h[:, None]
    first, last = a.slope[:, None], b.slope[:, None]
    bend = first + last - 2.0 * secant
    ends = 2.0 * (secant - first - bend), 2.0 * (secant - first + 2.0 * bend)
    error = np.abs(first + part * (ends[0] + 3.0 * part * bend) - slopes)
    error -= ROUND_OFF * np.maximum(np.abs(first), np.abs(last)) + round_off[:, None] / h
    # where the formula has no slope there is a kink, which is none of the cubics
    error[~np.isfinite(error)] = 0.0
    worst: Array = np.max(error, axis=1)
    if order == 1:
        return worst, np.max(np.abs(np.hstack([first, last])), axis=1)
    return worst * 125.0 / 12.0 / h[:, 0], np.max(np.abs(np.hstack(ends)) / h, axis=1)


def _refuse_jump(
    left: Array, right: Array, before: Array, after: Array, least: float, largest: float
) -> None:
    """Raises ExpressionError where the formula jumps: no slope continues it."""
    jumps = (right - left <= least) & (np.abs(after - before) > JUMP * largest)
    for at in left[jumps][:1]:
        raise ExpressionError(
            f"the formula jumps at x = {at:.6g}", "give it a slope there, or a shorter range"
        )


def motion_tolerance(tolerance: float) -> float:
    """Error of accelerations over their largest, where that of the values is `tolerance`."""
    return MOTION / TOLERANCE * tolerance


def build_motion(card: Formula, scene: Scene, order: int) -> tuple[Array, Array, int]:
    """As `build`, of a motion whose derivative of this order is read."""
    return build(card, scene, order=order)


def build(card: Formula, scene: Scene, *, order: int = 0) -> tuple[Array, Array, int]:
    """Breakpoints (n,), coefficients (n - 1, 4) and the code of extrapolation."""
    try:
        x, y, slopes, tolerance = sample(card, order)
    except ExpressionError as error:
        raise scene.fail(f"{error.message}; {error.advice}", "expression") from None
    if tolerance > TOLERANCE:
        scene.warnings.append(
            f"formula '{card.expression}': {len(x) - 1} cubics approximate it within "
            f"{tolerance:.0e} of its largest value, where {TOLERANCE:.0e} is usual"
            + (f", and its acceleration within {motion_tolerance(tolerance):.0e}" * (order > 0))
            + "; give a shorter range, or write it without differences of nearly equal terms"
        )
    return x, hermite(x, y, slopes), EXTRAPOLATE[card.extrapolate]
