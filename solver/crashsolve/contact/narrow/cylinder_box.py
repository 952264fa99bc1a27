"""Gap between a cylinder and a box with rounded edges: see contact/narrow/_edged.py."""

from crashsolve.contact.narrow import _edged
from crashsolve.contact.shape import box, cylinder

PARAMETERS_A = PARAMETERS_B = _edged.PARAMETERS
gap = _edged.gap


def expand_a(elements):
    """Each cylinder with the ellipsoids it is a sum of."""
    return _edged.expand(elements, cylinder)


def expand_b(elements):
    """Each box with the ellipsoids it is a sum of."""
    return _edged.expand(elements, box)
