"""Loads: external forces, torques, pressures and prescribed motions; none between two bodies."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built, Force


class LoadLaw(Built, Force, Protocol):
    """Attributes and functions of a load's file, beside its card."""

    # the column of PARAMETERS that its force is proportional to
    AMPLITUDE: str


FAMILY = Family(
    entry="load",
    follows="contacts",
    law=LoadLaw,
    energy=("external", "potential"),
    channels={"bndout": "loads and forces of prescribed motion"},
    picture=None,
    uses=(),
    integrators=ANY,
    # they keep the output of a sample
    at_rest=True,
)
