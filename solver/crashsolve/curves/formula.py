"""Curve from a formula of x, in SI, sampled to piecewise cubics.

    y(x) = expression, with slopes from five-point differences of step h/4

Consequence to test: a quartic's values and slopes at the breakpoints are exact, and the error
between them falls with h^4.
References: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), table 25.2.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from pydantic import ValidationInfo, model_validator

from crashsolve.curves._card import EXTRAPOLATE, CurveCard
from crashsolve.curves._piecewise import Array, hermite
from crashsolve.deck.card import word
from crashsolve.deck.mistakes import refuse
from crashsolve.deck.numbers import Context, number_in
from crashsolve.deck.reading.expressions import Expression, ExpressionError

FINE = 4  # samples to a segment


class Formula(CurveCard):
    """Curve from a formula of x, such as `0.1*sin(2*pi*x)`; x and the result are in SI."""

    expression: str = word("formula of x")
    from_: float = word("lower end of the range, in SI or with a unit")
    to: float = word("upper end of the range, in SI or with a unit")
    segments: int = word("cubics that make up the curve", 200, ge=1, le=100_000)

    @model_validator(mode="before")
    @classmethod
    def _ends_to_si(cls, given: Any, info: ValidationInfo) -> Any:
        if not isinstance(given, Mapping):
            return given
        context = info.context or Context()
        ends = {
            name: number_in(given[name], None, context, (name,))[0]
            for name in ("from", "to")
            if name in given
        }
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


def sample(card: Formula) -> tuple[Array, Array]:
    """Abscissae and values (4 segments + 1,), at every quarter. Raises ExpressionError."""
    return _sample(card.expression, card.from_, card.to, card.segments)


@lru_cache(maxsize=32)
def _sample(expression: str, start: float, end: float, segments: int) -> tuple[Array, Array]:
    """The same, once for the check of the card and its build."""
    formula = Expression(expression)
    x = np.linspace(start, end, FINE * segments + 1)
    return x, np.array([formula.value({"x": float(at)}) for at in x])


def build(card: Formula, scene: Any) -> tuple[Array, Array, int]:
    """Breakpoints (n,), coefficients (n - 1, 4) and the code of extrapolation."""
    x, y = sample(card)
    step = (card.to - card.from_) / (FINE * card.segments)
    middle = (y[2:-6:FINE] - 8 * y[3:-5:FINE] + 8 * y[5:-3:FINE] - y[6:-2:FINE]) / (12 * step)
    ends = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / (12 * step)
    slopes = np.concatenate([[ends @ y[:5]], middle, [-ends @ y[:-6:-1]]])
    coarse = x[::FINE]
    return coarse, hermite(coarse, y[::FINE], slopes), EXTRAPOLATE[card.extrapolate]
