"""Curves a deck may name: from a table, a file or a formula, all as piecewise cubics."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class CurveLaw(Built, Protocol):
    """Functions of a curve's file, beside its card: points and cubics."""


FAMILY = Family(
    entry="curve",
    follows="sections",
    law=CurveLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
    default="table",
)
