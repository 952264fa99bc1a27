"""Laws of contact: shapes, gaps, normal forces; neither tables of pairs nor search."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family


class ContactLaw(Protocol):
    """A contact has surfaces on two sides, and a law of force or of its own."""


FAMILY = Family(
    entry="contact",
    follows="surfaces",
    law=ContactLaw,
    energy=(),
    channels={"rcforc": "contact forces", "sleout": "contact energies"},
    picture=None,
    uses=(),
    integrators=ANY,
    default="force",
    section="contacts",
)
