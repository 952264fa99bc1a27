"""Gap between two boxes or cylinders with rounded edges, which press on each other over an area.

    depth = - max over unit n of  (c_a - c_b) . n - h_a(n) - h_b(n)
    h = sum_k sqrt(alpha_k + beta_k (n . e_k)^2)

The sums of ellipsoids of contact/narrow/_convex.py, each of which is round about an axis e_k of its
shape. Two boxes meet at normals of their faces or across two of their edges, so Newton's method
starts at the best of those 15 axes, found without rounding, and for overlapping bodies at each that
is as good but for the rounding. Consequence to test: the depth is that of contact/narrow/_convex.

References: Gottschalk, Lin and Manocha (1996), Proc. SIGGRAPH, 171-180 (separating axes).
"""

from collections.abc import Iterable, Sequence
from math import sqrt
from types import ModuleType

import numpy as np

from crashsolve.contact.narrow import _rounded
from crashsolve.contact.narrow._ascent import (
    ROUND_OFF,
    along,
    axes_of,
    direction,
    find_maximum,
    unit_towards,
)
from crashsolve.contact.narrow._convex import PARALLEL, SAME_MAXIMUM, SEARCHES, STARTS
from crashsolve.contact.narrow._patch import PATCH_POINT, ROWS, patch
from crashsolve.deck.building import Columns
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, scale, sub, vec

__all__ = ["PARAMETERS", "bound", "data", "expand", "gap", "patch"]

# description of these pairs in the manual
POINTS = "one, or where sides lie flat up to eight (twelve with a cap) that share the force"
# the gap is a distance: see system/contact/resting.py
IS_DISTANCE = True
PARAMETERS = Record("""
    node      index     body
    point     m      3  centre from the mass centre, body axes
    axes      1      9  rotation matrix, shape to body, by rows
    half      m      3  half sizes; of a cylinder radius, radius, half length
    radius    m         of the enclosing sphere
    edge      m         rounding of the edges
    is_round  flag      a cylinder about axis 3, not a box
    alpha     m^2    3  of the three ellipsoids, across their axes
    gamma     m^2    3  the same along them
    beta      m^2    3  gamma less alpha
""")
# cosine to an earlier start that leads to the same maximum
SAME_DIRECTION = 1.0 - 1e-6
# separations that differ by less than this share of the distance belong to one direction
SAME_VALUE = 1e-12
# the last step of Newton's method is smaller than this share of edge / size [rad]: the remaining
# error is its square times size / edge, so the position of contact is right to 1e-8 of a face
LAST_STEP = 1e-4
# least rounding of a box, in shares of that of a cube of its width: Newton's method with sixteen
# digits resolves no sharper edge; and the largest, in shares of its half thickness
LEAST_ROUNDING, LARGEST_ROUNDING = 1e-6, 0.1
# power of the ratio of widths by which a wider face is the flatter
FLATNESS_POWER = 4
# of a cap, on which the search does not start over the position of contact
FLATNESS_POWER_OF_CAP = 1
# share of a face within which the position is searched
OUTERMOST = 0.9999


def expand(
    elements: Iterable[Columns], shape: ModuleType, others: Sequence[Columns] = ()
) -> list[Columns]:
    """Elements of boxes or cylinders with the ellipsoids that they are sums of.

    The rounding is a share of the least half size of the element and of all `others` that it may
    meet. An element whose faces are wider than those of the others acts as a plane: of half width S
    to s its rounding is (s / S)^4 of that. A face that tilts by e x / S^2
    at x from its middle moves the centre of pressure of a face of half width s and rounding d upon
    it by s^2 / d times as much, so that a face nearly as flat would tip a body on it.
    """
    least = min((least_half(other) for other in others), default=np.inf)
    width = min((widest_half(other) for other in others), default=np.inf)
    return [_with_rounding(element, shape, least, width) for element in elements]


def _half(element: Columns) -> np.ndarray:
    """Half sizes (3,) [m] of the enclosing box."""
    if "radius" in element:
        r = element["radius"]
        return np.array([r, r, element["half_length"]])
    return np.asarray(element["half"])


def least_half(element: Columns) -> float:
    """Least half size [m] of a box or cylinder."""
    return float(min(_half(element)))


def widest_half(element: Columns) -> float:
    """Largest half size [m] of a box or cylinder."""
    return float(max(_half(element)))


def _with_rounding(element: Columns, shape: ModuleType, least: float, width: float) -> Columns:
    is_round, r = "radius" in element, element.get("radius")
    half = _half(element)
    flatness = min(1.0, width / widest_half(element)) ** (
        FLATNESS_POWER_OF_CAP if is_round else FLATNESS_POWER
    )
    e = shape.ROUNDING * max(
        flatness * min(least, min(half)), LEAST_ROUNDING * widest_half(element)
    )
    # of a sheet the latter may be more than it is thick
    e = min(e, LARGEST_ROUNDING * min(half))
    # semi-axes across and along; a cylinder is a disc and a needle
    across = [r - e, e, 0.0] if is_round else [e, e, e]
    along = [e, half[2] - e, 0.0] if is_round else half - 2.0 * e
    kept = {name: element[name] for name in ("node", "point", "axes")}
    alpha, gamma = np.square(across), np.square(along)
    size = {"half": half, "radius": shape.bounding(element)[1], "edge": e, "is_round": is_round}
    return kept | size | {"alpha": alpha, "gamma": gamma, "beta": gamma - alpha}


