"""Gap between a cylinder with flat caps and a plane, one for each cap.

A cap acts as a flat ellipsoid that reaches exactly to the rim and to the cap: a lying cylinder
rests on both, a standing one on one, whose point of contact moves across the cap as it tilts by a
thousandth.
"""

from crashsolve.contact.narrow import ellipsoid_plane
from crashsolve.contact.shape import cylinder, ellipsoid

PARAMETERS_A = ellipsoid.PARAMETERS
gap = ellipsoid_plane.gap


def expand_a(elements):
    """The two caps of each cylinder."""
    return [rim for element in elements for rim in cylinder.rims(element)]
