"""Gap between two convex bodies, each a sum of ellipsoids.

    depth = - max over unit n of  (c_a - c_b) . n - h_a(n) - h_b(n)
    h = sum_k sqrt(sum_i (s_ki n . e_i)^2)

h is the support function, s_k are the semi-axes of ellipsoid k, which all lie along the axes e of
the shape. For separated bodies the maximum is unique and its value is their distance; for bodies
that overlap it is the shortest exit, one of several local maxima, searched from the best of the
directions in which edged bodies meet, by Newton's method on the sphere of directions (_ascent.py).
Point of contact: midway between the deepest points.
Consequence to test: depth and normal of two spheres, and those of a brute-force search.

References: Gilbert and Foo (1990), IEEE Trans. Robotics Autom. 6, 53-61 (support functions).
"""

from collections.abc import Iterable, Sequence
from types import ModuleType

import numpy as np

from crashsolve.contact.narrow import _ellipsoids
from crashsolve.contact.narrow._ascent import (
    ROUND_OFF,
    axes_of,
    direction,
    find_maximum,
    separation_along,
    unit_towards,
)
from crashsolve.deck.building import Columns
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, scale, sub, vec

# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
PARAMETERS = Record("""
    node     index      body
    point    m       3  centre from the mass centre, body axes
    axes     1       9  rotation matrix, shape to body, by rows
    count    count      ellipsoids in the sum
    squares  m^2     9  of their semi-axes, which lie along those axes
    angle    rad        largest last step of the search for a direction
""")
# directions are found to this angle [rad], and to a share of the rounding over the size, as of
# _edged.py; the depth is then right to its square
ANGLE, LAST_STEP = 1e-10, 1e-4
# rounding of edges against ellipsoids, over the least semi-axis of those or the radius of the
# enclosing sphere; its least, over that radius: sixteen digits resolve no sharper edge; and its
# largest, over the least half size
SHARP, LEAST_ROUNDING, THINNEST = 1e-5, 1e-9, 0.1
# square of the least sine of the angle between two edges that span a direction
PARALLEL = 1e-12
# directions to start from, and searches for different maxima of bodies that overlap; cosine of the
# angle within which two searches have reached the same maximum
STARTS, SEARCHES, SAME_MAXIMUM = 22, 4, 1.0 - 1e-8


def expand(
    elements: Iterable[Columns], shape: ModuleType, others: Sequence[Columns] = ()
) -> list[Columns]:
    """Elements of a shape as sums of ellipsoids."""
    return [_as_sum(element, shape.rounds(element), ANGLE) for element in elements]


def expand_sharp(
    elements: Sequence[Columns], shape: ModuleType, others: Sequence[Columns] = ()
) -> list[Columns]:
    """Boxes or cylinders that meet the ellipsoids `others`, as sums of ellipsoids.

    The roundness of the ellipsoid is enough for a unique contact: the edges of the other shape are
    only as round as Newton's method needs with sixteen digits. Off its middle a face is lower by up
    to the rounding, which is a share of the smallest ellipsoid for that.
    """
    least = min((min(other["semi"]) for other in others), default=np.inf)
    sums = []
    for element in elements:
        size, most = shape.bounding(element)[1], THINNEST * shape.half_thickness(element)
        edge = min(most, max(SHARP * min(size, least), LEAST_ROUNDING * size))
        angle = min(ANGLE, LAST_STEP * edge / size)
        sums.append(_as_sum(element, shape.rounds(element | {"edge": edge}), angle))
    return sums


def _as_sum(element: Columns, rounds: np.ndarray, angle: float) -> Columns:
    """`rounds`: semi-axes of the ellipsoids [m], by rows; `angle` of the last step [rad]."""
    squares = np.zeros(9)
    squares[: rounds.size] = np.square(rounds).ravel()
    kept = {name: element[name] for name in ("node", "point", "axes")}
    return kept | {"count": len(rounds), "squares": squares, "angle": angle}


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    depth, n, x, _ = search(a, b, nodes, data)
    return depth, n, x


