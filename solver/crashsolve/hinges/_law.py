"""A slider that hardens or softens, in series with the elastic stiffness: one motion of a hinge.

    M = k (x - x_p),   |M| <= phi R in the direction s of flow,   x the angle, x_p the plastic one

    isotropic      R = y(alpha),   alpha = sum |dx_p|
    kinematic      R = Y_0 + s X(x_p),   X(x_p) = y(x_p) - Y_0 for x_p > 0, odd or of y_negative
    peak-oriented  R on the line from (x_0, 0) to the largest x_p so far in direction s, (x_r, y),
                   then y(s x_p);   x_0 is the x_p at which M last changed its sign
    rate           phi = 1 + a V^b where R > 0;   with V latched at first yield, or the present one

y(x_p) is the backbone of _backbone.py. A step goes straight from the old angle to the new one: the
new M is where the elastic line of that angle meets R, found to round-off, so that the answer
depends on the turning points of the angle and not on the steps between them. Work on the slider is
the area under R, exactly; stored is M^2 / 2k, and with kinematic hardening the area under X. What
phi adds is a trapezoid of it over the plastic displacement.

Consequence to test: over any path and any step, work = stored + lost; a closed loop loses its area.

References: Ambrosio (2003), Eq. 6-7 and Fig. 4; Simo and Hughes (1998), Computational Inelasticity,
1.2 to 1.6 (isotropic and kinematic); Clough and Johnston (1966), Effect of stiffness degradation on
earthquake ductility requirements, and Mahin and Bertero (1976), ASCE J. Struct. Div. 102 (peak-
oriented); Nikravesh, Chung and Benedict (1983), Computers and Structures 16, 395-400 (hinges).
"""

from typing import NamedTuple

from crashsolve.foundation.curve import curve_area, curve_value, segment
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

ISOTROPIC, KINEMATIC, PEAK_ORIENTED = 0, 1, 2
# share of the moments by which yield must be passed: less is round-off of the elastic line
ROUND_OFF = 1e-14
ITERATIONS = 100

LAW = Record("""
    stiffness         N m/rad or N/m  2  k of both motions
    backbone          index           4  y of both motions, in positive and negative direction
    cyclic            flag               ISOTROPIC, KINEMATIC or PEAK_ORIENTED
    initial           rad or m        2  motion from the start at which there is no moment
    failure           rad or m        2  motion at which the hinge fails; infinity for never
    is_apart          flag               whether failure frees the joint too
    rate_coefficient  1                  a
    rate_exponent     1                  b
    rate_floor        m/s or rad/s       speed at which phi = 1.1
    latched           flag               whether V is that at first yield
""")
PATH = Record("""
    x             rad or m      2  motion from the undeformed hinge
    speed         rad/s or m/s     V
    plastic       rad or m      2  x_p
    flow          rad or m      2  alpha
    reached       rad or m      4  largest x_p in positive and in negative direction of both motions
    origin        rad or m      2  x_0
    plastic_flow  flag          2  1 or -1: x_p grows or falls; 0: it rests
    corner        rad or m      2  plastic displacement to the end of the segment of y
    factor        1                phi
    latch         m/s or rad/s     V at first yield; -1 before
    failed        flag             1: there is no hinge any more
""")


class Flow(NamedTuple):
    """Flow of one motion in a step."""

    c: int  # which motion, 0 or 1
    side: float  # its direction
    displacement: float  # of the slider [rad or m]
    origin: float  # x_0 [rad or m]


@kernel
def resistance(p, old, c, side, displacement, origin, curves):
    """R [N m or N] after a plastic displacement in one direction, and its slope; `c`: motion 0 or
    1.
    """
    own = 2 * c if side > 0.0 else 2 * c + 1
    if p.cyclic == ISOTROPIC:
        y, slope, _ = curve_value(curves, p.backbone[own], old.flow[c] + displacement)
        return y, slope
    at = side * old.plastic[c] + displacement
    if p.cyclic == KINEMATIC:
        if at >= 0.0:
            y, slope, _ = curve_value(curves, p.backbone[own], at)
            return y, slope
        other = p.backbone[4 * c + 1 - own]
        y, slope, _ = curve_value(curves, other, -at)
        return curves[p.backbone[own]].c[0] + curves[other].c[0] - y, slope
    top = old.reached[own]
    if at < top:
        y = curve_value(curves, p.backbone[own], top)[0]
        slope = y / (top - side * origin)
        return slope * (at - side * origin), slope
    y, slope, _ = curve_value(curves, p.backbone[own], at)
    return y, slope


