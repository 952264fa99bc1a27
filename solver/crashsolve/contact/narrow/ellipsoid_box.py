"""Gap between an ellipsoid and a box with rounded edges: see contact/narrow/_convex.py."""

from crashsolve.contact.narrow import _convex
from crashsolve.contact.shape import box, ellipsoid

PARAMETERS_A = PARAMETERS_B = _convex.PARAMETERS
gap, bound = _convex.gap, _convex.bound


def expand_a(elements, others=()):
    """Each ellipsoid as a sum of ellipsoids."""
    return _convex.expand(elements, ellipsoid)


def expand_b(elements, others=()):
    """Each box as a sum of ellipsoids; `others`: ellipsoids that it may meet."""
    return _convex.expand_sharp(elements, box, others)
