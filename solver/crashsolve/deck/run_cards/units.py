"""Units of the bare numbers of a file; other units follow, as force = mass length / time^2."""

from pydantic import field_validator

from crashsolve.channels.units import BASES, SI, Unit, UnitError, describe, parse_unit
from crashsolve.deck.card import Card, word


class Units(Card):
    """Units of bare numbers in this file only; SI and radians when absent."""

    length: str = word("unit of length, such as mm", "m")
    mass: str = word("unit of mass, such as t", "kg")
    time: str = word("unit of time, such as ms", "s")
    angle: str = word("unit of angle, such as deg", "rad")

    @field_validator(*BASES)
    @classmethod
    def _right_dimension(cls, text: str, info: object) -> str:
        base = str(getattr(info, "field_name", ""))
        try:
            unit = parse_unit(text)
        except UnitError as error:
            raise ValueError(str(error)) from None
        if unit.exponents != SI[base].exponents:
            raise ValueError(f"'{text}' is in {describe(unit)}, not a unit of {base}")
        return text

    def symbols(self) -> tuple[str, ...]:
        """The name of the unit of each of BASES."""
        return tuple(str(getattr(self, name)) for name in BASES)

    def bases(self) -> dict[str, Unit]:
        """The unit of each of BASES."""
        return {name: parse_unit(getattr(self, name)) for name in BASES}
