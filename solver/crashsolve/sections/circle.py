"""Solid circular section.

    A = pi r^2,   I_y = I_z = A r^2 / 4,   J = 2 I_y,   kappa = 6 (1 + nu) / (7 + 6 nu)

Consequence to test: it is a tube without a hole.

Reference: Cowper (1966), The shear coefficient in Timoshenko's beam theory, Journal of Applied
Mechanics 33, 335-340.
"""

from math import pi
from typing import Any

import numpy as np

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record
from crashsolve.sections.tube import ring, rings


class Circle(Card):
    """Solid circular section."""

    radius: float = quantity("m", "r", gt=0)


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Circle, poisson: float) -> dict[str, Any]:
    area = pi * card.radius**2
    second = area * card.radius**2 / 4.0
    shear = 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson)
    return {
        "area": area,
        "second": (second, second),
        "torsion": 2.0 * second,
        "shear": (shear, shear),
    }


def outline(card: Circle) -> np.ndarray:
    """Points (n, 2) of the outer edge for pictures, y and z [m]."""
    return ring(card.radius)


def fibres(card: Circle, grid: tuple[int, int]) -> np.ndarray:
    """Places and areas (y, z, A) of fibres: rings and sectors."""
    return rings(0.0, card.radius, grid)
