"""Springs: forces between two bodies that follow from their relative motion."""

from typing import Any, Protocol

from crashsolve.deck.family import ANY, LINE, Family


class SpringLaw(Protocol):
    """What the file of a spring provides beside its card."""

    def build(self, card: Any, scene: Any) -> Any:
        """Words into symbols: one row of PARAMETERS."""

    def force(self, p, old, new, out, t, h, nodes, rows, curves):
        """Forces on both bodies, energy stored and power lost. Writes: nodes, out, new."""


FAMILY = Family(
    entry="spring",
    follows="joints",
    law=SpringLaw,
    energy=("spring", "joint", "brake"),
    channels=("deforc", "spring, damper and bushing forces"),
    picture=LINE,
    uses=(),
    integrators=ANY,
)
