"""Stiffness of the elements of shells, by differences of their own forces, node by node.

    K_ab = -(f_a(x_b + delta) - f_a) / delta,   at the end of the step as iterated

Nodes without a common neighbour are displaced together, so that six times some ten passes over the
elements tell all of K: nine colours for quadrilaterals in rows and columns. It is the whole tangent
of the step, with the return of what yields, the stress that stiffens, the turn of the axes and the
middle of the step in which strains are measured, whatever the element; its error is that of one
difference, 1e-6. It is not symmetric: strains are those of the middle of the step, forces those of
its end, and the symmetric part alone has -E A theta^2 / 16 against a step that turns by theta, more
than bending resists. Velocities of points are those of the step and follow their places, so that
nothing is lost by subtraction.

Reference: Curtis, Powell and Reid (1974), On the estimation of sparse Jacobian matrices, IMA
Journal of Applied Mathematics 13, 117-119.
"""

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.vec3 import add, cross, dot, put, scale, vec

# over the model's size, and rad
WAY, TURN = 1e-7, 1e-6


@kernel
def clear(scene):
    """Writes: scene.blocks_0."""
    for e in range(scene.blocks_0.shape[0]):
        for k in range(36):
            scene.blocks_0[e].stiff[k] = scene.blocks_0[e].stiff_above[k] = 0.0


@kernel
def keep_forces(scene):
    """Forces of the elements in the place itself. Writes: scene.points, base."""
    for i in range(scene.points.shape[0]):
        b = scene.points[i]
        for k in range(3):
            scene.base[6 * i + k], scene.base[6 * i + 3 + k] = b.force[k], b.torque[k]
    clear_points(scene)


@kernel
def clear_points(scene):
    """Writes: scene.points."""
    for i in range(scene.points.shape[0]):
        put(scene.points[i].force, (0.0, 0.0, 0.0))
        put(scene.points[i].torque, (0.0, 0.0, 0.0))
        scene.points[i].rate = scene.points[i].spin_rate = 0.0


@kernel
def size_of(k, scene):
    """Length of a displacement [m], or turn."""
    return WAY * scene.control[0].length if k < 3 else TURN


@kernel
def displace(h, colour, k, scene):
    """Move the points of a colour along axis k at the end of the step, or turn them.

    Writes: scene.points.
    """
    size = size_of(k, scene)
    for i in range(scene.points.shape[0]):
        if scene.colours[i] != colour:
            continue
        b = scene.points[i]
        if k < 3:
            b.r[k] += size
            b.v[k] += size / h
        else:
            c = scale(0.5 * h, vec(b.w))
            half = 0.5 * size
            d = (half if k == 3 else 0.0, half if k == 4 else 0.0, half if k == 5 else 0.0)
            both = scale(1.0 / (1.0 - dot(c, d)), add(add(c, d), cross(d, c)))
            put(b.w, scale(2.0 / h, both))


@kernel
def note(colour, k, scene):
    """Columns of K from forces with the points of a colour displaced. Writes: scene.blocks_0."""
    points, base, share = scene.points, scene.base, 1.0 / size_of(k, scene)
    for e in range(scene.links.shape[0]):
        link = scene.links[e]
        a, b, block = link.point_a, link.point_b, scene.blocks_0[link.block]
        if scene.colours[b] == colour and points[b].held >> k & 1 == 0:
            f = points[a]
            for i in range(6):
                more = share * (base[6 * a + i] - (f.force[i] if i < 3 else f.torque[i - 3]))
                if f.held >> i & 1 == 0:
                    block.stiff[6 * i + k] = more
        if a != b and scene.colours[a] == colour and points[a].held >> k & 1 == 0:
            f = points[b]
            for i in range(6):
                more = share * (base[6 * b + i] - (f.force[i] if i < 3 else f.torque[i - 3]))
                if f.held >> i & 1 == 0:
                    block.stiff_above[6 * k + i] = more


@kernel
def keep(scene):
    """What the elements keep at the start of a step. Writes: scene.lanes_before."""
    for i in range(scene.counts[0].numbers):
        scene.lanes_before[i] = scene.lanes[i]


@kernel
def begin_again(h, clock, scene):
    """Elements as before a step of h; a sample leaves them. Writes: scene.lanes, clock."""
    clock.element_rate = 0.0
    if h > 0.0:
        for i in range(scene.counts[0].numbers):
            scene.lanes[i] = scene.lanes_before[i]
