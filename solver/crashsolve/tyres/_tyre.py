"""A tyre on its roads: contact patch, slips, vertical force and deflection of the carcass.

    depth   delta = R cos(gamma) - d,   n the normal of the road, d the distance of the centre
    F_z     = max(y(delta) + c w delta_dot, 0),   y = k delta or a curve,   + k_rim beyond the rim
    forward x = u x n / cos(gamma), left y = n x x, u the axis of the wheel, sin(gamma) = u . n
    leaning -F_z R grad cos(gamma) on the centre, as n turns on edges and rounded roads
    slip    V_s of the wheel's point on the road,   V = max(|V_x|, |V_x - V_sx|)
    carcass q_dot + V q / sigma = -V_s   in both directions,   slips s = (q - k_V / C V_s) / sigma

V_x is the speed of the centre along x and V_x - V_sx that of rolling, so that one definition serves
braking (V = |V_x|) and driving. At rest the carcass is a spring C / sigma with the damper k_V,
which fades out at the speed V_low: the wheel stands on a slope without creep. M_z of the laws is
that of rolling forward; in reverse it changes its sign, through 0 at rest. The force acts in the
road on both bodies. Consequence to test: steady s = -V_s / V; a wheel that rolls freely has
Omega r = V_x with the loaded radius r = d / cos(gamma).

References: Gim and Nikravesh (1990), International Journal of Vehicle Design 11, 589-618; Pacejka
(2012), Tire and Vehicle Dynamics, chapters 7 and 8 (relaxation, standing still).
"""

from math import asin, sqrt
from typing import ClassVar, NamedTuple

from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, CurveName, SurfaceName, Vec3, quantity, word
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_wrench,
    arm,
    mobility,
    point_at,
    point_velocity,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import Vector, add, add_scaled, cross, dot, scale, sub, vec
from crashsolve.springs._resistance import steepest
from crashsolve.tyres._road import MAX_ROADS, NEAR, ROADS, Profile, road_columns, road_distance

# cosine of the camber below which a wheel lies on its side, and is not on its tyre
LEAST_COSINE = 0.1


class TyreCard(Card):
    """Words that all tyres share."""

    curve_axes: ClassVar = {"curve": ("m", "N")}

    wheel: BodyName = word("body of the wheel")
    axis: Vec3 = word("axis of the wheel, to the left of forward, in its frame", (0.0, 1.0, 0.0))
    at: Vec3 = quantity("m", "centre of the wheel, in its frame", (0.0, 0.0, 0.0))
    road: tuple[SurfaceName, ...] = word("surfaces on which it may roll: planes, boxes, meshes", ())
    profile: Profile | None = word("height of a road over the distance along it", None)
    radius: float = quantity("m", "R, without load", gt=0)
    stiffness: float | None = quantity("N/m", "k, of the depth", None, gt=0)
    curve: CurveName | None = word("force over depth, from 0; instead of stiffness", None)
    damping: float = quantity("N s/m", "c, of the depth", 0.0, ge=0)
    damping_depth: float = quantity("m", "depth over which damping grows to c", 5e-3, gt=0)
    rim_radius: float | None = quantity("m", "radius at which it meets the rim", None, gt=0)
    rim_stiffness: float = quantity("N/m", "k_rim, added to k once the rim is reached", 0.0, ge=0)
    slip_stiffness: float = quantity("N", "C_x, longitudinal force over slip at zero", gt=0)
    cornering_stiffness: float = quantity("N/rad", "C_y, lateral force over slip at zero", gt=0)
    camber_stiffness: float = quantity(
        "N/rad", "C_gamma, lateral force over camber at zero", 0.0, ge=0
    )
    friction_max: float = quantity("1", "mu without slip", gt=0)
    friction_min: float | None = quantity("1", "mu at slip 1; friction_max when absent", None, gt=0)
    contact_length: float | None = quantity(
        "m", "l, of the patch; the chord of the circle when absent", None, gt=0
    )
    relaxation: float = quantity("m", "sigma along the wheel", 0.1, gt=0)
    side_relaxation: float = quantity("m", "sigma across the wheel", 0.3, gt=0)
    standstill_damping: float = quantity("N s/m", "k_V of the carcass at rest", 770.0, ge=0)
    low_speed: float = quantity("m/s", "V_low, speed at which k_V has fallen to 0", 2.5, gt=0)
    side_stiffness: float | None = quantity(
        "N/m", "of the carcass, for the overturning moment; none when absent", None, gt=0
    )
    rolling_resistance: float = quantity("1", "moment over F_z R that opposes rolling", 0.0, ge=0)

    @model_validator(mode="after")
    def _consistent(self) -> "TyreCard":
        if (self.stiffness is None) == (self.curve is None):
            raise ValueError("needs one of stiffness and curve")
        if not self.road and self.profile is None:
            raise ValueError("road: needs a surface, or a profile")
        if len(set(self.road)) < len(self.road):
            raise ValueError("road: names a surface twice, which would bear twice the force")
        if self.friction_min is not None and self.friction_min > self.friction_max:
            raise ValueError("friction_min: must not exceed friction_max")
        if self.rim_radius is not None and self.rim_radius >= self.radius:
            raise ValueError("rim_radius: must be below radius")
        if (self.rim_radius is None) != (self.rim_stiffness == 0.0):
            raise ValueError("rim_radius and rim_stiffness belong together")
        return self


