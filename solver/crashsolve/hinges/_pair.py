"""Two motions of one hinge: each by itself, or on an ellipse of both moments.

    uncoupled   both follow _law.py
    elliptic    M_1^2 / y_1^2 + M_2^2 / y_2^2 <= phi^2,   M_i = k_i (x_i - x_pi)
                dx_pi = dl M_i / (phi y_i)^2              (associated flow)

On the ellipse dl is plastic work. Both curves are read at the work done, W: y_i^2 is made of
straight lines over it, as dW = y dx. One motion alone thus follows its own curve, and equal curves
of both make one that is the same in every direction. A step is cut into pieces of a tenth of the
elastic range and the rest, each of which returns to the ellipse at its end (backward Euler,
order 1); the loss is the trapezoid of the moments over the plastic displacement.

Consequence to test: under a load that turns, the moments stay on the ellipse and the loss is the
work less the stored energy.

References: Simo and Hughes (1998), Computational Inelasticity, 2.3 and 3.3; ellipse: Powell and
Chen (1986), 3D beam-column element with generalized plastic hinges, ASCE J. Eng. Mech. 112,
627-641.
"""

from math import ceil, sqrt
from typing import NamedTuple

from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.hinges import _joint
from crashsolve.hinges._law import (
    ROUND_OFF,
    advance_motion,
    beyond_motion,
    factor,
    growth_slope,
    motion_tangent,
    overshoot,
    step_factor,
)

PAIR = Record("is_elliptic  flag  whether both moments share one ellipse")
WORK = Record("flow_work  J  W, plastic work at which elliptic curves are read")
# of the elastic range in one piece of a step, and most pieces
PIECE, MAX_PIECES = 0.1, 1000
ITERATIONS = 100


class Motions(NamedTuple):
    """Both motions of a hinge."""

    x: float  # from the undeformed hinge [rad or m]
    y: float
    rate: float  # of x
    across: float  # of y
    speed: float  # of the rate factor
    sizes: tuple[float, float]  # by which it fails [rad or m]


@kernel
def response(p, old, new, out, deformation, curves):
    """Both moments or forces [N m or N], 0 after failure, and phi [1]. Writes: new, out."""
    _joint.copy_history(old, new)
    new.flow_work = old.flow_work
    share = overshoot_pair(p, old, deformation.x, deformation.y, curves) if p.latched == 1 else 2.0
    phi = factor(p, old, new, deformation.speed, share)
    new.failed = 1 if _joint.fails(p, old, deformation.sizes[0], deformation.sizes[1]) else 0
    first, second, stored, loss = 0.0, 0.0, 0.0, 0.0
    if old.failed == 0:
        first, second, stored, loss = advance_pair(
            p, old, new, deformation.x, deformation.y, phi, curves
        )
    if new.failed == 1:
        first, second = 0.0, 0.0
    new.x[0], new.x[1] = deformation.x, deformation.y
    _joint.write_energies(p, old, new, out, stored, loss)
    return first, second, phi


@kernel
def advance_pair(p, old, new, x, y, phi, curves):
    """Both moments, stored energy and loss [J]. Writes: new, but for its common columns."""
    if p.is_elliptic == 1:
        return advance_ellipse(p, old, new, x, y, phi, curves)
    new.flow_work = old.flow_work
    first, stored, loss = advance_motion(p, old, new, 0, x, phi, curves)
    second, more, lost = advance_motion(p, old, new, 1, y, phi, curves)
    return first, second, stored + more, loss + lost


@kernel
def limits(p, work, phi, curves):
    """Squares of both yield moments [N^2 m^2 or N^2] with the factor, and their slopes over W."""
    a, da, _ = curve_value(curves, p.backbone[0], work)
    b, db, _ = curve_value(curves, p.backbone[2], work)
    return phi * phi * a, phi * phi * b, phi * phi * da, phi * phi * db


