"""Postures: initial configurations of chains of joints; no forces."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class PostureLaw(Built, Protocol):
    """Functions of a posture's file, beside its card: `build` positions the bodies."""


FAMILY = Family(
    entry="posture",
    follows="joints",
    law=PostureLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
    default="angles",
)
