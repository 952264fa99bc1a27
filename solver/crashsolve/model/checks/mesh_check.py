"""Whether the elements of a mesh hang together: unconnected, duplicate, inverted, disjoint."""

import numpy as np

from crashsolve.meshes._mesh import Mesh


def faults(mesh: Mesh) -> str:
    """The first error in the connectivity of elements; empty without any."""
    return _unconnected(mesh) or _duplicate(mesh) or _inverted(mesh) or _disjoint(mesh)


def _unconnected(mesh: Mesh) -> str:
    used = np.zeros(len(mesh.points), bool)
    used[mesh.quads] = True
    if used.all():
        return ""
    return f"node {int(np.argmin(used)) + 1} belongs to no element; leave it out"


def _duplicate(mesh: Mesh) -> str:
    """Nodes nearer than a millionth of the shortest side, found in two nets of cells."""
    sides = mesh.points[mesh.quads] - mesh.points[np.roll(mesh.quads, -1, axis=1)]
    # a triangle names a corner twice
    real = mesh.quads != np.roll(mesh.quads, -1, axis=1)
    grain = 1e-6 * float(np.linalg.norm(sides, axis=2)[real].min())
    if grain == 0.0:
        return ""  # an element with a side of no length is refused by itself
    for shift in (0.0, 0.5):
        cells = np.floor(mesh.points / grain + shift)
        order = np.lexsort(cells.T)
        same = np.flatnonzero((cells[order[1:]] == cells[order[:-1]]).all(axis=1))
        if len(same):
            a, b = sorted(int(order[same[0] + k]) + 1 for k in (0, 1))
            where = ", ".join(f"{x:.6g}" for x in mesh.points[a - 1])
            return f"nodes {a} and {b} are both at ({where}) m; merge them or move them apart"
    return ""


def _inverted(mesh: Mesh) -> str:
    """Two elements that run along a side in the same direction have opposite normals.

    Of three that share a side, two always do.
    """
    ends = np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    order = np.lexsort(ends.T)
    # a triangle has a side of no length
    real = ends[order[1:], 0] != ends[order[1:], 1]
    same = np.flatnonzero((ends[order[1:]] == ends[order[:-1]]).all(axis=1) & real)
    if not len(same):
        return ""
    side = ends[order[same[0]]]
    sharing = np.flatnonzero((np.sort(ends, axis=1) == np.sort(side)).all(axis=1)) // 4 + 1
    if len(sharing) > 2:
        names = f"{', '.join(map(str, sharing[:-1]))} and {sharing[-1]}"
        return (
            f"elements {names} share the side of nodes {side.min() + 1} and {side.max() + 1}, a "
            "T-junction: a side of a shell has one neighbour at most; make the web a part of its "
            "own and join it by ties"
        )
    a, b = sorted(int(order[same[0] + k]) // 4 + 1 for k in (0, 1))
    return f"elements {a} and {b} have opposite normals; reverse the corners of one"


def _disjoint(mesh: Mesh) -> str:
    """Every element must be joined to every other by common nodes."""
    label = np.arange(len(mesh.points))
    while True:
        least = label[mesh.quads].min(axis=1)
        new = label.copy()
        np.minimum.at(new, mesh.quads.ravel(), np.repeat(least, 4))
        new = new[new]
        if (new == label).all():
            break
        label = new
    count = len(np.unique(label))
    if count == 1:
        return ""
    other = int(np.argmax(label != label[0])) + 1
    message = f"is disjoint, in {count} parts: no elements connect node 1 with node {other}"
    return f"{message}; make two parts of it"
