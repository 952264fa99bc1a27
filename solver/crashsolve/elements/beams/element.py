"""Element of a beam: deformation in its co-rotational frame, forces and moments on its nodes.

f = K u + damping forces,   m = K_r theta + damping moments

through the derivatives of u and theta (beam.py, corotational.py, bowing.py), with the bound of the
step that the element sets. Consequence to test: forces are the gradient of the energy.

References: those of the beam.
"""

from math import sqrt

from crashsolve.elements.beams.bowing import bowed, stretched
from crashsolve.elements.beams.corotational import frame_lag, half_angle_over_sine, rotated_rate
from crashsolve.elements.beams.tangent import slope_of_viscosity
from crashsolve.elements.damping import apply_drag
from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import no_tangent
from crashsolve.foundation.vec3 import ZERO, add, add_scaled, cross, dot, put, scale, sub, unit, vec

TANGENTS = 6


@kernel
def element_forces(p, out, a, b, R, v, w):
    """Forces on the nodes a and b of an element whose frame is R. Writes: a, b, out."""
    deformed = deformation(p, a, b, R, v, w)
    _, u, theta, u_dot, theta_dot, _, _ = deformed
    f, energy, power = damped_force(p.stiffness, p.damping, u, u_dot)
    viscosity = p.viscosity - p.quadratic_viscosity * min(u_dot[0], 0.0)
    f, power = (f[0] + viscosity * u_dot[0], f[1], f[2]), power + viscosity * u_dot[0] * u_dot[0]
    m, bending, moment_power = damped_force(p.rotational_stiffness, p.damping, theta, theta_dot)
    out.stored = energy + bending
    out.power = power + moment_power
    out.loss = 0.0
    apply_load(p, out, a, b, (R, v, w), deformed, (f, m, viscosity))


@kernel
def deformation(p, a, b, R, v, w):
    """y, u, theta, rates of u and theta, slopes of the stretch (bowing.stretched), rate of y."""
    eta = half_angle_over_sine(v, w)
    y = matvec_t(R, sub(vec(b.r), vec(a.r)))
    spin = matvec_t(R, sub(vec(b.w), vec(a.w)))
    mean = scale(0.5, matvec_t(R, add(vec(a.w), vec(b.w))))
    theta, theta_dot = scale(2.0 * eta, v), rotated_rate(eta, v, spin)
    y_dot = matvec_t(R, sub(vec(b.v), vec(a.v)))
    y_dot = sub(y_dot, cross(sub(mean, frame_lag(v, w, spin)), y))
    e, bent = stretched(p, y, theta)
    e_dot = dot(bent[3], y_dot) + dot(bent[4], theta_dot)
    u, u_dot = (e, y[1], y[2]), (e_dot, y_dot[1], y_dot[2])
    return y, u, theta, u_dot, theta_dot, bent, y_dot


@kernel
def apply_load(p, out, a, b, frame, deformed, load):
    """Apply the force f [N] and moments m [N m] conjugate to u and theta to both nodes.

    `frame`: R, v and w of corotational.py; `deformed` is the result of deformation(); `load`: f, m
    and the viscosity of the stretch [N s/m]. Returns the ratio of its stiffness to that
    of a straight one. Writes: a, b, out.
    """
    (R, v, w), (f, m, viscosity) = frame, load
    y, u, theta, _, _, bent, _ = deformed
    eta, tension = half_angle_over_sine(v, w), f[0]
    f = add_scaled((0.0, f[1], f[2]), tension, bent[3])
    m = add_scaled(m, tension, bent[4])
    # the force acts at both nodes, each of which takes half of its moment about the other
    c = scale(0.5, cross(f, y))
    m = add(rotated_rate(eta, v, m), scale(2.0, frame_lag(v, w, c)))
    put(out.force, f)
    put(out.moment_a, sub(m, c))
    put(out.moment_b, add(m, c))
    put(out.strain, scale(1.0 / p.length, u))
    put(out.curvature, scale(1.0 / p.length, theta))
    f = matvec(R, f)
    add_to(a.force, f)
    add_to(a.torque, matvec(R, sub(m, c)))
    add_to(b.force, scale(-1.0, f))
    add_to(b.torque, matvec(R, scale(-1.0, add(m, c))))
    growth, coupling = growth_of_rates(p, eta, v, w, deformed)
    bow, taut = 2.0 * growth * bowed(y, theta, bent), growth * max(tension, 0.0)
    growth *= coupling
    add_bounds(p, a, growth * p.rate_a, bow * p.tension_rate_a, taut * p.tension_rate_a, viscosity)
    add_bounds(p, b, growth * p.rate_b, bow * p.tension_rate_b, taut * p.tension_rate_b, viscosity)
    return growth


