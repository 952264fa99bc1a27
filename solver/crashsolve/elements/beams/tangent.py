"""Tangent of a beam element within implicit steps: blocks of its nodes, with its velocities.

    dF = R (df - f x omega),   dM_a = R (dm' - dc - (m' - c) x omega),   dM_b = -R (dm' + ...)
    df = e_y dN + N de_y + dV,   dm = K_r (dtheta + beta dtheta_dot) + e_theta dN + N de_theta
    (dN, dV) = K (du + beta du_dot),   dm' = T dm + (dT) m + 2 (dg x c + g x dc)

in axes of R, with omega, dy, dtheta and c as `static_tangent.py` has them, and e_y and e_theta the
derivatives of the stretch (`bowing.py`). u_dot and theta_dot change with the position as well: each
world vector in them by x x omega, T and g by themselves.
Derivatives by the velocities are rows (element.py). A section that yields (fibres.py) adds its
inelastic N, M_y and M_z, and their derivatives by stretch and bending and by the rates of these.
Consequence to test: central differences of the forces of an element that moves, with damping and
viscosity, elastic and yielding.

Reference: Crisfield (1990), Computer Methods in Applied Mechanics and Engineering 81, 131-150.
"""

from math import cos, sin, sqrt, tan

from crashsolve.elements.beams.bowing import change_of_slopes
from crashsolve.elements.beams.corotational import half_angle_over_sine, rotated_rate
from crashsolve.foundation.columns import matvec, matvec_t, symmetric_matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.sparse.bordered import subtract_coupling, subtract_own
from crashsolve.foundation.vec3 import ZERO, add, add_scaled, cross, dot, scale, sub, vec

# [rad] smaller rotations count as zero in T and g
SMALL = 1e-8


@kernel
def add_tangent_blocks(p, section, a, b, frame, deformed, slot, blocks):
    """Subtract the derivatives of the forces by every motion of both ends. Writes: blocks.

    `section`: the inelastic parts of fibres.moduli, or None; `frame`: R, v and w of
        corotational.py; `deformed`: the result of element.deformation.
    """
    R, v, w = frame
    eta, g = half_angle_over_sine(v, w), scale(0.5 / (1.0 + w), v)
    spins = matvec_t(R, sub(vec(b.w), vec(a.w))), scale(0.5, matvec_t(R, add(vec(a.w), vec(b.w))))
    state = (
        v,
        eta,
        g,
        matvec_t(R, sub(vec(b.v), vec(a.v))),
        spins[0],
        spins[1],
        rotation_factors(deformed[2]),
    )
    stress = stresses(p, section, deformed, eta, v, g)
    for k in range(3):
        e = (R[3 * k], R[3 * k + 1], R[3 * k + 2])
        displacement = changes(p, section, deformed, state, stress, e, ZERO, ZERO)
        rotation = changes(p, section, deformed, state, stress, ZERO, e, ZERO)
        mean = changes(p, section, deformed, state, stress, ZERO, ZERO, scale(0.5, e))
        put_column(blocks, slot, R, k, scaled(-1.0, displacement), displacement)
        put_column(
            blocks, slot, R, 3 + k, summed(mean, scaled(-1.0, rotation)), summed(mean, rotation)
        )


@kernel
def stresses(p, section, deformed, eta, v, g):
    """Tension N, force f and moments m with damping, c, and the moment m' of both ends."""
    y, u, theta, u_dot, theta_dot, bent, _, _ = deformed
    k, k_r, beta = p.stiffness, p.rotational_stiffness, p.damping
    slow = p.viscosity - p.quadratic_viscosity * min(u_dot[0], 0.0)
    f = (
        k[0] * (u[0] + beta * u_dot[0]) + slow * u_dot[0],
        k[1] * (u[1] + beta * u_dot[1]),
        k[2] * (u[2] + beta * u_dot[2]),
    )
    m = times(k_r, add(theta, scale(beta, theta_dot)))
    if section is not None:
        f, m = with_fibres(f, m, section[0])
    tension = f[0]
    f = add_scaled((0.0, f[1], f[2]), tension, bent[3])
    m = add_scaled(m, tension, bent[4])
    c = scale(0.5, cross(f, y))
    return tension, f, m, c, add(rotated_rate(eta, v, m), scale(2.0, cross(g, c)))


@kernel
def changes(p, section, deformed, state, stress, dr, s, w_0):
    """Changes of the force on a, and of the moments on a and b, axes of R.

    `dr`, `s` and `w_0` are the changes of the vector from a to b, of the rotation of b over a, and
    of the mean rotation.
    """
    v, eta, g, _, _, _, factors = state
    y, theta, bent = deformed[0], deformed[2], deformed[5]
    tension, f, m, c, moment = stress
    omega = sub(w_0, cross(g, s))
    dy = sub(dr, cross(omega, y))
    d_theta = rotated_rate(eta, v, s)
    dg = change_of_g(factors, d_theta)
    slopes = change_of_slopes(p, theta, bent, dy, d_theta)
    du = (dot(bent[3], dy) + dot(bent[4], d_theta), dy[1], dy[2])
    df, dm = times(p.stiffness, du), times(p.rotational_stiffness, d_theta)
    if section is not None or p.damping > 0.0 or p.viscosity > 0.0 or p.quadratic_viscosity > 0.0:
        du_dot, d_theta_dot = rate_changes(deformed, state, omega, dy, d_theta, dg, slopes)
        df_lag, dm_lag = damping_changes(p, deformed, du_dot, d_theta_dot)
        if section is not None:
            flow = add(
                symmetric_matvec(section[1], (du[0], d_theta[1], d_theta[2])),
                symmetric_matvec(section[2], (du_dot[0], d_theta_dot[1], d_theta_dot[2])),
            )
            df_lag, dm_lag = with_fibres(df_lag, dm_lag, flow)
        df, dm = add(df, df_lag), add(dm, dm_lag)
    dm = add(dm, add_scaled(scale(df[0], bent[4]), tension, slopes[1]))
    df = add((0.0, df[1], df[2]), add_scaled(scale(df[0], bent[3]), tension, slopes[0]))
    dm = add(rotated_rate(eta, v, dm), change_of_T(factors, m, d_theta))
    dc = scale(0.5, add(cross(f, dy), cross(df, y)))
    dm = add(dm, scale(2.0, add(cross(dg, c), cross(g, dc))))
    on_a = sub(sub(dm, dc), cross(sub(moment, c), omega))
    on_b = sub(cross(add(moment, c), omega), add(dm, dc))
    return sub(df, cross(f, omega)), on_a, on_b


