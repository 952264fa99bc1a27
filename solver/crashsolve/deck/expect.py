"""What a deck expects of its own run: a deck is also its own test."""

import re
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import ValidationInfo, field_validator, model_validator

from crashsolve.deck.card import Card, word
from crashsolve.deck.laws import choices
from crashsolve.deck.mistakes import refuse
from crashsolve.deck.numbers import Context, number_in, unit_named
from crashsolve.foundation.units import PURE

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
        unit = None if name is None else unit_named(name, ("unit",))
        if "value" in fields:
            fields["value"], unit = number_in(fields["value"], unit, context, ("value",))
        if "tolerance" in fields:
            relative = "%" in str(fields["tolerance"])
            unit = PURE if relative else unit
            fields["tolerance"], _ = number_in(fields["tolerance"], unit, context, ("tolerance",))
            fields["relative"] = fields.get("relative", False) or relative
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
