"""Plastic hinges: joints whose free motions an elastic-plastic moment or force resists."""

from typing import Protocol

from crashsolve.deck.family import ANY, MARK, Family
from crashsolve.deck.roles import Built, Constraint, Force


class HingeLaw(Built, Constraint, Force, Protocol):
    """Functions of a hinge's file: those of a joint, and the resistance to its motion."""


FAMILY = Family(
    entry="hinge",
    follows="springs",
    law=HingeLaw,
    energy=("hinge",),
    channels={"hinge": "moments, angles and energies of plastic hinges"},
    picture=MARK,
    uses=("joints", "sections"),
    integrators=ANY,
    at_rest=True,
)
