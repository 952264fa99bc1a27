"""Directions between the world and the axes of a shape within a body; spheres beside a shape."""

from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.vec3 import add_scaled, dot, scale, sub, vec


@kernel
def to_shape_axes(shape, body, x):
    """World direction x in the axes of the shape."""
    return matvec_t(shape.axes, matvec_t(body.A, x))


@kernel
def to_world_axes(shape, body, y):
    """Direction y in the axes of the shape, in the world."""
    return matvec(body.A, matvec(shape.axes, y))


@kernel
def local_position(shape, body, x):
    """World point x from the centre of the shape, in its axes."""
    return to_shape_axes(shape, body, sub(x, world_position(body, vec(shape.point))))


@kernel
def local_centre(a, b, nodes):
    """Centre of the sphere a from that of the shape b, in its axes [m]."""
    return local_position(b, nodes[b.node], world_position(nodes[a.node], vec(a.point)))


@kernel
def touch_of_sphere(a, b, nodes, distance, m):
    """Depth [m], normal out of b, and point of contact of a sphere, world components.

    Its centre is `distance` [m] away from the shape b along m, in the axes of b.
    """
    n, centre = to_world_axes(b, nodes[b.node], m), world_position(nodes[a.node], vec(a.point))
    return a.radius - distance, n, add_scaled(centre, -a.radius, n)


@kernel
def axes_of_a(a, b, nodes):
    """Axes of the shape on side a in those of the shape on side b."""
    of_a, of_b = nodes[a.node], nodes[b.node]
    return (
        to_shape_axes(b, of_b, to_world_axes(a, of_a, (1.0, 0.0, 0.0))),
        to_shape_axes(b, of_b, to_world_axes(a, of_a, (0.0, 1.0, 0.0))),
        to_shape_axes(b, of_b, to_world_axes(a, of_a, (0.0, 0.0, 1.0))),
    )


@kernel
def into_axes(axes, x):
    """Components of x along three unit vectors, those of axes_of_a: from axes of b to axes of a."""
    return dot(axes[0], x), dot(axes[1], x), dot(axes[2], x)


@kernel
def out_of_axes(axes, z):
    """The vector of the components z along three unit vectors: from axes of a to axes of b."""
    return add_scaled(add_scaled(scale(z[0], axes[0]), z[1], axes[1]), z[2], axes[2])
