"""Plasticity of Johnson and Cook: power hardening, rate of strain, softening by heat of the work.

    Y = (A + B e^n) (1 + C ln(rate / rate_0)) (1 - T^m)
    T_dot = chi w_p_dot / (rho q),   q = c (T_melt - T_room)

e is the equivalent plastic strain, rate that of the total strain, T the temperature from 0 in the
room, where everything starts, to 1 where it melts; w_p is the plastic work per volume. Below
rate_0 the second factor is 1. Every layer keeps its own temperature: heat stays where it is made,
as it does within milliseconds. Without q nothing softens; a molten layer keeps a millionth of
its strength. Consequence to test: a bar pulled at one rate follows the formula.

Reference: Johnson and Cook (1983), A constitutive model and data for metals subjected to large
strains, high strain rates and high temperatures, 7th Int. Symposium on Ballistics, 541-547.
"""

from typing import Any

from crashsolve.deck.card import quantity
from crashsolve.foundation.record import Record
from crashsolve.materials import elastic


class JohnsonCook(elastic.Elastic):
    """Plasticity of Johnson and Cook."""

    yield_stress: float = quantity("Pa", "A", gt=0)
    hardening: float = quantity("Pa", "B", default=0.0, ge=0)
    exponent: float = quantity("1", "n", default=1.0, gt=0, le=1)
    rate: float = quantity("1", "C", default=0.0, ge=0)
    reference_rate: float = quantity("1/s", "rate_0", default=1.0, gt=0)
    melting_heat: float | None = quantity(
        "J/kg", "q = c (T_melt - T_room); without it nothing softens", default=None, gt=0
    )
    softening: float = quantity("1", "m", default=1.0, gt=0)
    heat_share: float = quantity("1", "chi, of the plastic work that is heat", 0.9, gt=0, le=1)
    failure_strain: float | None = quantity("1", "e at which a layer fails", default=None, gt=0)


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: JohnsonCook, scene: Any) -> dict[str, Any]:
    heated = card.heat_share / (card.density * card.melting_heat) if card.melting_heat else 0.0
    return elastic.build(card, scene) | {
        "plastic": 1,
        "yield_stress": card.yield_stress,
        "power": card.hardening,
        "exponent": card.exponent,
        "rate_C": card.rate,
        "rate_0": card.reference_rate,
        "heating": heated,
        "softening": card.softening,
        "failure": card.failure_strain or 0.0,
    }
