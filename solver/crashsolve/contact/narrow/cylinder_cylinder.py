"""Gap between two cylinders with rounded rims: see contact/narrow/_edged.py."""

from crashsolve.contact.narrow import _edged
from crashsolve.contact.shape import cylinder

PARAMETERS_A = PARAMETERS_B = _edged.PARAMETERS
gap = _edged.gap


def expand_a(elements, others=()):
    """Each cylinder as a sum of ellipsoids; `others`: elements that it may meet."""
    return _edged.expand(elements, cylinder, others)


def expand_b(elements, others=()):
    """Each cylinder as a sum of ellipsoids; `others`: elements that it may meet."""
    return _edged.expand(elements, cylinder, others)
