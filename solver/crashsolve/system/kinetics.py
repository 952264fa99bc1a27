"""Motion of free bodies: kick (forces change momentum) and drift (momentum moves the body).

    kick    m v += h/2 f,   L += h/2 tau           (world components)
    drift   r += h v,   J Omega + h/2 Omega x J Omega = A^T L,   q <- q * Cayley(h Omega)

A drift keeps momentum to the bit and the kinetic energy to round-off. Consequence to test: a free
body spinning about its middle axis flips for ever at constant energy.

References: Simo and Wong (1991), Int. J. Num. Meth. Eng. 31, 19-52; Krysl and Endres (2005).
"""

from math import sqrt

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.rotation import (
    midpoint_spin,
    rotate_by_cayley,
    write_matrix,
    write_world_tensor,
)
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec


@kernel
def save(nodes):
    """Keep positions and momenta at the start of a step. Writes: nodes.start_*."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        put(b.start_r, vec(b.r))
        put(b.start_v, vec(b.v))
        put(b.start_L, vec(b.L))
        for k in range(4):
            b.start_q[k] = b.q[k]
        for k in range(9):
            b.start_A[k] = b.A[k]


@kernel
def first_kick(nodes, h):
    """First half kick by the applied forces alone. Writes: nodes.v_half, L_half."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        v, L = kicked(b, h, vec(b.start_v), vec(b.start_L))
        put(b.v_half, v)
        put(b.L_half, L)


@inlined
def kicked(b, h, v, L):
    """Velocity [m/s] and angular momentum [kg m^2/s] of a body after half a kick of h [s]."""
    return (
        add_scaled(v, 0.5 * h * b.mass_inv, vec(b.force)),
        add_scaled(L, 0.5 * h, vec(b.torque)),
    )


@kernel
def drift(nodes, h):
    """Move every body by its momentum at half step. Writes: nodes.r, q, A."""
    for i in range(1, nodes.shape[0]):
        drift_body(nodes[i], h)


@inlined
def drift_body(b, h):
    """Move one body by its momentum at half step. Writes: b.r, q, A."""
    put(b.r, add_scaled(vec(b.start_r), h, vec(b.v_half)))
    if b.L_half[0] == 0.0 and b.L_half[1] == 0.0 and b.L_half[2] == 0.0:
        # a body without rotation keeps its orientation to the bit
        for k in range(4):
            b.q[k] = b.start_q[k]
        for k in range(9):
            b.A[k] = b.start_A[k]
        return
    omega = midpoint_spin(b.J, b.J_inv, matvec_t(b.start_A, vec(b.L_half)), h)
    rotate_by_cayley(b.start_q, scale(0.5 * h, omega), b.q)
    write_matrix(b.q, b.A)


@kernel
def predict(nodes, h):
    """Momenta at the end of the step with the forces of its start. Writes: nodes.v, L."""
    for i in range(1, nodes.shape[0]):
        predict_body(nodes[i], h)


@inlined
def predict_body(b, h):
    """Momenta of one body. Writes: b.v, L."""
    f = add(vec(b.force), vec(b.joint_force))
    put(b.v, add_scaled(vec(b.v_half), 0.5 * h * b.mass_inv, f))
    put(b.L, add_scaled(vec(b.L_half), 0.5 * h, add(vec(b.torque), vec(b.joint_torque))))


@kernel
def refresh(nodes):
    """Inverse inertia and angular velocity at the present configuration. Writes: nodes.W, w."""
    for i in range(1, nodes.shape[0]):
        refresh_body(nodes[i])


@inlined
def refresh_body(b):
    """Inverse inertia and angular velocity of one body. Writes: b.W, w."""
    write_world_tensor(b.A, b.J_inv, b.W)
    put(b.w, matvec(b.W, vec(b.L)))


@kernel
def begin_force_pass(nodes, h):
    """Predicted momenta, except in a sample (h = 0), velocities, and no forces, in one loop.

    Writes: nodes.v, L, W, w and the sums of a force pass.
    """
    clear_forces_of(nodes[0])
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if b.is_attached == 0:
            if h > 0.0:
                predict_body(b, h)
            refresh_body(b)
        clear_forces_of(b)
    for k in range(6):
        nodes[0].external[k] = 0.0


@kernel
def second_kick(nodes, h):
    """Second half kick by the applied forces, from half step. Writes: nodes.v, L, w."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        # attached nodes have the velocities of the force pass
        if b.is_attached == 0:
            v, L = kicked(b, h, vec(b.v_half), vec(b.L_half))
            put(b.v, v)
            put(b.L, L)
            put(b.w, matvec(b.W, L))


@kernel
def apply_deferred(nodes, sign):
    """Leave out (-1) or put back (+1) the forces that began during the step. Writes: nodes."""
    for i in range(nodes.shape[0]):
        b = nodes[i]
        add_to(b.force, scale(sign, vec(b.deferred_force)))
        add_to(b.torque, scale(sign, vec(b.deferred_torque)))


@kernel
def has_deferred(nodes):
    """Whether a force began during the step."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if norm(vec(b.deferred_force)) > 0.0:
            return True
    return False


@kernel
def clear_forces(nodes):
    """Zero the sums of a force pass. Writes: nodes."""
    for i in range(nodes.shape[0]):
        clear_forces_of(nodes[i])
    for k in range(6):
        nodes[0].external[k] = 0.0


@inlined
def clear_forces_of(b):
    """Zero the sums of one body. Writes: b."""
    zero = (0.0, 0.0, 0.0)
    put(b.force, zero)
    put(b.torque, zero)
    put(b.deferred_force, zero)
    put(b.deferred_torque, zero)
    b.stiffness = 0.0
    b.damping = 0.0


@kernel
def fastest_rotation(nodes):
    """Largest angular speed of any body [rad/s]."""
    fastest = 0.0
    for i in range(1, nodes.shape[0]):
        w = vec(nodes[i].w)
        fastest = max(fastest, dot(w, w))
    return sqrt(fastest)


@kernel
def bad_node(nodes):
    """First node whose position or momentum is not a finite number, or -1.

    Beyond 1e100 the energy, a square, will soon not be one.
    """
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        total = 0.0
        for k in range(3):
            total += abs(b.r[k]) + abs(b.v[k]) + abs(b.L[k]) + abs(b.w[k])
        if not total < 1e100:
            return i
    return -1


@kernel
def add_impulse(clock, nodes, half_step):
    """Impulse from outside: loads, and the reaction of the ground. Writes: clock."""
    ground = nodes[0]
    for k in range(3):
        force = ground.external[k] - ground.force[k] - ground.joint_force[k]
        torque = ground.external[3 + k] - ground.torque[k] - ground.joint_torque[k]
        clock.impulse[k] += half_step * force
        clock.angular_impulse[k] += half_step * torque


@kernel
def kinetic_energy(nodes):
    """Sum of 1/2 m v^2 + 1/2 w . L [J]."""
    total = 0.0
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        v = vec(b.v)
        total += 0.5 * dot(v, v) / b.mass_inv + 0.5 * dot(vec(b.w), vec(b.L))
    return total


@kernel
def accelerations(nodes):
    """v_dot and w_dot of every body from all forces. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        put(b.v_dot, scale(b.mass_inv, add(vec(b.force), vec(b.joint_force))))
        gyro = cross(vec(b.w), vec(b.L))
        torque = add(vec(b.torque), vec(b.joint_torque))
        put(b.w_dot, matvec(b.W, sub(torque, gyro)))
