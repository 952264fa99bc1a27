"""Thin-walled rectangular tube; a and b are the sides of the wall's middle line along y and z.

    A = 2 t (a + b),   I_y = t b^2 (a / 2 + b / 6),   I_z = t a^2 (b / 2 + a / 6)
    J = 2 t a^2 b^2 / (a + b),   1 / (kappa A) = int q^2 / (V^2 t) ds

q(s) is the shear flow under a shear force V. Consequence to test: with webs alone kappa is 5/6.

Reference: Megson (2017), Aircraft Structures for Engineering Students, chapters 16 to 18 and 20.
"""

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record
from crashsolve.sections.rectangle import corners, patch


class RectangularTube(Card):
    """Thin-walled rectangular tube."""

    width: float = quantity("m", "outer, along y of the section", gt=1e-12, lt=1e6)
    height: float = quantity("m", "outer, along z of the section", gt=1e-12, lt=1e6)
    thickness: float = quantity("m", "t, of the wall", gt=1e-12, lt=1e6)

    @model_validator(mode="after")
    def _thin(self) -> "RectangularTube":
        if 5.0 * self.thickness > min(self.width, self.height):
            raise ValueError("thickness: must be at most a fifth of the sides; the walls are thin")
        return self


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: RectangularTube, poisson: float) -> Columns:
    t = card.thickness
    a, b = card.width - t, card.height - t
    area = 2.0 * t * (a + b)
    return {
        "area": area,
        "second": (second(a, b, t), second(b, a, t)),
        "torsion": 2.0 * t * a * a * b * b / (a + b),
        "shear": (shear_area(b, a, t) / area, shear_area(a, b, t) / area),
    }


def second(flange: float, web: float, t: float) -> float:
    """Second moment about the axis along the flanges [m^4]."""
    return t * web**2 * (flange / 2.0 + web / 6.0)


def shear_area(flange: float, web: float, t: float) -> float:
    """kappa A for a shear force along the webs [m^2]."""
    inertia = second(flange, web, t)
    # q I / (V t): web s / 2 along half a flange, then c + (web^2 / 4 - y^2) / 2 in the webs
    c = flange * web / 4.0
    flanges = web**2 * flange**3 / 24.0
    webs = c * c * web + c * web**3 / 6.0 + web**5 / 120.0
    return inertia**2 / (t * (flanges + 2.0 * webs))


def outline(card: RectangularTube) -> np.ndarray:
    """Points (n, 2) of the outer edge for pictures, y and z [m]."""
    return corners(card.width, card.height)


def fibres(card: RectangularTube, grid: tuple[int, int]) -> np.ndarray:
    """Fibres (n, 3), y, z [m] and A [m^2], on the middle line, so many of each wall."""
    t = card.thickness
    a, b = card.width - t, card.height - t
    flange, web = patch(a, 0.0, (grid[0], 1)), patch(0.0, b, (1, grid[1]))
    flange[:, 2], web[:, 2] = a * t / grid[0], b * t / grid[1]
    sides = [flange + [0.0, s * b / 2.0, 0.0] for s in (-1, 1)]
    sides += [web + [s * a / 2.0, 0.0, 0.0] for s in (-1, 1)]
    return np.concatenate(sides)
