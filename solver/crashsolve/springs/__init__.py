"""Springs: forces between bodies that follow from their relative motion; no contact."""

from typing import Protocol

from crashsolve.deck.family import ANY, LINE, Family
from crashsolve.deck.roles import Built, Force


class SpringLaw(Built, Force, Protocol):
    """Attributes and functions of a spring's file, beside its card."""


FAMILY = Family(
    entry="spring",
    follows="joints",
    law=SpringLaw,
    energy=("spring", "joint", "brake"),
    channels={"deforc": "spring, damper and bushing forces"},
    picture=LINE,
    uses=("materials", "parts", "sections"),
    integrators=ANY,
)
