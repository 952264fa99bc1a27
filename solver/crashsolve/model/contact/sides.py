"""Both sides of a contact as builders see them: surfaces by their shapes, and probes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from types import ModuleType

    from crashsolve.deck.building import Columns
    from crashsolve.deck.reading.items import Entry
    from crashsolve.elements.shells.layout import DiscretisedShell
    from crashsolve.model.scene import Scene


class Shaped(Protocol):
    """A surface by its shape."""

    shape: str
    entry: Entry


class Surface(Shaped, Protocol):
    """A surface and its elements (model/contact/build.py)."""

    module: ModuleType
    elements: list[Columns]
    radius: float | None  # of curvature [m]


@dataclass(eq=False)
class Probes:
    """The side of the probes: rows of PROBE, their radius, their part if they are shell points."""

    rows: np.ndarray
    radius: float
    part: str | None
    meshed: DiscretisedShell | None
    first_point: int


class Touching:
    """The contact and its two surfaces, for the build of a normal law."""

    def __init__(self, contact: str, a: Surface, b: Surface, scene: Scene) -> None:
        self.contact, self.radius_a, self.radius_b = contact, a.radius, b.radius
        stiff = []
        for surface in (a, b):
            if surface.shape in ("points", "faces"):
                meshed, _, _ = scene.skin(surface.entry.card.part, "part")
                stiff.append(meshed.material.young * meshed.card.thickness)
        self.membrane = min(stiff)


@dataclass(eq=False)
class SurfaceOfProbes:
    """A surface as gap routines see it."""

    shape: str
    entry: Entry
