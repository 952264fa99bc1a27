"""Friction laws of contact."""

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import FrictionLaw

FAMILY = Family(
    entry=None,
    follows=None,
    law=FrictionLaw,
    energy=("friction",),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
