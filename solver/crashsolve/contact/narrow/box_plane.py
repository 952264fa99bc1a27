"""Gap between a box and a plane, one for each of the eight corners.

    depth = -(c - x_0) . n,   a quarter of the force of the law in each

so that a box that lies on four corners sinks as deep as one point would under the whole force.
"""

from crashsolve.contact.narrow import sphere_plane
from crashsolve.contact.shape import box, sphere
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

# description in the manual
POINTS = "one for each of the eight corners, with a quarter of the force: a lone corner has K/4"
# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
PARAMETERS_A = sphere.PARAMETERS + Record("share  1  of the force of the law")


def expand_a(elements):
    """The corners of each box, as spheres of radius 0."""
    return [c | {"share": 0.25} for element in elements for c in box.corners(element)]


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, the corner; world components."""
    return sphere_plane.gap(a, b, nodes, data)