TYRE = ROADS + Record("""
    node            index     wheel
    axis            1      3  u, wheel axes
    centre          m      3  of the wheel from its mass centre, wheel axes
    radius          m         R
    stiffness       N/m       k; not used with a curve
    curve           index     y; 0 for none
    largest_slope   N/m       largest slope of the vertical force
    damping         N s/m     c
    damping_depth   m         depth over which it grows
    rim_depth       m         depth at which the rim is met; infinite for none
    rim_stiffness   N/m       k_rim
    friction_max    1         mu without slip
    friction_min    1         mu at slip 1
    length          m         l; 0 for the chord of the circle
    sigma_x         m         relaxation length along the wheel
    sigma_y         m         the same across
    standstill_damping   N s/m     k_V
    low_speed       m/s       V_low
    side_stiffness  N/m       of the carcass; infinite for none
    resistance      1         coefficient of rolling resistance
    K_x             N/m       C_x / sigma_x
    K_y             N/m       C_y / sigma_y
    C_x             N         longitudinal force over slip at zero
    C_y             N/rad     lateral force over slip at zero
    C_gamma         N/rad     lateral force over camber at zero
""")
CARCASS = Record(f"""
    q_x            m     {MAX_ROADS}  deflection of the carcass along the wheel, on each road
    q_y            m     {MAX_ROADS}  the same across
    store          J     {MAX_ROADS}  energy in it
    bottomed       flag  whether its centre has been on a road or below it
    roads_overlap  flag  whether two roads have pressed it from one side
""")
OUT_OF_RANGE = {
    "bottomed": "the wheel centre has reached the road: the tyre is too soft for its load, or for "
    "what it struck, which it may have passed; give rim_radius and rim_stiffness, or a stiffening "
    "curve",
    "roads_overlap": "two roads pressed it from one side, and their forces were added: where they "
    "lie in one plane its load is too high; define them as one box, one mesh or one profile",
}
FORCES_OF_TYRE = Record("""
    force         N    3  on the wheel, world axes
    moment        N m  3  on the wheel about its centre, world axes
    normal        N       F_z, sum over the roads
    longitudinal  N       F_x of the road pressed most
    lateral       N       F_y of that road
    aligning      N m     M_z of that road
    depth         m       delta of that road; negative: a gap
    slip          1       s_x of that road, positive drives
    side_slip     1       s_y of that road
    camber        rad     gamma on that road
    sliding       1       share of the patch that slides, there
""")


