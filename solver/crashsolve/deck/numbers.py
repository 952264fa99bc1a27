"""Numbers as they stand in a deck, bare or with a unit, brought to SI."""

import math
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from crashsolve.channels.units import (
    BASES,
    PURE,
    SI,
    SI_SYMBOLS,
    Unit,
    UnitError,
    default_factor,
    describe,
    parse_unit,
    product_of,
    split_quantity,
    to_si,
)
from crashsolve.deck.diagnostics import already_reported, refuse, shown
from crashsolve.deck.source import BROKEN

# a unit that is not known may have any base
EVERY_BASE = Unit(1.0, (Fraction(1),) * len(BASES))


class Foreign(NamedTuple):
    """A parameter with bare numbers, its file, and which of BASES have other units there."""

    name: str
    file: str
    bases: tuple[str, ...]

    def refuse_in(self, unit: Unit, value: float) -> None:
        """Raise UnitError where it may stand for another number of that unit."""
        used = [base for base, power in zip(BASES, unit.exponents, strict=True) if power]
        if value != 0.0 and any(base in self.bases for base in used):
            raise UnitError(
                f"parameter '{self.name}' has bare numbers in the units of {self.file}, which are "
                "not those of this file; give its unit there ('1' if it has none)"
            )


class BareFloat(float):
    """A bare number that parameters of files with other units make."""

    foreign: tuple[Foreign, ...]

    def __new__(cls, value: float, foreign: tuple[Foreign, ...]) -> "BareFloat":
        self = super().__new__(cls, value)
        self.foreign = foreign
        return self

    def __getnewargs__(self) -> tuple[float, tuple[Foreign, ...]]:  # type: ignore[override]
        """Arguments with which a copy is made."""
        return float(self), self.foreign


class BareInt(int):
    """The same of a whole number, which may be a count."""

    foreign: tuple[Foreign, ...]

    def __new__(cls, value: float, foreign: tuple[Foreign, ...]) -> "BareInt":
        self = super().__new__(cls, value)
        self.foreign = foreign
        return self

    def __getnewargs__(self) -> tuple[int, tuple[Foreign, ...]]:  # type: ignore[override]
        """Arguments with which a copy is made."""
        return int(self), self.foreign


class SiFloat(float):
    """A number known to be in SI already, such as an expression of parameters with units.

    `unit` is its SI unit; None where the expression does not state one. `derived` is its unit if
    the bare numbers of the expression are pure; None where terms of a sum then differ. `foreign`
    are its bare parameters of files with other units.
    """

    unit: Unit | None
    derived: Unit | None
    foreign: tuple[Foreign, ...]

    def __new__(
        cls,
        value: float,
        unit: Unit | None = None,
        derived: Unit | None = None,
        foreign: tuple[Foreign, ...] = (),
    ) -> "SiFloat":
        self = super().__new__(cls, value)
        self.unit = unit and Unit(1.0, unit.exponents)
        self.derived = derived and Unit(1.0, derived.exponents)
        self.foreign = foreign
        return self

    def __getnewargs__(self) -> tuple[object, ...]:  # type: ignore[override]
        """Arguments with which a copy is made."""
        return float(self), self.unit, self.derived, self.foreign


class Context(NamedTuple):
    """Properties of the file of a card: units of bare numbers, and folder.

    `symbols` are those units by name; `axes` the units of x and y of a curve by its use.
    """

    units: Mapping[str, Unit] = SI
    folder: Path = Path()
    symbols: tuple[str, ...] = SI_SYMBOLS
    axes: tuple[str, str] | None = None

    def unit_of_axis(self, j: int) -> str | None:
        """Unit of the bare numbers of x or y of a curve in this file, where its use states it."""
        if self.axes is None or self.units is SI:
            return None
        return product_of(self.symbols, parse_unit(self.axes[j]))


def as_written(value: float) -> str:
    """A number as text without round-off: 1.8 for 1.8000000000000003.

    Short is up to twelve digits, rounding a few units of the last digit.
    """
    if not isinstance(value, float):
        return repr(value)
    short = float(f"{value:.12g}")
    return repr(short if abs(value - short) <= 4.0 * math.ulp(value) else float(value))


