"""Tangent of the layers of a shell: how resultants change with the strains of a step.

    d sigma = C d eps - (C n + ...) dg,   dg from the yield condition, whose root g is

    dN = A d eps + B d kappa,   dM = B d eps + D d kappa,   A, B, D = int (1, z, z^2) C_t dz

C_t is the derivative of the return as it is computed (algorithmic, or consistent), so that Newton's
method keeps its order beyond yield. With a factor of the rate of strain on the yield stress it is
not symmetric. Consequence to test: it is the derivative of the resultants.

References: Simo and Taylor (1985), Consistent tangent operators for rate-independent
elastoplasticity, Computer Methods in Applied Mechanics and Engineering 48, 101-118. Simo and Taylor
(1986), A return mapping algorithm for plane stress elastoplasticity, Int. J. Num. Meth. Eng. 22.
"""

from math import exp, expm1, log, sqrt

from crashsolve.foundation.compile import blockwise, inlined
from crashsolve.foundation.point import LANES
from crashsolve.parts._layers import (
    ACROSS,
    FACTOR,
    METRIC,
    SLOPE,
    XI,
    YIELD,
    G,
    elastic_layer,
    hyperelastic_layer,
    layer_strain,
    plastic_layers,
    softening,
)
from crashsolve.parts._quad_block import DEPTH, three

# rows of the tangent of a point of the plane: A, B and D by rows of three, and what the mean strain
# across the thickness grows by with strains and with curvatures
A, B, D, THIN_STRAIN, THIN_BEND, POINT_ROWS = 0, 9, 18, 27, 30, 33


@blockwise
def clear_tangent(seen, at):
    """Writes: seen."""
    for row in range(POINT_ROWS * LANES):
        seen[at + row] = 0.0


@blockwise
def layers_and_tangent(blocks, kept, first, work, seen, at, h, p, curves):
    """Stresses of the layers at a point of the plane, their resultants, the tangent of these.

    `kept` is what layers were before the step. Writes: blocks, work, seen.
    """
    clear_tangent(seen, at)
    for k in range(p.layers):
        row, zeta, weight = first + LANES * p.layer_rows * k, p.zeta[k], p.weight[k]
        if p.hyper == 1:
            hyperelastic_layer(blocks, row, work, p, zeta, weight)
            add_hyperelastic(blocks, kept, row, work, seen, at, p, zeta, weight)
        elif p.plastic == 0:
            elastic_layer(blocks, row, work, p, zeta, weight)
            clear_flow(work)
            add_layer(work, seen, at, h, p, zeta, weight)
        else:
            clear_flow(work)
            plastic_layers(blocks, first, work, work, h, p, k, k + 1, curves)
            add_layer(work, seen, at, h, p, zeta, weight)


@blockwise
def clear_flow(work):
    """No layer yields yet. Writes: work."""
    for e in range(LANES):
        work[LANES * G + e], work[LANES * SLOPE + e] = 0.0, 0.0
        work[LANES * YIELD + e], work[LANES * FACTOR + e] = 1.0, 1.0


@inlined
def factor_slopes(d, factor, h, p):
    """Change of the factor on the yield stress with the strains of the step."""
    x, y, xy = d
    square = 4.0 / 3.0 * (x * x + y * y + x * y + 0.25 * xy * xy)
    rate = sqrt(square) / h + 1e-300
    if p.rate_D > 0.0:
        slope = (factor - 1.0) / (p.rate_q * rate)
    elif p.rate_C > 0.0:
        # the factor of temperature stays; below the rate of reference there is none of rate
        logs = log(max(rate / p.rate_0, 1.0))
        slope = factor / (1.0 + p.rate_C * logs) * p.rate_C / rate if logs > 0.0 else 0.0
    else:
        slope = 0.0
    k = slope / (rate * h * h) * 2.0 / 3.0
    return k * (2.0 * x + y), k * (2.0 * y + x), k * 0.5 * xy


@inlined
def flow_of(work, e, d, h, p, c1, c2):
    """g, the stress of the end less alpha as (sum, difference, shear), and slopes of g by strains.

    All slopes are 0 within yield.
    """
    g, flow, slope = work[LANES * G + e], work[LANES * YIELD + e], work[LANES * SLOPE + e]
    factor, (x, y, xy) = work[LANES * FACTOR + e], three(work, LANES * XI + e)
    u1, u2, u3 = 1.0 + c1 * g, 1.0 + c2 * g, 1.0 - 2.0 / 3.0 * slope * g
    both, apart, s = (x + y) / u1, (x - y) / u2, xy / u2
    size = flow / u3
    square = size * size
    falls = 0.5 * c1 / u1 * both * both + c2 / u2 * (1.5 * apart * apart + 6.0 * s * s)
    falls += 4.0 / 3.0 * square * slope / u3
    over = 1.0 / falls if g > 0.0 else 0.0
    f_x, f_y, f_s = factor_slopes(d, factor, h, p)
    k = 2.0 * square / (factor * u3)
    # of the trial stress: its sum and its difference
    p_1 = 0.5 * both / u1 * p.young / (1.0 - p.poisson)
    p_2, p_3 = 3.0 * apart / u2 * p.shear, 6.0 * s / u2 * p.shear
    by = (over * (p_1 + p_2 - k * f_x), over * (p_1 - p_2 - k * f_y), over * (p_3 - k * f_s))
    return (g, u1, u2), (both, apart, s), by


