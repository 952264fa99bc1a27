"""Mesh from a file that meshio reads: .inp, .bdf, .msh, .vtu and others; its sets are kept.

Nodes, elements and sets are read, and the rest is passed over with a warning. What would move or
make nodes and elements there, or that are not understood, are refused with their line
(foundation/mesh_files/reading.py). Consequence to test: a mesh written and read is the same.
"""

from pathlib import Path
from typing import Literal

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, FileName, SetName, quantity, word
from crashsolve.foundation.mesh_files.reading import (
    OUTLINES,
    SIDES,
    MeshFile,
    MeshFileError,
    read_mesh_file,
)
from crashsolve.meshes._joined import coarsened
from crashsolve.meshes._mesh import Mesh


class File(Card):
    """Elements of a file, of four or three nodes; needs the extra [mesh]; sets are kept.

    Sets are those of Abaqus by name; properties of Nastran by number, its sets as SET 3; physical
    groups of gmsh by name or number.
    """

    file: FileName = word("mesh file, beside the deck that names it")
    unit: float = quantity("m", "length of the file's unit", default=1.0, gt=0)
    elements: SetName = word(
        "element set, property or physical group; all elements of the file if empty", default=""
    )
    joined: Literal[1, 2, 4, 8] = word(
        "number of elements along each side that become one, where they lie in rows", default=1
    )


def build(card: File, scene: Scene) -> Mesh:
    path = Path(card.file)
    try:
        mesh_file = read_mesh_file(path)
    except ImportError:
        raise scene.fail("needs meshio: pip install 'crashsolve[mesh]'", "mesh.file") from None
    except MeshFileError as error:
        raise scene.fail(str(error), "mesh.file") from None
    if mesh_file.passed_over:
        words = ", ".join(mesh_file.passed_over[:8]) + ", ..." * (len(mesh_file.passed_over) > 8)
        scene.warn(f"{path.name}: only nodes, elements and sets are read, not {words}")
    wanted = _wanted(mesh_file, card, scene)
    corners = mesh_file.corners[wanted]
    used, numbers = np.unique(corners, return_inverse=True)
    index = np.full(len(mesh_file.points), -1)
    index[used] = np.arange(len(used))
    # of a set of nodes, those that belong to these elements
    sets = {name: index[own][index[own] >= 0] for name, own in mesh_file.node_sets.items()}
    at = np.full(len(mesh_file.kinds), -1)
    at[wanted] = np.arange(len(wanted))
    elements = {name: at[own][at[own] >= 0] for name, own in mesh_file.element_sets.items()}
    points = mesh_file.points[used] * card.unit
    mesh = Mesh(points, numbers.reshape(corners.shape), sets, elements)
    return coarsened(mesh, card, scene)


def _wanted(mesh: MeshFile, card: File, scene: Scene) -> np.ndarray:
    """Numbers of the elements wanted."""
    if not card.elements:
        own = np.arange(len(mesh.kinds))
        if mesh.has_outlines:
            own = own[~np.isin(mesh.kinds, OUTLINES)]
    elif card.elements in mesh.element_sets:
        own = mesh.element_sets[card.elements]
    else:
        known = ", ".join(sorted(mesh.element_sets)) or "none"
        message = f"the file has no element set '{card.elements}' (sets: {known})"
        raise scene.fail(message, "mesh.elements")
    others = own[~np.isin(mesh.kinds[own], list(SIDES))]
    if len(others):
        kind = str(mesh.kinds[others[0]])
        count = int((mesh.kinds[others] == kind).sum())
        index = f" ({mesh.firsts[kind]})" if kind in mesh.firsts else ""
        wanted = "shells are of type quad or triangle"
        raise scene.fail(f"{count} elements are of type {kind}; {wanted}{index}", "mesh.file")
    if not len(own):
        name = f"set '{card.elements}'" if card.elements else "the file"
        raise scene.fail(f"{name} holds no elements", "mesh.elements")
    return np.asarray(own)
