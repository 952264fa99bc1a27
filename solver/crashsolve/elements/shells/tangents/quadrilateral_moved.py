"""How strains and forces of a four-node shell change when its corners move: derivatives, by hand.

    d S = B du + (dB) u,   d f = B^T d sigma + (dB)^T sigma

B from the geometry of the middle of the step for strains, of its end for forces
(`elements/quadrilateral.py`). The axes turn by omega when the diagonals change: out of the plane as
a rigid body does, in it by the spin of the polar rotation,

    omega_3 = (dF_21 - dF_12) / (F_11 + F_22),   F = (D E) G

and a vector fixed in space changes by -omega x u along them. Consequence to test: the derivative of
the forces that the step computes.

Reference: Crisfield (1997), Non-linear Finite Element Analysis of Solids and Structures, vol. 2,
18: the condition of a consistent co-rotational tangent.
"""

from crashsolve.elements.shells.forces.quadrilateral import (
    cross3,
    shears,
    shears_transposed,
    sides,
    slopes,
    slopes_transposed,
)
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.vec3 import ZERO

NONE = (0.0, 0.0, 0.0, 0.0)


@inlined
def spin_slopes(flat, G):
    """Spin of the axes in the plane by changes of x31, y31, x42 and y42."""
    k = 1.0 / (flat[0] * G[0] + flat[2] * G[2] + flat[1] * G[1] + flat[3] * G[3])
    return -k * G[1], k * G[0], -k * G[3], k * G[2]


@inlined
def rotation_of_axes(geometry, spin, d, c):
    """omega of the axes, in them, when D changes by d and E by c."""
    x31, y31, x42, y42 = geometry[0]
    k = 0.5 / geometry[3]
    about = spin[0] * d[0] + spin[1] * d[1] + spin[2] * c[0] + spin[3] * c[1]
    return k * (x31 * c[2] - x42 * d[2]), k * (y31 * c[2] - y42 * d[2]), about


@inlined
def change_of(geometry, rotation, d, c, g):
    """Change of (flat, hourglass, z, area) as D, E and H change by d, c and g."""
    (x31, y31, x42, y42), (h_x, h_y), z, _ = geometry
    flat = (
        d[0] + rotation[2] * y31,
        d[1] - rotation[2] * x31,
        c[0] + rotation[2] * y42,
        c[1] - rotation[2] * x42,
    )
    over = cross3(rotation, (h_x, h_y, 4.0 * z))
    area = flat[0] * y42 + x31 * flat[3] - flat[1] * x42 - y31 * flat[2]
    return flat, (g[0] - over[0], g[1] - over[1]), 0.25 * (g[2] - over[2]), 0.5 * area


@inlined
def strains(u, rotation, geometry):
    """Strains of the plane, curvatures, modes, shear, its change and drilling of a motion.

    u and turn are (x, y, z) of its displacements and rotations, each (D, E, H, S).
    """
    (u_x, u_y, w), (t_x, t_y, t_z) = u, rotation
    flat, hourglass, z, area = geometry
    xx, xy, q_x = slopes(u_x[0], u_x[1], u_x[2] - z * t_y[3], flat, hourglass, area)
    yx, yy, q_y = slopes(u_y[0], u_y[1], u_y[2] + z * t_x[3], flat, hourglass, area)
    m_x, m_y, p_x = slopes(t_y[0], t_y[1], t_y[2], flat, hourglass, area)
    n_x, n_y, p_y = slopes(-t_x[0], -t_x[1], -t_x[2], flat, hourglass, area)
    gamma, change = shears(
        (w[0], w[1], w[2]),
        (t_x[0], t_x[1], t_x[3]),
        (t_y[0], t_y[1], t_y[3]),
        flat,
        hourglass,
        area,
    )
    drill = 0.5 * (yx - xy) - 0.25 * t_z[3]
    return (xx, yy, xy + yx), (m_x, n_y, m_y + n_x), (q_x, q_y, p_x, p_y), gamma, change, drill


