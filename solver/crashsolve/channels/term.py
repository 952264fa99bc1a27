"""What functions of channels are given and give back: values with a unit."""

from typing import NamedTuple

import numpy as np

from crashsolve.channels.display import Product, factor, same_dimension
from crashsolve.channels.errors import ChannelError

SECOND = Product.parse("s")


class Term(NamedTuple):
    """Values (n,) or one number; unit None marks a bare number, which fits any unit."""

    values: np.ndarray | float
    unit: Product | None

    def over(self, time: np.ndarray) -> np.ndarray:
        """The values at all sample times (n,)."""
        return np.broadcast_to(np.asarray(self.values, float), time.shape)

    @property
    def product(self) -> Product:
        """The unit of the term; that of a bare number is 1."""
        return Product() if self.unit is None else self.unit


def common_unit(*terms: Term) -> Product | None:
    """The unit in which terms can be added; raises ChannelError where there is none."""
    units = [term.unit for term in terms if term.unit is not None]
    for unit in units[1:]:
        if not same_dimension(units[0], unit):
            raise ChannelError(f"cannot add '{units[0]}' and '{unit}': units differ")
    return units[0] if units else None


def duration(term: Term, function: str) -> float:
    """A duration [s] given as '15 ms'; raises ChannelError for anything else.

    A bare number is none: 15 would be taken for seconds.
    """
    is_one = np.ndim(term.values) == 0 and term.unit is not None
    if not is_one or not same_dimension(term.product, SECOND) or not term.values > 0:
        raise ChannelError(f"{function}() takes a duration with its unit, as in '15 ms'")
    return float(term.values)


def in_gravities(term: Term, time: np.ndarray, function: str) -> np.ndarray:
    """The magnitude (n,) of an acceleration in units of 9.80665 m/s^2; raises ChannelError."""
    try:
        size = factor(str(term.product), "g0")
    except ChannelError:
        shown = f"'{term.unit}'" if term.unit is not None else "a bare number"
        raise ChannelError(f"{function}() takes an acceleration, not {shown}") from None
    return np.abs(term.over(time)) * size
