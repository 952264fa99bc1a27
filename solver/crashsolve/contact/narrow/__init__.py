"""Gap and normal between two shapes, one file a pair; no forces."""

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import GapRoutine

FAMILY = Family(
    entry=None,
    follows=None,
    law=GapRoutine,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
