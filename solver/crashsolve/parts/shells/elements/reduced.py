"""Four-node shell with one point in its plane: strains, stresses and forces of a step.

What one point cannot see is resisted by the stiffness of bending in the plane, of bending, and of
the assumed shear of the sides (quadrilateral.py); its energy is `hourglass`. Consequence to test:
any patch of elements holds constant strain and constant curvature.

References: those of the shell, and of quadrilateral.py.
"""

from crashsolve.foundation.kernels import apart, kernel
from crashsolve.foundation.point import LANES
from crashsolve.parts.shells.damping import allow, damp
from crashsolve.parts.shells.elements.corners import gather, note_rate, scatter, slow_corners
from crashsolve.parts.shells.elements.quadrilateral_block import push, strain
from crashsolve.parts.shells.energies import drilling_energy, in_plane, layer_energy, shear_energy
from crashsolve.parts.shells.erosion import (
    add_losses,
    delete,
    diagonal,
    has_failed,
    mute_forces,
    mute_strains,
)
from crashsolve.parts.shells.hourglass_return import (
    clear_weak,
    relax_modes,
    relax_shear,
    see_modes,
    see_shear,
)
from crashsolve.parts.shells.layers import grow_rate, layers
from crashsolve.parts.shells.records import BLOCK


@apart
def deform(p, clock, h, scene, material):
    """Strains, stresses and forces of the one-point elements of a part after a step of h.

    Writes: scene.points, lanes, work, clock.
    """
    done = 0
    clear_weak(scene.work)
    while done < p.one_point:
        first, corner = p.first + done // LANES * p.stride, p.first_corner + 4 * done
        live = min(LANES, p.one_point - done)
        respond(p, h, first, corner, scene, material)
        if material.VON_MISES and p.erodes == 1:
            erode(p, scene, first, corner, live, material)
        note_rate(clock, p.first_element + done, scene, first, live, 4)
        if p.slows == 1:
            slow_corners(scene, corner, p.aside, live, 4)
        scatter(scene.points, scene.corners, corner + p.aside, live, scene.work, 4)
        done += LANES


@kernel
def respond(p, h, first, corner, scene, material):
    """Forces and torques of a block on its corners after a step of h. Writes: scene.lanes, work."""
    blocks, work = scene.lanes, scene.work
    gather(scene.points, scene.corners, corner, work)
    strain(blocks, first, work, h, p)
    if p.erodes == 1:
        mute_strains(blocks, first, work)
    if p.yields == 1:
        see_shear(blocks, first, work)
        see_modes(blocks, first, work)
    if layers(blocks, first, p.stride, work, h, p, scene.curves, material) > 0:
        relax_modes(blocks, first, work)
        relax_shear(blocks, first, work, p)
    if p.slows == 1:
        damp(blocks, first, p.stride, work, h, p)
    push(blocks, first, work, p)
    if p.large_strain == 1:
        grow_rate(work)
    if p.slows == 1:
        allow(blocks, first, p.stride, work, h, p)
    if p.erodes == 1:
        mute_forces(blocks, first, work)


@kernel
def erode(p, scene, first, corner, live, material):
    """Delete the elements of a block that have failed. Writes: scene.lanes."""
    for e in range(live):
        if has_failed(scene.lanes, first + e, p, 1):
            d, c = diagonal(scene, corner + e, 2), diagonal(scene, corner + LANES + e, 2)
            stored, held, drilling = element_energy(p, scene.lanes, first + e, d, c, material)
            delete(scene, first, p.stride, corner, e, 4, stored + held + drilling)


@kernel
def add_energies(p, out, scene, material):
    """Energies of the one-point elements. Writes: out."""
    for i in range(p.one_point):
        lane = i % LANES
        at = p.first + i // LANES * p.stride + lane
        corner = p.first_corner + 4 * (i - lane) + lane
        add_losses(p, scene.lanes, at, p.stride, out)
        if scene.lanes[at + LANES * BLOCK.thickness] == 0.0:
            continue
        d, e = diagonal(scene, corner, 2), diagonal(scene, corner + LANES, 2)
        stretched, hourglass, drilling = element_energy(p, scene.lanes, at, d, e, material)
        out.strain += stretched
        out.hourglass += hourglass
        out.drilling += drilling


@kernel
def element_energy(p, blocks, at, d, e, material):
    """Elastic energy of the layers and shear, of the hourglass stresses, of drilling [J]."""
    t, _, area = in_plane(blocks, at, d, e)
    total = layer_energy(p, blocks, at + LANES * BLOCK.SIZE, material) + shear_energy(p, blocks, at)
    # what yields gives its work back in part only: that done on the hourglass is told
    held = blocks[at + LANES * BLOCK.hourglass_work]
    return area * t * total, held, drilling_energy(p, blocks, at, t, area)
