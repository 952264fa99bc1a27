"""One varied parameter of a sweep: its values, or its range and distribution.

    x = F^-1(u),   0 < u < 1,   F the distribution function of x

Cut to [a, b]: x = F^-1(F(a) + u (F(b) - F(a))). Consequence to test: with u spread evenly, the
values have the mean and the deviation that the plan names.

References: Devroye, Non-uniform random variate generation (1986), section 2.1.
"""

import math
from typing import ClassVar, Literal, NamedTuple

from pydantic import field_validator, model_validator

from crashsolve.channels.units import UnitError, parse_unit, split_quantity
from crashsolve.deck.card import Card, word
from crashsolve.deck.diagnostics import refuse, shown
from crashsolve.deck.numbers import as_written

# share of a distribution that its limits must leave
LEAST_SHARE = 1e-6
# sizes of numbers whose quotients are numbers; deviations of lognormal values over their mean
SMALLEST, LARGEST, WIDEST = 1e-150, 1e150, 1e6
NORMALS = ("normal", "lognormal")


class Amount(NamedTuple):
    """A number of the plan and the unit it is written in, empty without one."""

    number: float
    unit: str


class Axis(Card):
    """A parameter that is varied: a list of values, a range, or a distribution."""

    fields_of: ClassVar[dict[str, tuple[str, ...]]] = {
        "mean": NORMALS,
        "deviation": NORMALS,
        "peak": ("triangular",),
    }

    values: tuple[object, ...] | None = word("values to take, numbers or words", None)
    from_: float | str | None = word("least value, alone or with a unit", None)
    to: float | str | None = word("largest value, in the same unit", None)
    count: int | None = word("values of a range in a grid", None, ge=2, le=10_000)
    distribution: Literal["uniform", "log_uniform", "normal", "lognormal", "triangular"] = word(
        "how values are spread; normal and lognormal are cut at from and to, if given", "uniform"
    )
    mean: float | str | None = word("mean of the values", None)
    deviation: float | str | None = word("standard deviation of the values, in their unit", None)
    peak: float | str | None = word("most likely value of a triangular distribution", None)
    whole: bool = word("whole numbers only, each with the same probability; for uniform", False)

    @field_validator("values")
    @classmethod
    def _plain(cls, values: tuple[object, ...] | None) -> tuple[object, ...] | None:
        for i, value in enumerate(values or ()):
            if not isinstance(value, str | int | float | bool | None):
                refuse(f"must be a number or a word, not {shown(value)}", within=(i,))
        if values is not None and not values:
            refuse("an empty list: nothing would be run")
        return values

    @field_validator("from_", "to", "mean", "deviation", "peak")
    @classmethod
    def _readable(cls, value: float | str | None) -> float | str | None:
        if isinstance(value, str):
            try:
                parse_unit(split_quantity(value)[1] or "1")
            except UnitError as error:
                refuse("must be a number, alone or with a unit", str(error))
        return value

    @model_validator(mode="after")
    def _one_kind(self) -> "Axis":
        if self.values is not None:
            others = [name for name in type(self).model_fields if name not in ("values",)]
            extra = [name for name in others if name in self.model_fields_set]
            if extra:
                raise ValueError(
                    f"{extra[0].rstrip('_')}: cannot be combined with a list of values"
                )
            return self
        for name, kinds in self.fields_of.items():
            if getattr(self, name) is not None and self.distribution not in kinds:
                raise ValueError(f"{name}: belongs to distribution: {' or '.join(kinds)}")
            if getattr(self, name) is None and self.distribution in kinds:
                raise ValueError(f"distribution: {self.distribution} needs '{name}'")
        if self.distribution not in NORMALS and (self.from_ is None or self.to is None):
            raise ValueError("needs a list of values, or a range from: ... to: ...")
        self._check_range()
        return self

    def _check_range(self) -> None:
        """Raises ValueError for a range that is empty or that its distribution cannot fill."""
        self._check_numbers()
        low, high = self._number("from_"), self._number("to")
        if low is not None and high is not None:
            _check_ends(low, high)
        self._check_shape(low, high)
        self._check_positive(low)
        if self.whole:
            self._check_whole(low, high)
        if self.distribution in NORMALS and self._share()[1] < LEAST_SHARE:
            raise ValueError("from: the limits leave nothing of the distribution")

    def _check_numbers(self) -> None:
        """All in one unit, and of sizes that can be drawn from."""
        units = {amount.unit for amount in self._given().values()}
        if len(units) > 1:
            message = " and ".join(f"'{unit or 'none'}'" for unit in sorted(units))
            raise ValueError(f"numbers of one range must be in one unit, not in {message}")
        for name, amount in self._given().items():
            if amount.number and not SMALLEST <= abs(amount.number) <= LARGEST:
                raise ValueError(f"{name.rstrip('_')}: {amount.number:g} is too large or small")

    def _check_shape(self, low: float | None, high: float | None) -> None:
        """The peak within the range, and a deviation that spreads."""
        peak, deviation = self._number("peak"), self._number("deviation")
        if peak is not None and not (low or 0.0) <= peak <= (high or 0.0):
            raise ValueError(f"peak: must lie from {low:g} to {high:g}")
        if deviation is not None and deviation <= 0.0:
            raise ValueError("deviation: must be greater than 0")

    def _check_positive(self, low: float | None) -> None:
        is_log = self.distribution in ("log_uniform", "lognormal")
        if is_log and low is not None and low <= 0.0:
            raise ValueError(f"from: must be greater than 0 for {self.distribution}")
        mean, deviation = self._number("mean") or 0.0, self._number("deviation") or 0.0
        if self.distribution != "lognormal":
            return
        if mean <= 0.0:
            raise ValueError("mean: must be greater than 0 for lognormal")
        if not 1.0 / WIDEST <= deviation / mean <= WIDEST:
            raise ValueError(f"deviation: must be from 1/{WIDEST:g} to {WIDEST:g} times the mean")

    def _check_whole(self, low: float | None, high: float | None) -> None:
        if self.distribution != "uniform":
            raise ValueError("whole: requires distribution: uniform")
        if low != int(low or 0.0) or high != int(high or 0.0):
            raise ValueError("whole: from and to must be whole numbers")
        if self.count is not None and (int(high or 0) - int(low or 0)) % (self.count - 1):
            raise ValueError(f"count: {self.count} whole numbers are not evenly apart here")

    def _given(self) -> dict[str, Amount]:
        names = ("from_", "to", "mean", "deviation", "peak")
        values = {name: getattr(self, name) for name in names}
        return {name: _amount(value) for name, value in values.items() if value is not None}

    def _number(self, name: str) -> float | None:
        amount = self._given().get(name)
        return None if amount is None else amount.number

    @property
    def unit(self) -> str:
        """Unit of its numbers as the plan writes them; empty for bare numbers and words."""
        if self.values is None:
            return next(iter(self._given().values())).unit
        units = {_unit_of(value) for value in self.values}
        return units.pop() or "" if len(units) == 1 else ""

    @property
    def is_of_numbers(self) -> bool:
        """Whether its values are numbers, all in one unit, which can be drawn on an axis."""
        units = {_unit_of(value) for value in self.values or ()}
        return self.values is None or (None not in units and len(units) == 1)

    def texts(self) -> list[str]:
        """The values of a grid or of a list, as --set takes them."""
        if self.values is not None:
            return [as_text(value) for value in self.values]
        assert self.count is not None
        low, high = self._number("from_") or 0.0, self._number("to") or 0.0
        shares = [i / (self.count - 1) for i in range(self.count)]
        if self.distribution == "log_uniform":
            ratio = high / low
            # the ends are kept as they are written
            numbers = [low, *(low * ratio**share for share in shares[1:-1]), high]
        else:
            numbers = [low + share * (high - low) for share in shares]
        return [self._text(number) for number in numbers]

    def text(self, u: float) -> str:
        """The value at a share of the distribution, 0 < u < 1, as --set takes it."""
        if self.values is not None:
            return as_text(self.values[int(u * len(self.values))])
        return self._text(self._quantile(u))

    def _text(self, number: float) -> str:
        written = str(round(number)) if self.whole else as_written(number)
        return f"{written} {self.unit}".rstrip()

    def _quantile(self, u: float) -> float:
        low, high = self._number("from_") or 0.0, self._number("to") or 0.0
        if self.whole:
            return float(math.floor(low + u * (high - low + 1.0)))
        match self.distribution:
            case "uniform":
                return low + u * (high - low)
            case "log_uniform":
                return low * (high / low) ** u
            case "triangular":
                peak = self._number("peak") or 0.0
                before = (peak - low) / (high - low)
                if u < before:
                    return low + math.sqrt(u * (high - low) * (peak - low))
                return high - math.sqrt((1.0 - u) * (high - low) * (high - peak))
        from scipy.special import ndtri

        below, share = self._share()
        mean, deviation = self._of_normal()
        x = mean + deviation * float(ndtri(below + u * share))
        return math.exp(x) if self.distribution == "lognormal" else x

    def _of_normal(self) -> tuple[float, float]:
        """Mean and deviation of the value, or of its logarithm for lognormal."""
        mean, deviation = self._number("mean") or 0.0, self._number("deviation") or 0.0
        if self.distribution == "normal":
            return mean, deviation
        square = math.log1p((deviation / mean) ** 2)
        return math.log(mean) - square / 2.0, math.sqrt(square)

    def _share(self) -> tuple[float, float]:
        """Shares of a normal distribution below its limits and between them."""
        mean, deviation = self._of_normal()
        ends = []
        for name, open_end in (("from_", 0.0), ("to", 1.0)):
            limit = self._number(name)
            if limit is None or (self.distribution == "lognormal" and limit <= 0.0):
                ends.append(open_end if limit is None else 0.0)
                continue
            x = math.log(limit) if self.distribution == "lognormal" else limit
            ends.append(0.5 * math.erfc((mean - x) / (deviation * math.sqrt(2.0))))
        return ends[0], ends[1] - ends[0]


def _amount(value: float | str) -> Amount:
    return Amount(*split_quantity(value)) if isinstance(value, str) else Amount(float(value), "")


def _unit_of(value: object) -> str | None:
    """Unit of a number, None for a word."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return None
    if not isinstance(value, str):
        return ""
    try:
        unit = split_quantity(value)[1]
        parse_unit(unit or "1")
        return unit
    except UnitError:
        return None


def _check_ends(low: float, high: float) -> None:
    if low > high:
        raise ValueError(f"from: {low:g} is more than to: {high:g}")
    if low == high:
        raise ValueError(f"from: and to are both {low:g}, which leaves nothing to vary")


def as_text(value: object) -> str:
    """A value of the plan in the words of --set."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(value)