def data(elements_a: object, elements_b: object) -> tuple[np.ndarray]:
    """Room for the points of one patch."""
    return (np.zeros(ROWS, PATCH_POINT.dtype),)


@kernel
def extent(shape, u, n):
    """Extent of the enclosing box along n from its centre, u its axes [m]."""
    half = shape.half
    return half[0] * abs(dot(u[0], n)) + half[1] * abs(dot(u[1], n)) + half[2] * abs(dot(u[2], n))


@kernel
def bound(a, b, nodes, data):
    """Depth that the bodies do not exceed [m]: by enclosing spheres, then along faces of boxes.

    With the round-off of the depth: a pair that touches by it must not be skipped.
    """
    body_a, body_b = nodes[a.node], nodes[b.node]
    c = sub(world_position(body_a, vec(a.point)), world_position(body_b, vec(b.point)))
    size = norm(c)
    apart = size - a.radius - b.radius
    if apart > 0.0:
        return ROUND_OFF * size - apart
    u, w = axes_of(a, body_a), axes_of(b, body_b)
    for k in range(3):
        apart = max(apart, abs(dot(c, u[k])) - a.half[k] - extent(b, w, u[k]))
        apart = max(apart, abs(dot(c, w[k])) - b.half[k] - extent(a, u, w[k]))
    return ROUND_OFF * size - apart


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    depth, n, x, _ = search(a, b, nodes, data)
    return depth, n, x


@kernel
def search(a, b, nodes, data):
    """Depth, normal and point as of gap, and how much lower the next maximum found is [m]."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    centre_a, centre_b = world_position(body_a, vec(a.point)), world_position(body_b, vec(b.point))
    c = sub(centre_a, centre_b)
    u, w = axes_of(a, body_a), axes_of(b, body_b)
    # maxima of two boxes equal their separation along an axis, but for the rounding
    are_boxes = a.is_round + b.is_round == 0
    allowed = 8.0 * (a.edge + b.edge) if are_boxes else 1e300
    cosines, c_u, c_w = cosines_of(u, w), along(u, c), along(w, c)
    best, n, before, same = -1e300, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), SAME_VALUE * norm(c)
    leading, last, next_maximum = (1e300, 0, 1e300, 0), last_step(a, b), -1e300
    for trial in range(SEARCHES):
        if trial % 2 == 0 and are_boxes:
            leading = next_box_axes(a, b, cosines, c_u, c_w, leading[2] - same, same)
        elif trial % 2 == 0:
            leading = next_directions(a, b, u, w, c, leading[2] - same, same)
        value, k = (leading[0], leading[1]) if trial % 2 == 0 else (leading[2], leading[3])
        # a start close to an earlier one is skipped
        if value < best - allowed:
            next_maximum = max(next_maximum, value)
            break
        k = wider_face(a, b, cosines, k) if are_boxes and k < 6 else k
        start = unit_towards(direction(u, w, c, k), c)
        if dot(start, before) < SAME_DIRECTION:
            before = start
            start = normal_above(a, b, u, w, c, k, start) if are_boxes and k < 6 else start
            height, n_maximum = find_maximum(_rounded, a, b, u, w, c, start, last)
            if dot(n_maximum, n) < SAME_MAXIMUM:
                next_maximum = max(next_maximum, min(best, height))
            if height > best:
                best, n = height, n_maximum
            # separated bodies have a single maximum
            if best >= 0.0:
                break
    depth, n, x = depth_at_maximum(a, b, u, w, c, centre_b, n)
    return depth, n, x, best - next_maximum


@kernel
def follow(a, b, nodes, data, n):
    """Gap at the local maximum nearest to direction n."""
    body_a, body_b = nodes[a.node], nodes[b.node]
    centre_a, centre_b = world_position(body_a, vec(a.point)), world_position(body_b, vec(b.point))
    c = sub(centre_a, centre_b)
    u, w = axes_of(a, body_a), axes_of(b, body_b)
    _, n = find_maximum(_rounded, a, b, u, w, c, n, last_step(a, b))
    return depth_at_maximum(a, b, u, w, c, centre_b, n)


@kernel
def last_step(a, b):
    """Largest angle of the last step of Newton's method [rad]."""
    return LAST_STEP * min(a.edge / a.radius, b.edge / b.radius)


