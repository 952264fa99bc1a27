"""Card `expect`: expected results of a deck, which make it a test."""

from collections.abc import Mapping
from typing import Literal

from pydantic import ValidationInfo, field_validator, model_validator

from crashsolve.channels.series import Window
from crashsolve.channels.units import PURE, Unit, describe, parse_unit
from crashsolve.deck.card import Card, quantity, word
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.numbers import Context, number_in, unit_named
from crashsolve.deck.run_cards.statistic import (
    channel_reported,
    check_window,
    known_statistic,
    words_reported,
)

PERCENT = parse_unit("%")


class Expect(Card):
    """Expected value of a statistic of a channel, with its tolerance and source.

    After reading, a value with a unit is in SI and `unit` names its SI unit, the tolerance with it;
    without a unit both are in the channel's own. A relative tolerance is a fraction of the value.
    """

    channel: str = word(channel_reported())
    statistic: str = word(words_reported())
    during: Window | None = quantity("s", "[from, to], when only these samples count", None)
    unit: str | None = word("unit of bare numbers; the channel's own when absent", None)
    value: float = word("expected value, in any unit")
    tolerance: float = word("allowed difference: in the unit of the value, or relative as '1 %'")
    relative: bool = word(
        "true: the tolerance is a fraction of the value; true for a tolerance in %", False
    )
    because: Literal["exact", "published", "derived", "golden"] = word("kind of evidence")
    source: str = word("source of the value")

    @model_validator(mode="before")
    @classmethod
    def _to_si(cls, given: object, info: ValidationInfo) -> object:
        if not isinstance(given, Mapping):
            return given
        fields = dict(given)
        context = info.context or Context()
        name = fields.pop("unit", None)
        unit = None if name is None else unit_named(name, ("unit",))
        if "value" in fields:
            fields["value"], unit = number_in(fields["value"], unit, context, ("value",))
        if "tolerance" in fields:
            if "relative" not in fields:
                fields["relative"] = _is_relative(fields["tolerance"], unit)
            own = PURE if fields["relative"] else unit
            fields["tolerance"], own = number_in(fields["tolerance"], own, context, ("tolerance",))
            # a bare value takes the unit that stands beside the tolerance
            unit = unit if fields["relative"] else own
        return fields if unit is None else fields | {"unit": describe(unit)}

    @field_validator("statistic")
    @classmethod
    def _known_statistic(cls, text: str) -> str:
        return known_statistic(text)

    @model_validator(mode="after")
    def _can_fail_and_pass(self) -> "Expect":
        check_window(self.statistic, self.during)
        if self.tolerance < 0:
            raise ValueError("tolerance: must be at least 0")
        if self.relative and self.value == 0:
            raise ValueError("tolerance: a fraction of zero is zero; give an absolute tolerance")
        return self


def _is_relative(tolerance: object, unit: Unit | None) -> bool:
    """Whether a tolerance is a share of the value; refused where "%" might mean either."""
    in_percent = "%" in str(tolerance)
    if in_percent and unit == PERCENT:
        advice = "set relative: true, or false for points of %"
        refuse("'%' of a value in % can be read in two ways", advice, within=("tolerance",))
    return in_percent
