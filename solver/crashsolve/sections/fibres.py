"""Section given by its fibres, for beams that yield.

    A = sum A_i,   I_y = sum z_i^2 A_i,   I_z = sum y_i^2 A_i

about the mass centre, which is the origin; y and z are principal axes. Consequence to test: two
fibres are a sandwich, whose limit moment is Y A h / 2.
"""

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity, word
from crashsolve.foundation.record import Record

# of the size: positions typed with six digits are central to this; a worse one is an error
CENTRAL = 1e-5


class Fibres(Card):
    """Section given by its fibres."""

    fibres: tuple[tuple[float, float, float], ...] = word(
        "positions y and z [m] and areas [m^2] in the axes of the section"
    )
    torsion: float = quantity("m^4", "J, torsion constant", gt=0)
    shear_y: float = quantity("1", "kappa_y, share of A that carries shear along y", gt=0)
    shear_z: float = quantity("1", "kappa_z, share of A that carries shear along z", gt=0)

    @model_validator(mode="after")
    def _central(self) -> "Fibres":
        if not self.fibres:
            raise ValueError("fibres: needs some")
        y, z, A = np.asarray(self.fibres).T
        if not (A > 0.0).all():
            raise ValueError("fibres: areas must be positive")
        if not ((y * y) @ A > 0.0 and (z * z) @ A > 0.0):
            raise ValueError("fibres: must not lie on one line along y or z")
        size = np.sqrt((y * y + z * z) @ A / A.sum())
        if max(abs(y @ A), abs(z @ A)) > CENTRAL * size * A.sum():
            raise ValueError("fibres: their mass centre must be the origin")
        if abs((y * z) @ A) > CENTRAL * size**2 * A.sum():
            raise ValueError("fibres: y and z must be principal axes, sum y z A = 0")
        return self


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Fibres, poisson: float) -> Columns:
    y, z, A = np.asarray(card.fibres).T
    return {
        "area": float(A.sum()),
        "second": (float((z * z) @ A), float((y * y) @ A)),
        "torsion": card.torsion,
        "shear": (card.shear_y, card.shear_z),
    }


def fibres(card: Fibres, grid: tuple[int, int]) -> np.ndarray:
    """Positions and areas (n, 3) of the fibres, y, z [m] and A [m^2]."""
    return np.asarray(card.fibres)
