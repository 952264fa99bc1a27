"""Bodies: rigid bodies with mass and inertia; deformable ones are parts."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class BodyLaw(Built, Protocol):
    """Attributes and functions of a body's file, beside its card."""


FAMILY = Family(
    entry="body",
    follows="curves",
    law=BodyLaw,
    energy=(),
    channels={"rbdout": "motion of rigid bodies and of nodes of parts"},
    picture=None,
    uses=(),
    integrators=ANY,
    default="rigid",
)
