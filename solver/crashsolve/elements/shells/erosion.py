"""Deletion of elements whose layers have all failed, and the energy lost by that.

An element is deleted when the plastic strain of all its layers has reached that of failure. Its
thickness is 0 from then on, and it keeps no stress. Its mass stays with its nodes, which fly on, so
that momentum is kept; the elastic energy of its last stresses is lost, and reported. Consequence to
test: kinetic, stored, plastic and eroded energy together are the work of the nodes.
"""

from crashsolve.elements.shells.damping import damping_row
from crashsolve.elements.shells.records import (
    BLOCK,
    EROSION,
    VISCOUS,
    WORK,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import dot, sub, vec
from crashsolve.materials._von_mises import LAYER


@kernel
def zero_strains(blocks, first, work):
    """Set the strains and stresses of deleted elements to zero.

    Writes: blocks, work.
    """
    for e in range(LANES):
        if blocks[first + LANES * BLOCK.thickness + e] == 0.0:
            for row in range(3):
                work[LANES * (WORK.membrane + row) + e] = 0.0
                work[LANES * (WORK.curvature + row) + e] = 0.0
            for row in range(4):
                work[LANES * (WORK.modes + row) + e] = 0.0
            for row in range(BLOCK.hourglass_plane, BLOCK.SIZE):
                blocks[first + LANES * row + e] = 0.0


@kernel
def zero_forces(blocks, first, work):
    """Set the forces of deleted elements, and their bounds of frequency, to zero. Writes: work."""
    for e in range(LANES):
        if blocks[first + LANES * BLOCK.thickness + e] == 0.0:
            for row in range(WORK.force, WORK.torque + 12):
                work[LANES * row + e] = 0.0
            work[LANES * WORK.rate + e] = 0.0


@kernel
def has_failed(blocks, at, p, points):
    """Whether all layers of an element that is not deleted have failed."""
    if blocks[at + LANES * BLOCK.thickness] == 0.0:
        return False
    strain = at + LANES * (BLOCK.SIZE + LAYER.plastic_strain)
    for k in range(points * p.layers):
        if blocks[strain + LANES * p.layer_rows * k] < p.material.failure:
            return False
    return True


@kernel
def delete(scene, first, stride, corner, e, sides, stored):
    """Delete an element with its `stored` energy [J]. Writes: scene.lanes."""
    blocks, at = scene.lanes, first + e
    lost, kinetic = at + stride - EROSION.SIZE * LANES, 0.0
    for c in range(sides):
        b = scene.points[scene.corners[corner + LANES * c + e]]
        kinetic += 0.5 * dot(vec(b.v), vec(b.v))
    blocks[lost] += stored
    blocks[lost + LANES] = blocks[at + LANES * BLOCK.mass] / sides * kinetic
    blocks[at + LANES * BLOCK.thickness] = 0.0
    for row in range(BLOCK.hourglass_plane, BLOCK.hourglass_work):
        blocks[at + LANES * row] = 0.0


@kernel
def add_losses(p, blocks, at, stride, out):
    """Add plastic work, losses by damping and by failure of an element to `out`. Writes: out."""
    out.plastic += blocks[at + LANES * BLOCK.plastic_work]
    if p.is_damped == 1:
        out.damping += blocks[damping_row(p, at, stride) + LANES * VISCOUS.work]
    if p.erodes == 1:
        lost = at + stride - EROSION.SIZE * LANES
        out.eroded += blocks[lost]
        if blocks[at + LANES * BLOCK.thickness] == 0.0:
            out.eroded_kinetic += blocks[lost + LANES]
            out.eroded_mass += blocks[at + LANES * BLOCK.mass]
            out.deleted += 1.0


@kernel
def diagonal(scene, corner, ahead):
    """Vector [m] from a corner to the one `ahead` of it."""
    a, b = scene.corners[corner], scene.corners[corner + ahead * LANES]
    return sub(vec(scene.points[b].r), vec(scene.points[a].r))
