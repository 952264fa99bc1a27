"""Belts: webbing that runs through rings from anchor to anchor, in tension only."""

from typing import Protocol

from crashsolve.deck.family import ROUTE, Family
from crashsolve.deck.roles import Built, Force


class BeltLaw(Built, Force, Protocol):
    """Attributes and functions of a belt's file, beside its card."""


FAMILY = Family(
    entry="belt",
    follows="springs",
    law=BeltLaw,
    energy=("belt",),
    channels={"beltout": "forces, lengths, slips and losses of belts"},
    picture=ROUTE,
    uses=("springs",),
    # webbing flows over whole steps
    integrators=("rattle",),
    default="belt",
)
