"""Meshes: positions of nodes, corners of elements, and sets of nodes with names."""

from typing import Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class MeshLaw(Built, Protocol):
    """What the file of a mesh provides beside its card."""


FAMILY = Family(
    entry=None,
    follows=None,
    law=MeshLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
