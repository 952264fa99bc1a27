"""Gaps between a cylinder and a mesh: its positions over a plane, and the deepest edge."""

from crashsolve.contact.narrow import _solid_mesh
from crashsolve.contact.narrow._solid_mesh import HIGHEST, LOWEST, POINT, RIDGES, part
from crashsolve.contact.narrow.cylinder_plane import POSITIONS

# description in the manual
POINTS = (
    "three on a cap, three on the side, and the deepest edge of the mesh, each a third of the force"
)
PARAMETERS_A, PARAMETERS_B = _solid_mesh.PARAMETERS_A, _solid_mesh.PARAMETERS_B
gap = _solid_mesh.gap
FEATURES = {1.0: LOWEST, 0.0: POINT, -1.0: HIGHEST}


def expand_a(elements):
    """The seven positions of each cylinder, and the whole of it."""
    parts = []
    for e in elements:
        r, half_length, axis = e["radius"], e["half_length"], e["axes"].reshape(3, 3)[:, 2]
        half = (r, r, half_length)
        for along, rho in POSITIONS:
            point = e["point"] + along * half_length * axis
            parts.append(part(e, half, FEATURES[rho], point, rho * r, 1.0 / 3.0))
        parts.append(part(e, half, RIDGES, e["point"], 0.0, 1.0 / 3.0))
    return parts
