"""Nearest point of a four-node face to a point in space.

    the face: the four triangles between its sides and the middle of its corners, m = sum x_k / 4
    c = sum N_k x_k,   |x - c| the least of the four triangles

A flat face is itself; a warped one is folded along lines to its middle, the same from whichever
corner one starts, and without gaps to its neighbours. Consequence to test: no point of the
face is nearer, and N_k >= 0 add up to 1.

Reference: Ericson (2005), Real-Time Collision Detection, 5.1.5.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add_scaled, cross, dot, sub

# where on a face: within it, on the side after corner k (EDGE + k), at corner k (CORNER + k)
INSIDE, EDGE, CORNER = 0, 1, 5
TINY = 1e-300


@kernel
def nearest_on_triangle(a, b, c):
    """Weights of three points [m] of the point of their triangle nearest to the origin."""
    ab, ac = sub(b, a), sub(c, a)
    d1, d2 = -dot(ab, a), -dot(ac, a)
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    d3, d4 = -dot(ab, b), -dot(ac, b)
    if d3 >= 0.0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    d5, d6 = -dot(ab, c), -dot(ac, c)
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    of_c = d1 * d4 - d3 * d2
    if of_c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        t = d1 / max(d1 - d3, TINY)
        return 1.0 - t, t, 0.0
    of_b = d5 * d2 - d1 * d6
    if of_b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        t = d2 / max(d2 - d6, TINY)
        return 1.0 - t, 0.0, t
    of_a = d3 * d6 - d5 * d4
    if of_a <= 0.0 and d4 >= d3 and d5 >= d6:
        t = (d4 - d3) / max((d4 - d3) + (d5 - d6), TINY)
        return 0.0, 1.0 - t, t
    k = 1.0 / max(of_a + of_b + of_c, TINY)
    return k * of_a, k * of_b, k * of_c


@kernel
def point_of(weights, a, b, c, d):
    """sum N_k x_k."""
    x = add_scaled((0.0, 0.0, 0.0), weights[0], a)
    return add_scaled(add_scaled(add_scaled(x, weights[1], b), weights[2], c), weights[3], d)


@kernel
def nearest_on_face(a, b, c, d):
    """Weights N of the corners, given from the point in space, squared distance, feature.

    The position is INSIDE, EDGE + k or CORNER + k.
    """
    m = point_of((0.25, 0.25, 0.25, 0.25), a, b, c, d)
    least, at, first, second, middle = 1e300, 0, 0.0, 0.0, 0.0
    for k in range(4):
        # the side from corner k to the next, and the middle
        p, q = (a, b) if k == 0 else ((b, c) if k == 1 else ((c, d) if k == 2 else (d, a)))
        u, v, w = nearest_on_triangle(p, q, m)
        x = add_scaled(add_scaled(add_scaled((0.0, 0.0, 0.0), u, p), v, q), w, m)
        square = dot(x, x)
        if square < least:
            least, at, first, second, middle = square, k, u, v, w
    N, position = corner_weights(at, first, second, middle)
    return N, least, position


@kernel
def corner_weights(k, first, second, middle):
    """Weights N of the corners, and the position, from those of a triangle: side k and middle."""
    share = 0.25 * middle
    N = (
        share + (first if k == 0 else 0.0) + (second if k == 3 else 0.0),
        share + (first if k == 1 else 0.0) + (second if k == 0 else 0.0),
        share + (first if k == 2 else 0.0) + (second if k == 1 else 0.0),
        share + (first if k == 3 else 0.0) + (second if k == 2 else 0.0),
    )
    position = INSIDE
    if middle == 0.0:
        position = EDGE + k
        if second == 0.0:
            position = CORNER + k
        elif first == 0.0:
            position = CORNER + (k + 1) % 4
    return N, position


@kernel
def normal_vector(a, b, c, d):
    """Normal of a face, twice as long as its area."""
    return cross(sub(c, a), sub(d, b))
