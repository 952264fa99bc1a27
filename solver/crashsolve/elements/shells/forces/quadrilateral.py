"""Four-node shell with one point in its plane: axes, strains of its motion, forces on its nodes.

A field at the nodes u_1 ... u_4 enters as its differences along both diagonals, its hourglass and
its sum,

    D = u_3 - u_1,   E = u_4 - u_2,   H = u_1 - u_2 + u_3 - u_4,   S = u_1 + u_2 + u_3 + u_4

a = (D - E) / 2 and b = (D + E) / 2 of the positions point from side to side. The axes turn with the
polar rotation of the plane's deformation. In a warped element the corners lie beside the mean plane
by z and -z: a surface through them has in its middle the strains of D and E, and those that
rotations add to H is no strain, so that the moments are in balance. Transverse shear is that of the
four sides (assumed strain). Forces are the transpose of strains, so that a rigid motion does no
work.

References: Belytschko, Lin and Tsay (1984), Explicit algorithms for the nonlinear dynamics of
shells, Computer Methods in Applied Mechanics and Engineering 42, 225-251. Belytschko and Leviathan
(1994), Physical stabilization of the 4-node shell element with one point quadrature, the same 113,
321-350. Zeng and Combescure (1998), A new one-point quadrature, general non-linear quadrilateral
shell element with physical stabilization, International Journal for Numerical Methods in
Engineering 42, 1307-1338. Dvorkin and Bathe (1984), A continuum mechanics based four-node shell
element for general nonlinear analysis, Engineering Computations 1, 77-88.
"""

from math import sqrt

from crashsolve.foundation.kernels import inlined

# stiffness against spins of the nodes about the normal that differ from the rotation of the plane,
# over that against shear of the plane: enough to tie them, too little to set the step
DRILLING = 0.1


