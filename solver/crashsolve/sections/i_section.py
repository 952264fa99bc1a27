"""Thin-walled I: two flanges b by t_f along y at the ends of a web of thickness t_w along z.

    I_y = (b h^3 - (b - t_w) (h - 2 t_f)^3) / 12,   J = (2 b t_f^3 + H t_w^3) / 3,   H = h - t_f
    1 / (kappa_z A) = (t_f H^2 b^3 / 24 + (c^2 H + c t_w H^3 / 6 + t_w^2 H^5 / 120) / t_w) / I^2

c = b t_f H / 2 and I = c H + t_w H^3 / 12; this is the energy of the shear flow. Along y the
flanges carry the shear, as rectangles do. Torsion is free of warping. Consequence to test: with the
web alone kappa_z is 5/6.

Reference: Megson (2017), Aircraft Structures for Engineering Students, chapters 16 to 18 and 20.
"""

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record
from crashsolve.sections.rectangle import patch


class ISection(Card):
    """Thin-walled I with equal flanges along y and its web along z."""

    width: float = quantity("m", "b, of the flanges, along y of the section", gt=1e-12, lt=1e6)
    height: float = quantity("m", "h, outer, along z of the section", gt=1e-12, lt=1e6)
    flange: float = quantity("m", "t_f, thickness of the flanges", gt=1e-12, lt=1e6)
    web: float = quantity("m", "t_w, thickness of the web", gt=1e-12, lt=1e6)

    @model_validator(mode="after")
    def _thin(self) -> "ISection":
        if 5.0 * self.flange > self.height or 5.0 * self.web > self.width:
            raise ValueError("flange: walls are thin: t_f at most a fifth of h, t_w of b")
        return self


PARAMETERS = HISTORY = OUTPUT = Record()


def outline(card: ISection) -> np.ndarray:
    """Points (n, 2) of the outer edge for pictures, y and z [m]."""
    b, h, w, f = card.width / 2, card.height / 2, card.web / 2, card.height / 2 - card.flange
    right = [(b, -h), (b, -f), (w, -f), (w, f), (b, f), (b, h)]
    return np.array(right + [(-y, -z) for y, z in right])


def build(card: ISection, poisson: float) -> Columns:
    b, h, t_f, t_w = card.width, card.height, card.flange, card.web
    clear, middle = h - 2.0 * t_f, h - t_f
    area = 2.0 * b * t_f + clear * t_w
    return {
        "area": area,
        "second": (
            (b * h**3 - (b - t_w) * clear**3) / 12.0,
            (2.0 * t_f * b**3 + clear * t_w**3) / 12.0,
        ),
        "torsion": (2.0 * b * t_f**3 + middle * t_w**3) / 3.0,
        "shear": (5.0 / 3.0 * b * t_f / area, web_area(b, middle, t_f, t_w) / area),
    }


def web_area(b: float, H: float, t_f: float, t_w: float) -> float:
    """Shear area kappa_z A along the web [m^2]."""
    c = 0.5 * b * t_f * H
    inertia = c * H + t_w * H**3 / 12.0
    web = (c * c * H + c * t_w * H**3 / 6.0 + t_w**2 * H**5 / 120.0) / t_w
    return float(inertia**2 / (t_f * H**2 * b**3 / 24.0 + web))


def fibres(card: ISection, grid: tuple[int, int]) -> np.ndarray:
    """Fibres (n, 3), y, z [m], A [m^2]: so many of each flange along y, of the web along z."""
    flange = patch(card.width, card.flange, (grid[0], 1))
    arm = (card.height - card.flange) / 2.0
    web = patch(card.web, card.height - 2.0 * card.flange, (1, grid[1]))
    return np.concatenate([flange - [0.0, arm, 0.0], flange + [0.0, arm, 0.0], web])
