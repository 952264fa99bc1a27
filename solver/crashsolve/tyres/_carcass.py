"""Vertical force of a tyre, and deflection of its carcass along and across the wheel.

    q_dot + V q / sigma = -V_s,   |C q / sigma| <= 3 mu F_z,   s = (q - k_V / C V_s) / sigma

Where a patch slides all over, the deflection stays at its limit, and what the motion brings beyond
it is slid; k_V fades out towards that limit. Consequence to test: a locked wheel that slides
obliquely is braked against its motion, however different the stiffnesses and relaxation lengths of
both directions.

Reference: Pacejka (2012), Tire and Vehicle Dynamics, chapters 7 and 8.
"""

from math import cos, exp, pi, sqrt
from typing import NamedTuple

from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel


@kernel
def vertical_force(p, at, curves):
    """F_z [N], stored energy [J], power lost [W], stiffness [N/m], damping [N s/m]."""
    delta = at.depth
    if p.curve > 0:
        elastic, slope, _ = curve_value(curves, p.curve, delta)
        stored = curve_area(curves, p.curve, delta)
    else:
        elastic, slope, stored = p.stiffness * delta, p.stiffness, 0.5 * p.stiffness * delta * delta
    over = delta - p.rim_depth
    if over > 0.0:
        elastic += p.rim_stiffness * over
        stored += 0.5 * p.rim_stiffness * over * over
    share = min(delta / p.damping_depth, 1.0)
    c = p.damping * share * share * (3.0 - 2.0 * share)
    total = max(elastic + c * at.closing, 0.0)
    # the rim counts before it is met: nothing else shortens the step by then
    return total, stored, (total - elastic) * at.closing, max(slope, p.largest_slope), c


class Grip(NamedTuple):
    """Vertical force on a patch, deflection of the carcass, and forces of the brush model."""

    F_z: float  # [N], 0 off the road
    slope: float  # of F_z over the depth [N/m]
    damping: float  # of F_z over its rate [N s/m]
    q_x: float  # deflections [m]
    q_y: float
    s_x: float  # slips of the deflection [1]
    s_y: float
    share: float  # slip of the motion over that of the deflection, of a patch that slides
    mu: float  # friction at the present slip


@kernel
def grip_of(p, i, old, new, out, at, h, curves):
    """The Grip on road i after a step h. Writes: new, out."""
    # also within a step, in which it may pass a thin road and come out behind it
    if old.bottomed == 1 or at.depth + h * abs(at.closing) >= p.radius:
        new.bottomed = 1
    if old.roads_overlap == 1:
        new.roads_overlap = 1
    if at.depth <= 0.0:
        out.depth = max(out.depth, at.depth)
        return unloaded(p, i, old, out, h)
    F_z, stored, lost, slope, c = vertical_force(p, at, curves)
    out.stored += stored
    out.power += lost
    if F_z == 0.0:
        return unloaded(p, i, old, out, h)
    V = max(abs(at.V_x), abs(at.V_x - at.slip_x))
    q_x = relaxed(old.q_x[i], at.slip_x, V, p.sigma_x, h)
    q_y = relaxed(old.q_y[i], at.slip_y, V, p.sigma_y, h)
    # from 1 at rest to -1 at V_low
    slow = cos(pi * (V / p.low_speed)) if p.low_speed > V else -1.0
    now = sqrt(at.slip_x**2 + at.slip_y**2) / max(V, p.low_speed)
    mu = p.friction_max - (p.friction_max - p.friction_min) * min(now, 1.0)
    # the carcass of a patch that slides all over is not deflected further
    part_x, part_y, size = within(p, q_x, q_y, 3.0 * mu * F_z)
    s_x, s_y, share = q_x / p.sigma_x * part_x, q_y / p.sigma_y * part_y, 1.0
    q_x, q_y = q_x * part_x, q_y * part_y
    new.q_x[i], new.q_y[i] = q_x, q_y
    if size > 0.5:
        # where most of the patch slides: from there on the slip of the motion counts more and more
        w = 2.0 * size - 1.0
        excess = max(now / sqrt(s_x * s_x + s_y * s_y) - 1.0, 0.0)
        share += w * w * (3.0 - 2.0 * w) * excess
    if slow > -1.0:
        k_V = 0.5 * p.standstill_damping * (1.0 + slow) * (1.0 - size**4)
        s_x -= k_V / p.C_x * at.slip_x / p.sigma_x
        s_y -= k_V / p.C_y * at.slip_y / p.sigma_y
    # a wheel that leans to the right is pushed to the right
    s_y -= p.C_gamma / p.C_y * at.camber * 0.5 * (1.0 - slow)
    return Grip(F_z, slope, c, q_x, q_y, s_x, s_y, share, mu)


@kernel
def unloaded(p, i, old, out, h):
    """The Grip of a carcass without force, off the road or as it springs back. Writes: out."""
    out.loss += old.store[i] if h > 0.0 else 0.0
    return Grip(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, p.friction_max)


@kernel
def within(p, q_x, q_y, limit):
    """Parts of both deflections whose force C |q / sigma| is at most `limit` [N], and its share of
    that.

    What a patch slides is parallel to its friction, and that to the slips q / sigma: q less beta
    q / sigma is left, with beta >= 0 such that the force is the limit.
    """
    x, y = p.K_x * q_x, p.K_y * q_y
    square = x * x + y * y
    if square <= limit * limit:
        return 1.0, 1.0, sqrt(square) / limit
    if limit * limit <= 1e-24 * square:
        return 0.0, 0.0, 1.0
    a, b, beta = p.C_x * q_x, p.C_y * q_y, 0.0
    r_x, r_y = 1.0 / p.sigma_x, 1.0 / p.sigma_y
    # Newton's method on 1/size, which is straight where both sigma are the same
    for _ in range(12):
        beta += (sqrt(square) - limit) * square / (limit * (x * x * r_x + y * y * r_y))
        r_x, r_y = 1.0 / (p.sigma_x + beta), 1.0 / (p.sigma_y + beta)
        x, y = a * r_x, b * r_y
        square = x * x + y * y
        # 1e-4 of the force: friction lacks the third power of what is left
        if abs(square - limit * limit) <= 2e-4 * limit * limit:
            break
    return p.sigma_x * r_x, p.sigma_y * r_y, 1.0


@kernel
def relaxed(q, slip, V, sigma, h):
    """q after h at constant slip and speed [m]."""
    x = V / sigma * h
    if x < 0.1:
        # (1 - exp(-x))/x; the next term is x^9/10!
        mean = 1.0 - x * (1 / 8 - x * (1 / 72))
        mean = 1.0 - x * (1 / 6) * (1.0 - x * (1 / 7) * mean)
        mean = 1.0 - x * (1 / 4) * (1.0 - x * (1 / 5) * mean)
        mean = 1.0 - x * 0.5 * (1.0 - x * (1 / 3) * mean)
        return q * (1.0 - x * mean) - slip * h * mean
    decay = exp(-x)
    return q * decay - slip * h / x * (1.0 - decay)
