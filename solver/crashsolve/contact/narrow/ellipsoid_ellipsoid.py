"""Gap between two ellipsoids: see contact/narrow/_convex.py."""

from crashsolve.contact.narrow import _convex
from crashsolve.contact.shape import ellipsoid

PARAMETERS_A = PARAMETERS_B = _convex.PARAMETERS
gap, bound = _convex.gap, _convex.bound


def expand_a(elements, others=()):
    """Each ellipsoid as a sum of ellipsoids."""
    return _convex.expand(elements, ellipsoid)


def expand_b(elements, others=()):
    """Each ellipsoid as a sum of ellipsoids."""
    return _convex.expand(elements, ellipsoid)
