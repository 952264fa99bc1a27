"""Loads: forces that come from outside."""

from typing import Any, Protocol

from crashsolve.deck.family import ANY, Family


class LoadLaw(Protocol):
    """What the file of a load provides beside its card."""

    def build(self, card: Any, scene: Any) -> Any:
        """Words into symbols: one row of PARAMETERS."""

    def force(self, p, old, new, out, t, h, nodes, rows, curves):
        """Forces on bodies, and the power of their work. Writes: nodes, out, new."""


FAMILY = Family(
    entry="load",
    follows="contacts",
    law=LoadLaw,
    energy=("external", "potential"),
    channels=("bndout", "loads and forces of prescribed motion"),
    picture=None,
    uses=(),
    integrators=ANY,
)
