"""Parameters of a deck and the expressions `${speed/3.6}` that use them.

A parameter with a unit is kept in SI, and so is every expression it enters. An expression of bare
numbers is itself a bare number, in the units of the file it stands in. Where a file has units of
its own, an expression that mixes both is read when its bare numbers leave no doubt (numbers.py).
A bare parameter counts in the units of the file that defines it: where a file with other units
reads it, it must be pure.
"""

import re
import sys
from collections.abc import Collection, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from crashsolve.channels.units import (
    BASES,
    PURE,
    SI_SYMBOLS,
    Unit,
    UnitError,
    describe,
    parse_unit,
    split_quantity,
)
from crashsolve.deck.diagnostics import shown
from crashsolve.deck.numbers import BareFloat, BareInt, Foreign, SiFloat, as_written
from crashsolve.deck.reading.expressions import CONSTANTS, FUNCTIONS, Expression, ExpressionError
from crashsolve.deck.reading.items import Item
from crashsolve.deck.source import BROKEN, Position, Rows, Table, plain_scalar
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError

# names of a circle of parameters that its message lists
LONGEST_CIRCLE = 50
_EXPRESSION = re.compile(r"\$\{([^{}]*)\}")
# the base of a power needs brackets, or -2**2 would be -4
_RAISED = re.compile(r"\$\{[^{}]*\}(?=\s*\*\*)")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
# title of a card and the position within it where a parameter stands
Reader = tuple[str, Position]


