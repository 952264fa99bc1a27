"""Friction that depends on the sliding speed alone: applied against the slip, all work is lost."""

from math import sqrt

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.vec3 import dot, scale


@kernel
def speed(slip):
    """Sliding speed [m/s]."""
    return sqrt(dot(slip, slip))


@kernel
def against(slip, v, friction, slope):
    """Friction on side a and its record, for a friction force at sliding speed v.

    Returns force, stored energy, dissipated power, loss, stiffness, damping; slope bounds the
    rise of the friction force over the sliding speed [N s/m].
    """
    share = -friction / v if v > 0.0 else 0.0
    return scale(share, slip), 0.0, friction * v, 0.0, 0.0, slope