@kernel
def depth_at_maximum(a, b, u, w, c, centre_b, n):
    """Depth, normal and point of contact at the maximum in direction n.

    c is the vector from the centre of b to that of a: far from the origin positions have no digits
    for the depth.
    """
    x_a = sub(c, _rounded.support_point(a, u, n))
    x_b = _rounded.support_point(b, w, n)
    return dot(sub(x_b, x_a), n), n, add_scaled(centre_b, 0.5, add(x_a, x_b))


@kernel
def cosines_of(u, w):
    """Cosines between the axes of both shapes, a row for each of the first."""
    return along(w, u[0]), along(w, u[1]), along(w, u[2])


@kernel
def insert_value(leading, value, k, same):
    """The two largest of some values and which they are; two that differ by `same` are one."""
    first, of_first, second, of_second = leading
    if value > first:
        if first < value - same:
            second, of_second = first, of_first
        return value, k, second, of_second
    if second < value < first - same:
        return first, of_first, value, k
    return leading


@kernel
def next_box_axes(a, b, cosines, c_u, c_w, limit, same):
    """The two largest separations of two boxes below `limit` [m], and along which axes they are.

    0 to 2 are normals of a, 3 to 5 of b, 6 + 3 i + j is across edges i of a and j of b.
    """
    leading, p, q = (-1e300, 0, -1e300, 0), a.half, b.half
    for i in range(3):
        r = cosines[i]
        value = abs(c_u[i]) - p[i] - q[0] * abs(r[0]) - q[1] * abs(r[1]) - q[2] * abs(r[2])
        if value < limit:
            leading = insert_value(leading, value, i, same)
    for j in range(3):
        r = (cosines[0][j], cosines[1][j], cosines[2][j])
        value = abs(c_w[j]) - q[j] - p[0] * abs(r[0]) - p[1] * abs(r[1]) - p[2] * abs(r[2])
        if value < limit:
            leading = insert_value(leading, value, 3 + j, same)
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            r_k, r_m = cosines[k][j], cosines[m][j]
            square = r_k * r_k + r_m * r_m
            if square > PARALLEL:
                value = abs(c_u[m] * r_k - c_u[k] * r_m) - p[k] * abs(r_m) - p[m] * abs(r_k)
                value -= q[(j + 1) % 3] * abs(cosines[i][(j + 2) % 3])
                value -= q[(j + 2) % 3] * abs(cosines[i][(j + 1) % 3])
                value /= sqrt(square)
                # a direction that is also a normal of a face starts above the point on it, see gap
                if value < limit and abs(value - leading[0]) > same:
                    leading = insert_value(leading, value, 6 + 3 * i + j, same)
    return leading


@kernel
def next_directions(a, b, u, w, c, limit, same):
    """The two largest separations below `limit` [m], and along which directions they are."""
    leading, size = (-1e300, 0, -1e300, 0), norm(c)
    for k in range(STARTS):
        n = direction(u, w, c, k)
        square = dot(n, n)
        if square > PARALLEL * (size * size if k >= 15 else 1.0):
            n = scale(1.0 / sqrt(square), n)
            value = abs(dot(c, n)) - extent_of(a, u, n) - extent_of(b, w, n)
            if value < limit:
                leading = insert_value(leading, value, k, same)
    return leading


@kernel
def wider_face(a, b, cosines, k):
    """The face of the larger box, of two that lie flat on each other."""
    for i in range(3):
        for j in range(3):
            if (k == i or k == 3 + j) and abs(cosines[i][j]) > SAME_DIRECTION:
                return i if a.radius > b.radius else 3 + j
    return k


@kernel
def normal_above(a, b, u, w, c, k, n):
    """Normal of a rounded face where the other box is nearest to it, for the normal n of the face.

    Newton's method would reach it too, in small steps.
    """
    if k < 3:
        return rounded_normal(a, u, k, sub(c, _rounded.support_point(b, w, n)), n, -1.0)
    return rounded_normal(b, w, k - 3, sub(c, _rounded.support_point(a, u, n)), n, 1.0)


@kernel
def rounded_normal(shape, u, k, separation, n, sign):
    """Normal of the rounded face k at the position `separation` from the centre. See
    normal_above.
    """
    rotated = n
    for j in range(3):
        if j != k:
            full = shape.alpha[j] + shape.beta[j]
            most = OUTERMOST * sqrt(full)
            p = max(-most, min(most, dot(separation, u[j])))
            slope = p * sqrt(shape.alpha[j] / (full * full - p * p * shape.beta[j]))
            rotated = add_scaled(rotated, sign * slope, u[j])
    return scale(1.0 / norm(rotated), rotated)


@kernel
def extent_of(shape, u, n):
    """Extent of the shape along n from its centre, edges not rounded [m]."""
    if shape.is_round == 1:
        z = dot(u[2], n)
        return shape.half[0] * sqrt(max(0.0, 1.0 - z * z)) + shape.half[2] * abs(z)
    return extent(shape, u, n)
