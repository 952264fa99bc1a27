"""Isotropic linear elastic material.

    sigma = E eps,   tau = G gamma,   G = E / (2 + 2 nu)

Consequence to test: a bar's elongation is N L / (E A).
"""

from typing import Any

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record


class Elastic(Card):
    """Isotropic linear elastic material."""

    young: float = quantity("Pa", "E, modulus of elasticity", gt=0)
    poisson: float = quantity("1", "nu, Poisson's ratio", gt=-1, lt=0.5)
    density: float = quantity("kg/m^3", "mass per volume", gt=0)


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Elastic, scene: Any) -> dict[str, Any]:
    return {
        "young": card.young,
        "poisson": card.poisson,
        "shear": card.young / (2.0 + 2.0 * card.poisson),
        "density": card.density,
    }