def tyre_columns(card: TyreCard, scene: Scene) -> Columns:
    """Columns of TYRE."""
    node = scene.node(card.wheel)
    if node == 0:
        raise scene.fail("the ground is no wheel; name a body", "wheel")
    curve = scene.curve(card.curve) if card.curve else 0
    if curve and scene.curve_points[curve]["x"] != 0.0:
        raise scene.fail("must begin at 0, where the tyre meets the road", "curve")
    k = card.stiffness or 0.0
    slope = steepest(scene.curve_points, curve) if curve else k
    rim = card.radius - card.rim_radius if card.rim_radius else float("inf")
    columns = road_columns(card.road, card.profile, scene)
    if node in columns["road_node"][: columns["roads"]]:
        raise scene.fail("the wheel cannot roll on itself", "road")
    return columns | {
        "node": node,
        "axis": scene.unit(card.axis, "axis"),
        "centre": scene.from_mass_centre(node, card.at),
        "radius": card.radius,
        "stiffness": k,
        "curve": curve,
        "largest_slope": slope + card.rim_stiffness,
        "damping": card.damping,
        "damping_depth": card.damping_depth,
        "rim_depth": rim,
        "rim_stiffness": card.rim_stiffness,
        "friction_max": card.friction_max,
        "friction_min": card.friction_min or card.friction_max,
        "length": card.contact_length or 0.0,
        "sigma_x": card.relaxation,
        "sigma_y": card.side_relaxation,
        "standstill_damping": card.standstill_damping,
        "low_speed": card.low_speed,
        "side_stiffness": card.side_stiffness or float("inf"),
        "resistance": card.rolling_resistance,
        "K_x": card.slip_stiffness / card.relaxation,
        "K_y": card.cornering_stiffness / card.side_relaxation,
        "C_x": card.slip_stiffness,
        "C_y": card.cornering_stiffness,
        "C_gamma": card.camber_stiffness,
    }


class Patch(NamedTuple):
    """Contact of a wheel with a road: point, axes and velocity; world components."""

    depth: float  # delta [m]
    n: Vector  # normal of the road
    x: Vector  # forward along the road
    y: Vector  # left along the road
    hub: Vector  # centre of the wheel, from its mass centre [m]
    bottom: Vector  # lowest point of the circle, from the mass centre of the wheel [m]
    foot: Vector  # point of the road under the centre, from the mass centre of the wheel [m]
    radius: float  # loaded radius r [m]
    camber: float  # sin(gamma)
    tilt: Vector  # R times the gradient of cos(gamma) over the centre, as the normal turns [1]
    closing: float  # delta_dot [m/s]
    V_x: float  # speed of the centre along x [m/s]
    slip_x: float  # V_sx [m/s]
    slip_y: float  # V_sy [m/s]
    sense: float  # 1 where the wheel rolls forward, -1 in reverse, between them below V_low


@kernel
def patch_of(p, i, nodes, curves, data):
    """The Patch on road i; depth below zero where the wheel is off it, or lies on its side."""
    wheel, road = nodes[p.node], nodes[p.road_node[i]]
    u, hub = arm(wheel, vec(p.axis)), arm(wheel, vec(p.centre))
    centre = point_at(wheel, hub)
    d, n, is_even = road_distance(p, i, nodes, centre, curves, data)
    camber = dot(u, n)
    upright = sqrt(max(1.0 - camber * camber, 0.0))
    lies = upright < LEAST_COSINE
    by_cosine = 1.0 / max(upright, LEAST_COSINE)
    m = scale(by_cosine, add_scaled(n, -camber, u))
    x = scale(by_cosine, cross(u, n))
    y = cross(n, x)
    radius = max(d * by_cosine, 0.1 * p.radius)
    depth = -1.0 if lies else p.radius * upright - d
    tilt = (0.0, 0.0, 0.0)
    if depth > 0.0 and not is_even:
        gradient = normal_gradient(p, i, nodes, centre, u, n, curves, data)
        tilt = scale(-p.radius * camber * by_cosine, gradient)
    velocity, spin = motion_over(wheel, hub, road)
    # a point at -r m from the centre moves with the velocity less r times this
    turning = cross(spin, m)
    V_x, rolling = dot(x, velocity), radius * dot(x, turning)
    return Patch(
        depth,
        n,
        x,
        y,
        hub,
        add_scaled(hub, -p.radius, m),
        add_scaled(hub, -radius, m),
        radius,
        camber,
        tilt,
        dot(sub(tilt, n), velocity) + p.radius * dot(n, turning),
        V_x,
        V_x - rolling,
        dot(y, velocity) - radius * dot(y, turning),
        # the tread comes in at the leading edge: in reverse the trail lies on the other side
        max(min(rolling / p.low_speed, 1.0), -1.0),
    )


@kernel
def normal_gradient(p, i, nodes, centre, u, n, curves, data):
    """Gradient of u . n over the centre, at rounded roads and edges [1/m].

    The distance from a road has a symmetric second derivative, so that it is that of n along u.
    """
    step = NEAR * p.radius
    _, beside, _ = road_distance(p, i, nodes, add_scaled(centre, step, u), curves, data)
    gradient = scale(1.0 / step, sub(beside, n))
    # the normal jumps where two parts of a road are equally near
    is_jump = dot(gradient, gradient) * (0.1 * p.radius) ** 2 > 1.0
    return (0.0, 0.0, 0.0) if is_jump else gradient


