"""Belts: webbing that runs through rings on bodies, and pulls."""

from typing import Protocol

from crashsolve.deck.family import ROUTE, Family
from crashsolve.deck.roles import Built, Force


class BeltLaw(Built, Force, Protocol):
    """What the file of a belt provides beside its card."""


FAMILY = Family(
    entry="belt",
    follows="loads",
    law=BeltLaw,
    energy=("belt",),
    channels={"sbtout": "tension, pay-out and slip of belts"},
    picture=ROUTE,
    uses=("springs",),
    # material flows over whole steps
    integrators=("rattle",),
    default="webbing",
)
