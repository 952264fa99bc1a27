"""Mesh from a file that meshio reads: .inp, .bdf, .vtu, .msh and others; its sets are kept.

meshio reads nodes, elements and sets, and passes over the rest in silence. What would move or make
nodes and elements there is refused here. Consequence to test: a mesh written and read is the same.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from crashsolve.deck.card import Card, FileName, quantity, word
from crashsolve.meshes._mesh import Mesh

# words of a file that meshio does not follow, though they decide where nodes and elements are
LOST = {
    ".inp": r"\*(INSTANCE|ASSEMBLY|PART|SYSTEM|TRANSFORM|NGEN|ELGEN|NCOPY|ELCOPY|NFILL|INCLUDE)\b"
    r"|\*NODE\b.*\bSYSTEM\s*=\s*[CS]\b",
    ".bdf": r"INCLUDE\b|CORD[123][RCS]\b",
}
LOST |= {".fem": LOST[".bdf"], ".nas": LOST[".bdf"]}


class File(Card):
    """Elements of a file, of four or three nodes; needs the extra [mesh]; sets are kept."""

    file: FileName = word("beside the deck")
    unit: float = quantity("m", "length that the file's unit stands for", default=1.0, gt=0)
    elements: str = word(
        "element set, or number of a property; all elements of the file if empty", default=""
    )


def build(card: File, scene: Any) -> Mesh:
    path = Path(card.file)
    _refuse_lost(path, scene)
    try:
        import meshio
    except ImportError:
        raise scene.fail("needs meshio: pip install crashsolve[mesh]", "mesh.file") from None
    try:
        found = meshio.read(path)
    except SystemExit:
        raise scene.fail(f"meshio does not know files like {path.name}", "mesh.file") from None
    except Exception as error:
        raise scene.fail(f"meshio cannot read {path.name}: {error}", "mesh.file") from None
    quads = _quads(found, card, scene)
    points = np.asarray(found.points, float) * card.unit
    if points.shape[1] == 2:
        points = np.hstack([points, np.zeros((len(points), 1))])
    used, numbers = np.unique(quads, return_inverse=True)
    place = np.full(len(points), -1)
    place[used] = np.arange(len(used))
    sets = {name: place[np.asarray(own, int)] for name, own in found.point_sets.items()}
    sets = {name: own[own >= 0] for name, own in sets.items()}
    return Mesh(points[used], numbers.reshape(quads.shape), sets)


def _refuse_lost(path: Path, scene: Any) -> None:
    lost = LOST.get(path.suffix.lower())
    if lost is None:
        return
    for number, line in enumerate(path.read_text("utf-8", errors="replace").splitlines(), 1):
        met = re.match(rf"\s*({lost})", line, re.IGNORECASE)
        if met:
            what = f"{path.name}, line {number}: {met[0].strip().upper()} would be passed over"
            raise scene.fail(f"{what}; write the mesh flat, with nodes and elements", "mesh.file")


def _numbered(found: Any) -> dict[str, list[np.ndarray]]:
    """Elements by the number of their property, of every block, as .bdf files have them."""
    numbers = found.cell_data.get("nastran:ref", [])
    known: Any = np.unique(np.concatenate(numbers)) if numbers else ()
    return {str(n): [np.flatnonzero(own == n) for own in numbers] for n in known}


def _quads(found: Any, card: File, scene: Any) -> np.ndarray:
    """Corners of the elements wanted; the last corner of a triangle is named twice."""
    sets = _numbered(found) | found.cell_sets
    if card.elements and card.elements not in sets:
        known = ", ".join(sorted(sets)) or "none"
        message = f"the file has no element set '{card.elements}' (sets: {known})"
        raise scene.fail(message, "mesh.elements")
    quads = []
    for k, block in enumerate(found.cells):
        cells = np.asarray(block.data)
        if card.elements:
            cells = cells[np.asarray(sets[card.elements][k], int)]
        if len(cells) and block.type not in ("quad", "triangle"):
            wanted = "shells are of type quad or triangle"
            message = f"{len(cells)} elements are of type {block.type}; {wanted}"
            raise scene.fail(message, "mesh.file")
        if block.type == "triangle":
            cells = cells[:, [0, 1, 2, 2]]
        quads.append(cells if len(cells) else np.zeros((0, 4), int))
    found_quads = np.concatenate(quads) if quads else np.zeros((0, 4), int)
    if not len(found_quads):
        raise scene.fail("holds no elements", "mesh.file")
    return found_quads
