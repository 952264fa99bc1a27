"""Energy balance of a single law between bodies, independent of the frame of reference.

    W = 1/2 sum (f_old + f_new) . u   over its bodies, u the displacement in the step
    gain = min(W - held at the start, W + held + lost - held at the start)

Kick, drift, kick: half of the forces at both ends of a step act along its displacement, see
contact/work.py. A law that is passed in too long a step, a stop or a tyre that is hit, gives more
than it took; the balance of the whole may hide that behind other energy. Consequence to test: the
gain of any step is that of the kinetic energy of two free bodies.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, dot, norm, put, put_triple, sub, triple, vec
from crashsolve.system.contact.work import motion_of

# of the energy of the relative motion of its bodies, that a belt may create: a step in which it
# becomes slack gives more than was left in it
NEGLIGIBLE = 1e-3
# share of the stated loss and energy of a law that its bodies never supplied
OVERSTATED = 0.9


@kernel
def applied_loads(p, nodes):
    """Forces and torques that have been applied to both bodies so far."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    return vec(a.force), vec(a.torque), vec(b.force), vec(b.torque)


@kernel
def record_work(p, old, new, before, h, nodes):
    """Work over a step of h of the forces that the law has added to `before`. Writes: new."""
    now = applied_loads(p, nodes)
    force_a, torque_a = sub(now[0], before[0]), sub(now[1], before[1])
    force_b, torque_b = sub(now[2], before[2]), sub(now[3], before[3])
    work = 0.0
    if h > 0.0:
        if p.node_a != 0:
            force, torque = add(force_a, vec(old.force_a)), add(torque_a, vec(old.torque_a))
            work += half_work(nodes[p.node_a], force, torque)
        if p.node_b != 0:
            force, torque = add(force_b, vec(old.force_b)), add(torque_b, vec(old.torque_b))
            work += half_work(nodes[p.node_b], force, torque)
    add_work(old, new, work, max(norm(force_a), norm(force_b)))
    put(new.force_a, force_a)
    put(new.torque_a, torque_a)
    put(new.force_b, force_b)
    put(new.torque_b, torque_b)


@kernel
def keep_applied_loads(p, count, new, nodes):
    """Forces and torques applied so far to the bodies of a law among several. Writes: new."""
    for j in range(count):
        if is_first(p, j):
            body = nodes[p.node[j]]
            put_triple(new.forces, j, vec(body.force))
            put_triple(new.torques, j, vec(body.torque))


@kernel
def record_work_of_several(p, count, old, new, h, nodes):
    """The same of a law among several bodies, after keep_applied_loads. Writes: new.

    Rows of the ground and of a body that is repeated are zero from the start.
    """
    work, largest = 0.0, 0.0
    for j in range(count):
        if is_first(p, j):
            body = nodes[p.node[j]]
            force = sub(vec(body.force), triple(new.forces, j))
            torque = sub(vec(body.torque), triple(new.torques, j))
            largest = max(largest, norm(force))
            if h > 0.0:
                before, turned = triple(old.forces, j), triple(old.torques, j)
                work += half_work(body, add(force, before), add(torque, turned))
            put_triple(new.forces, j, force)
            put_triple(new.torques, j, torque)
    add_work(old, new, work, largest)


@kernel
def is_first(p, j):
    """Whether node j of a law is a body, and none before it is the same."""
    node = p.node[j]
    if node == 0:
        return False
    back = 1
    while back <= j and p.node[j - back] != node:
        back += 1
    return back > j


@kernel
def add_work(old, new, work, force):
    """Add the work of a step [J], and the largest force in it [N]. Writes: new."""
    new.work_done = old.work_done + work
    new.exchanged = old.exchanged + abs(work)
    new.peak_force = max(old.peak_force, force)


@kernel
def half_work(body, force, torque):
    """Half of the work of a force and a torque at the mass centre over the step [J]."""
    displacement, rotation = motion_of(body)
    return 0.5 * (dot(force, displacement) + dot(torque, rotation))


@kernel
def energy_gain(now, stored):
    """Energy [J] that a law has returned beyond the energy it received and stored."""
    beyond = now.work_done - max(now.initially_stored, 0.0)
    return min(beyond, now.work_done + stored + now.dissipated - now.initially_stored)


@kernel
def overstates(now, stored, limit, unseen, least):
    """Whether the stated loss and energy of a law are ten times the energy it received.

    So does a damper that turns a velocity round in every step, with a force that has a bound.
    """
    stated = stored + now.dissipated
    missing = now.work_done + stated - now.initially_stored
    bound = max(limit * now.exchanged, unseen * now.peak_force, least)
    return missing > max(OVERSTATED * stated, bound)


@kernel
def has_gain(now, stored, limit, unseen, least):
    """Whether that is more than `limit` of all taken and given, and than the largest force does
    over `unseen`, the round-off of positions [m], and than `least`, the round-off of energies [J].
    """
    bound = max(limit * now.exchanged, unseen * now.peak_force, least)
    return energy_gain(now, stored) > bound


@kernel
def relative_energy(p, count, nodes):
    """Kinetic energy [J] of the relative motion of the mass centres of two bodies of a law that
    follow each other, the most of its first `count`.
    """
    largest = 0.0
    for j in range(1, count):
        a, b = nodes[p.node[j - 1]], nodes[p.node[j]]
        inverse = a.mass_inv + b.mass_inv
        v = norm(sub(vec(a.v), vec(b.v)))
        if inverse > 0.0:
            largest = max(largest, 0.5 * v * v / inverse)
    return largest
