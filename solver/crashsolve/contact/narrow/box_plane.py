"""Gap between a box and a plane, one for each of the eight corners."""

from crashsolve.contact.narrow import sphere_plane
from crashsolve.contact.shape import box, sphere

PARAMETERS_A = sphere.PARAMETERS
gap = sphere_plane.gap


def expand_a(elements):
    """The corners of each box, as spheres of radius 0."""
    return [corner for element in elements for corner in box.corners(element)]
