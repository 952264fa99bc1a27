"""Yield of a finite segment: tension and both bending moments on one ellipse.

    (N / A)^2 + (M_y / Z_y)^2 + (M_z / Z_z)^2 <= Y(e)^2 (1 + (rate / D)^(1/q))^2

rate is that of the plastic strain e over the step. The return to it is one step of backward Euler;
the loss in a step is the mean force times the plastic displacement, because bodies
receive the mean of the forces before and after it.

References: Powell and Chen (1986), ASCE J. Eng. Mech. 112, 627-641; Simo and Hughes (1998),
Computational Inelasticity, 3.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.materials import elastoplastic

ITERATIONS = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14
# in load steps, which have no length: no step, as in runs in time; flow; keep the flow so far
NO_STEP, FLOWS, FROZEN = 0, 1, 2


@kernel
def resisting(p, old, new, h, q, curves):
    """N, M_y, M_z, their stored energy and the loss in the step. Writes: new.

    `q` is the stretch and both bends [m, rad].
    """
    k = (p.stiffness[0], p.rotational_stiffness[1], p.rotational_stiffness[2])
    for i in range(3):
        new.plastic[i] = new.plastic[i] if p.at_rest == FROZEN else old.plastic[i]
    trial = (
        k[0] * (q[0] - new.plastic[0]),
        k[1] * (q[1] - new.plastic[1]),
        k[2] * (q[2] - new.plastic[2]),
    )
    flow, share = 0.0, 0.0
    if p.yields == 1 and (h > 0.0 or p.at_rest == FLOWS):
        flow, share = growth(p, k, trial, old.strain, 1.0, h, curves)
    new.strain = old.strain + flow / p.volume
    resultant = scaled_back(p, k, trial, share)
    stored, lost = 0.0, 0.0
    for i in range(3):
        new.plastic[i] += (trial[i] - resultant[i]) / k[i]
        stored += 0.5 * resultant[i] * resultant[i] / k[i]
        # bodies receive the mean of the forces before and after the step
        lost += 0.5 * (old.resultant[i] + resultant[i]) * (trial[i] - resultant[i]) / k[i]
        new.resultant[i] = resultant[i]
    return resultant, stored, lost


@kernel
def scaled_back(p, k, trial, share):
    """Trial forces returned to the ellipse: F = trial / (1 + share k / Z^2)."""
    return (
        trial[0] / (1.0 + share * k[0] / p.moduli[0] ** 2),
        trial[1] / (1.0 + share * k[1] / p.moduli[1] ** 2),
        trial[2] / (1.0 + share * k[2] / p.moduli[2] ** 2),
    )


@kernel
def growth(p, k, trial, strain, factor, h, curves):
    """Plastic work over stress in a step [m^3], and the same over stress; 0 within the ellipse.

    Newton's method on 1 / |F / Z| over Y, which is concave in the flow, and linear for one force.
    With a length of the step the flow has a rate; without one, `factor` stands for it.
    """
    flow, share, is_rated = 0.0, 0.0, p.rate_D > 0.0 and h > 0.0
    if is_rated:
        flow = first_flow(p, k, trial, strain, h, curves)
    for _ in range(ITERATIONS):
        stress, slope = yield_stress(p, strain, flow, factor, h if is_rated else 0.0, curves)
        size, steep = 0.0, 0.0
        for i in range(3):
            s, c = trial[i] / p.moduli[i], k[i] / p.moduli[i] ** 2
            x = stress + flow * c
            size += (s / x) ** 2
            steep += s * s * (slope + c) / x**3
        share = flow / stress
        is_closed = size <= 1.0 + CLOSE and (flow == 0.0 or size >= 1.0 - CLOSE)
        if is_closed or not steep > 0.0:
            break
        size = sqrt(size)
        ahead = max(0.5 * flow, flow + (1.0 - 1.0 / size) * size**3 / steep)
        if not is_rated and ahead <= flow:
            break
        flow = ahead
    return flow, share


@kernel
def first_flow(p, k, trial, strain, h, curves):
    """A first flow, for a stress linear in the rate; 0 within the ellipse."""
    Y, _ = elastoplastic.flow(p, strain, curves)
    square, steep = 0.0, 0.0
    for i in range(3):
        s, c = trial[i] / (p.moduli[i] * Y), k[i] / p.moduli[i] ** 2
        square += s * s
        steep += s * s * c / Y
    if not square > 1.0:
        return 0.0
    size = sqrt(square)
    at_once = (size - 1.0) * square / steep
    slowed = p.volume * h * elastoplastic.rate_of(p, size)
    return at_once / (1.0 + at_once / (slowed + 1e-300))


@kernel
def yield_stress(p, strain, flow, factor, h, curves):
    """Yield stress [Pa] after a flow [m^3] in a step of h, 0 for none, and its slope by that."""
    stress, slope = elastoplastic.flow(p, strain + flow / p.volume, curves)
    rate = flow / (p.volume * h) if h > 0.0 else 0.0
    if not rate > 0.0:
        return factor * stress, factor * slope / p.volume
    factor *= elastoplastic.rate_factor(p, rate)
    faster, _ = elastoplastic.rate_slopes(p, rate, factor)
    return factor * stress, (factor * slope + stress * faster / h) / p.volume


@kernel
def factor_of(p, rate):
    """Factor [1] on the yield stress at rates of stretch and bends [m/s, rad/s]."""
    if p.rate_D == 0.0:
        return 1.0
    A, per = p.moduli[0], 1.0 / p.length
    bend_y, bend_z = p.moduli[1] / A * rate[1], p.moduli[2] / A * rate[2]
    strained = per * sqrt(rate[0] * rate[0] + bend_y * bend_y + bend_z * bend_z)
    return 1.0 + (strained / p.rate_D) ** (1.0 / p.rate_q)


@kernel
def softened(p, k, trial, flow, share, strain, factor, curves):
    """Derivatives of N, M_y, M_z by stretch and rotations while they flow (upper half, 6).

    dF = (diag(k s) - b b^T / B) dq,   s = 1 / (1 + share k / Z^2),   b = F s k / Z^2,
    B = sum F b / Z^2 + Y^2 Y' / (1 - Y' share), Y' per flow.
    """
    stress, slope = elastoplastic.flow(p, strain + flow / p.volume, curves)
    stress, slope = factor * stress, factor * slope / p.volume
    resultant = scaled_back(p, k, trial, share)
    s_0 = k[0] / (1.0 + share * k[0] / p.moduli[0] ** 2)
    s_1 = k[1] / (1.0 + share * k[1] / p.moduli[1] ** 2)
    s_2 = k[2] / (1.0 + share * k[2] / p.moduli[2] ** 2)
    b_0 = resultant[0] * s_0 / p.moduli[0] ** 2
    b_1 = resultant[1] * s_1 / p.moduli[1] ** 2
    b_2 = resultant[2] * s_2 / p.moduli[2] ** 2
    B = stress * stress * slope / (1.0 - slope * share)
    B += resultant[0] * b_0 / p.moduli[0] ** 2
    B += resultant[1] * b_1 / p.moduli[1] ** 2 + resultant[2] * b_2 / p.moduli[2] ** 2
    return (
        s_0 - b_0 * b_0 / B,
        -b_0 * b_1 / B,
        -b_0 * b_2 / B,
        s_1 - b_1 * b_1 / B,
        -b_1 * b_2 / B,
        s_2 - b_2 * b_2 / B,
    )
