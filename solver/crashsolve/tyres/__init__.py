"""Tyres: forces between a wheel and the roads that it may touch."""

from typing import Protocol

from crashsolve.deck.family import Family
from crashsolve.deck.roles import Built, Force


class TyreLaw(Built, Force, Protocol):
    """Attributes and functions of a tyre's file, beside its card."""


FAMILY = Family(
    entry="tyre",
    follows="loads",
    law=TyreLaw,
    energy=("tyre",),
    channels={"tyrout": "forces, moments and slips of tyres"},
    picture=None,
    uses=("contact/narrow", "springs"),
    # the deflection of the carcass is carried over whole steps
    integrators=("rattle",),
)