@inlined
def dot3(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross3(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def combine(s, a, t, b):
    """s a + t b."""
    return (s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2])


@inlined
def plane_axes(d, e, G):
    """Axes by the polar rotation, diagonals in them, area; d and e are D and E of the positions.

    G is the inverse of the diagonals at the start, as columns in the axes of the start.
    """
    n = cross3(d, e)
    dd, de, area = dot3(d, d), dot3(d, e), 0.5 * sqrt(dot3(n, n))
    # F11 + F22 and F21 - F12 of the deformation gradient, times the length of d
    c = dd * G[0] + de * G[2] + 2.0 * area * G[3]
    s = 2.0 * area * G[2] - dd * G[1] - de * G[3]
    k = 1.0 / sqrt(dd * (c * c + s * s))
    c, s = k * c, k * s
    k = 0.5 / area
    e3 = (k * n[0], k * n[1], k * n[2])
    across = cross3(e3, d)
    axes = (combine(c, d, s, across), combine(c, across, -s, d), e3)
    return axes, (c * dd, -s * dd, c * de + s * 2.0 * area, c * 2.0 * area - s * de), area


@inlined
def slopes(D, E, H, flat, hourglass, area):
    """Derivatives by x and y of one component, and its hourglass without its linear part."""
    x31, y31, x42, y42 = flat
    k = 0.5 / area
    by_x = k * (y42 * D - y31 * E)
    by_y = k * (x31 * E - x42 * D)
    return by_x, by_y, 0.25 * (H - hourglass[0] * by_x - hourglass[1] * by_y)


@inlined
def slopes_transposed(along_x, along_y, q, flat, hourglass, area):
    """Generalized forces on D, E and H, of power along_x by_x + along_y by_y + q hourglass."""
    x31, y31, x42, y42 = flat
    q = 0.25 * q
    k = 0.5 / area
    p_x, p_y = k * (along_x - q * hourglass[0]), k * (along_y - q * hourglass[1])
    return y42 * p_x - x42 * p_y, x31 * p_y - y31 * p_x, q


@inlined
def sides(flat):
    """a and b of the positions in the plane."""
    x31, y31, x42, y42 = flat
    return 0.5 * (x31 - x42), 0.5 * (y31 - y42), 0.5 * (x31 + x42), 0.5 * (y31 + y42)


@inlined
def shears(w, theta_x, theta_y, flat, hourglass, area):
    """Transverse shear in the middle, and its change across the element, along a and b.

    w is (D, E, H) of the deflection, theta_x and theta_y are (D, E, S) of the rotations.
    """
    a_x, a_y, b_x, b_y = sides(flat)
    h_x, h_y = hourglass
    mean_x, mean_y = 0.25 * theta_x[2], 0.25 * theta_y[2]
    p_x, p_y = 0.5 * (theta_x[0] - theta_x[1]), 0.5 * (theta_y[0] - theta_y[1])
    q_x, q_y = 0.5 * (theta_x[0] + theta_x[1]), 0.5 * (theta_y[0] + theta_y[1])
    g_a = 0.5 * (w[0] - w[1]) + a_x * mean_y - a_y * mean_x + 0.25 * (h_x * q_y - h_y * q_x)
    g_b = 0.5 * (w[0] + w[1]) + b_x * mean_y - b_y * mean_x + 0.25 * (h_x * p_y - h_y * p_x)
    twist = w[2] + h_x * mean_y - h_y * mean_x
    k = 1.0 / area
    gamma = (k * (b_y * g_a - a_y * g_b), k * (a_x * g_b - b_x * g_a))
    return gamma, (twist + a_x * q_y - a_y * q_x, twist + b_x * p_y - b_y * p_x)


@inlined
def shears_transposed(V, Q, flat, hourglass):
    """Generalized forces on (D, E, H) of w, (D, E, S) of rotations: A V . gamma + Q . change."""
    a_x, a_y, b_x, b_y = sides(flat)
    h_x, h_y = hourglass
    g_a, g_b = b_y * V[0] - b_x * V[1], a_x * V[1] - a_y * V[0]
    both = Q[0] + Q[1]
    w = (0.5 * (g_a + g_b), 0.5 * (g_b - g_a), both)
    mean_x = 0.25 * (a_x * g_a + b_x * g_b + h_x * both)
    mean_y = 0.25 * (a_y * g_a + b_y * g_b + h_y * both)
    q_x, q_y = 0.25 * h_x * g_a + a_x * Q[0], 0.25 * h_y * g_a + a_y * Q[0]
    p_x, p_y = 0.25 * h_x * g_b + b_x * Q[1], 0.25 * h_y * g_b + b_y * Q[1]
    theta_x = (-0.5 * (p_y + q_y), -0.5 * (q_y - p_y), -mean_y)
    theta_y = (0.5 * (p_x + q_x), 0.5 * (q_x - p_x), mean_x)
    return w, theta_x, theta_y


@inlined
def hourglass_stiffness(flat, area, E, G, nu, t):
    """Hourglass stiffness of the plane: xx, yy, xy times E t; and of the change of transverse shear
    along a and b.

    The integrals of the slopes of xi eta over the element, with the strains of pure bending.
    """
    a_x, a_y, b_x, b_y = sides(flat)
    k = 4.0 / (3.0 * area)
    plane = E * t * k
    shear = 5.0 / 6.0 * G * t / (12.0 * area)
    stiff = (
        plane * (a_y * a_y + b_y * b_y),
        plane * (a_x * a_x + b_x * b_x),
        plane * nu * (a_x * a_y + b_x * b_y),
    )
    return stiff, (shear * (b_x * b_x + b_y * b_y), shear * (a_x * a_x + a_y * a_y))


@inlined
def larger_eigenvalue(a, b, c):
    """Largest eigenvalue of a (x - sqrt(c) y)^2 + b y^2."""
    more = a * c
    return 0.5 * (a + b + more + sqrt((a - b) * (a - b) + more * (2.0 * (a + b) + more)))


@inlined
def rotation_bound(largest, both, skew, a_b, bending, rotation, nu):
    """Bounds of squared frequency of transverse shear in the middle, and of its change with
    bending; a skew element has both.

    Rows of the shear in the middle share at most the root of `shared` with those of the rest.
    """
    k = 5.0 / 12.0 * (1.0 - nu)
    mean = k * (largest + (1.0 + skew) * rotation)
    rest = k / 3.0 * (both + (skew + 2.0 * a_b) * rotation) + bending
    shared = k * rotation * skew * (2.0 / 3.0 * (1.0 + 2.0 * a_b) * k * rotation + bending)
    apart = 0.5 * (mean - rest)
    return 0.5 * (mean + rest) + sqrt(apart * apart + shared)


@inlined
def rate_bound(flat, hourglass, z, area, thickness, radius_2, light, nu):
    """Bound of the largest squared frequency of the free element [1/s^2].

    light is E A t / m / (1 - nu^2). Exact for strains of the plane; `hourglass_rate` is that
    of the hourglass, which is coupled with strains in a skew element and with rotations in a
    warped one.
    """
    x31, y31, x42, y42 = flat
    a_x, a_y, b_x, b_y = sides(flat)
    h_x, h_y = hourglass
    k, rotation = 0.5 / area, 1.0 / radius_2
    k = 8.0 * k * k
    # sums of the squared slopes of the corners' functions
    xx, yy = k * (y31 * y31 + y42 * y42), k * (x31 * x31 + x42 * x42)
    xy = -k * (x31 * y31 + x42 * y42)
    both, apart = xx + yy, 0.25 * (xx - yy) * (xx - yy) + xy * xy
    plane = 0.5 * both + sqrt(apart + 8.0 * nu * nu * k)
    plane = max(plane, 0.5 * (1.0 - nu) * (both + 0.25 * DRILLING * (both + rotation)))
    largest = 0.5 * both + sqrt(apart)
    hourglass_rate = (1.0 - nu * nu) / 3.0 * largest
    slant = (h_x * h_x * xx + 2.0 * h_x * h_y * xy + h_y * h_y * yy) / 16.0
    skew = (h_x * h_x + h_y * h_y) * both / 16.0
    a_b = 0.5 * k * (a_x * a_x + a_y * a_y) * (b_x * b_x + b_y * b_y)
    # either with one stiffness for both, or apart, by (x - y)^2 <= (1 + s) x^2 + (1 + 1 / s) y^2
    share, warp = sqrt(slant), z * z * rotation
    strained = plane + hourglass_rate * (share + slant)
    bending = strained * thickness * thickness * rotation / 12.0
    rotated = rotation_bound(largest, both, skew, a_b, bending, rotation, nu)
    one = larger_eigenvalue(hourglass_rate, max(plane, rotated), slant + warp)
    two = max(strained, larger_eigenvalue(hourglass_rate * (1.0 + share), rotated, warp))
    return light * min(one, two)
