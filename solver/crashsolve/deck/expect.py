"""What a deck expects of its own run: a deck is also its own test."""

import re
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import ValidationInfo, field_validator, model_validator

from crashsolve.deck.card import Card, Context, SiFloat, word
from crashsolve.deck.laws import choices
from crashsolve.deck.mistakes import already_reported, refuse, shown
from crashsolve.deck.source import BROKEN
from crashsolve.foundation.units import PURE, SI, Unit, UnitError, parse_unit, split_quantity

STATISTICS = ("max", "min", "abs_max", "mean", "final", "integral", "argmax", "argmin")
_AT = re.compile(r"at:[0-9]+\.?[0-9]*([eE][-+]?[0-9]+)?")


class Expect(Card):
    """A statistic of a channel, the value it must have, and why it must.

    After reading, value and tolerance are in SI; a relative tolerance is a fraction of the value.
    """

    channel: str = word("channel, or arithmetic of channels")
    statistic: str = word(f"{', '.join(STATISTICS)}, or at:T with T in seconds")
    unit: str | None = word("unit of a value written as a bare number; SI when absent", None)
    value: float = word("what the run must give, in any unit")
    tolerance: float = word("allowed difference: in the unit of the value, or relative as '1 %'")
    relative: bool = word("whether the tolerance is a fraction of the value", False)
    because: Literal["exact", "published", "derived", "golden"] = word("kind of evidence")
    source: str = word("where the value comes from")

    @model_validator(mode="before")
    @classmethod
    def _to_si(cls, given: Any, info: ValidationInfo) -> Any:
        if not isinstance(given, Mapping):
            return given
        fields = dict(given)
        context = info.context or Context()
        name = fields.pop("unit", None)
        unit = None if name is None else _unit(name, "unit")
        if "value" in fields:
            if unit is None and context.units is not SI and _is_bare(fields["value"]):
                advice = "write it with its unit, as this file has units of its own"
                refuse("the unit of a bare number is not known here", advice, within=("value",))
            fields["value"], unit = _number(fields["value"], unit or PURE, "value")
        if "tolerance" in fields:
            percent = "%" in str(fields["tolerance"])
            base = PURE if percent or unit is None else unit
            fields["tolerance"], own = _number(fields["tolerance"], base, "tolerance")
            if percent:
                fields["relative"] = True
            elif unit and own.exponents != unit.exponents:
                refuse("must be in a unit like that of the value", within=("tolerance",))
        return fields

    @field_validator("statistic")
    @classmethod
    def _known_statistic(cls, text: str) -> str:
        if text not in STATISTICS and not re.fullmatch(
            r"at:[0-9]+\.?[0-9]*([eE][-+]?[0-9]+)?", text
        ):
            known = (*STATISTICS, "at:T")
            refuse(f"unknown statistic '{text}'", choices(text, known, "statistics"))
        return text

    @model_validator(mode="after")
    def _can_fail_and_pass(self) -> "Expect":
        if self.tolerance < 0:
            raise ValueError("tolerance: must be at least 0")
        if self.relative and self.value == 0:
            raise ValueError("tolerance: a fraction of zero is zero; give an absolute tolerance")
        return self


def _is_bare(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, SiFloat)


def _unit(text: object, field: str) -> Unit:
    try:
        return parse_unit(str(text))
    except UnitError as error:
        refuse(str(error), within=(field,))


def _number(written: Any, unit: Unit, field: str) -> tuple[float, Unit]:
    """Value in SI of a number in `unit`, or of a text with its own unit; and the unit."""
    if written is BROKEN:
        already_reported()
    if isinstance(written, SiFloat):
        return float(written), unit
    try:
        if isinstance(written, str):
            written, name = split_quantity(written)
            unit = _unit(name, field) if name else unit
        if not isinstance(written, bool) and isinstance(written, int | float):
            return float(written) * unit.factor, unit
    except (UnitError, OverflowError) as error:
        refuse("must be a number, alone or with a unit", str(error), within=(field,))
    refuse(f"must be a number, alone or with a unit, not {shown(written)}", within=(field,))
