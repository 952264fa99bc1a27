"""Joints: kinematic constraints between two bodies; stops and friction are springs."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built, Constraint


class JointLaw(Built, Constraint, Protocol):
    """Attributes and functions of a joint's file, beside its card."""


FAMILY = Family(
    entry="joint",
    follows="bodies",
    law=JointLaw,
    energy=(),
    channels={"jntforc": "joint reactions and joint motion"},
    picture=None,
    uses=(),
    integrators=ANY,
)
