"""Neo-Hookean material: elastic at any strain, for rubber and foam.

    W = G/2 (tr b - 3 - 2 ln J) + L/2 (ln J)^2,   L = E nu / ((1 + nu) (1 - 2 nu))
    sigma = G (b - lambda_3^2) / J   in plane stress,   G (lambda_3^2 - 1) + L ln J = 0

b is the left Cauchy-Green tensor, lambda_3 the stretch across the thickness, W per volume at the
start. Young's modulus and Poisson's ratio are those of small strain. Consequence to test: the
stress at a stretch is that of the formula, and a closed path of strain costs nothing.

Reference: Bonet and Wood (2008), Nonlinear Continuum Mechanics for Finite Element Analysis, 6.4.
"""

from typing import Any, ClassVar

import numpy as np

from crashsolve.foundation.record import Record
from crashsolve.materials import elastic


class NeoHookean(elastic.Elastic):
    """Neo-Hookean material, for shells with `thinning: true`."""

    LARGE_STRAIN: ClassVar[bool] = True

    @property
    def volumetric(self) -> float:
        """L [Pa]."""
        return self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))

    def energy(self, x: Any, y: Any, s: Any, across: Any) -> Any:
        """Energy per present volume [J/m^3] from C - 1 and ln lambda_3."""
        volume = 0.5 * np.log1p(x + y + x * y - s * s) + across
        trace = x + y + np.expm1(2.0 * across) - 2.0 * volume
        shear = self.young / (2.0 + 2.0 * self.poisson)
        return np.exp(-volume) * 0.5 * (shear * trace + self.volumetric * volume**2)


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: NeoHookean, scene: Any) -> dict[str, Any]:
    return elastic.build(card, scene) | {"hyper": 1, "volumetric": card.volumetric}
