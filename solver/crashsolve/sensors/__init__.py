"""Sensors: measurements at points of bodies; they exert no forces."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built, Reading


class SensorLaw(Built, Reading, Protocol):
    """Functions of a sensor's file, beside its card."""


FAMILY = Family(
    entry="sensor",
    follows="loads",
    law=SensorLaw,
    energy=(),
    channels={
        "nodout": "motion of nodes and accelerometers",
        "disbout": "relative displacement of two points",
        "secforc": "forces through a section",
    },
    picture=None,
    uses=(),
    integrators=ANY,
)
