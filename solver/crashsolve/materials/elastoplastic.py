"""Elastoplastic material of von Mises, with isotropic, kinematic and tabulated hardening.

    sqrt(3/2) |dev(sigma - alpha)| <= Y(e) (1 + (rate / D)^(1/q)),   e the equivalent plastic strain
    Y = Y_0 + (1 - beta) H e, or a curve;   alpha_dot = 2/3 beta H eps_p_dot

rate is that of the total strain (Cowper and Symonds). Consequence to test: a bar pulled beyond
Y_0 / E follows the slope E H / (E + H), and yields backwards after 2 Y_0 where beta is 1.

References: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670. Cowper and Symonds (1957), Strain-hardening and strain-rate
effects in the impact loading of cantilever beams, Brown University Report 28.
"""

from typing import Any, ClassVar

from pydantic import model_validator

from crashsolve.deck.card import CurveName, quantity, word
from crashsolve.foundation.record import Record
from crashsolve.materials import elastic


class Elastoplastic(elastic.Elastic):
    """Elastoplastic material of von Mises."""

    curve_axes: ClassVar = {"curve": ("1", "Pa")}

    yield_stress: float | None = quantity("Pa", "Y_0; or give `curve`", default=None, gt=0)
    hardening: float = quantity("Pa", "H, stress over plastic strain", default=0.0, ge=0)
    kinematic: float = quantity("1", "beta, share of H that moves", default=0.0, ge=0, le=1)
    curve: CurveName | None = word("Y over e, instead of yield_stress", default=None)
    rate_D: float | None = quantity("1/s", "D of Cowper and Symonds", default=None, gt=0)
    rate_q: float = quantity("1", "q of Cowper and Symonds", default=5.0, gt=0)
    failure_strain: float | None = quantity("1", "e at which a layer fails", default=None, gt=0)

    @model_validator(mode="after")
    def _one_hardening(self) -> "Elastoplastic":
        if (self.yield_stress is None) == (self.curve is None):
            raise ValueError("needs either yield_stress or curve")
        if self.curve is not None and self.hardening and self.kinematic < 1.0:
            raise ValueError("hardening: the curve says it; beside it, only with kinematic: 1")
        return self


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Elastoplastic, scene: Any) -> dict[str, Any]:
    return elastic.build(card, scene) | {
        "plastic": 1,
        "yield_stress": card.yield_stress or 0.0,
        "isotropic": (1.0 - card.kinematic) * card.hardening,
        "kinematic": card.kinematic * card.hardening,
        "curve": scene.curve(card.curve) if card.curve else 0,
        "rate_D": card.rate_D or 0.0,
        "rate_q": card.rate_q,
        "failure": card.failure_strain or 0.0,
    }
