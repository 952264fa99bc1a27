"""Friction laws of contact; that of joints is among the springs."""

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
