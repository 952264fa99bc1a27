"""Stiffness of a contact law: given, or from the materials of both sides by Hertz.

    K = 4/3 E* sqrt(r),   1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b,   1/r = 1/r_a + 1/r_b

This is the chapter's K = 0.424 sqrt(r) [h_a + h_b]^-1, h = (1 - nu^2)/(pi E), since 0.424 stands
for 4/(3 pi) (Ambrosio (2003), Eq. 19). A side without a Young's modulus is rigid.
"""

from math import inf, isfinite, sqrt

from pydantic import model_validator

from crashsolve.deck.building import Pair, Scene
from crashsolve.deck.card import Card, quantity

# share of the wave speed below which local deformation is quasi-static (Ambrosio (2003), 4.2)
QUASI_STATIC = 1e-5
SOURCES = "stiffness, or young_a or young_b with their Poisson ratios"


class Materials(Card):
    """Materials of the two sides, in the order of the contact card."""

    young_a: float | None = quantity(
        "Pa", "Young's modulus of side a; rigid when absent", None, gt=0
    )
    young_b: float | None = quantity(
        "Pa", "Young's modulus of side b; rigid when absent", None, gt=0
    )
    poisson_a: float | None = quantity("1", "Poisson's ratio of side a", None, gt=-1, le=0.5)
    poisson_b: float | None = quantity("1", "Poisson's ratio of side b", None, gt=-1, le=0.5)
    density_a: float | None = quantity(
        "kg/m^3", "density of side a, only to warn of impacts beyond 1e-5 sqrt(E/rho)", None, gt=0
    )
    density_b: float | None = quantity(
        "kg/m^3", "density of side b, for the same warning", None, gt=0
    )
    radius: float | None = quantity(
        "m", "relative radius of curvature; from the surfaces when absent", None, gt=0
    )

    @model_validator(mode="after")
    def _whole_sides(self) -> "Materials":
        for side in "ab":
            young, poisson = getattr(self, f"young_{side}"), getattr(self, f"poisson_{side}")
            if (young is None) != (poisson is None):
                raise ValueError(f"young_{side} and poisson_{side} belong together")
            if young is None and getattr(self, f"density_{side}") is not None:
                raise ValueError(f"density_{side}: needs young_{side}, for the speed of its waves")
        return self

    def compliance(self) -> float:
        """Inverse of E* [1/Pa]; 0 when no material is given."""
        sides = ((self.young_a, self.poisson_a), (self.young_b, self.poisson_b))
        return sum((1.0 - (nu or 0.0) ** 2) / young for young, nu in sides if young is not None)

    def speed_limit(self) -> float:
        """Impact speed beyond which the law is outside its range [m/s]; infinite if unknown."""
        sides = ((self.young_a, self.density_a), (self.young_b, self.density_b))
        waves = [sqrt(E / rho) for E, rho in sides if E is not None and rho is not None]
        return QUASI_STATIC * min(waves, default=inf)


def hertz_stiffness(card: Materials, scene: Scene, pair: Pair) -> float:
    """K of Eq. 19 [N/m^1.5]; refuses a pair whose curvature is unknown."""
    compliance = card.compliance()
    if compliance == 0.0:
        raise scene.fail(f"needs a stiffness: give {SOURCES}", "normal")
    radius = card.radius if card.radius is not None else relative_radius(pair)
    if not isfinite(radius) or radius == 0.0:
        raise scene.fail(
            "the curvature of the surfaces where they touch is not known; give radius or stiffness",
            "normal",
        )
    return 4.0 / 3.0 * sqrt(radius) / compliance


def relative_radius(pair: Pair) -> float:
    """1/r = 1/r_a + 1/r_b [m]; infinite for two flats, not a number where a side is not round."""
    curvature = sum(1.0 / r if r else inf for r in (pair.radius_a, pair.radius_b) if r is not None)
    return 1.0 / curvature if curvature > 0.0 else inf
