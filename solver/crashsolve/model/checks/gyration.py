"""Whether the inertia of a body fits the points and surfaces on it; a wrong unit is the common
error.

    k_i = sqrt(I_i / m)

k_i, the radius of gyration about a principal axis, is a mean distance of the mass from that axis.
It cannot be far beyond the farthest surface, joint or spring of the body, and is hardly ever a
hundredth of their distance from the axis. Consequence to test: kg mm^2 taken for kg m^2, or the
reverse, is seen in a body of any size.
"""

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.model.model import Group, Joint

# k over the reach of all from the axis below which, and over that of surfaces above which, is
# reported: cm for m changes k by 100, mm by 1000, and k is some third of the reach in most bodies
SMALL, LARGE = 1e-2, 10.0
# factors on the inertia by a unit mistaken for another, and both units
UNITS = {1e9: "g mm^2", 1e6: "kg mm^2", 1e4: "kg cm^2"}
# a radius of gyration over the reach that a factor should lead to: that of a shell, or a rod
USUAL = 0.4
Points = list[tuple[np.ndarray, float]]


def gyration_warnings(scene: Scene, groups: list[Group], joints: list[Joint]) -> list[str]:
    """One warning for every rigid body whose inertia is far too small or too large."""
    fixed, shapes = attached(groups, joints), outlines(scene)
    warnings = []
    for i, (name, entry) in enumerate(scene.deck.entries["bodies"].items(), start=1):
        if entry.type == "rigid" and entry.card.inertia is not None:
            own, J = shapes.get(i, []), scene.J[i].reshape(3, 3)
            text = inconsistency(float(scene.mass[i]), J, own, [*fixed.get(i, []), *own])
            warnings += [f"body '{name}': {text}"] if text else []
    return warnings


def inconsistency(mass: float, J: np.ndarray, surface: Points, points: Points) -> str:
    """Message of an inconsistent inertia [kg m^2]; points from the mass centre with radii [m].

    A point fixed in a body gives a lower bound of its extent, a surface its extent.
    """
    if not points:
        return ""
    moments, axes = np.linalg.eigh(J)
    gyration = np.sqrt(moments / mass)
    positions = np.array([point for point, _ in points])
    radii = np.array([radius for _, radius in points])
    across = [
        float((np.linalg.norm(positions - np.outer(positions @ u, u), axis=1) + radii).max())
        for u in axes.T
    ]
    small = [k < SMALL * far for k, far in zip(gyration, across, strict=True)]
    if any(small):
        i = int(np.argmax(np.array(across) / gyration))
        return _reported(gyration[i], "small", across[i], moments[i])
    reach = max(
        (float(np.linalg.norm(position)) + radius for position, radius in surface), default=0.0
    )
    if surface and gyration[2] > LARGE * reach > 0.0:
        return _reported(gyration[2], "large", reach, moments[2])
    return ""


def _reported(gyration: float, word: str, reach: float, moment: float) -> str:
    wanted = (USUAL * reach / gyration) ** (2 if word == "small" else -2)
    factor = min(UNITS, key=lambda f: abs(np.log(wanted / f)))
    numbers = ("kg m^2", UNITS[factor]) if word == "small" else (UNITS[factor], "kg m^2")
    return (
        f"its inertia looks too {word}: {moment:.3g} kg m^2 is a radius of gyration of "
        f"{gyration:.3g} m, and its surfaces, joints and springs reach {reach:.3g} m far; "
        f"were these numbers in {numbers[0]}, and read as {numbers[1]}? "
        "Name the unit with the number"
    )


def attached(groups: list[Group], joints: list[Joint]) -> dict[int, Points]:
    """Points of joints and springs from the mass centre of each body, body axes [m]."""
    points_of: dict[int, Points] = {}

    def add(node: int, point: object) -> None:
        points_of.setdefault(int(node), []).append((np.asarray(point, float), 0.0))

    for joint in joints:
        for side, node in (("a", joint.node_a), ("b", joint.node_b)):
            if f"point_{side}" in joint.frame:
                add(node, joint.frame[f"point_{side}"])
    for g in groups:
        columns = g.parameters.dtype.names or ()
        if hasattr(g.module, "force") and g.keyword != "parts":
            for side in "ab":
                if {f"node_{side}", f"point_{side}"} <= set(columns):
                    for p in g.parameters:
                        add(p[f"node_{side}"], p[f"point_{side}"])
    return points_of


def outlines(scene: Scene) -> dict[int, Points]:
    """Points of the surfaces of each body, from its mass centre, each with a radius [m]."""
    points_of: dict[int, Points] = {}
    for surface in scene.surfaces.values():
        if hasattr(surface.module, "bounding"):
            for element in surface.elements:
                points_of.setdefault(int(element["node"]), []).extend(outline(element))
    return points_of


def outline(element: Columns) -> Points:
    """Points on the surface of a shape, or its middle with a radius, body axes."""
    middle = np.asarray(element["point"], float)
    if "points" in element:
        corners = np.asarray(element["points"]) @ element["axes"].reshape(3, 3).T
        return [(middle + corner, 0.0) for corner in corners]
    half = element.get("half", element.get("semi"))
    if "half_length" in element:
        half = (element["radius"], element["radius"], element["half_length"])
    if half is None:
        return [(middle, float(element["radius"]))]
    offsets = element["axes"].reshape(3, 3) * np.asarray(half, float)
    return [(middle + sign * offset, 0.0) for offset in offsets.T for sign in (-1.0, 1.0)]
