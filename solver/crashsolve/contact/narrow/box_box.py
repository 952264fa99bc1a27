"""Gap between two boxes with rounded edges: see contact/narrow/_convex.py."""

from crashsolve.contact.narrow import _convex
from crashsolve.contact.shape import box

PARAMETERS_A = PARAMETERS_B = _convex.PARAMETERS
gap = _convex.gap


def expand_a(elements):
    """Each box as a sum of ellipsoids."""
    return _convex.expand(elements, box)


def expand_b(elements):
    """Each box as a sum of ellipsoids."""
    return _convex.expand(elements, box)
