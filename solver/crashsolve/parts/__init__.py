"""Parts: deformable bodies as sets of elements; strains and forces are in elements/."""

from typing import Protocol

from crashsolve.deck.family import ANY, ELEMENTS, Family
from crashsolve.deck.roles import Built


class PartLaw(Built, Protocol):
    """Attributes and functions of a part's file, beside its card."""


FAMILY = Family(
    entry="part",
    follows="bodies",
    law=PartLaw,
    energy=("part",),
    channels={
        "elout": "forces, moments and strains of elements",
        "matsum": "energies and momenta by part",
    },
    picture=ELEMENTS,
    uses=("materials",),
    integrators=ANY,
    # their histories are those of their modules
    at_rest=True,
)
