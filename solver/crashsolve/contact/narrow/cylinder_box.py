"""Gap between a cylinder and a box with rounded edges: see contact/narrow/_convex.py."""

from crashsolve.contact.narrow import _convex
from crashsolve.contact.shape import box, cylinder

PARAMETERS_A = PARAMETERS_B = _convex.PARAMETERS
gap = _convex.gap


def expand_a(elements):
    """Each cylinder as a sum of ellipsoids."""
    return _convex.expand(elements, cylinder)


def expand_b(elements):
    """Each box as a sum of ellipsoids."""
    return _convex.expand(elements, box)
