"""Ties: nodes of shells that move with faces of others and transfer their forces; no release."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class TieLaw(Built, Protocol):
    """Functions of a tie's file, beside its card: `build` returns a row of TIE for each node.

    (TIE stands in foundation/point.py.)
    """


FAMILY = Family(
    entry="tie",
    follows="parts",
    law=TieLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    # implicit methods are refused by the tie, with the reason
    integrators=ANY,
    default="node_to_face",
)
