"""Damping of shells: resultants from the rates of strain, which the layers do not remember.

    N += t (beta C eps_dot + q 1),   M += t^3/12 beta C kappa_dot,   C that of plane stress
    q = rho l (b_1 c + b_2^2 l |tr eps_dot| [tr eps_dot < 0]) tr eps_dot,   l = sqrt(A)
    omega -> omega (xi + sqrt(1 + xi^2)),   xi = beta omega / 2 + b_1 + b_2^2 l/c |tr eps_dot|

with c^2 = E / (rho (1 - nu^2)); the last line bounds the step, since the rate is
that of the half step before. Hourglass, and transverse shear, is not damped. The
rows lie behind those of the layers, in parts that have any of it. Consequence to test: energy lost
is the work of these resultants.

References: those of ../_damping.py.
"""

from math import sqrt

from crashsolve.elements.shells.records import (
    EROSION,
    VISCOUS,
    WORK,
)
from crashsolve.foundation.kernels import blockwise, kernel
from crashsolve.foundation.point import LANES


@kernel
def damping_row(p, first, stride):
    """Index of the rows of damping of a block of `stride` numbers."""
    behind = VISCOUS.SIZE + EROSION.SIZE if p.erodes == 1 else VISCOUS.SIZE
    return first + stride - LANES * behind


@blockwise
def damp(blocks, first, stride, work, h, p):
    """Add the resultants of damping to those of the layers. Writes: blocks, work."""
    at = damping_row(p, first, stride)
    # a step of no length has no rates: those of the last step stay
    if h > 0.0:
        for e in range(LANES):
            damping_resultants(blocks, at + e, work, e, h, p)
    for e in range(6 * LANES):
        work[LANES * WORK.resultant + e] += blocks[at + LANES * VISCOUS.resultant + e]


@blockwise
def damping_resultants(blocks, at, work, e, h, p):
    """Resultants of damping of an element, and the energy they take in the step.

    Writes: blocks.
    """
    t, area = work[LANES * WORK.depth + e], work[LANES * WORK.area + e]
    plane = p.young / (1.0 - p.poisson * p.poisson)
    m, k = LANES * WORK.membrane + e, LANES * WORK.curvature + e
    trace = (work[m] + work[m + LANES]) / h
    speed, size = sqrt(plane / p.density), sqrt(area)
    q = p.linear * speed - p.quadratic * size * min(trace, 0.0)
    q *= p.density * size * trace * t
    lost = 0.0
    for side in range(2):
        of = m if side == 0 else k
        stiff = p.damping * plane * t * (1.0 if side == 0 else t * t / 12.0) / h
        x, y, s = work[of], work[of + LANES], work[of + 2 * LANES]
        row = at + LANES * 3 * side
        n_x, n_y = stiff * (x + p.poisson * y), stiff * (y + p.poisson * x)
        n_s = stiff * 0.5 * (1.0 - p.poisson) * s
        if side == 0:
            n_x, n_y = n_x + q, n_y + q
        # nodes receive the mean of the resultants before and after the step
        lost += 0.5 * (n_x + blocks[row]) * x + 0.5 * (n_y + blocks[row + LANES]) * y
        lost += 0.5 * (n_s + blocks[row + 2 * LANES]) * s
        blocks[row], blocks[row + LANES], blocks[row + 2 * LANES] = n_x, n_y, n_s
    blocks[at + LANES * VISCOUS.work] += lost * area


@blockwise
def add_damping_to_bound(blocks, first, stride, work, h, p):
    """Correct the bound of squared frequency for damping and added mass. Writes: work."""
    at = damping_row(p, first, stride) + LANES * VISCOUS.mass_factor
    speed = sqrt(p.young / (p.density * (1.0 - p.poisson * p.poisson)))
    for e in range(LANES):
        omega = sqrt(work[LANES * WORK.rate + e] / blocks[at + e])
        m = LANES * WORK.membrane + e
        squeeze = -min(work[m] + work[m + LANES], 0.0) / h if h > 0.0 else 0.0
        xi = 0.5 * p.damping * omega + p.linear
        xi += p.quadratic * squeeze * sqrt(work[LANES * WORK.area + e]) / speed
        omega *= xi + sqrt(1.0 + xi * xi)
        work[LANES * WORK.rate + e] = omega * omega