@kernel
def advance_ellipse(p, old, new, x, y, phi, curves):
    """Advance both motions on one ellipse. Writes: new."""
    k, j = p.stiffness[0], p.stiffness[1]
    u, v, work = old.plastic[0], old.plastic[1], old.flow_work
    a, b, _, _ = limits(p, work, phi, curves)
    dx, dy = x - old.x[0], y - old.x[1]
    increment = sqrt((k * dx) ** 2 / a + (j * dy) ** 2 / b)
    # a last piece that grows from nothing: their number makes no jumps, which iterations would meet
    piece = max(PIECE / max(increment, PIECE), 1.0 / MAX_PIECES)
    loss, done = 0.0, 0.0
    before, across = k * (old.x[0] - u), j * (old.x[1] - v)
    for i in range(int(ceil(1.0 / piece))):
        share = min((i + 1.0) * piece, 1.0)
        f, g = k * (old.x[0] + share * dx - u), j * (old.x[1] + share * dy - v)
        done = return_work(p, f, g, work, phi, curves)
        if done > 0.0:
            flow, a, b = scaled_flow(p, f, g, work, done, phi, curves)
            work += done
            f, g = f * a / (a + flow * k), g * b / (b + flow * j)
            du, dv = flow * f / a, flow * g / b
            loss += 0.5 * ((before + f) * du + (across + g) * dv)
            u, v = u + du, v + dv
            new.flow[0], new.flow[1] = new.flow[0] + abs(du), new.flow[1] + abs(dv)
        before, across = f, g
    new.x[0], new.x[1], new.plastic[0], new.plastic[1], new.flow_work = x, y, u, v, work
    new.plastic_flow[0] = new.plastic_flow[1] = 1 if done > 0.0 else 0
    first, second = k * (x - u), j * (y - v)
    return first, second, 0.5 * (first * (x - u) + second * (y - v)), loss


@kernel
def return_work(p, f, g, work, phi, curves):
    """Plastic work, over phi, of the return from trial moments to the ellipse; 0 if within.

    dl = 2 phi dW / (1 + r), r the old size of the ellipse over the new one along the trial moments:
    a trapezoid of the work, exact on a straight piece of the curve. Illinois method.
    """
    a, b, _, _ = limits(p, work, phi, curves)
    if f * f / a + g * g / b <= 1.0 + ROUND_OFF:
        return 0.0
    # trials may lead past the end of a curve, which only the answer must not
    fault = curves[0].fault
    low, at_low = 0.0, f * f / a + g * g / b - 1.0
    # where all of the trial energy went into flow, less than half of the ellipse would be left
    high = (f * f / p.stiffness[0] + g * g / p.stiffness[1]) / phi
    at_high = excess(p, f, g, work, high, phi, curves)
    while at_high > 0.0:
        low, at_low, high = high, at_high, 2.0 * high
        at_high = excess(p, f, g, work, high, phi, curves)
    done, side = low, 0
    for _ in range(ITERATIONS):
        before, done = done, low + (high - low) * at_low / (at_low - at_high)
        residual = excess(p, f, g, work, done, phi, curves)
        if residual > 0.0:
            low, at_low = done, residual
            at_high *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, at_high = done, residual
            at_low *= 0.5 if side == -1 else 1.0
            side = -1
        if abs(residual) <= 1e-15 or abs(done - before) <= 1e-14 * done:
            break
    curves[0].fault = fault
    return done


@kernel
def scaled_flow(p, f, g, work, done, phi, curves):
    """dl [J] for plastic work that is done, and the squares of both yield moments after it."""
    a, b, _, _ = limits(p, work, phi, curves)
    c, d, _, _ = limits(p, work + done, phi, curves)
    ratio = sqrt((f * f / c + g * g / d) / (f * f / a + g * g / b))
    return 2.0 * phi * done / (1.0 + ratio), c, d


@kernel
def excess(p, f, g, work, done, phi, curves):
    """Relative distance of the moments outside of the ellipse [1] after plastic work that is
    done [J].
    """
    flow, a, b = scaled_flow(p, f, g, work, done, phi, curves)
    c, d = a + flow * p.stiffness[0], b + flow * p.stiffness[1]
    return f * f * a / (c * c) + g * g * b / (d * d) - 1.0


