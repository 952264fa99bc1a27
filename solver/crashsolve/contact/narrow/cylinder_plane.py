"""Gap between a cylinder with flat caps and a plane, one for each position it may rest on.

    depth = rho g(t) - (c - x_0) . n,   t = n - (n . e) e,   x = c - rho grad g,   g = |t|

c is a point of the axis e. On either cap there are the lowest point of the rim (rho = R), the
highest (rho = -R) and the centre (rho = 0); on the lateral surface, the lowest point midway (rho
= R). Each has a third of the force of the law, so that a cylinder on a cap or on its side sinks as
deep as one point would under the whole force. Spun on a cap it is braked by 2/3 mu N R, as under an
even pressure, and it tips over its rim. All depths are those of its surface, and change as it
moves. The lowest point of an upright rim is any of it: next to upright

    g = |t + delta w s| - delta w,   w = (1 - t^2 / T^2)^2 within |t| < T

with s fixed across the cylinder, so that it leans to one side of the rim, and the contact has a
potential at every tilt. Consequences to test: mu 0.4 stops a disc of 0.1 m at 6 rad/s in 0.115 s,
and a cap that friction tilts by 1e-4 gives back what it took.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, dot, norm, scale, sub, vec

# delta [rad]: bristles that hold an upright cylinder against a torque must not be thrown about by
# tilts below it; and T [rad]: the rim is out of round by 2 delta of its radius within, and the
# lowest point is off it by 4 delta / T
SIDE_TILT, UPRIGHT = 1e-5, 1e-2
# description in the manual
POINTS = "three on a cap and three on the side, each a third of the force"
# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
PARAMETERS_A = Record("""
    node   index     body
    point  m      3  on the axis, from the mass centre, body axes
    axis   1      3  unit vector, body axes
    side   1      3  unit vector across, body axes: the lowest of an upright cylinder
    rho    m         from the axis downwards; negative upwards
    share  1         of the force of the law
""")


def expand_a(elements):
    """The seven points of each cylinder."""
    return [position_on(e, *at) for e in elements for at in POSITIONS]


# where along the half length, and how far across in radii
POSITIONS = [(0.0, 1.0), *((side, rho) for side in (-1.0, 1.0) for rho in (1.0, 0.0, -1.0))]


def position_on(element, along, across):
    """A position on a cylinder, `along` in half lengths and `across` in radii from its centre."""
    axes = element["axes"].reshape(3, 3)
    return {
        "node": element["node"],
        "point": element["point"] + along * element["half_length"] * axes[:, 2],
        "axis": axes[:, 2],
        "side": axes[:, 0],
        "rho": across * element["radius"],
        # how far it reaches: the lowest point of a rim that leans to a side is off the rim
        "radius": (1.0 + 8.0 * SIDE_TILT / UPRIGHT) * element["radius"],
        "share": 1.0 / 3.0,
    }


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body = nodes[a.node]
    centre = world_position(body, vec(a.point))
    origin = world_position(nodes[b.node], vec(b.point))
    n, e = arm(nodes[b.node], vec(b.normal)), arm(body, vec(a.axis))
    drop, down = lowest(n, e, arm(body, vec(a.side)))
    depth = a.rho * drop - dot(sub(centre, origin), n)
    return depth, n, add_scaled(centre, -a.rho, down)


@kernel
def lowest(n, e, side):
    """Drop of the lowest point of a rim about the axis e over a plane of the normal n, over its
    radius, and the gradient of that: across e, away from that point.
    """
    t = add_scaled(n, -dot(n, e), e)
    square = dot(t, t)
    inside = max(0.0, 1.0 - square / (UPRIGHT * UPRIGHT))
    lean = SIDE_TILT * inside * inside
    leaning = add_scaled(t, lean, side)
    length = norm(leaning)
    # at one tilt towards the side all points are equal
    along = scale(1.0 / length, leaning) if length > 0.0 else side
    slope = -4.0 * SIDE_TILT * inside / (UPRIGHT * UPRIGHT)
    return length - lean, add_scaled(along, (dot(along, side) - 1.0) * slope, t)
