"""Work of joints on their bodies in steps that are long for them, which the balance may hide.

    W = h/2 f . (v_0 + v_1)/2 + h/2 t . (w_0 + w_1)/2     of each half kick and body

f and t of joints alone. Over the bodies of a mechanism W is the work of its drivers: the rest has
been created or lost. Velocities are those relative to one of its bodies, or to the ground that
holds it, so that no motion of the whole enters. A drift that closes the joints in few iterations
is not looked at, since what it errs by is small. Consequence to test: the work of all steps is
the change of kinetic energy of a mechanism on which no other force acts.
"""

from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, dot, norm, sub, vec

# iterations of a drift from which its joints are looked at: 0 to 2 are common
MANY_ITERATIONS = 3


@kernel
def add_first_half(control, nodes, rows, h):
    """Work of joints in the kick before a drift, that of drivers left out. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if is_held(b):
            u = vec(nodes[b.reference].start_v)
            spin = add(spin_at_start(b, vec(b.start_L)), spin_at_start(b, vec(b.L_half)))
            add_work(b, h, sub(vec(b.start_v), u), sub(vec(b.v_half), u), spin)
            gap = control.constraint_tolerance
            lever = control.length * norm(vec(b.joint_force)) + norm(vec(b.joint_torque))
            b.joint_unseen += gap * lever
    for k in range(rows.shape[0]):
        row = rows[k]
        subtract_driver(nodes, row.node_a, row.node_b, 0.5 * h * row.trial * row.nu)


@kernel
def add_second_half(nodes, rows, h):
    """The same in the kick after a drift, and the kinetic energy after it. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if is_held(b):
            u = vec(nodes[b.reference].v_half)
            spin = add(matvec(b.W, vec(b.L_half)), vec(b.w))
            add_work(b, h, sub(vec(b.v_half), u), sub(vec(b.v), u), spin)
            v = sub(vec(b.v), vec(nodes[b.reference].v))
            kinetic = 0.5 * dot(v, v) / b.mass_inv + 0.5 * dot(vec(b.w), vec(b.L))
            b.largest_kinetic = max(b.largest_kinetic, kinetic)
    for k in range(rows.shape[0]):
        row = rows[k]
        subtract_driver(nodes, row.node_a, row.node_b, 0.5 * h * row.reaction * row.nu)


@kernel
def is_held(b):
    """Whether joints act on a body that has a mass."""
    f, t = vec(b.joint_force), vec(b.joint_torque)
    return b.mass_inv > 0.0 and dot(f, f) + dot(t, t) > 0.0


@kernel
def spin_at_start(b, L):
    """Angular velocity [rad/s] of an angular momentum at the orientation of the step's start."""
    return matvec(b.start_A, matvec(b.J_inv, matvec_t(b.start_A, L)))


@kernel
def add_work(b, h, before, after, spin):
    """Add the work of joints in half a kick; `spin` is the sum of both. Writes: b."""
    work = dot(vec(b.joint_force), add(before, after)) + dot(vec(b.joint_torque), spin)
    work *= 0.25 * h
    b.joint_work += work
    b.joint_exchange += abs(work)


@kernel
def subtract_driver(nodes, a, b, work):
    """Leave out what a driver has done [J]. Writes: nodes."""
    held = nodes[b] if b != 0 else nodes[a]
    held.joint_work -= work
