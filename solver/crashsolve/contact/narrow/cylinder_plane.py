"""Gap between a cylinder with flat caps and a plane, one for each position it may rest on.

    depth = rho |t| - (c - x_0) . n,   t = n - (n . e) e,   x = c - rho t / |t|

c is a point of the axis e. On either cap there are the lowest point of the rim (rho = R), the
highest (rho = -R) and the centre (rho = 0); on the lateral surface, the lowest point midway (rho
= R). Each has a third of the force of the law, so that a cylinder on a cap or on its side sinks as
deep as one point would under the whole force. Spun on a cap it is braked by 2/3 mu N R, as under an
even pressure, and it tips over its rim. All depths are those of its surface, and change as it
moves. Consequence to test: mu 0.4 stops a disc of 0.1 m at 6 rad/s in 0.115 s.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, dot, scale, sub, vec

# tilt [rad] of an upright cylinder up to which the lowest point of its rim leans to a fixed one:
# bristles that hold it against a torque must not be thrown about by round-off
UPRIGHT = 1e-4
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
        # how far it reaches: while its rim leans to a fixed side, a depth changes by up to half as
        # much again as the point of the rim moves
        "radius": 1.5 * element["radius"],
        "share": 1.0 / 3.0,
    }


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    body = nodes[a.node]
    centre = world_position(body, vec(a.point))
    origin = world_position(nodes[b.node], vec(b.point))
    n, e = arm(nodes[b.node], vec(b.normal)), arm(body, vec(a.axis))
    down = lowest(n, e, arm(body, vec(a.side)))
    depth = a.rho * dot(add_scaled(n, -dot(n, e), e), down) - dot(sub(centre, origin), n)
    return depth, n, add_scaled(centre, -a.rho, down)


@kernel
def lowest(n, e, side):
    """Direction across the axis e against which a rim is lowest over a plane of the normal n."""
    t = add_scaled(n, -dot(n, e), e)
    even = max(0.0, 1.0 - sqrt(dot(t, t)) / UPRIGHT)
    down = add_scaled(t, 0.1 * UPRIGHT * even * even, side)
    length = sqrt(dot(down, down))
    return scale(1.0 / length, down) if length > 0.0 else side