@kernel
def search(a, b, nodes, data):
    """Depth, normal and point as of gap, and how much lower the next maximum found is [m]."""
    u, w = axes_of(a, nodes[a.node]), axes_of(b, nodes[b.node])
    c = from_centre(a, b, nodes)
    best, n, next_maximum = -1e300, (0.0, 0.0, 1.0), -1e300
    starts = best_directions(a, b, u, w, c)
    for climb_number in range(SEARCHES):
        k = direction_number(starts, climb_number)
        start = unit_towards(direction(u, w, c, k), c) if k >= 0 else (0.0, 0.0, 1.0)
        height, n_maximum = find_maximum(_ellipsoids, a, b, u, w, c, start, min(a.angle, b.angle))
        if dot(n_maximum, n) < SAME_MAXIMUM:
            next_maximum = max(next_maximum, min(best, height))
        if height > best:
            best, n = height, n_maximum
        # separated bodies have a single maximum
        if best >= 0.0:
            break
    depth, n, x = depth_at_maximum(a, b, u, w, c, nodes, n)
    return depth, n, x, best - next_maximum


@kernel
def follow(a, b, nodes, data, n):
    """Gap at the local maximum nearest to direction n."""
    u, w = axes_of(a, nodes[a.node]), axes_of(b, nodes[b.node])
    c = from_centre(a, b, nodes)
    _, n = find_maximum(_ellipsoids, a, b, u, w, c, n, min(a.angle, b.angle))
    return depth_at_maximum(a, b, u, w, c, nodes, n)


@kernel
def from_centre(a, b, nodes):
    """Vector from the centre of b to that of a [m]."""
    centre_a = world_position(nodes[a.node], vec(a.point))
    return sub(centre_a, world_position(nodes[b.node], vec(b.point)))


@kernel
def depth_at_maximum(a, b, u, w, c, nodes, n):
    """Depth, normal and point of contact at the maximum in direction n.

    c is the vector from the centre of b to that of a: far from the origin positions have no digits
    for the depth.
    """
    x_a = sub(c, _ellipsoids.support_point(a, u, n))
    x_b = _ellipsoids.support_point(b, w, n)
    centre_b = world_position(nodes[b.node], vec(b.point))
    return dot(sub(x_b, x_a), n), n, add_scaled(centre_b, 0.5, add(x_a, x_b))


@kernel
def bound(a, b, nodes, data):
    """Depth that the bodies do not exceed [m]: along the line of centres and the axes of b.

    With the round-off of the depth: a pair that touches by it must not be skipped.
    """
    u, w = axes_of(a, nodes[a.node]), axes_of(b, nodes[b.node])
    c = from_centre(a, b, nodes)
    length = norm(c)
    if length == 0.0:
        return 1e300
    best = separation_along(_ellipsoids, a, b, u, w, c, scale(1.0 / length, c))
    for k in range(3):
        best = max(best, separation_along(_ellipsoids, a, b, u, w, c, unit_towards(w[k], c)))
    return ROUND_OFF * length - best


@kernel
def best_directions(a, b, u, w, c):
    """The SEARCHES directions with the largest separations; -1 without any.

    Of those with the same distance one is enough.
    """
    none, size = (-1e300, -1), norm(c)
    one, two, three, four = none, none, none, none
    for k in range(STARTS):
        n = direction(u, w, c, k)
        if dot(n, n) > PARALLEL * (size * size if k >= 15 else 1.0):
            value = separation_along(_ellipsoids, a, b, u, w, c, unit_towards(n, c))
            if value > one[0]:
                one, two, three, four = (value, k), one, two, three
            elif two[0] < value < one[0]:
                two, three, four = (value, k), two, three
            elif three[0] < value < two[0]:
                three, four = (value, k), three
            elif four[0] < value < three[0]:
                four = (value, k)
    return one[1], two[1], three[1], four[1]


@kernel
def direction_number(starts, number):
    """Direction from which the search of that number starts; -1 without any."""
    first, second, third, fourth = starts
    if number < 2:
        return first if number == 0 else second
    return third if number == 2 else fourth
