"""Layers of a shell: plane stress at points through the thickness, summed to resultants.

    N = t/2 sum w sigma,   M = t^2/4 sum w zeta sigma,   strain at zeta: eps + zeta t/2 kappa

with the points zeta in -1 ... 1 and weights w of a quadrature rule. Consequence to test: a linear
stress over the thickness has its exact N and M from two points on.
"""

from math import expm1

from crashsolve.elements.shells.plasticity import plastic_layers
from crashsolve.elements.shells.records import (
    BLOCK,
    EROSION,
    WORK,
    Law,
    layer_of,
)
from crashsolve.elements.shells.resultants import (
    add_resultants,
    clear_resultants,
    layer_strain,
    put_three,
)
from crashsolve.foundation.kernels import blockwise
from crashsolve.foundation.point import LANES


@blockwise
def add_layer(blocks, layer, work, h, law):
    """Stress of a layer after the strains of a step, added to the resultants.

    Writes: blocks, work.
    """
    (at, zeta, weight), (m, curves, material) = layer, law
    for e in range(LANES):
        t = work[LANES * WORK.depth + e]
        z = 0.5 * t * zeta
        d = layer_strain(work, e, z)
        stress, across, lost, growth = material.update(m, blocks, at + e, d, h, curves)
        put_three(blocks, at + e, stress)
        add_resultants(work, e, 0.5 * t * weight, z, stress)
        work[LANES * WORK.thinning + e] += 0.5 * weight * across
        if material.DISSIPATES:
            work[LANES * WORK.lost + e] += 0.5 * weight * t * lost
        if material.LARGE_STRAIN:
            work[LANES * WORK.growth + e] = max(work[LANES * WORK.growth + e], growth)


@blockwise
def layers(blocks, first, stride, work, h, p, curves, material):
    """Stresses of all layers of a block after a step of h, their resultants, the thickness.

    Returns how many layers yield somewhere. Writes: blocks, work.
    """
    if p.large_strain == 1:
        reset_growth(work)
    clear_resultants(work)
    start = first + LANES * BLOCK.SIZE
    count = through_thickness(blocks, start, work, h, p, curves, material)
    update_elements(blocks, first, stride, work, h, p)
    return count


@blockwise
def through_thickness(blocks, first, work, h, p, curves, material):
    """Stresses of the layers at one point of the plane of every element, added to the resultants.

    Returns how many layers yield by von Mises' stress somewhere. Writes: blocks, work.
    """
    law = Law(p.material, curves, material)
    # a step of no length changes nothing, for any rate
    if material.VON_MISES and h != 0.0:
        return plastic_layers(blocks, first, work, work, h, p, (0, p.layers), law)
    for k in range(p.layers):
        add_layer(blocks, layer_of(p, first, k), work, h, law)
    return 0


@blockwise
def update_elements(blocks, first, stride, work, h, p):
    """Update plastic work, energy lost by failure and thickness of elements after a step of h.

    Writes: blocks, work.
    """
    if p.dissipates == 1:
        for e in range(LANES):
            blocks[first + LANES * BLOCK.plastic_work + e] += (
                work[LANES * WORK.area + e] * work[LANES * WORK.lost + e]
            )
    if p.erodes == 1:
        for e in range(LANES):
            at = first + stride - EROSION.SIZE * LANES + e
            blocks[at] += work[LANES * WORK.dropped + e]
    if p.large_strain == 1:
        for e in range(LANES):
            work[LANES * WORK.thinning + e] = expm1(work[LANES * WORK.thinning + e])
    if p.thins == 1:
        for e in range(LANES):
            blocks[first + LANES * BLOCK.thickness + e] *= 1.0 + work[LANES * WORK.thinning + e]


@blockwise
def raise_frequency(work):
    """Raise the squared frequency by the growth of stiffness with strain. Writes: work."""
    for e in range(LANES):
        work[LANES * WORK.rate + e] *= work[LANES * WORK.growth + e]


@blockwise
def reset_growth(work):
    """Writes: work."""
    for e in range(LANES):
        work[LANES * WORK.growth + e] = 1.0
