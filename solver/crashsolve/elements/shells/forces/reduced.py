"""Four-node shell with one point in its plane: strains, stresses and forces of a step.

What one point cannot see is resisted by the stiffness of bending in the plane, of bending, and of
the assumed shear of the sides (quadrilateral.py); its energy is `hourglass`. Consequence to test:
any patch of elements holds constant strain and constant curvature.

References: those of the shell, and of quadrilateral.py.
"""

from crashsolve.elements.shells.energies import (
    drilling_energy,
    in_plane,
    layer_energy,
    shear_energy,
)
from crashsolve.elements.shells.forces.blocks import span_of_quadrilaterals
from crashsolve.elements.shells.forces.quadrilateral_block import corner_forces as corner_forces
from crashsolve.elements.shells.forces.quadrilateral_block import strain as strain
from crashsolve.elements.shells.hourglass_return import (
    relax_modes,
    relax_shear,
    set_trial_modes,
    set_trial_shear,
)
from crashsolve.elements.shells.layers import layers
from crashsolve.elements.shells.records import BLOCK
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES

CORNERS, POINTS = 4, 1


@kernel
def span(p):
    """The Span of these elements in a part."""
    return span_of_quadrilaterals(p, p.one_point)


@kernel
def stress(blocks, first, stride, work, h, p, curves, material):
    """Stresses after a step of h [s], and their resultants. Writes: blocks, work."""
    if p.yields == 1:
        set_trial_shear(blocks, first, work)
        set_trial_modes(blocks, first, work)
    if layers(blocks, first, stride, work, h, p, curves, material) > 0:
        relax_modes(blocks, first, work)
        relax_shear(blocks, first, work, p)


@kernel
def element_energy(p, blocks, at, d, e, material):
    """Elastic energy of the layers and shear, of the hourglass stresses, of drilling [J]."""
    t, _, area = in_plane(blocks, at, d, e)
    total = layer_energy(p, blocks, at + LANES * BLOCK.SIZE, material) + shear_energy(p, blocks, at)
    # after yielding the work on the hourglass is recoverable in part only: all of it is reported
    hourglass = blocks[at + LANES * BLOCK.hourglass_work]
    return area * t * total, hourglass, drilling_energy(p, blocks, at, t, area)
