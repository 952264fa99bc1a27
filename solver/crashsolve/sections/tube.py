"""Hollow circular section.

    A = pi (R^2 - r^2),   I_y = I_z = A (R^2 + r^2) / 4,   J = 2 I_y
    kappa = 6 (1 + nu) (1 + m^2)^2 / ((7 + 6 nu) (1 + m^2)^2 + (20 + 12 nu) m^2),   m = r / R

Consequence to test: a thin wall has kappa = 2 (1 + nu) / (4 + 3 nu).

Reference: Cowper (1966), The shear coefficient in Timoshenko's beam theory, Journal of Applied
Mechanics 33, 335-340.
"""

from math import pi

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record


class Tube(Card):
    """Hollow circular section."""

    radius: float = quantity("m", "R, outer", gt=1e-12, lt=1e6)
    thickness: float = quantity("m", "R - r, of the wall", gt=1e-12, lt=1e6)

    @model_validator(mode="after")
    def _hollow(self) -> "Tube":
        if self.thickness >= self.radius:
            raise ValueError(f"thickness: must be below the radius, {self.radius:g} m")
        return self


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Tube, poisson: float) -> Columns:
    return round_section(card.radius, card.radius - card.thickness, poisson)


def round_section(outer: float, inner: float, poisson: float) -> Columns:
    """Constants of a section between two radii [m]: area [m^2], second moments and torsion [m^4].

    Shear factors are those of Cowper (1966), J. Appl. Mech. 33, 335-340.
    """
    area = pi * (outer**2 - inner**2)
    second = area * (outer**2 + inner**2) / 4.0
    m2 = (inner / outer) ** 2
    round_ = (1.0 + m2) ** 2
    shear = 6.0 * (1.0 + poisson) * round_
    shear /= (7.0 + 6.0 * poisson) * round_ + (20.0 + 12.0 * poisson) * m2
    return {
        "area": area,
        "second": (second, second),
        "torsion": 2.0 * second,
        "shear": (shear, shear),
    }


def outline(card: Tube) -> np.ndarray:
    """Points (n, 2) of the outer edge for pictures, y and z [m]."""
    return ring(card.radius)


def ring(radius: float, corners: int = 16) -> np.ndarray:
    """Corners (n, 2) on a circle."""
    angle = 2.0 * pi * np.arange(corners) / corners
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def fibres(card: Tube, grid: tuple[int, int]) -> np.ndarray:
    """Positions and areas (n, 3) of fibres, y, z [m] and A [m^2]: rings and sectors."""
    return rings(card.radius - card.thickness, card.radius, grid)


def rings(inner: float, outer: float, grid: tuple[int, int]) -> np.ndarray:
    """Fibres (n, 3), y, z [m] and A [m^2], of equal areas, in rings and sectors of two radii."""
    n, m = grid
    edges = np.sqrt(np.linspace(inner**2, outer**2, n + 1))
    # sectors have their mass centres at these radii
    middle = 2.0 / 3.0 * np.diff(edges**3) / np.diff(edges**2) * np.sinc(1.0 / m)
    angle = 2.0 * pi * (np.arange(m) + 0.5) / m
    R, angles = np.meshgrid(middle, angle)
    y, z = (R * np.cos(angles)).ravel(), (R * np.sin(angles)).ravel()
    return np.column_stack([y, z, np.full(n * m, pi * (outer**2 - inner**2) / (n * m))])
