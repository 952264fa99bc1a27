"""Strains of the layers of a shell, and their shares in the resultants."""

from crashsolve.elements.shells.records import (
    WORK,
)
from crashsolve.foundation.kernels import blockwise, inlined
from crashsolve.foundation.point import LANES


@blockwise
def clear_resultants(work):
    """Writes: work."""
    for e in range(6 * LANES):
        work[LANES * WORK.resultant + e] = 0.0
    for e in range(LANES):
        work[LANES * WORK.thinning + e] = 0.0
        work[LANES * WORK.lost + e] = 0.0
        work[LANES * WORK.dropped + e] = 0.0
        for k in range(3):
            work[LANES * (WORK.relaxed + k) + e] = 0.0


@inlined
def layer_strain(work, e, z):
    """Strain of the step at the height z."""
    at, to = LANES * WORK.membrane + e, LANES * WORK.curvature + e
    return (
        work[at] + z * work[to],
        work[at + LANES] + z * work[to + LANES],
        work[at + 2 * LANES] + z * work[to + 2 * LANES],
    )


@inlined
def add_resultants(work, e, n, z, s):
    """Share of a layer in the resultants. Writes: work."""
    at, to = LANES * WORK.resultant + e, LANES * WORK.moment + e
    work[at] += n * s[0]
    work[at + LANES] += n * s[1]
    work[at + 2 * LANES] += n * s[2]
    work[to] += n * z * s[0]
    work[to + LANES] += n * z * s[1]
    work[to + 2 * LANES] += n * z * s[2]


@inlined
def put_three(slots, at, s):
    """Writes: slots."""
    slots[at], slots[at + LANES], slots[at + 2 * LANES] = s
