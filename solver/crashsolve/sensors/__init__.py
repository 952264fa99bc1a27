"""Sensors: what is measured, not what acts."""

from typing import Any, Protocol

from crashsolve.deck.family import ANY, Family


class SensorLaw(Protocol):
    """What the file of a sensor provides beside its card."""

    def build(self, card: Any, scene: Any) -> Any:
        """Words into symbols: one row of PARAMETERS."""

    def measure(self, p, out, t, nodes, rows, curves):
        """Readings at a sample. Writes: out."""


FAMILY = Family(
    entry="sensor",
    follows="loads",
    law=SensorLaw,
    energy=(),
    channels=("nodout", "motion of nodes and accelerometers"),
    picture=None,
    uses=(),
    integrators=ANY,
)