def number(value: str | float, wanted: str, bases: Mapping[str, Unit]) -> float:
    """A number of the dimension of `wanted`, bare ones in units of `bases`; raises UnitError."""
    if isinstance(value, SiFloat):
        if value.unit and value.unit.exponents != parse_unit(wanted).exponents:
            raise UnitError(f"this expression is in {describe(value.unit)}")
        return float(value) * _factor_of_mixed(value, parse_unit(wanted), bases)
    if isinstance(value, str):
        return to_si(value, wanted, bases)
    refuse_foreign(value, parse_unit(wanted))
    try:
        return float(value) * default_factor(parse_unit(wanted), bases)
    except OverflowError:
        raise UnitError("this number is too large") from None


def refuse_foreign(value: float, unit: Unit) -> None:
    """Raise UnitError at a number of that unit that parameters of files with other units make."""
    for parameter in getattr(value, "foreign", ()):
        parameter.refuse_in(unit, value)


def _factor_of_mixed(value: SiFloat, wanted: Unit, bases: Mapping[str, Unit]) -> float:
    """From an expression of parameters with units to SI, in a file with units of its own.

    Bare numbers in it are pure where the units then fit, and all in units of the file where those
    of the others cancel. Raises UnitError elsewhere, as it is unknown which of them have a unit; in
    SI nobody needs to.
    """
    derived = value.derived
    if derived and derived.exponents == wanted.exponents:
        return 1.0
    refuse_foreign(value, wanted)
    if all(
        bases[name].factor == SI[name].factor
        for name, power in zip(BASES, wanted.exponents, strict=True)
        if power
    ):
        return 1.0
    if derived and derived.exponents == PURE.exponents:
        return default_factor(wanted, bases)
    advice = "this file has units of its own: give the unit of every parameter that has one"
    raise UnitError(f"this expression mixes bare numbers with numbers in units; {advice}")


def number_in(
    value: object, unit: Unit | None, context: Context, within: tuple[str | int, ...]
) -> tuple[float, Unit | None]:
    """A number whose unit is given beside it or in its own text; in SI, with its unit.

    A bare number without any unit is in SI, and refused where the file has units of its own,
    unless it is zero.
    """
    if value is BROKEN:
        already_reported()
    if isinstance(value, SiFloat):
        return _of_expression(value, unit, context, within)
    kind = "a number, alone or with a unit"
    try:
        if isinstance(value, str):
            value, name = split_quantity(value)
            own = parse_unit(name) if name else unit
            if unit and own and own.exponents != unit.exponents:
                raise UnitError(f"this is in {describe(own)}, not in {describe(unit)}")
            unit = own
        if isinstance(value, bool) or not isinstance(value, int | float):
            refuse(f"must be {kind}, not {shown(value)}", within=within)
        if unit is None:
            refuse_foreign(value, EVERY_BASE)
        if unit is None and context.units is not SI and value != 0:
            raise UnitError("this file has units of its own, so give the unit of this number")
        return float(value) * (unit or PURE).factor, unit
    except (UnitError, OverflowError) as error:
        refuse(f"must be {kind}", str(error), within=within)


def _of_expression(
    value: SiFloat, unit: Unit | None, context: Context, within: tuple[str | int, ...]
) -> tuple[float, Unit | None]:
    """The value of an expression in SI, with its unit; refused in another unit than is wanted."""
    if unit and value.unit and value.unit.exponents != unit.exponents:
        refuse(
            f"must be in {describe(unit)}",
            f"this expression is in {describe(value.unit)}",
            within=within,
        )
    _refuse_mixed(value, unit, context, within)
    return float(value), unit or value.unit


def _refuse_mixed(
    value: SiFloat, unit: Unit | None, context: Context, within: tuple[str | int, ...]
) -> None:
    """Refuse an expression that may be a bare number of a file with units of its own."""
    try:
        if unit is None and value.unit is None:
            refuse_foreign(value, EVERY_BASE)
        factor = _factor_of_mixed(value, unit or value.unit or PURE, context.units)
        if factor != 1.0 and value != 0.0:
            raise UnitError("this file has units of its own, so give the unit of this number")
    except UnitError as error:
        refuse("must be a number, alone or with a unit", str(error), within=within)


def unit_named(text: object, within: tuple[str | int, ...]) -> Unit:
    """The unit a field names."""
    try:
        return parse_unit(str(text))
    except UnitError as error:
        refuse(str(error), within=within)
