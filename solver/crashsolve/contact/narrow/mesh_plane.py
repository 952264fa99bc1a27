"""Gap between a mesh and a plane, one for each point of the mesh."""

from crashsolve.contact.narrow import sphere_plane
from crashsolve.contact.shape import mesh, sphere

PARAMETERS_A = sphere.PARAMETERS
gap = sphere_plane.gap


def expand_a(elements):
    """The points of each mesh, as spheres of radius 0."""
    return [corner for element in elements for corner in mesh.corners(element)]
