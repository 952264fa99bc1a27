"""Meshes: positions of nodes, corners of elements, and sets with names.

A mesh stands within the card of its part, or in a section of its own where parts share it.
"""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class MeshLaw(Built, Protocol):
    """Functions of a mesh's file, beside its card."""


FAMILY = Family(
    entry="mesh",
    follows="sections",
    law=MeshLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
