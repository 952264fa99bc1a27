"""Gap between a cylinder and a box with rounded edges: see contact/narrow/_edged.py."""

from crashsolve.contact.narrow import _edged
from crashsolve.contact.shape import box, cylinder

PARAMETERS_A = PARAMETERS_B = _edged.PARAMETERS
gap = _edged.gap


def expand_a(elements, others=()):
    """Each cylinder as a sum of ellipsoids; `others`: elements that it may meet."""
    return _edged.expand(elements, cylinder, others)


def expand_b(elements, others=()):
    """Each box with the ellipsoids of which it is a sum; `others`: elements that it may meet."""
    return _edged.expand(elements, box, others)
