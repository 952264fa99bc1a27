"""Shells that have passed through themselves, for want of contact or between its nodes.

An edge p q passes through a triangle a b c if p and q lie on different sides of its plane, and all
three sides of the triangle on the same side of the line through p and q, by the signs of volumes.
Consequence to test: a tube crushed without contact of its walls is found, one that bends is not.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from crashsolve.model.model import Model
from crashsolve.system.engine import Engine

# so many elements no fold crosses that is not through itself; and the share of those that edges
# cross between nodes in contact, 2 of 744 in a tube of 6 elements a side
FEW, EDGES = 4, 0.01
# of the length of an edge: ends nearer to the plane of a triangle are in it but for round-off
IN_PLANE = 1e-9
# pairs of an edge and a triangle that are examined at once
CHUNK = 200_000


def shells_through_themselves(engine: Engine) -> list[str]:
    """Warnings of parts of shells that end pushed through themselves; none with deleted elements,
    which are still in the mesh.
    """
    model, state = engine.model, engine.state
    if model.elements is None:
        return []
    eroded = {
        name
        for group in model.element_groups()
        for name, count in zip(group.names, group.output["deleted"], strict=True)
        if count
    }
    contacts = _self_contacts(model)
    warnings = []
    for name, meshed in model.elements.parts.items():
        if name in eroded:
            continue
        quads, contact = meshed.mesh.quads, contacts.get(meshed.first)
        x = state.points["r"][meshed.first : meshed.first + len(meshed.mesh.points)]
        count, few = int(passed(x, quads).sum()), FEW if contact is None else EDGES * len(quads)
        # a mesh may begin so
        if count > few and (count := count - int(passed(meshed.mesh.points, quads).sum())) > few:
            warnings.append(_warning(name, contact, count, len(quads)))
    return warnings


def _warning(name: str, contact: str | None, count: int, total: int) -> str:
    start = f"part '{name}': {count} of {total} elements end pushed through others of it"
    if contact is None:
        return (
            f"{start}, since nothing keeps its walls apart: it is too soft, and folds too far; let "
            "its nodes touch its own faces (self_contact: true of a structure), and compare the "
            "results"
        )
    return (
        f"{start}: '{contact}' keeps its nodes from its faces, but edges pass between nodes where "
        "folds are as sharp as elements; take smaller elements, and compare the results"
    )


def _self_contacts(model: Model) -> dict[int, str]:
    """Contacts of nodes with the faces of their own mesh, by its first point."""
    return {
        int(group.arrays["p"]["first_own"][0]): group.card
        for group in model.nodal_groups
        if group.is_self_contact
    }


def passed(x: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Which quadrilaterals (n, 4) have a side that passes through another; x: positions (m, 3)."""
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    owner = np.tile(np.arange(len(quads)), 2)
    is_real = triangles[:, 1] != triangles[:, 2]
    triangles, owner = triangles[is_real], owner[is_real]
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1)
    edges = np.unique(np.sort(sides.reshape(-1, 2), axis=1), axis=0)
    crossed = np.zeros(len(quads), bool)
    for e, t in _near(x[edges], x[triangles]):
        apart = (edges[e][:, :, None] != triangles[t][:, None, :]).all(axis=(1, 2))
        e, t = e[apart], t[apart]
        crossed[owner[t[_pass(x[edges[e]], x[triangles[t]])]]] = True
    return crossed


def _near(edges: np.ndarray, triangles: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of edges (n, 2, 3) and triangles (m, 3, 3) whose middles are in cubes side by side."""
    sizes = [np.ptp(of, axis=1).max() for of in (edges, triangles)]
    width = max(*sizes, np.finfo(float).tiny)
    cells = [np.floor(of.mean(axis=1) / width).astype(np.int64) for of in (edges, triangles)]
    low = np.minimum(cells[0].min(axis=0), cells[1].min(axis=0)) - 1
    shape = np.maximum(cells[0].max(axis=0), cells[1].max(axis=0)) - low + 2
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    own, keys = ((of - low) @ strides for of in cells)
    order = np.argsort(keys, kind="stable")
    for offset in product((-1, 0, 1), repeat=3):
        wanted = own + np.array(offset) @ strides
        begin = np.searchsorted(keys[order], wanted, "left")
        counts = np.searchsorted(keys[order], wanted, "right") - begin
        ends = np.cumsum(counts)
        for first in range(0, int(ends[-1]), CHUNK):
            number = np.arange(first, min(first + CHUNK, int(ends[-1])))
            e = np.searchsorted(ends, number, "right")
            yield e, order[begin[e] + number - (ends[e] - counts[e])]


def _pass(edges: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whether edges (n, 2, 3) pass through triangles (n, 3, 3), each through its own."""
    p, q = edges[:, 0], edges[:, 1]
    a, b, c = (triangles[:, k] for k in range(3))
    above, below = _volume(p, a, b, c), _volume(q, a, b, c)
    largest = np.linalg.norm(q - p, axis=1) * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    is_clear = np.minimum(abs(above), abs(below)) > IN_PLANE * largest
    volumes = np.array([_volume(p, q, u, v) for u, v in ((a, b), (b, c), (c, a))])
    same = (volumes > 0.0).all(axis=0) | (volumes < 0.0).all(axis=0)
    through: np.ndarray = is_clear & (above * below < 0.0) & same
    return through


def _volume(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Six times the signed volume of tetrahedra p a b c."""
    volume: np.ndarray = np.einsum("ij,ij->i", a - p, np.cross(b - p, c - p))
    return volume
