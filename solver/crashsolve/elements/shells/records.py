"""Named rows of the blocks of shell elements: their state and their work space.

A block holds sixteen elements side by side: each number is a row of lanes. Of a block that keeps
its numbers from step to step, BLOCK comes first, then the layers of every point of the plane, then
VISCOUS and EROSION where a part has them; WORK is scratch that all blocks share.
"""

from types import ModuleType
from typing import NamedTuple

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record, rows_of
from crashsolve.foundation.rows import Row

MAX_LAYERS = 10
BLOCK = rows_of(
    Record("""
        thickness          m       t; 0 of a deleted element
        inverse            1/m  4  inverse of the diagonals at the start, by rows
        gyration           m^2     squared radius of gyration of the mass at a corner
        mass               kg      of the element
        plastic_work       J       done so far
        hourglass_plane    N    2  Q_x and Q_y, against bending in the plane
        hourglass_bending  N m  2  P_x and P_y, of the curvatures
        shear_change       N    2  against the change of transverse shear
        shear              Pa   2  transverse shear stress
        drilling           N m     that ties spins about the normal to the rotation of the plane
        hourglass_work     J       done on the hourglass
    """)
)
# rows behind the layers where strains are damped or mass is added
VISCOUS = rows_of(
    Record("""
        resultant    N/m, N  6  N and M of damping
        work         J          energy it took
        mass_factor  1          mass with what is added over that without
    """)
)
# rows at the end of a block where elements may fail
EROSION = rows_of(
    Record("""
        energy   J  of the stresses lost
        kinetic  J  of the element when it was deleted
    """)
)
# of a layer beyond its yield stress, in its slot of WORK
_SLOT = Record("""
    trial     Pa         3  xi = sigma - alpha if nothing yields
    s1        Pa^2          of the sum of its normal parts
    s2        Pa^2          of the deviator, with transverse shear and hourglass
    g         1/Pa          plastic multiplier
    flow      Pa            yield stress
    slope     Pa            its slope by the plastic strain
    factor    1             of rate and temperature on it
    residual  Pa^2 or 1     what is beyond yield
    lost      J/m^3         plastic work of the step
    least     1/Pa          below the g of a yield stress that bends
    most      1/Pa          above it
""")
_STEP = Record("""
    position   m                   12  of the four corners
    velocity   m/s                 12  of the corners
    spin       rad/s               12  of the corners
    force      N                   12  on the corners
    torque     N m                 12  on the corners
    load       kg/s^2, kg m^2/s^2   2  squared frequency times mass, and times inertia, at a corner
    membrane   1                    3  strains of the step in the plane: xx, yy, twice xy
    curvature  1/m                  3  of the step
    resultant  N/m                  3  N: xx, yy, xy
    moment     N                    3  M: xx, yy, xy
    rate       1/s^2                   bound of the squared frequency
    area       m^2                     in the middle of the step
    depth      m                       thickness before the step
    modes      m                    4  motion of the step beyond a linear field: of the plane, of
                                       the turns
    diagonals  m                    4  of the element in its axes, in the middle of the step
    old_shear  Pa                   3  transverse shear and drilling before the step
    thinning   1                       strain across the thickness
    lost       J/m^2                   plastic work of the step
    dropped    J                       energy of the layers that fail
    growth     1                       largest stiffness over that without strain
""")
_SHEAR_RETURN = Record("""
    shear_square  Pa^2      three times the square of the trial transverse shear
    amplitude     N      4  a_x and a_y of the hourglass at all heights, and over the height
    mode_square   1/m^4  2  1 / (t r)^2
    relaxed       1      3  sums over the layers of k, k z and k z^2
    shear_factor  1         factor on the shear stiffness
    trial_shear   Pa     2  transverse shear if nothing yields
    yielding      index     numbers of the layers that yield, side by side
""")
_POINTS = Record("""
    middle         1, 1/m  6  strains and curvatures of the middle of the element
    sums           N/m, N  6  means of the resultants of the points
    xi_eta         N/m, N  8  the same less nu times those across, times xi and eta
    mean_thinning  1          of the points
    mean_lost      J/m^2      of the points
    mean_dropped   J          of the points
    mean_relaxed   1          of the points
""")
_BEFORE = _STEP + _SHEAR_RETURN
SLOT = rows_of(_SLOT, rows_of(_BEFORE).SIZE)
_SLOTS = Record(f"slots  1  {MAX_LAYERS * SLOT.SIZE}  of the layers that yield")
WORK = rows_of(_BEFORE + _SLOTS + _POINTS)


class Layer(NamedTuple):
    """One layer of a block at a point of the plane."""

    at: int  # where its numbers begin in the blocks
    zeta: float  # its position, -1 to 1
    weight: float  # of the rule, sum 2


class Law(NamedTuple):
    """Material of layers."""

    m: Row  # columns `material` of a part
    curves: np.ndarray  # those of the deck
    kernels: ModuleType  # the law's module


@kernel
def layer_of(p, first, k):
    """Layer k of those whose numbers begin at `first`."""
    return Layer(first + LANES * p.layer_rows * k, p.zeta[k], p.weight[k])