@kernel
def dynamic(R, phi):
    """phi R [N m or N] where it opposes the flow, else R."""
    return phi * R if R > 0.0 else R


@kernel
def line_origin(p, old, c, side):
    """x_0 [rad or m] of the line to the peak: the elastic line's zero, if M changes its sign."""
    before = side * p.stiffness[c] * (old.x[c] - old.plastic[c])
    return old.origin[c] if before > 0.0 else old.plastic[c]


@kernel
def direction(p, old, c, x, phi, curves):
    """Direction, 1 or -1, in which motion x [rad or m] makes the slider flow; 0 for none."""
    k = p.stiffness[c]
    for j in range(2):
        side = 1.0 - 2.0 * j
        trial = side * k * (x - old.plastic[c])
        if p.cyclic != KINEMATIC and trial <= 0.0:
            continue
        R, _ = resistance(p, old, c, side, 0.0, line_origin(p, old, c, side), curves)
        R = dynamic(R, phi)
        if trial - R > ROUND_OFF * (abs(trial) + abs(R)):
            return side
    return 0.0


@kernel
def plastic_displacement(p, old, c, side, x, phi, curves):
    """Step [rad or m] of the slider: k (x - x_p) = phi R by Newton's method within a bracket."""
    k, origin = p.stiffness[c], line_origin(p, old, c, side)
    trial = side * k * (x - old.plastic[c])
    R, _ = resistance(p, old, c, side, 0.0, origin, curves)
    low, high = 0.0, (trial - min(dynamic(R, phi), 0.0)) / k
    # trials may lead past the end of a curve, which only the answer must not
    displacement, fault = 0.0, curves[0].fault
    for _ in range(ITERATIONS):
        R, slope = resistance(p, old, c, side, displacement, origin, curves)
        excess = trial - k * displacement - dynamic(R, phi)
        if excess > 0.0:
            low = displacement
        else:
            high = displacement
        steep = k + (phi * slope if R > 0.0 else slope)
        following = displacement + excess / steep if steep > 0.0 else -1.0
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - displacement) <= 1e-16 * high:
            break
        displacement = following
    curves[0].fault = fault
    resistance(p, old, c, side, displacement, origin, curves)
    return displacement


@kernel
def hardened(p, c, x_p, curves):
    """Area under X up to x_p: the energy stored by kinematic hardening [J]."""
    if p.cyclic != KINEMATIC:
        return 0.0
    own = p.backbone[2 * c if x_p > 0.0 else 2 * c + 1]
    return curve_area(curves, own, abs(x_p)) - curves[own].c[0] * abs(x_p)


@kernel
def static_loss(p, old, flow, curves):
    """Area under R over the plastic displacement, less its stored part [J]."""
    c, side, displacement, origin = flow
    own = 2 * c if side > 0.0 else 2 * c + 1
    curve = p.backbone[own]
    if p.cyclic == ISOTROPIC:
        done = old.flow[c]
        return curve_area(curves, curve, done + displacement) - curve_area(curves, curve, done)
    if p.cyclic == KINEMATIC:
        return curves[curve].c[0] * displacement
    at, top = side * old.plastic[c], old.reached[own]
    end, loss = at + displacement, 0.0
    if at < top:
        y = curve_value(curves, curve, top)[0]
        slope, start, stop = y / (top - side * origin), at - side * origin, min(end, top)
        stop -= side * origin
        loss = 0.5 * slope * (stop - start) * (stop + start)
    if end > top:
        loss += curve_area(curves, curve, end) - curve_area(curves, curve, max(at, top))
    return loss


