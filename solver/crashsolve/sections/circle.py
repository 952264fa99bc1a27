"""Solid circular section.

    A = pi r^2,   I_y = I_z = A r^2 / 4,   J = 2 I_y,   kappa = 6 (1 + nu) / (7 + 6 nu)

Consequence to test: it is a tube without a hole.

Reference: Cowper (1966), The shear coefficient in Timoshenko's beam theory, Journal of Applied
Mechanics 33, 335-340.
"""

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record
from crashsolve.sections.tube import ring, rings, round_section


class Circle(Card):
    """Solid circular section."""

    radius: float = quantity("m", "r, radius", gt=1e-12, lt=1e6)


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Circle, poisson: float) -> Columns:
    return round_section(card.radius, 0.0, poisson)


def outline(card: Circle) -> np.ndarray:
    """Points (n, 2) of the outer edge for pictures, y and z [m]."""
    return ring(card.radius)


def fibres(card: Circle, grid: tuple[int, int]) -> np.ndarray:
    """Positions and areas (n, 3) of fibres, y, z [m] and A [m^2]: rings and sectors."""
    return rings(0.0, card.radius, grid)
