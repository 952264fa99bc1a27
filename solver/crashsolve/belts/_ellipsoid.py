"""Belt over an ellipsoid: the geodesic that leaves two points along tangents, and is the shortest.

A ray from A (`_geodesic.py`) leaves the ellipsoid towards B where B lies in the plane of tangents
there, straight ahead. The unknowns are the angle psi of the silhouette of A, and tau of the ray;
Newton's method takes their exact derivatives. At B the distance to a neighbour is j + j' |B - x|:
where it is not above zero, a line beside it is shorter, and the belt slips off.
A belt that lies on the ellipsoid follows its geodesic; at the start, rays in all directions are
traced, and the shortest line of those that meet B is taken.
Consequence to test: the length is that of an independent search for the shortest line, over
needles and discs too.
"""

from math import pi
from typing import NamedTuple

from crashsolve.belts._arc import OPPOSITE, Arc, nearest_share, straight_arc
from crashsolve.belts._geodesic import (
    Ray,
    divided,
    half_second_derivatives,
    middle_of,
    offsets,
    pieces_of,
    step,
    tangent_ray,
    trace,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add_scaled, cross, dot, norm, scale

# passes of Newton's method, and the last change [rad, of tau]: its square is the
# error that it leaves
TRIALS, CLOSE = 30, 1e-6
# largest change in a pass [rad, of tau]
LARGEST = 0.3
# rays of a search in all directions, in psi and in the angle between them, and tau to which they
# are traced, in steps as many times as long: once around a ball
RAYS, LONGEST, COARSER = 48, 2.0 * pi, 3.0
# square of the least distance of the line between the points, over the ellipsoid's own: there the
# arc is so short that the plane of both points and the centre shows where it begins
SHALLOW = 0.9


class Geodesic(NamedTuple):
    """Result of a search."""

    holds: bool  # there is one, and no line beside it is shorter
    psi: float
    tau: float
    pieces: int  # of the integration
    total: float  # length with both tangents [m]
    first: Ray
    last: Ray


class Frame(NamedTuple):
    """A over the semi-axes, and directions at right angles to it from which psi counts."""

    a: tuple[float, float, float]
    e: tuple[float, float, float]
    f: tuple[float, float, float]


@kernel
def frame_towards(a, near):
    """The Frame whose psi is 0 towards a point, and the sine of its angle from a."""
    across = add_scaled(near, -dot(a, near) / dot(a, a), a)
    size, sine = norm(across), norm(across) / norm(near)
    e = scale(1.0 / size, across) if sine > OPPOSITE else across
    return Frame(a, e, scale(1.0 / norm(a), cross(a, e))), sine


@kernel
def over_ellipsoid(semi, A, B, before):
    """The Arc on an ellipsoid after that of the last step: its touches, first point, middle [m] and
    turned; 0 for the last if it is not known.
    """
    touched, begun, middle, tau = before
    a, b = divided(A, semi), divided(B, semi)
    share = min(max(nearest_share(a, b), 0.0), 1.0)
    if dot(a, a) <= 1.0 or dot(b, b) <= 1.0:
        return straight_arc(-1, A, B, share, 0.0)
    nearest = add_scaled(a, share, (b[0] - a[0], b[1] - a[1], b[2] - a[2]))
    square, lies = dot(nearest, nearest), touched == 1 and tau > 0.0
    # a belt may lie around the back of a shape in front of which the line passes
    if square >= 1.0 and not (lies and dot(nearest, divided(middle, semi)) < 0.0):
        return straight_arc(0, A, B, share, 0.0)
    if touched < 0:
        return straight_arc(touched, A, B, share, 0.0)
    frame, sine = frame_towards(a, divided(begun, semi) if lies else b)
    if sine <= OPPOSITE:
        return straight_arc(-2, A, B, share, 0.0)
    if lies or square > SHALLOW:
        geodesic = find_geodesic(semi, A, B, frame, 0.0, tau if lies else 0.1)
    else:
        geodesic = shortest_geodesic(semi, A, B, frame)
    if not geodesic.holds:
        return straight_arc(-2, A, B, share, 0.0)
    first, last = geodesic.first, geodesic.last
    x, t = middle_of(semi, first, geodesic.tau, geodesic.pieces, last.length)
    return Arc(1, first.x, last.x, x, t, last.length, last.bend, geodesic.tau)


@kernel
def find_geodesic(semi, A, B, frame, psi, tau):
    """The Geodesic near psi and tau."""
    largest, pieces = 1.0, pieces_of(semi, tau)
    for _ in range(TRIALS):
        first, angle_psi = tangent_ray(semi, A, frame.a, frame.e, frame.f, psi)
        last, _ = trace(semi, first, tau, pieces)
        (above, across, _), by_tau, by_angle = offsets(semi, last, B)
        above_psi, across_psi = angle_psi * by_angle[0], angle_psi * by_angle[1]
        determinant = by_tau[0] * across_psi - by_tau[1] * above_psi
        if determinant == 0.0:
            break
        d_tau = (above_psi * across - across_psi * above) / determinant
        d_psi = (by_tau[1] * above - by_tau[0] * across) / determinant
        largest = max(abs(d_psi), abs(d_tau))
        relaxation = min(1.0, LARGEST / largest) if largest > 0.0 else 1.0
        psi += relaxation * d_psi
        tau = max(tau + relaxation * d_tau, 0.1 * tau)
        if largest < CLOSE:
            break
    first, _ = tangent_ray(semi, A, frame.a, frame.e, frame.f, psi)
    last, least = trace(semi, first, tau, pieces)
    (_, _, along), _, _ = offsets(semi, last, B)
    # the distance to a neighbour at B
    spread = last.spread + last.growth * along
    holds = largest < CLOSE and along > 0.0 and least > 0.0 and spread > 0.0
    return Geodesic(holds, psi, tau, pieces, first.spread + last.length + along, first, last)


@kernel
def meet_plane(semi, ray, B):
    """tau at which B comes into the plane of tangents of a ray, and how far it is then across the
    ray and along it [m]; behind it if it never does.
    """
    H, h = half_second_derivatives(semi), LONGEST * COARSER / pieces_of(semi, LONGEST)
    tau = 0.0
    (below, across, along), _, _ = offsets(semi, ray, B)
    while below < 0.0 and tau < LONGEST:
        after = step(H, ray, h)
        (above, _, _), _, _ = offsets(semi, after, B)
        if above >= 0.0:
            part = h * below / (below - above)
            (_, across, along), _, _ = offsets(semi, step(H, ray, part), B)
            return tau + part, across, along
        ray, below, tau = after, above, tau + h
    return tau, across, -1.0


@kernel
def shortest_geodesic(semi, A, B, frame):
    """The shortest Geodesic that rays in all directions show."""
    between = 2.0 * pi / RAYS
    psi_0 = -0.5 * between
    ray, angle_psi = tangent_ray(semi, A, frame.a, frame.e, frame.f, psi_0)
    shortest = Geodesic(False, 0.0, 0.0, 0, 0.0, ray, ray)
    tau_0, across_0, along_0 = meet_plane(semi, ray, B)
    while psi_0 < 2.0 * pi - 0.5 * between:
        psi = psi_0 + between / max(abs(angle_psi), 1.0)
        ray, angle_psi = tangent_ray(semi, A, frame.a, frame.e, frame.f, psi)
        tau, across, along = meet_plane(semi, ray, B)
        if max(along, along_0) > 0.0 and across * across_0 <= 0.0 and across != across_0:
            share = across / (across - across_0)
            near = find_geodesic(
                semi, A, B, frame, psi - share * (psi - psi_0), tau + share * (tau_0 - tau)
            )
            if near.holds and (not shortest.holds or near.total < shortest.total):
                shortest = near
        psi_0, tau_0, across_0, along_0 = psi, tau, across, along
    return shortest