@kernel
def rate_changes(deformed, state, omega, dy, d_theta, dg, slopes):
    """Changes of u_dot and theta_dot by the position."""
    y, _, _, _, theta_dot, bent, y_dot, _ = deformed
    v, eta, g, speed, spin, mean, factors = state
    d_spin, d_mean = cross(spin, omega), cross(mean, omega)
    d_swing = add(cross(dg, spin), cross(g, d_spin))
    dy_dot = sub(cross(speed, omega), cross(sub(d_mean, d_swing), y))
    dy_dot = sub(dy_dot, cross(sub(mean, cross(g, spin)), dy))
    d_theta_dot = add(rotated_rate(eta, v, d_spin), change_of_T(factors, spin, d_theta))
    by_slopes = dot(slopes[0], y_dot) + dot(slopes[1], theta_dot)
    de_dot = by_slopes + dot(bent[3], dy_dot) + dot(bent[4], d_theta_dot)
    return (de_dot, dy_dot[1], dy_dot[2]), d_theta_dot


@kernel
def damping_changes(p, deformed, du_dot, d_theta_dot):
    """Changes of the force and of the moments of damping."""
    u_dot = deformed[3]
    df = scale(p.damping, times(p.stiffness, du_dot))
    df = (df[0] + slope_of_viscosity(p, u_dot[0]) * du_dot[0], df[1], df[2])
    return df, scale(p.damping, times(p.rotational_stiffness, d_theta_dot))


@kernel
def slope_of_viscosity(p, u_dot):
    """Rise of the viscous tension over the rate of stretch."""
    return p.viscosity - 2.0 * p.quadratic_viscosity * min(u_dot, 0.0)


@kernel
def with_fibres(f, m, flow):
    """A force and moments, plus tension and moments about y and z of the fibres."""
    return (f[0] + flow[0], f[1], f[2]), (m[0], m[1] + flow[1], m[2] + flow[2])


@kernel
def times(k, x):
    """K x of a diagonal K."""
    return (k[0] * x[0], k[1] * x[1], k[2] * x[2])


@kernel
def rotation_factors(theta):
    """Axis n of a rotation, and the derivatives of T and g along it and across it."""
    angle = sqrt(dot(theta, theta))
    if angle < SMALL:
        return ZERO, 0.0, 0.0, 0.125, 0.125
    half, quarter = 0.5 * angle, tan(0.25 * angle)
    sine = sin(half)
    angular = 0.5 * (sine - half * cos(half)) / (sine * sine), (1.0 - half / sine) / angle
    swing = 0.125 * (1.0 + quarter * quarter), 0.5 * quarter / angle
    return scale(1.0 / angle, theta), angular[0], angular[1], swing[0], swing[1]


@kernel
def change_of_T(factors, m, d_theta):
    """(dT) m at constant m."""
    n, slope, per, _, _ = factors
    m_along, along = dot(n, m), dot(n, d_theta)
    m_across, across = sub(m, scale(m_along, n)), sub(d_theta, scale(along, n))
    bent = add(scale(m_along, across), scale(dot(m_across, d_theta), n))
    return add(scale(slope * along, m_across), scale(per, bent))


@kernel
def change_of_g(factors, d_theta):
    """dg."""
    n, _, _, lengthwise, per = factors
    along = dot(n, d_theta)
    return add(scale(per, d_theta), scale((lengthwise - per) * along, n))


@kernel
def scaled(s, x):
    """Three vectors times a number."""
    return scale(s, x[0]), scale(s, x[1]), scale(s, x[2])


@kernel
def summed(x, y):
    """Sums of three vectors."""
    return add(x[0], y[0]), add(x[1], y[1]), add(x[2], y[2])


@kernel
def put_column(blocks, slot, R, k, by_a, by_b):
    """Write the change of the forces by motion k of the ends a and b. Writes: blocks."""
    put_half(blocks, slot, R, k, 0, by_a)
    put_half(blocks, slot, R, k, 1, by_b)


@kernel
def put_half(blocks, slot, R, k, side, rows):
    """Column k of one end, in the blocks of both. Writes: blocks."""
    f, on_a, on_b = matvec(R, rows[0]), matvec(R, rows[1]), matvec(R, rows[2])
    back = scale(-1.0, f)
    if side == 1:
        subtract_own(blocks[slot.b], k, back, on_b)
        subtract_coupling(blocks[slot.across], k, slot.flips == 0, f, on_a)
    else:
        subtract_own(blocks[slot.a], k, f, on_a)
        subtract_coupling(blocks[slot.across], k, slot.flips == 1, back, on_b)