@kernel
def motion_over(wheel, d, road):
    """Velocity of the point d of the wheel over the point of the road there [m/s], and angular
    velocity over the road [rad/s].
    """
    there = sub(point_at(wheel, d), vec(road.r))
    velocity = sub(point_velocity(wheel, d), point_velocity(road, there))
    return velocity, sub(vec(wheel.w), vec(road.w))


@kernel
def patch_length(p, at):
    """l [m]."""
    return p.length if p.length > 0.0 else 2.0 * sqrt(max(p.radius**2 - at.radius**2, 0.0))


@kernel
def reset(p, new, out):
    """Reset before the roads are searched. Writes: new, out."""
    for k in range(MAX_ROADS):
        new.q_x[k] = new.q_y[k] = new.store[k] = 0.0
    new.bottomed = new.roads_overlap = 0
    for k in range(3):
        out.force[k] = out.moment[k] = 0.0
    out.normal = out.longitudinal = out.lateral = out.aligning = 0.0
    out.slip = out.side_slip = out.camber = out.sliding = 0.0
    out.depth = -1e300
    out.stored = out.power = out.loss = 0.0


@kernel
def apply_patch_forces(p, i, old, new, out, h, nodes, at, grip, F, M_z, store):
    """Forces F = (F_x, F_y) and M_z of a patch on wheel and road. Writes: nodes, new, out."""
    wheel, road = nodes[p.node], nodes[p.road_node[i]]
    press = scale(grip.F_z, at.n)
    pull = add(scale(F[0], at.x), scale(F[1], at.y))
    M_y = -p.resistance * grip.F_z * p.radius * at.sense
    # the patch is deflected to the side to which the road pulls it, and the load with it
    M_x = grip.F_z * F[1] / p.side_stiffness
    moment = add(add(scale(M_z, at.n), scale(M_y, at.y)), scale(M_x, at.x))
    # the depth gained by rotation of the normal is taken from the wheel, at its centre
    total = add_scaled(add(press, pull), -grip.F_z, at.tilt)
    about = add(cross(sub(at.bottom, at.hub), press), cross(sub(at.foot, at.hub), pull))
    about = add(about, moment)
    to_road = sub(vec(wheel.r), vec(road.r))
    apply_wrench(wheel, total, at.hub, about)
    apply_wrench(road, scale(-1.0, total), add(to_road, at.hub), scale(-1.0, about))
    spin = sub(vec(wheel.w), vec(road.w))
    out.power += -F[0] * at.slip_x - F[1] * at.slip_y - dot(moment, spin)
    out.loss += old.store[i] - store if h > 0.0 else 0.0
    new.store[i] = store
    out.stored += store
    add_to(out.force, total)
    add_to(out.moment, about)
    out.normal += grip.F_z
    load(wheel, at.bottom, at.n, grip.slope, grip.damping)
    if p.road_node[i] > 0:
        load(road, add(to_road, at.bottom), at.n, grip.slope, grip.damping)
    load(wheel, at.foot, at.x, p.K_x, p.standstill_damping)
    load(wheel, at.foot, at.y, p.K_y, p.standstill_damping)


@kernel
def bound_step(p, nodes, curves, data):
    """A tyre off all roads bounds the step: nothing else shortens it before the next road, which
    it meets in a point of its circle, not of the road that is now below it. Writes: nodes.
    """
    at, wheel = patch_of(p, 0, nodes, curves, data), nodes[p.node]
    load(wheel, at.bottom, at.n, p.largest_slope, p.damping)
    load(wheel, at.bottom, at.x, p.K_x, p.standstill_damping)
    load(wheel, at.bottom, at.y, p.K_y, p.standstill_damping)


@kernel
def load(body, d, u, stiffness, damping):
    """Add the stiffness of a force along u in the point d to a body. Writes: body."""
    add_stiffness_bound(body, mobility(body, d, u), stiffness, damping)


@kernel
def show(out, at, grip, F, M_z, sliding):
    """Channels of the road pressed deepest. Writes: out."""
    if at.depth > out.depth:
        out.depth, out.longitudinal, out.lateral, out.aligning = at.depth, F[0], F[1], M_z
        out.slip, out.side_slip = grip.share * grip.s_x, grip.share * grip.s_y
        out.camber = asin(at.camber)
        out.sliding = sliding