@kernel
def growth_of_rates(p, eta, v, w, deformed):
    """Factors on the bound of a straight element: of its gradients, and of what they couple.

    Rates of theta grow by eta, those of shear by that and the length. An element that bends is also
    stretched by its rotation, which couples both modes; in short elements they have one frequency,
    and the coupling, the root of the ratio of their rates, adds as it is. Twist couples shear and
    bending by 2 |g|.
    """
    y, _, theta, _, _, bent, _ = deformed
    square = eta * eta
    growth = square * max(1.0, square * dot(y, y) / (p.length * p.length))
    twist = abs(v[0]) / (1.0 + w)
    return growth, 1.0 + twist + p.bow_coupling * sqrt(2.0 * bowed(y, theta, bent))


@kernel
def add_drag(p, out, nodes):
    """Drag on both nodes. Writes: nodes, out."""
    if p.drag_a > 0.0:
        out.power += apply_drag(nodes, p.node_a, p.drag_a) + apply_drag(nodes, p.node_b, p.drag_b)


@kernel
def damped_force(stiffness, damping, x, x_dot):
    """Force K (x + beta x_dot), stored energy [J] and power lost [W]."""
    k = vec(stiffness)
    f = (k[0] * x[0], k[1] * x[1], k[2] * x[2])
    lag = (damping * k[0] * x_dot[0], damping * k[1] * x_dot[1], damping * k[2] * x_dot[2])
    return add(f, lag), 0.5 * dot(f, x), dot(lag, x_dot)


@kernel
def add_bounds(p, body, rate, bow, taut, viscosity):
    """Report the squared frequency of an element, with those of its bow and its tension, to the
    step control.

    Writes: body.
    """
    deformed = rate + p.stiffness[0] * bow
    body.stiffness += deformed + taut
    body.damping += p.damping * deformed + viscosity * (body.mass_inv + bow)


@kernel
def damping_rows(p, a, b, R, v, w, rows, first):
    """Rows of the damping of an element whose frame is R. Writes: rows."""
    for k in range(TANGENTS):
        no_tangent(rows[first + k])
    if not (p.damping > 0.0 or p.viscosity > 0.0 or p.quadratic_viscosity > 0.0):
        return
    eta = half_angle_over_sine(v, w)
    y, _, _, u_dot, _, bent, _ = deformation(p, a, b, R, v, w)
    for k in range(3):
        e = bent[3] if k == 0 else unit(k)
        c = scale(0.5, cross(e, y))
        m = scale(2.0, frame_lag(v, w, c))
        if k == 0:
            m = add(m, rotated_rate(eta, v, bent[4]))
        write_damping_row(rows[first + k], R, e, sub(m, c), add(m, c), p.damping * p.stiffness[k])
        m = rotated_rate(eta, v, unit(k))
        write_damping_row(rows[first + 3 + k], R, ZERO, m, m, p.damping * p.rotational_stiffness[k])
    rows[first].damping += slope_of_viscosity(p, u_dot[0])


@kernel
def write_damping_row(row, R, f, m_a, m_b, damping):
    """Tangent of a unit force f with moments m_a and m_b at the ends, axes of R. Writes: row."""
    f, m_a, m_b = matvec(R, f), matvec(R, m_a), matvec(R, m_b)
    for k in range(3):
        row.D[k], row.D[6 + k] = f[k], -f[k]
        row.D[3 + k], row.D[9 + k] = m_a[k], -m_b[k]
    for k in range(12):
        row.G[k] = 0.0
    row.damping = damping
