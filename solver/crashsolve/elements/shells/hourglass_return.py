"""Transverse shear and hourglass of a shell, which yield with its layers.

Transverse shear tau is one number for all layers. Hourglass has in a layer at the
height z stresses whose mean squares over the element are those of

    s_x = a_x / (t r_x),   a_x = Q_x + 12 z / t^2 P_x,   r_x^2 = A int h_x^2,   likewise along y

with Q and P of the hourglass in the plane and in bending, and h_x the slopes of xi eta. A layer
yields by von Mises' stress of all of them, s_x^2 + s_y^2 + 3 tau^2 beside that of its plane, and
where it does all shrink by 1 / (1 + c2 g), as its own deviator: with the share n of the layer in t

    k = n (1 - 1 / (1 + c2 g)),   Q_x - sum k a_x,   P_x - sum k z a_x,   tau (1 - sum k)

The stress that ties spins to the plane shrinks as tau. Consequence to test: at large strain none of
them is beyond the yield stress.

References: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670. Zeng and Combescure (1998), A new one-point quadrature, general
non-linear quadrilateral shell element with physical stabilization, the same 42, 1307-1338.
"""

from crashsolve.elements.shells.forces.corners import four
from crashsolve.elements.shells.forces.quadrilateral import DRILLING, sides
from crashsolve.elements.shells.plasticity import relaxed_modes
from crashsolve.elements.shells.records import (
    BLOCK,
    WORK,
)
from crashsolve.foundation.kernels import blockwise, inlined
from crashsolve.foundation.point import LANES

# beside a square of the thickness [m^2], or that times one of a side [m^4]
NOTHING = 1e-60


@inlined
def mode_sizes(flat):
    """Squares of r_x and r_y."""
    a_x, a_y, b_x, b_y = sides(flat)
    return 4.0 / 3.0 * (a_y * a_y + b_y * b_y), 4.0 / 3.0 * (a_x * a_x + b_x * b_x)


@blockwise
def set_trial_shear(blocks, first, work):
    """Set the trial transverse shear, its square, and no hourglass. Writes: work."""
    for e in range(LANES):
        at = first + LANES * BLOCK.shear + e
        x, y = blocks[at], blocks[at + LANES]
        work[LANES * WORK.trial_shear + e], work[LANES * (WORK.trial_shear + 1) + e] = x, y
        work[LANES * WORK.shear_square + e] = 3.0 * (x * x + y * y)
        for k in range(6):
            work[LANES * (WORK.amplitude + k) + e] = 0.0


@blockwise
def set_trial_modes(blocks, first, work):
    """Set the trial hourglass stresses: a_x, a_y and their slopes over the height. Writes: work."""
    for e in range(LANES):
        # of a deleted element all of these are 0
        t, sizes = work[LANES * WORK.depth + e], mode_sizes(four(work, LANES * WORK.diagonals + e))
        over = 1.0 / (t * t + NOTHING)
        for k in range(2):
            at = first + LANES * (BLOCK.hourglass_plane + k) + e
            work[LANES * (WORK.amplitude + k) + e] = blocks[at]
            work[LANES * (WORK.amplitude + 2 + k) + e] = 12.0 * over * blocks[at + 2 * LANES]
            work[LANES * (WORK.mode_square + k) + e] = 1.0 / (t * t * sizes[k] + NOTHING)


@blockwise
def relax_modes(blocks, first, work):
    """Relax the hourglass stresses by yielding, and correct their work. Writes: blocks."""
    for e in range(LANES):
        less, relaxed = 0.0, relaxed_modes(work, e)
        for k in range(4):
            blocks[first + LANES * (BLOCK.hourglass_plane + k) + e] -= relaxed[k]
            less += 0.5 * relaxed[k] * work[LANES * (WORK.modes + k) + e]
        blocks[first + LANES * BLOCK.hourglass_work + e] -= less


@blockwise
def relax_shear(blocks, first, work, p):
    """Relax transverse shear and drilling by yielding; adds the loss [J]. Writes: blocks."""
    for e in range(LANES):
        at, old, relaxed = (
            first + LANES * BLOCK.shear + e,
            LANES * WORK.old_shear + e,
            work[LANES * WORK.relaxed + e],
        )
        volume = work[LANES * WORK.depth + e] * work[LANES * WORK.area + e]
        x, y, tie = blocks[at], blocks[at + LANES], blocks[at + 2 * LANES]
        left = 1.0 - relaxed
        blocks[at], blocks[at + LANES], blocks[at + 2 * LANES] = left * x, left * y, left * tie
        # the mean stress of the step times the plastic strain
        lost = (work[old] + left * x) * x + (work[old + LANES] + left * y) * y
        lost *= 1.2 / (work[LANES * WORK.shear_factor + e] + 1e-30) * volume
        lost += (work[old + 2 * LANES] + left * tie) * tie / (DRILLING * volume + 1e-300)
        blocks[first + LANES * BLOCK.plastic_work + e] += 0.5 * relaxed / p.shear * lost


@blockwise
def reset_shear_factor(work):
    """Set the shear factor of quadrilaterals to 1. Writes: work."""
    for e in range(LANES):
        work[LANES * WORK.shear_factor + e] = 1.0
