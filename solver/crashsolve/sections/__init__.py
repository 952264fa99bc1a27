"""Cross sections of beams: areas, second moments, torsion and shear; no materials."""

from typing import Any, Protocol

from crashsolve.deck.building import Columns
from crashsolve.deck.family import ANY, Family


class SectionLaw(Protocol):
    """Functions of a cross section's file, beside its card."""

    def build(self, card: Any, poisson: float) -> Columns:
        """Area, `second` (I_y, I_z), `torsion` and `shear` (kappa_y, kappa_z)."""


FAMILY = Family(
    entry="section",
    follows="materials",
    law=SectionLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
