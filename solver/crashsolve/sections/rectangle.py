"""Solid rectangular section, a along y and b along z.

    A = a b,   I_y = a b^3 / 12,   I_z = a^3 b / 12,   kappa = 10 (1 + nu) / (12 + 11 nu)
    J = l s^3 (1/3 - 64 s / (pi^5 l) sum tanh(n pi l / 2 s) / n^5),   n = 1, 3, 5, ...

l is the longer side and s the shorter. Consequence to test: a square has J = 0.1405770 a^4.

References: Cowper (1966), The shear coefficient in Timoshenko's beam theory, Journal of Applied
Mechanics 33, 335-340. Timoshenko and Goodier (1970), Theory of Elasticity, 109.
"""

from math import pi, tanh

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record


class Rectangle(Card):
    """Solid rectangular section."""

    width: float = quantity("m", "a, along y of the section", gt=1e-12, lt=1e6)
    height: float = quantity("m", "b, along z of the section", gt=1e-12, lt=1e6)


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Rectangle, poisson: float) -> Columns:
    a, b = card.width, card.height
    shear = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson)
    return {
        "area": a * b,
        "second": (a * b**3 / 12.0, a**3 * b / 12.0),
        "torsion": torsion(max(a, b), min(a, b)),
        "shear": (shear, shear),
    }


def torsion(long: float, short: float) -> float:
    """Torsion constant J [m^4]."""
    # terms of 1 / n^5: the neglected ones are below 1e-10
    series = sum(tanh(n * pi * long / (2.0 * short)) / n**5 for n in range(1, 301, 2))
    return long * short**3 * (1.0 / 3.0 - 64.0 * short / (pi**5 * long) * series)


def outline(card: Rectangle) -> np.ndarray:
    """Points (n, 2) of the outer edge for pictures, y and z [m]."""
    return corners(card.width, card.height)


def corners(width: float, height: float) -> np.ndarray:
    """Corners (4, 2) of a rectangle about the origin, counter-clockwise."""
    return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (width / 2.0, height / 2.0)


def fibres(card: Rectangle, grid: tuple[int, int]) -> np.ndarray:
    """Positions and areas (n, 3) of fibres, y, z [m] and A [m^2], so many along y and z."""
    return patch(card.width, card.height, grid)


def patch(width: float, height: float, grid: tuple[int, int]) -> np.ndarray:
    """Fibres (n, 3), y, z [m] and A [m^2], of a rectangle about the origin."""
    n, m = grid
    y, z = ((np.arange(n) + 0.5) / n - 0.5) * width, ((np.arange(m) + 0.5) / m - 0.5) * height
    Y, Z = np.meshgrid(y, z)
    return np.column_stack([Y.ravel(), Z.ravel(), np.full(n * m, width * height / (n * m))])
