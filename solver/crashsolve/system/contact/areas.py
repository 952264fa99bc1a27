"""Contact over an area: friction that resists a spin; loops/contact_pressure.py has the pressure.

Friction sees the slip and r w_n at once, w_n the spin of a over b about the normal and r the radius
with which friction resists it, as one vector with the spin along the normal:

    v + r w_n n  ->  t + t_n n      force t along the surface, torque r t_n n

so that any law of friction keeps its limit, its regularisation and its energy: |t + t_n n| <= mu N,
the ellipsoidal limit surface. Consequence to test: pure spin of an evenly pressed disc is resisted
by 2/3 mu N R.

References: Howe and Cutkosky (1996), Int. J. Robotics Research 15, 557-572.
"""

from crashsolve.contact.narrow._ascent import tangents
from crashsolve.foundation.columns import add_to, matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_torque, point_tangent
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.system.contact.work import add_end_work, displacement_from

# normal passed to laws that project their history onto the plane: its normal part is that of a spin
NO_ROTATION = (0.0, 0.0, 0.0)


@kernel
def combined_slip(a, b, slip, n, radius):
    """Slip of a over b and, along the normal, that of the spin at the radius [m/s]."""
    return add_scaled(slip, radius * dot(sub(vec(a.w), vec(b.w)), n), n)


@kernel
def along_surface(friction_force, n):
    """The part of friction or slip without that of the spin."""
    return add_scaled(friction_force, -dot(friction_force, n), n)


@kernel
def sliding_displacement(motion, displacement, n, radius):
    """Displacement of a over b in a step [m], with that of the spin along the normal as in
    combined_slip; `displacement`: of the point of contact.
    """
    return add_scaled(along_surface(displacement, n), radius * dot(motion[2], n), n)


@kernel
def add_first_half_work(h, old, motion, a, card):
    """Work of the forces at the start of the step; returns that of friction [J].

    Writes: card.
    """
    size = norm(vec(old.normal_force))
    if old.active == 0 or h == 0.0 or size == 0.0:
        return 0.0
    n = scale(1.0 / size, vec(old.normal_force))
    displacement = displacement_from(motion, a, vec(old.position))
    friction_loss = 0.5 * dot(
        vec(old.friction_force), sliding_displacement(motion, displacement, n, old.radius)
    )
    card.work += 0.5 * size * dot(n, displacement)
    card.friction_work += friction_loss
    return friction_loss


@kernel
def add_second_half_work(
    applied, pair, sliding, x, friction_force, sliding_displacement, radius, card
):
    """Work of the forces at the end of the step, which are stored for the next.

    Writes: new, card.
    """
    out, new = pair.out, pair.new
    add_end_work(applied, sliding.displacement, sliding.f, sliding.n, x, out, new, card)
    card.friction_work += 0.5 * applied * dot(friction_force, sliding_displacement)
    card.bristle_energy += out.friction_stored
    put(new.friction_force, friction_force)
    new.bristle_energy, new.radius = out.friction_stored, radius


@kernel
def twist(a, b, friction_force, n, radius, applied):
    """Apply the torque of friction about the normal to a, and its opposite to b. Writes: a, b."""
    moment = scale(radius * dot(friction_force, n), n)
    apply_torque(a, moment)
    apply_torque(b, scale(-1.0, moment))
    if applied < 1.0:
        add_to(a.deferred_torque, scale(1.0 - applied, moment))
        add_to(b.deferred_torque, scale(applied - 1.0, moment))


@kernel
def friction_mobility(a, b, d_a, d_b, u, n, radius):
    """Mobilities of both sides for friction along u, slip and spin of length 1 [1/kg]."""
    force, moment = along_surface(u, n), scale(radius * dot(u, n), n)
    return response(a, d_a, force, moment), response(b, d_b, force, moment)


@kernel
def response(body, d, force, moment):
    """Mobility of a body for a unit force at d together with a torque [1/kg]."""
    rotation = add(cross(d, force), moment)
    return dot(force, force) * body.mass_inv + dot(rotation, matvec(body.W, rotation))


@kernel
def add_pressure(f, n, out):
    """Add the sum f of the normal forces of an area on side a to its friction. Writes: out."""
    for k in range(3):
        out.force[k] += f * n[k]


@kernel
def tilt_tangents(first, second, spots, count, n, x, stiffness, damping):
    """Tangents of the torque against tilting about both tangents. Writes: first, second.

    The centre of pressure crosses the area while the sides tilt by their rounding over its size:
    `stiffness` is 3 f over the sum of both roundings.
    """
    s, t = tangents(n)
    about_s, about_t = 0.0, 0.0
    for k in range(count):
        d = sub(vec(spots[k].point), x)
        about_s += spots[k].share * dot(d, t) ** 2
        about_t += spots[k].share * dot(d, s) ** 2
    tilt_tangent(first, s, stiffness * about_s, damping * about_s)
    tilt_tangent(second, t, stiffness * about_t, damping * about_t)


@kernel
def tilt_tangent(row, g, stiffness, damping):
    """Tangent of a torque about g on a and against it on b. Writes: row."""
    for k in range(3):
        row.D[k] = row.D[6 + k] = 0.0
        row.D[3 + k], row.D[9 + k] = g[k], -g[k]
    for k in range(12):
        row.G[k] = 0.0
    row.stiffness, row.damping = stiffness, damping


@kernel
def friction_tangent_row(row, u, n, radius, d_a, d_b, damping):
    """Tangent of friction along u, slip and spin of length 1. Writes: row."""
    point_tangent(row, along_surface(u, n), d_a, d_b, 0.0, damping)
    spin = radius * dot(u, n)
    for k in range(3):
        row.D[3 + k] += spin * n[k]
        row.D[9 + k] -= spin * n[k]
