"""Normal force laws of contact; no friction and no gaps."""

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import NormalLaw

FAMILY = Family(
    entry=None,
    follows=None,
    law=NormalLaw,
    energy=("contact",),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