@inlined
def slopes_moved(D, E, H, geometry, moved):
    """Change of slopes() with the geometry."""
    flat, hourglass, _, area = geometry
    (x31, y31, x42, y42), (h_x, h_y), _, grown = moved
    by_x, by_y, _ = slopes(D, E, H, flat, hourglass, area)
    k, share = 0.5 / area, grown / area
    d_x = k * (y42 * D - y31 * E) - share * by_x
    d_y = k * (x31 * E - x42 * D) - share * by_y
    q = h_x * by_x + hourglass[0] * d_x + h_y * by_y + hourglass[1] * d_y
    return d_x, d_y, -0.25 * q


@inlined
def shears_moved(w, theta_x, theta_y, geometry, moved):
    """Change of shears() with the geometry."""
    flat, (h_x, h_y), _, area = geometry
    (a_x, a_y, b_x, b_y), (da_x, da_y, db_x, db_y) = sides(flat), sides(moved[0])
    k_x, k_y = moved[1]
    mean_x, mean_y = 0.25 * theta_x[2], 0.25 * theta_y[2]
    p_x, p_y = 0.5 * (theta_x[0] - theta_x[1]), 0.5 * (theta_y[0] - theta_y[1])
    q_x, q_y = 0.5 * (theta_x[0] + theta_x[1]), 0.5 * (theta_y[0] + theta_y[1])
    g_a = 0.5 * (w[0] - w[1]) + a_x * mean_y - a_y * mean_x + 0.25 * (h_x * q_y - h_y * q_x)
    g_b = 0.5 * (w[0] + w[1]) + b_x * mean_y - b_y * mean_x + 0.25 * (h_x * p_y - h_y * p_x)
    d_a = da_x * mean_y - da_y * mean_x + 0.25 * (k_x * q_y - k_y * q_x)
    d_b = db_x * mean_y - db_y * mean_x + 0.25 * (k_x * p_y - k_y * p_x)
    twist, k, share = k_x * mean_y - k_y * mean_x, 1.0 / area, moved[3] / (area * area)
    x = k * (db_y * g_a + b_y * d_a - da_y * g_b - a_y * d_b) - share * (b_y * g_a - a_y * g_b)
    y = k * (da_x * g_b + a_x * d_b - db_x * g_a - b_x * d_a) - share * (a_x * g_b - b_x * g_a)
    return (x, y), (twist + da_x * q_y - da_y * q_x, twist + db_x * p_y - db_y * p_x)


@inlined
def strains_moved(u, rotation, geometry, moved):
    """Change of strains() with the geometry."""
    (u_x, u_y, w), (t_x, t_y, _) = u, rotation
    z, rise = geometry[2], 0.25 * moved[2]
    xx, xy, q_x = slopes_moved(u_x[0], u_x[1], u_x[2] - z * t_y[3], geometry, moved)
    yx, yy, q_y = slopes_moved(u_y[0], u_y[1], u_y[2] + z * t_x[3], geometry, moved)
    q_x, q_y = q_x - rise * t_y[3], q_y + rise * t_x[3]
    m_x, m_y, p_x = slopes_moved(t_y[0], t_y[1], t_y[2], geometry, moved)
    n_x, n_y, p_y = slopes_moved(-t_x[0], -t_x[1], -t_x[2], geometry, moved)
    gamma, change = shears_moved(
        (w[0], w[1], w[2]), (t_x[0], t_x[1], t_x[3]), (t_y[0], t_y[1], t_y[3]), geometry, moved
    )
    drill = 0.5 * (yx - xy)
    return (xx, yy, xy + yx), (m_x, n_y, m_y + n_x), (q_x, q_y, p_x, p_y), gamma, change, drill


@inlined
def generalized_forces(stress, geometry):
    """Generalized forces on D, E, H of positions and D, E, H, S of rotations, axes of the element.

    `stress` has N, M, the forces on the modes and on the change of shear, V, half of the drilling.
    """
    N, M, q, s, V, drill = stress
    flat, hourglass, z, area = geometry
    xy = area * N[2]
    d_x, e_x, h_x = slopes_transposed(area * N[0], xy - drill, q[0], flat, hourglass, area)
    d_y, e_y, h_y = slopes_transposed(xy + drill, area * N[1], q[1], flat, hourglass, area)
    m_d, m_e, m_h = slopes_transposed(area * M[0], area * M[2], q[2], flat, hourglass, area)
    n_d, n_e, n_h = slopes_transposed(area * M[2], area * M[1], q[3], flat, hourglass, area)
    w, t_x, t_y = shears_transposed(V, s, flat, hourglass)
    return ((d_x, d_y, w[0]), (e_x, e_y, w[1]), (h_x, h_y, w[2])), (
        (t_x[0] - n_d, t_y[0] + m_d, 0.0),
        (t_x[1] - n_e, t_y[1] + m_e, 0.0),
        (-n_h, m_h, 0.0),
        (t_x[2] + z * h_y, t_y[2] - z * h_x, -0.5 * drill),
    )