class Parameters:
    """Values of all parameters, each evaluated when it is first needed."""

    def __init__(
        self,
        items: Mapping[str, Item],
        overrides: Mapping[str, str],
        diagnostics: list[DeckError],
        units: Mapping[str, object],
    ) -> None:
        self.items = items
        # factors of the card `units` of every file
        self.unit_factors = {file: _factors(card) for file, card in units.items()}
        self.diagnostics = diagnostics
        self.values: dict[str, Any] = {}
        self.pending: list[str] = []
        # who reads each of them, other parameters aside
        self.readers: dict[str, set[Reader]] = {name: set() for name in items}
        # the words of the command line that set them
        self.given: dict[str, str] = {}
        self.overrides = self._checked(overrides)
        for name in self._in_order():
            self._value(name)
        self._check_units_of_expressions()

    def substitute(self, value: object, card: str, where: Position) -> object:
        """The value with every expression in it worked out, or BROKEN where that fails."""
        if isinstance(value, str):
            if "${" not in value:
                return value
            if not self.pending:
                for name in self._named_in(value):
                    self.readers[name].add((card, where))
            return self._text(value, card, where)
        if isinstance(value, Table):
            table = Table(value.file)
            for key, part in value.items():
                location = value.value_location(key)
                new = self.substitute(part, card, location)
                table.put(key, new, value.keys_at[key], value.values_at[key])
            return table
        if isinstance(value, Rows):
            rows = Rows(value.file)
            rows.values_at = value.values_at
            for i, part in enumerate(value):
                rows.append(self.substitute(part, card, value.location(i)))
            return rows
        return value

    def read(self, but: Collection[Reader] = ()) -> set[str]:
        """Names of those that cards read, also through others; not those in readers `but`.

        A title reads nothing that a run could follow.
        """
        waiting = [
            name
            for name, readers in self.readers.items()
            if any(reader not in but and reader[0] != "title" for reader in readers)
        ]
        needed = set(waiting)
        while waiting:
            more = set(self._needs(waiting.pop())) - needed
            needed |= more
            waiting += more
        return needed

    @property
    def derived(self) -> list[str]:
        """Names of those whose values are expressions of others."""
        return [name for name in self.items if self._needs(name)]

    @property
    def with_units(self) -> dict[str, str]:
        """The text of those that are given as a number with a unit, by name."""
        texts = {name: str(self.overrides.get(name, self.items[name].value)) for name in self.items}
        return {
            name: text
            for name, text in texts.items()
            if isinstance(self.values[name], SiFloat) and "${" not in text
        }

    def _in_order(self) -> list[str]:
        """Names, each after those it needs, so that long chains nest no calls; circles last."""
        order: dict[str, None] = {}
        visited: set[str] = set()
        for first in self.items:
            waiting = [first]
            while waiting:
                needs = self._needs(waiting[-1])
                missing = next((n for n in needs if n not in visited), None)
                if missing is not None:
                    visited.add(missing)
                    waiting.append(missing)
                    continue
                name = waiting.pop()
                if all(n in order for n in needs):
                    order[name] = None
        return [*order, *(name for name in self.items if name not in order)]

    def _needs(self, name: str) -> list[str]:
        """Parameters that the value of a parameter may name."""
        value = self.overrides.get(name, self.items[name].value)
        return self._named_in(value) if isinstance(value, str) else []

    def _named_in(self, text: str) -> list[str]:
        """Parameters in the expressions of a text."""
        parts = _EXPRESSION.findall(text)
        return [n for part in parts for n in _NAME.findall(part) if n in self.items]

    def _text(self, text: str, card: str, where: Position) -> object:
        """Number of a text that is one expression, else text with numbers put in."""
        try:
            whole = _EXPRESSION.fullmatch(text.strip())
            if whole:
                return self._expression(whole[1], where.file)
            return self._filled_in(text, where.file)
        except ExpressionError as error:
            self.diagnostics.append(DeckError(*where, card, error.message, error.advice))
        except _AlreadyReported:
            pass
        return BROKEN

    def _filled_in(self, text: str, file: str) -> str:
        """The text with the numbers of its expressions put in."""
        numbers = [self._expression(part, file) for part in _EXPRESSION.findall(text)]
        values = iter(numbers)
        new = _EXPRESSION.sub(lambda _: as_written(next(values)), _RAISED.sub(r"(\g<0>)", text))
        if "${" in new:
            raise ExpressionError(f"cannot read {shown(text)}", "write '${...}'")
        if any(isinstance(number, SiFloat) for number in numbers) and _unit(new):
            advice = "the expression is in SI already; write all of it as one '${...}'"
            raise ExpressionError(f"{shown(text)} mixes an expression with a number", advice)
        return new

    def _expression(self, text: str, file: str) -> float:
        """Value in SI when a parameter with a unit takes part, else a bare number in `file`."""
        expression = _parsed(text)
        names = {name: self._value(name) for name in expression.names if name in self.items}
        if BROKEN in names.values():
            raise _AlreadyReported
        for name in expression.names:
            if name not in names:
                advice = choices(name, self.items, "parameters")
                raise ExpressionError(f"unknown parameter '{name}'", advice)
        value = expression.value(names)
        units = {name: n.unit for name, n in names.items() if isinstance(n, SiFloat)}
        foreign = tuple(one for name in names for one in self._foreign(name, file))
        if units or expression.has_angles:
            derived = _derived_unit(expression, names)
            return SiFloat(value, expression.unit(units), derived, foreign)
        is_whole = value.is_integer() and abs(value) < 2**53
        if foreign:
            return (BareInt if is_whole else BareFloat)(value, foreign)
        return int(value) if is_whole else value

    def _foreign(self, name: str, file: str) -> tuple[Foreign, ...]:
        """The bare numbers of a parameter that a file reads in other units than its own."""
        value, item = self._value(name), self.items[name]
        made_of = getattr(value, "foreign", ())
        bases = self._differing_bases(item.at.file, file)
        if not bases or isinstance(value, SiFloat) and _has_known_unit(value, item.value):
            return made_of
        return (Foreign(name, Path(item.at.file).name, bases), *made_of)

    def _differing_bases(self, file: str, other: str) -> tuple[str, ...]:
        """Which of BASES have different units in two files."""
        factors = (self.unit_factors.get(one) or _factors(None) for one in (file, other))
        return tuple(base for base, a, b in zip(BASES, *factors, strict=True) if a != b)

    def _value(self, name: str) -> Any:
        if len(self.pending) > LONGEST_CIRCLE:
            raise ExpressionError("depends on itself, through many others")
        if name in self.pending:
            chain = " -> ".join([*self.pending[self.pending.index(name) :], name])
            raise ExpressionError(f"depends on itself ({chain})")
        if name not in self.values:
            self.pending.append(name)
            self.values[name] = self._worked_out(name)
            self.pending.pop()
        return self.values[name]

    def _worked_out(self, name: str) -> object:
        item = self.items[name]
        card = item.title
        if not _NAME.fullmatch(name) or name in FUNCTIONS or name in CONSTANTS:
            advice = "letters, digits and _, and no name of a function"
            self.diagnostics.append(
                DeckError(*item.where, card, "cannot be used as a name", advice)
            )
            return BROKEN
        value = self.substitute(self.overrides.get(name, item.value), card, item.at)
        if value is BROKEN or isinstance(value, SiFloat):
            return value
        try:
            return _number(value)
        except UnitError as error:
            message = "must be a number, alone or with a unit"
            self.diagnostics.append(DeckError(*item.at, card, message, str(error)))
            return BROKEN

    def _check_units_of_expressions(self) -> None:
        """Report overrides of another unit than the deck's value, where one is an expression."""
        for name, given in self.overrides.items():
            written = self.items[name].value
            if "${" not in f"{given}{written}":
                continue
            value, before = self.values[name], self._as_written(name)
            if BROKEN in (value, before):
                continue
            is_bare = not isinstance(value, SiFloat)
            # the numbers of a product may have units: only a bare number is held against the rest
            own, wanted = _unit_of(value), _unit_of(before, if_pure=is_bare)
            if own and wanted and own.exponents != wanted.exponents:
                message = f"the deck has {shown(written)} here, {_in(wanted)}"
                advice = f"give a number {_in(wanted)}"
                advice += ", or what it is computed from" * ("${" in str(written))
                message = f"{message}, and this is {_in(own)}"
                self.diagnostics.append(
                    DeckError(self.given[name], None, None, "", message, advice)
                )

    def _as_written(self, name: str) -> object:
        """Value of a parameter by the deck's own text, whatever the command line sets it to."""
        item = self.items[name]
        # its errors are none of the run
        count = len(self.diagnostics)
        text = item.value if isinstance(item.value, str) else ""
        value = self._text(text, item.title, item.at) if "${" in text else item.value
        del self.diagnostics[count:]
        try:
            return value if value is BROKEN or isinstance(value, SiFloat) else _number(value)
        except UnitError:
            return BROKEN

    def _checked(self, overrides: Mapping[str, str]) -> dict[str, object]:
        """Overrides as values; those which do not fit the deck are reported and left out."""
        checked = {}
        for name, text in overrides.items():
            value, message, advice = plain_scalar(text.strip())
            if name not in self.items:
                message = f"unknown parameter '{name}'"
                advice = choices(name, self.items, "parameters")
            elif not message:
                message, advice = _inconsistency(value, self.items[name].value)
            location = f"--set {name}={text}"
            if message:
                self.diagnostics.append(DeckError(location, None, None, "", message, advice))
            else:
                checked[name], self.given[name] = value, location
        return checked


