"""Layers of a shell: plane stress at points through the thickness, summed to resultants.

    N = t/2 sum w sigma,   M = t^2/4 sum w zeta sigma,   strain at zeta: eps + zeta t/2 kappa

with the points zeta in -1 ... 1 and weights w of a quadrature rule.
"""

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.point import LANES
from crashsolve.parts._quad_block import CURVATURE, DEPTH, LAYERS, MEMBRANE, MOMENT, RESULTANT


@kernel
def clear_resultants(work):
    """Writes: work."""
    for e in range(6 * LANES):
        work[LANES * RESULTANT + e] = 0.0


@kernel
def elastic_layer(blocks, first, row, work, p, zeta, weight):
    """Stress of a layer after the strains of a step, and its share of the resultants.

    Writes: blocks, work.
    """
    nu = p.poisson
    C = p.young / (1.0 - nu * nu)
    G = p.shear
    for e in range(LANES):
        t = work[LANES * DEPTH + e]
        z = 0.5 * t * zeta
        at, to = LANES * MEMBRANE + e, LANES * CURVATURE + e
        xx = work[at] + z * work[to]
        yy = work[at + LANES] + z * work[to + LANES]
        xy = work[at + 2 * LANES] + z * work[to + 2 * LANES]
        at = first + LANES * row + e
        s_xx = blocks[at] + C * (xx + nu * yy)
        s_yy = blocks[at + LANES] + C * (yy + nu * xx)
        s_xy = blocks[at + 2 * LANES] + G * xy
        blocks[at], blocks[at + LANES], blocks[at + 2 * LANES] = s_xx, s_yy, s_xy
        n = 0.5 * t * weight
        at, to = LANES * RESULTANT + e, LANES * MOMENT + e
        work[at] += n * s_xx
        work[at + LANES] += n * s_yy
        work[at + 2 * LANES] += n * s_xy
        work[to] += n * z * s_xx
        work[to + LANES] += n * z * s_yy
        work[to + 2 * LANES] += n * z * s_xy


@kernel
def elastic_layers(blocks, first, work, p):
    """All layers of a block of an elastic material. Writes: blocks, work."""
    clear_resultants(work)
    for k in range(p.layers):
        elastic_layer(blocks, first, LAYERS + 3 * k, work, p, p.zeta[k], p.weight[k])