@kernel
def advance_motion(p, old, new, c, x, phi, curves):
    """Moment, stored energy and loss of one motion at x. Writes: new, but for its common columns.

    Returns M, stored, loss.
    """
    k, side = p.stiffness[c], direction(p, old, c, x, phi, curves)
    new.x[c] = x
    new.plastic[c], new.flow[c] = old.plastic[c], old.flow[c]
    new.reached[2 * c], new.reached[2 * c + 1] = old.reached[2 * c], old.reached[2 * c + 1]
    loss = 0.0
    if side != 0.0:
        displacement = plastic_displacement(p, old, c, side, x, phi, curves)
        origin = line_origin(p, old, c, side)
        flow = Flow(c, side, displacement, origin)
        loss = static_loss(p, old, flow, curves)
        if phi > 1.0:
            loss += added_loss(p, old, flow, loss, phi, curves)
        own = 2 * c if side > 0.0 else 2 * c + 1
        new.plastic[c] += side * displacement
        new.flow[c] += displacement
        new.reached[own] = max(new.reached[own], side * new.plastic[c])
    moment = k * (x - new.plastic[c])
    now = 1.0 if moment > 0.0 else -1.0
    new.origin[c] = line_origin(p, old, c, now)
    new.plastic_flow[c] = int(side)
    new.corner[c] = to_corner(p, new, c, side, curves) if side != 0.0 else 0.0
    stored = 0.5 * k * (x - new.plastic[c]) ** 2 + hardened(p, c, new.plastic[c], curves)
    return moment, stored, loss


@kernel
def added_loss(p, old, flow, static, phi, curves):
    """Additional work [J] on the slider by the rate factor, with its mean over the step."""
    c, side, displacement, origin = flow
    mean = 0.5 * (phi + old.factor) if old.plastic_flow[c] == int(side) else phi
    if p.cyclic != KINEMATIC:
        return (mean - 1.0) * static
    first, _ = resistance(p, old, c, side, 0.0, origin, curves)
    last, _ = resistance(p, old, c, side, displacement, origin, curves)
    return (mean - 1.0) * 0.5 * (max(first, 0.0) + max(last, 0.0)) * displacement


@kernel
def to_corner(p, new, c, side, curves):
    """Plastic displacement from here to the next corner of R [rad or m]."""
    own = 2 * c if side > 0.0 else 2 * c + 1
    if p.cyclic == ISOTROPIC:
        return next_point(curves, p.backbone[own], new.flow[c])
    at = side * new.plastic[c]
    if p.cyclic == PEAK_ORIENTED and at < new.reached[own]:
        return new.reached[own] - at
    if at >= 0.0:
        return next_point(curves, p.backbone[own], at)
    other = p.backbone[4 * c + 1 - own]
    # unloading along the other curve
    return -at - curves[segment(curves, other, curves[other].last, -at)].x


@kernel
def next_point(curves, point, at):
    """Displacement [rad or m] to the end of the segment of a curve; far where there is none."""
    last = curves[point].last
    i = segment(curves, point, last, at)
    return curves[i + 1].x - at if curves[i + 1].x > at else 1e300


@kernel
def motion_tangent(p, state, c, x, rate, phi, phi_slope, curves):
    """Slopes of the moment over the motion [N m/rad or N/m] and over V; direction of flow."""
    k = p.stiffness[c]
    side = direction(p, state, c, x, phi, curves)
    if side == 0.0:
        side = at_yield(p, state, c, x, rate, phi, curves)
    if side == 0.0:
        return k, 0.0, 0.0
    origin = line_origin(p, state, c, side)
    displacement = plastic_displacement(p, state, c, side, x, phi, curves)
    R, slope = resistance(p, state, c, side, displacement, origin, curves)
    lifted = phi if R > 0.0 else 1.0
    share = k / (k + lifted * slope)
    return share * lifted * slope, share * max(R, 0.0) * phi_slope, side


@kernel
def at_yield(p, state, c, x, rate, phi, curves):
    """Direction, 1 or -1, in which it flows on at yield, but for round-off; 0 for none."""
    k = p.stiffness[c]
    side = 1.0 if rate > 0.0 else -1.0
    if rate == 0.0 or state.plastic_flow[c] != int(side):
        return 0.0
    trial = side * k * (x - state.plastic[c])
    R, _ = resistance(p, state, c, side, 0.0, line_origin(p, state, c, side), curves)
    R = dynamic(R, phi)
    return side if trial - R > -1e-12 * (abs(trial) + abs(R)) else 0.0