@cache
def _parsed(text: str) -> Expression:
    """A deck repeats expressions, in the files that it includes several times. Raises
    ExpressionError.
    """
    return Expression(text)


def _has_known_unit(value: SiFloat, written: object) -> bool:
    """Whether a parameter means the same in all units: as a quantity, or with pure bare numbers."""
    if "${" not in str(written):
        return True
    return value.derived is not None and value.derived.exponents != PURE.exponents


def _factors(units: object) -> list[float]:
    """SI units in the unit of each of BASES; one where the card is wrong, and reported."""
    card = units if isinstance(units, Mapping) else {}
    factors = []
    for base, symbol in zip(BASES, SI_SYMBOLS, strict=True):
        try:
            factors.append(parse_unit(str(card.get(base, symbol))).factor)
        except UnitError:
            factors.append(1.0)
    return factors


def _derived_unit(expression: Expression, names: Mapping[str, object]) -> Unit | None:
    """Unit of an expression where its bare numbers are pure; None without any."""
    units = {}
    for name, number in names.items():
        if isinstance(number, SiFloat):
            if number.derived is None:
                return None
            units[name] = number.derived
    return expression.derived_unit(units)


class _AlreadyReported(Exception):
    """A parameter is wrong, and has been reported with its location."""


def _number(value: object) -> float:
    """A number, in SI when it has a unit."""
    if isinstance(value, str):
        number, name = split_quantity(value)
        if not name:
            return number
        unit = parse_unit(name)
        return SiFloat(number * unit.factor, unit, unit)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UnitError(f"this is {shown(value)}")
    if abs(value) > sys.float_info.max:
        raise UnitError(f"{shown(value)} is beyond all numbers that a run can compute with")
    return value


def _unit(value: object) -> Unit | None:
    """Unit of a value as written; None when it is an expression or cannot be read."""
    if isinstance(value, str):
        try:
            return parse_unit(split_quantity(value)[1] or "1")
        except UnitError:
            return None
    return PURE if isinstance(value, int | float) and not isinstance(value, bool) else None


def _unit_of(value: object, *, if_pure: bool = False) -> Unit | None:
    """Unit of a number; of an expression the stated one, or that if its bare numbers are pure."""
    if not isinstance(value, SiFloat):
        return PURE
    return value.derived if if_pure else value.unit


def _in(unit: Unit) -> str:
    return "without unit" if unit.exponents == PURE.exponents else f"in {describe(unit)}"


def _unreadable(value: object) -> str:
    """What of a value that is no number cannot be read."""
    try:
        _number(value)
    except UnitError as error:
        return str(error)
    return ""


def _inconsistency(value: object, replaced: object) -> tuple[str, str]:
    """Message of a wrong value given on the command line, and advice; empty when it fits."""
    if isinstance(value, str) and "${" in value:
        return "", ""
    unit, before = _unit(value), _unit(replaced)
    if unit is None:
        return "must be a number, alone or with a unit", _unreadable(value)
    if before is not None and unit.exponents != before.exponents:
        message = f"the deck has {shown(replaced)} here"
        if before.exponents == PURE.exponents:
            return message, "give a number without unit"
        # most likely its own number with the unit of the deck is meant, or that of SI
        digits, own = split_quantity(str(value))[0], split_quantity(str(replaced))[1]
        units = dict.fromkeys((own, describe(before)))
        numbers = " or ".join(f"'{digits:g} {unit}'" for unit in units)
        meant = f"give a number with a unit, such as {numbers}"
        return f"{message}, and this is a number {_in(unit)}", meant
    return "", ""
