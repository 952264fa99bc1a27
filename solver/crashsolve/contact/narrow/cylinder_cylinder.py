"""Gap between two cylinders with rounded rims: see contact/narrow/_edged.py."""

from crashsolve.contact.narrow import _edged
from crashsolve.contact.shape import cylinder

PARAMETERS_A = PARAMETERS_B = _edged.PARAMETERS
gap = _edged.gap


def expand_a(elements):
    """Each cylinder with the ellipsoids it is a sum of."""
    return _edged.expand(elements, cylinder)


def expand_b(elements):
    """Each cylinder with the ellipsoids it is a sum of."""
    return _edged.expand(elements, cylinder)