@kernel
def tangent(p, state, deformation, curves):
    """Rows of the tangent: shares of both motions, stiffness and damping of each row.

    Of the ellipse: K^(1/2) (1 - z z^T / (1 + H / n K n)) K^(1/2), z along K^(1/2) n, n the normal
    over M: the flow, and the rest.
    """
    if state.failed == 1:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    x, y, rate, across, speed, _ = deformation
    phi, slope = step_factor(p, state, speed), growth_slope(p, speed)
    if p.is_elliptic == 0:
        k, _, _ = motion_tangent(p, state, 0, x, rate, phi, slope, curves)
        j, _, _ = motion_tangent(p, state, 1, y, across, phi, slope, curves)
        return (1.0, 0.0, k), (0.0, 1.0, j)
    k, j = p.stiffness[0], p.stiffness[1]
    f, g = k * (x - state.plastic[0]), j * (y - state.plastic[1])
    work = state.flow_work
    done = return_work(p, f, g, work, phi, curves)
    flow = scaled_flow(p, f, g, work, done, phi, curves)[0] if done > 0.0 else 0.0
    a, b, da, db = limits(p, work + done, phi, curves)
    f, g = f * a / (a + flow * k), g * b / (b + flow * j)
    at_yield = f * f / a + g * g / b > 1.0 - 1e-12
    onward = f / a * k * rate + g / b * j * across > 0.0
    if done == 0.0 and not (at_yield and onward and state.plastic_flow[0] == 1):
        return (1.0, 0.0, k), (0.0, 1.0, j)
    n, m = f / a, g / b
    stiff = k * n * n + j * m * m
    hardening = 0.5 * (n * n * da + m * m * db) / phi
    z, w = sqrt(k / stiff) * n, sqrt(j / stiff) * m
    left = hardening / (stiff + hardening)
    r, s = sqrt(k), sqrt(j)
    return (r * z, s * w, left), (-r * w, s * z, 1.0)


@kernel
def beyond(p, old, h, deformation, curves):
    """Distance beyond the branch of the law on which the step began [rad or m]."""
    if old.failed == 1:
        return -1e300
    failing = max(deformation.sizes[0] - p.failure[0], deformation.sizes[1] - p.failure[1])
    return max(beyond_yield(p, old, h, deformation, curves), failing)


@kernel
def beyond_yield(p, old, h, deformation, curves):
    """Distance beyond the branch of the law on which the step began, without failure [rad or m]."""
    x, y, rate, across, speed, _ = deformation
    phi = step_factor(p, old, speed)
    if p.is_elliptic == 0:
        first = beyond_motion(p, old, h, 0, x, rate, phi, curves)
        return max(first, beyond_motion(p, old, h, 1, y, across, phi, curves))
    k, j = p.stiffness[0], p.stiffness[1]
    a, b, _, _ = limits(p, old.flow_work, phi, curves)
    elastic = sqrt(a) / k
    f, g = k * (x - old.plastic[0]), j * (y - old.plastic[1])
    if old.plastic_flow[0] == 1:
        return -1e300 if h == 0.0 else -h * (f / a * k * rate + g / b * j * across) * elastic
    return (sqrt(f * f / a + g * g / b) - 1.0) * elastic


@kernel
def overshoot_pair(p, old, x, y, curves):
    """Share [1] of the step before static yield; above 1 where it is not met."""
    if p.is_elliptic == 0:
        return min(overshoot(p, old, 0, x, curves), overshoot(p, old, 1, y, curves))
    a, b, _, _ = limits(p, old.flow_work, 1.0, curves)
    k, j = p.stiffness[0], p.stiffness[1]
    f, g = k * (old.x[0] - old.plastic[0]), j * (old.x[1] - old.plastic[1])
    df, dg = k * (x - old.x[0]), j * (y - old.x[1])
    # (f + s df)^2 / a + (g + s dg)^2 / b = 1
    square, middle = df * df / a + dg * dg / b, f * df / a + g * dg / b
    left = 1.0 - f * f / a - g * g / b
    if square == 0.0 or square + 2.0 * middle <= left:
        return 2.0
    return max((sqrt(middle * middle + square * max(left, 0.0)) - middle) / square, 0.0)
