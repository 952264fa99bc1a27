"""Angle between two directions, to round-off from 0 to pi, without a call of the library.

    cos beta below 1/2 in size   beta = pi/2 - asin(u . v)
    else                         beta = 2 asin(|u - v| / 2)   or   pi - 2 asin(|u + v| / 2)

so the arc sine is needed up to 1/2 alone: asin s = s + s z R(z), z = s^2. R is the interpolation of
its series (1 3 ... (2k - 1)) / (2 4 ... 2k) / (2k + 1) z^(k - 1), k from 1 on, at the 12 zeros of
the polynomial of Chebyshev on [0, 1/4]; there z R is exact to 6e-17.
"""

from math import pi, sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, dot, sub

# R from the constant term on
R0, R1, R2 = 0.1666666666666665, 0.07500000000020764, 0.044642857103423646
R3, R4, R5 = 0.03038194736709848, 0.02237204763174451, 0.017355259955786323
R6, R7, R8 = 0.013929652902326633, 0.011875494382636924, 0.007802949477353317
R9, R10, R11 = 0.016035514349148825, -0.010749050339697811, 0.028169218060881414


@kernel
def angle_between(u, v):
    """Angle between two unit vectors [rad]."""
    c = dot(u, v)
    if abs(c) <= 0.5:
        return 0.5 * pi - asin_to_half(c, c * c)
    across = sub(u, v) if c > 0.0 else add(u, v)
    z = 0.25 * dot(across, across)
    angle = 2.0 * asin_to_half(sqrt(z), z)
    return angle if c > 0.0 else pi - angle


@kernel
def asin_to_half(s, z):
    """Arc sine of s up to 1/2 in size; z = s^2. In pairs of terms, which do not wait in a row."""
    z2 = z * z
    z4 = z2 * z2
    low = R0 + R1 * z + (R2 + R3 * z) * z2
    middle = R4 + R5 * z + (R6 + R7 * z) * z2
    high = R8 + R9 * z + (R10 + R11 * z) * z2
    return s + s * z * (low + (middle + high * z4) * z4)
