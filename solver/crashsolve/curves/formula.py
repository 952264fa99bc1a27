"""Curve from a formula of x, in SI, as cubics that keep to it within a stated tolerance.

    y(x) = expression, y'(x) its derivative, both exact at breakpoints;
    between two of them |cubic - expression| <= 1e-9 of the largest |y| there, or 1e-15 of the
    largest of all, beside the round-off of x; of a motion that drives a joint also
    |cubic'' - expression''| <= 1e-6 of the largest |y''|

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
from crashsolve.curves._derivatives import Jet, with_derivative
from crashsolve.curves._enclosures import deviation
from crashsolve.curves._piecewise import Array, hermite
from crashsolve.deck.building import Scene
from crashsolve.deck.card import word
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.numbers import Context, number_in
from crashsolve.deck.reading.expressions import Expression, ExpressionError

# error of the cubics over the value, or over this share of the largest value; and the largest error
# of those that need too many
TOLERANCE, FLOOR, LOOSEST, ROUND_OFF = 1e-9, 1e-6, 2e-4, 1e-15
# points at which a formula is evaluated, in each piece at least so many; and the most cubics
EVALUATIONS, LEAST, MAX_CUBICS = 65_536, 5, 450_000
# [of the range] the shortest cubic, which holds a kink; and least size of a jump, of the largest
# value
SMALLEST, JUMP = 1e-13, 1e-3
# [of the largest] error of the second derivative where a formula drives a joint; pieces that are
# shorter than this share of the range hold kinks
MOTION, SHORT = 1e-6, 1e-6
# [of the largest value] the least of what is sought between breakpoints, and the most searches
HIDDEN, SEARCHES = 1e-3, 10


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


def sample(card: Formula, *, is_motion: bool = False) -> tuple[Array, Array, Array, float]:
    """Breakpoints, values and slopes (n,), and the tolerance kept. Raises ExpressionError."""
    return _sample(card.expression, card.from_, card.to, card.segments, is_motion)


@lru_cache(maxsize=32)
def _sample(
    expression: str, start: float, end: float, segments: int, is_motion: bool
) -> tuple[Array, Array, Array, float]:
    """The samples of a formula, computed once for the check of the card and its build."""
    formula = Expression(expression)
    # a formula that cannot be evaluated is reported by the plain evaluation
    formula.value({"x": start})
    x = np.linspace(start, end, segments + 1)
    evaluations = max(math.ceil(EVALUATIONS / segments), LEAST)
    samples = _refined(formula, x, evaluations, is_motion=is_motion)
    for _ in range(SEARCHES):
        hidden = _hidden(formula, *samples[:3])
        if not len(hidden):
            break
        x = np.union1d(x, hidden)
        samples = _refined(formula, x, evaluations, is_motion=is_motion)
    return samples


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
    formula: Expression, x: Array, evaluations: int, *, is_motion: bool
) -> tuple[Array, Array, Array, float]:
    """Breakpoints that begin with x, values and slopes (n,), and the tolerance kept."""
    start, end = float(x[0]), float(x[-1])
    largest, bent, tolerance = 0.0, 0.0, TOLERANCE
    done: list[Array] = []
    left, right = x[:-1], x[1:]
    ends = _known(formula, x)
    a, b = Jet(ends.y[:-1], ends.slope[:-1]), Jet(ends.y[1:], ends.slope[1:])
    least = SMALLEST * max(end - start, abs(start), abs(end))
    count = len(left)
    while len(left):
        inside = np.linspace(0.0, 1.0, evaluations + 2)[1:-1]
        # a fast sine could be a multiple of equidistant points
        inside = inside + 0.3 / (evaluations + 1) * np.sin(17.0 * inside)
        positions = left[:, None] + (right - left)[:, None] * inside
        y, slope = (u.reshape(positions.shape) for u in with_derivative(formula, positions.ravel()))
        size = np.max(np.abs(np.column_stack([y, a.y, b.y])), axis=1)
        largest = max(largest, float(size.max()))
        error = np.max(np.abs(y - _cubic(right - left, a, b, inside)), axis=1)
        _refuse_jump(left, right, a.y, b.y, least, largest)
        scale = np.maximum(size, FLOOR * largest)
        round_off = _round_off(largest, np.maximum(np.abs(left), np.abs(right)), a, b)
        error -= round_off
        bend_error = np.zeros_like(error)
        if is_motion:
            bend_error, bend = _bends(right - left, a, b, slope, inside, round_off)
            is_long = right - left > SHORT * (end - start)
            bend_error *= is_long
            bent = max(bent, float(bend[is_long].max(initial=0.0)))
        limit = motion_tolerance(1.0) * bent
        is_rough = (error > tolerance * scale) | (bend_error > tolerance * limit)
        is_rough &= right - left > least
        while count + is_rough.sum() > MAX_CUBICS:
            tolerance *= 10.0
            # a fast one: of its largest value
            scale = np.full_like(scale, largest)
            is_rough &= (error > tolerance * scale) | (bend_error > tolerance * limit)
            if tolerance > LOOSEST:
                raise ExpressionError(
                    f"needs more than {MAX_CUBICS} cubics from {start:g} to {end:g}",
                    "give a shorter range",
                )
        done.append(left[~is_rough])
        left, right = left[is_rough], right[is_rough]
        a, b = (Jet(j.y[is_rough], j.slope[is_rough]) for j in (a, b))
        middle = 0.5 * (left + right)
        m = _known(formula, middle)
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
        a, b = (
            Jet(*(np.concatenate(pair) for pair in zip(*pairs, strict=True)))
            for pairs in ((a, m), (m, b))
        )
        count += len(middle)
        evaluations = max((evaluations + 1) // 2, LEAST)
    x = np.concatenate([np.sort(np.concatenate(done)), [end]])
    jet = _known(formula, x)
    return x, jet.y, jet.slope, tolerance


def _round_off(largest: float, size: Array, a: Jet, b: Jet) -> Array:
    """Round-off of values (n,) between a and b, also that of x of this size in a steep formula."""
    steepest = np.maximum(np.abs(a.slope), np.abs(b.slope))
    with np.errstate(over="ignore"):
        return np.asarray(ROUND_OFF * (largest + size * steepest))


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


def _bends(
    h: Array, a: Jet, b: Jet, slopes: Array, part: Array, round_off: Array
) -> tuple[Array, Array]:
    """Errors of the second derivatives of cubics (n,), by slopes (n, m) at parts of them; and the
    largest of these derivatives. `round_off` (n,) is that of the values.

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
    worst: Array = np.max(error, axis=1) * 125.0 / 12.0 / h[:, 0]
    return worst, np.max(np.abs(np.hstack(ends)) / h, axis=1)


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
    """Error of the second derivative over its largest, where that of the values is `tolerance`."""
    return MOTION / TOLERANCE * tolerance


def build_motion(card: Formula, scene: Scene) -> tuple[Array, Array, int]:
    """As `build`, of a motion whose second derivative is read."""
    return build(card, scene, is_motion=True)


def build(card: Formula, scene: Scene, *, is_motion: bool = False) -> tuple[Array, Array, int]:
    """Breakpoints (n,), coefficients (n - 1, 4) and the code of extrapolation."""
    try:
        x, y, slopes, tolerance = sample(card, is_motion=is_motion)
    except ExpressionError as error:
        raise scene.fail(f"{error.message}; {error.advice}", "expression") from None
    if tolerance > TOLERANCE:
        scene.warnings.append(
            f"formula '{card.expression}': {len(x) - 1} cubics approximate it within "
            f"{tolerance:.0e} of its largest value, where {TOLERANCE:.0e} is usual"
            + (f", and its acceleration within {motion_tolerance(tolerance):.0e}" * is_motion)
            + "; give a shorter range"
        )
    return x, hermite(x, y, slopes), EXTRAPOLATE[card.extrapolate]