@inlined
def stress_slopes(g, stress, by, d, p, c1, c2):
    """Change of the stress, and of the strain across, for a change d of strain and by of g."""
    (g, u1, u2), (both, apart, s) = g, stress
    d_both = (p.young / (1.0 - p.poisson) * (d[0] + d[1]) - c1 * both * by) / u1
    d_apart = (2.0 * p.shear * (d[0] - d[1]) - c2 * apart * by) / u2
    d_s = (p.shear * d[2] - c2 * s * by) / u2
    moves = 2.0 / 3.0 * p.kinematic
    k = 1.0 + moves * g
    across = -p.poisson / p.young * (k * d_both + moves * by * both)
    across -= (by * both + g * d_both) / 3.0
    x = k * 0.5 * (d_both + d_apart) + moves * by * 0.5 * (both + apart)
    y = k * 0.5 * (d_both - d_apart) + moves * by * 0.5 * (both - apart)
    return x, y, k * d_s + moves * by * s, across


@inlined
def add_column(seen, at, column, n, z, s):
    """Share of a layer in A, B and D, of the stress and the strain across by one strain.

    Writes: seen.
    """
    for k in range(3):
        row = at + LANES * (3 * k + column)
        seen[row] += n * s[k]
        seen[row + LANES * B] += n * z * s[k]
        seen[row + LANES * D] += n * z * z * s[k]


@blockwise
def add_layer(work, seen, at, h, p, zeta, weight):
    """Tangent of an elastic or plastic layer after its return. Writes: seen."""
    c1, c2 = softening(p)
    for e in range(LANES):
        t = work[LANES * DEPTH + e]
        z, n = 0.5 * t * zeta, 0.5 * t * weight
        d = layer_strain(work, e, z)
        g, stress, by = flow_of(work, e, d, h, p, c1, c2)
        x = stress_slopes(g, stress, by[0], (1.0, 0.0, 0.0), p, c1, c2)
        y = stress_slopes(g, stress, by[1], (0.0, 1.0, 0.0), p, c1, c2)
        s = stress_slopes(g, stress, by[2], (0.0, 0.0, 1.0), p, c1, c2)
        add_column(seen, at + e, 0, n, z, x)
        add_column(seen, at + e, 1, n, z, y)
        add_column(seen, at + e, 2, n, z, s)
        add_across(seen, at + e, 0.5 * weight, z, (x[3], y[3], s[3]))


@inlined
def add_across(seen, at, n, z, across):
    """Share of a layer in the growth of the thickness. Writes: seen."""
    for k in range(3):
        seen[at + LANES * (THIN_STRAIN + k)] += n * across[k]
        seen[at + LANES * (THIN_BEND + k)] += n * z * across[k]


@blockwise
def add_hyperelastic(blocks, kept, at, work, seen, to, p, zeta, weight):
    """Tangent of a neo-Hookean layer after a step. Writes: seen."""
    for e in range(LANES):
        t = work[LANES * DEPTH + e]
        z, n = 0.5 * t * zeta, 0.5 * t * weight
        d, row = layer_strain(work, e, z), at + LANES * METRIC + e
        old, new = three(kept, row), three(blocks, row)
        across = blocks[at + LANES * ACROSS + e]
        x = hyper_slopes(old, new, across, d, (1.0, 0.0, 0.0), p)
        y = hyper_slopes(old, new, across, d, (0.0, 1.0, 0.0), p)
        s = hyper_slopes(old, new, across, d, (0.0, 0.0, 0.5), p)
        add_column(seen, to + e, 0, n, z, x)
        add_column(seen, to + e, 1, n, z, y)
        add_column(seen, to + e, 2, n, z, s)
        add_across(seen, to + e, 0.5 * weight, z, (x[3], y[3], s[3]))


@inlined
def hyper_slopes(old, new, across, d, more, p):
    """Change of the stress of a neo-Hookean layer, and of the strain across, with its strains.

    `more` is the change of the strains, its last that of xy, not of twice xy.
    """
    a, b, c = d[0], d[1], 0.5 * d[2]
    u, v, w = more
    # of exp(2 d) - 1 as it is taken
    xx, yy = 2.0 * (u + 2.0 * (a * u + c * w)), 2.0 * (v + 2.0 * (b * v + c * w))
    xy = 2.0 * (w + w * (a + b) + c * (u + v))
    x, y, s = old
    det = sqrt((1.0 + x) * (1.0 + y) - s * s)
    k = 1.0 / sqrt(2.0 + x + y + 2.0 * det)
    u, v, w = k * (1.0 + x + det), k * (1.0 + y + det), k * s
    o_1, o_2, o_3, o_4 = u * xx + w * xy, u * xy + w * yy, w * xx + v * xy, w * xy + v * yy
    d_x, d_y, d_s = o_1 * u + o_2 * w, o_3 * w + o_4 * v, o_1 * w + o_2 * v
    x, y, s = new
    square = 1.0 + x + y + x * y - s * s
    area = 0.5 * (d_x * (1.0 + y) + d_y * (1.0 + x) - 2.0 * s * d_s) / square
    thick = 2.0 * exp(2.0 * across)
    d_across = -p.volumetric * area / (p.shear * thick + p.volumetric)
    k, falls = p.shear * exp(-across) / sqrt(square), area + d_across
    rises, high = thick * d_across, expm1(2.0 * across)
    return (
        k * (d_x - rises - falls * (x - high)),
        k * (d_y - rises - falls * (y - high)),
        k * (d_s - falls * s),
        d_across,
    )