@inlined
def transposed_moved(along, more, q, geometry, moved):
    """Change of slopes_transposed() with the geometry, `along` by `more`."""
    (x31, y31, x42, y42), (h_x, h_y), _, area = geometry
    flat, hourglass, _, grown = moved
    q, k, share = 0.25 * q, 0.5 / area, grown / area
    p_x, p_y = k * (along[0] - q * h_x), k * (along[1] - q * h_y)
    d_x = k * (more[0] - q * hourglass[0]) - share * p_x
    d_y = k * (more[1] - q * hourglass[1]) - share * p_y
    return (
        flat[3] * p_x - flat[2] * p_y + y42 * d_x - x42 * d_y,
        flat[0] * p_y - flat[1] * p_x + x31 * d_y - y31 * d_x,
    )


@inlined
def shears_transposed_moved(V, Q, geometry, moved):
    """Change of shears_transposed() with the geometry."""
    flat, (h_x, h_y), _, _ = geometry
    (a_x, a_y, b_x, b_y), (da_x, da_y, db_x, db_y) = sides(flat), sides(moved[0])
    k_x, k_y = moved[1]
    g_a, g_b, both = b_y * V[0] - b_x * V[1], a_x * V[1] - a_y * V[0], Q[0] + Q[1]
    d_a, d_b = db_y * V[0] - db_x * V[1], da_x * V[1] - da_y * V[0]
    w = (0.5 * (d_a + d_b), 0.5 * (d_b - d_a))
    mean_x = 0.25 * (da_x * g_a + a_x * d_a + db_x * g_b + b_x * d_b + k_x * both)
    mean_y = 0.25 * (da_y * g_a + a_y * d_a + db_y * g_b + b_y * d_b + k_y * both)
    q_x, q_y = 0.25 * (k_x * g_a + h_x * d_a) + da_x * Q[0], 0.25 * (k_y * g_a + h_y * d_a)
    p_x, p_y = 0.25 * (k_x * g_b + h_x * d_b) + db_x * Q[1], 0.25 * (k_y * g_b + h_y * d_b)
    q_y, p_y = q_y + da_y * Q[0], p_y + db_y * Q[1]
    theta_x = (-0.5 * (p_y + q_y), -0.5 * (q_y - p_y), -mean_y)
    theta_y = (0.5 * (p_x + q_x), 0.5 * (q_x - p_x), mean_x)
    return w, theta_x, theta_y


@inlined
def pushes_moved(stress, forces, geometry, moved):
    """Change of pushes() with the geometry; `forces` are those on D, E, H of the positions."""
    N, M, q, s, V, drill = stress
    area, rise, grown = geometry[3], moved[2], moved[3]
    xy, more = area * N[2], grown * N[2]
    d_x, e_x = transposed_moved(
        (area * N[0], xy - drill), (grown * N[0], more), q[0], geometry, moved
    )
    d_y, e_y = transposed_moved(
        (xy + drill, area * N[1]), (more, grown * N[1]), q[1], geometry, moved
    )
    xy, more = area * M[2], grown * M[2]
    m_d, m_e = transposed_moved((area * M[0], xy), (grown * M[0], more), q[2], geometry, moved)
    n_d, n_e = transposed_moved((xy, area * M[1]), (more, grown * M[1]), q[3], geometry, moved)
    w, t_x, t_y = shears_transposed_moved(V, s, geometry, moved)
    H = forces[2]
    return ((d_x, d_y, w[0]), (e_x, e_y, w[1]), ZERO), (
        (t_x[0] - n_d, t_y[0] + m_d, 0.0),
        (t_x[1] - n_e, t_y[1] + m_e, 0.0),
        ZERO,
        (t_x[2] + rise * H[1], t_y[2] - rise * H[0], 0.0),
    )