@kernel
def beyond_motion(p, old, h, c, x, rate, phi, curves):
    """Distance of a motion beyond the branch of the law on which the step began [rad or m].

    A load step (h = 0) has no rates: one that turns back does so from its start on.
    """
    side = 1.0 * old.plastic_flow[c]
    if side == 0.0:
        return max(
            beyond_yield(p, old, c, 1.0, x, phi, curves),
            beyond_yield(p, old, c, -1.0, x, phi, curves),
        )
    displacement = plastic_displacement(p, old, c, side, x, phi, curves)
    if h > 0.0:
        return max(-side * rate * h, displacement - old.corner[c])
    if displacement > 0.0:
        return displacement - old.corner[c]
    return beyond_yield(p, old, c, -side, x, phi, curves)


@kernel
def beyond_yield(p, old, c, side, x, phi, curves):
    """Distance of a motion beyond the elastic line in one direction [rad or m]."""
    R, _ = resistance(p, old, c, side, 0.0, line_origin(p, old, c, side), curves)
    # without resistance there is nothing to meet, but the line to a peak where M turns
    is_rising = p.cyclic == PEAK_ORIENTED and side * (old.x[c] - old.plastic[c]) < 0.0
    if p.cyclic == KINEMATIC or R > 0.0 or is_rising:
        return side * (x - old.plastic[c]) - dynamic(R, phi) / p.stiffness[c]
    return -1e300


@kernel
def growth(p, speed):
    """phi [1] at a speed [m/s or rad/s]."""
    if p.rate_coefficient == 0.0:
        return 1.0
    return 1.0 + p.rate_coefficient * speed**p.rate_exponent


@kernel
def growth_bound(p, speed):
    """Bound of its slope [s/m or s/rad], which may be vertical at 0: the secant from phi = 1.1."""
    if p.rate_coefficient == 0.0 or p.latched == 1:
        return 0.0
    b = p.rate_exponent
    return max(b, 1.0) * p.rate_coefficient * max(speed, p.rate_floor) ** (b - 1.0)


@kernel
def growth_slope(p, speed):
    """Slope of the rate factor [s/m or s/rad]; near rest, where a power below 1 is vertical, that
    at a small rate.
    """
    if p.rate_coefficient == 0.0 or p.latched == 1:
        return 0.0
    b = p.rate_exponent
    at = max(speed, 1e-3 * p.rate_floor) if b < 1.0 else speed
    return p.rate_coefficient * b * at ** (b - 1.0)


@kernel
def overshoot(p, old, c, x, curves):
    """Share [1] of the step before static yield; above 1 where it is not met."""
    k, before = p.stiffness[c], old.x[c] - old.plastic[c]
    now, share = x - old.plastic[c], 2.0
    for j in range(2):
        side = 1.0 - 2.0 * j
        R, _ = resistance(p, old, c, side, 0.0, old.plastic[c], curves)
        start, end = side * k * before, side * k * now
        if end > R:
            share = min(share, max((R - start) / (end - start), 0.0) if end > start else 0.0)
    return share


@kernel
def factor(p, old, new, speed, share):
    """phi [1] of this step; `share` of the step is before static yield. Writes: new.

    A speed that is latched is that at first yield, on the straight line over the step.
    """
    new.speed = speed
    new.latch = old.latch
    if p.rate_coefficient == 0.0:
        new.factor = 1.0
    elif p.latched == 0:
        new.factor = growth(p, speed)
    else:
        if old.latch < 0.0 and share <= 1.0:
            new.latch = old.speed + share * (speed - old.speed)
        new.factor = growth(p, new.latch) if new.latch >= 0.0 else 1.0
    return new.factor


@kernel
def step_factor(p, state, speed):
    """phi [1] from an accepted state."""
    if p.latched == 0:
        return growth(p, speed)
    return growth(p, state.latch) if state.latch >= 0.0 else 1.0
