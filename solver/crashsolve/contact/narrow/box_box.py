"""Gap between two boxes with rounded edges: see contact/narrow/_edged.py."""

from crashsolve.contact.narrow import _edged
from crashsolve.contact.shape import box

PARAMETERS_A = PARAMETERS_B = _edged.PARAMETERS
gap = _edged.gap


def expand_a(elements, others=()):
    """Each box with the ellipsoids of which it is a sum; `others`: elements that it may meet."""
    return _edged.expand(elements, box, others)


def expand_b(elements, others=()):
    """Each box with the ellipsoids of which it is a sum; `others`: elements that it may meet."""
    return _edged.expand(elements, box, others)
