"""Gaps between a box and a mesh of triangles: eight corners, and the deepest edge of the mesh."""

from crashsolve.contact.narrow import _solid_mesh
from crashsolve.contact.narrow._solid_mesh import POINT, RIDGES, part
from crashsolve.contact.shape import box

# description in the manual
POINTS = "the eight corners, and the deepest edge of the mesh, with a quarter of the force each"
PARAMETERS_A, PARAMETERS_B = _solid_mesh.PARAMETERS_A, _solid_mesh.PARAMETERS_B
gap = _solid_mesh.gap


def expand_a(elements):
    """The corners of each box, and the whole of it."""
    parts = []
    for e in elements:
        parts += [part(e, e["half"], POINT, c["point"], 0.0, 0.25) for c in box.corners(e)]
        parts.append(part(e, e["half"], RIDGES, e["point"], 0.0, 0.25))
    return parts
