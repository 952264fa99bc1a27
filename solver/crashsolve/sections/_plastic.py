"""Plastic modulus of a section: its bending moment over the stress at which all of it yields.

    Z = sum |d| A about the axis of equal areas

d is the distance of a fibre from that axis. Consequence to test: Z = b h^2 / 4 for a rectangle,
D^3 / 6 for a round bar.

Reference: Neal (1977), The Plastic Methods of Structural Analysis, 1.3.
"""

from functools import lru_cache
from types import ModuleType
from typing import Any

import numpy as np

# fibres along each side of a wall or plate that state Z to five digits
GRID = (400, 400)


@lru_cache(maxsize=64)
def plastic_moduli(law: ModuleType, card: Any) -> tuple[float, float]:
    """Z about y and z of a section with a shape [m^3]; once for all elements that have it."""
    fibres = law.fibres(card, GRID)
    return plastic_modulus(fibres, "y"), plastic_modulus(fibres, "z")


def plastic_modulus(fibres: np.ndarray, about: str) -> float:
    """Z of fibres (y, z, A) about an axis of the section, y or z [m^3]."""
    d, area = fibres[:, 1 if about == "y" else 0], fibres[:, 2]
    order = np.argsort(d)
    below = np.cumsum(area[order])
    middle = float(np.interp(0.5 * below[-1], below - 0.5 * area[order], d[order]))
    return float(np.abs(d - middle) @ area)
