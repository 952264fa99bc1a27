"""Shapes of surfaces: their cards and elements; the gap between two is in contact/narrow."""

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Shape

FAMILY = Family(
    entry="surface",
    follows="parts",
    law=Shape,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
    section="surfaces",
)
