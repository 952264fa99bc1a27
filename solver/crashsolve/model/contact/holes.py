"""Holes between nodes or points, through which the opposite side of a contact could pass.

Nodes and points touch individually. A ball between four of them touches none
while its radius and theirs are less than the distance to the nearest: the radius of the hole.
"""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.model.contact.sides import Surface

# of the radius of a hole: a probe that just fits is not reported
FITS = 1e-6
# points of a set that are all examined; of larger sets a part is
MANY = 2000
INSTEAD = {
    "points": "use faces instead of nodes, or refine its mesh",
    "sphere": "give more of them, or another shape",
}


def warn_of_holes(contact: str, sides: Sequence[Sequence[Surface]], scene: Scene) -> None:
    """Warn of every two surfaces of a card of which one fits between the points of the other."""
    for a, b in product(*sides):
        for probes, other in ((a, b), (b, a)):
            # most shapes have none, which is known at once
            width = half_width(other, scene) if may_have_holes(probes) else None
            if width is None:
                continue
            radius = hole(probes, scene)
            if radius <= (own_radius(probes) + width) * (1.0 + FITS):
                continue
            scene.warn(
                f"contact '{contact}': the points of '{probes.entry.name}' leave holes of radius "
                f"{radius:.3g} m, which '{other.entry.name}' with a half width of {width:.3g} m "
                f"may pass without being touched; {INSTEAD[probes.shape]}"
            )


def own_radius(surface: Surface) -> float:
    """Distance of the surface from its points [m]."""
    return float(getattr(surface.entry.card, "radius", 0.0))


def may_have_holes(surface: Surface) -> bool:
    """Whether a surface touches by its points alone, and has several."""
    is_set = surface.entry.type in ("nodes", "point_set") and len(surface.elements) > 1
    return surface.shape == "points" or is_set


def hole(surface: Surface, scene: Scene) -> float:
    """Radius of the largest ball that touches no point as it passes between them [m]."""
    if surface.shape == "points":
        mesh = scene.skin(surface.entry.card.part, "part")[0].mesh
        corners = mesh.points[mesh.quads]
        distance = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2)
        return float(distance.min(axis=1).max())
    positions = np.array(list(_positions(surface, scene)))
    some = positions[:: 1 + len(positions) // MANY]
    return 0.5 * max(_second_least(np.linalg.norm(positions - x, axis=1)) for x in some)


def half_width(surface: Surface, scene: Scene) -> float | None:
    """Half of the middle one of three extents [m], which must pass a hole; None if infinite."""
    if surface.shape in ("points", "faces"):
        meshed = scene.skin(surface.entry.card.part, "part")[0]
        if surface.shape == "points":
            return own_radius(surface)
        return 0.5 * float(np.sort(np.ptp(meshed.mesh.points, axis=0))[1])
    if not hasattr(surface.module, "half_width"):
        return None
    return min(float(surface.module.half_width(element)) for element in surface.elements)


def _positions(surface: Surface, scene: Scene) -> Iterator[np.ndarray]:
    nodes = scene.placed_nodes()
    for element in surface.elements:
        node = element["node"]
        yield nodes["r"][node] + np.reshape(nodes["A"][node], (3, 3)) @ np.asarray(element["point"])


def _second_least(distances: np.ndarray) -> float:
    """Distance to the nearest other; the least is that to the point itself."""
    return float(np.partition(distances, 1)[1])
