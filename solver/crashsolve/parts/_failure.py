"""Elements whose layers have all failed: deleted, with what is lost by that.

An element is deleted when the plastic strain of all its layers has reached that of failure. Its
thickness is 0 from then on, and it keeps no stress. Its mass stays with its nodes, which fly on, so
that momentum is kept; the elastic energy of its last stresses is lost, and told. Consequence to
test: kinetic, stored, plastic and eroded energy together are the work of the nodes.
"""

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import dot, sub, vec
from crashsolve.parts._layers import FAILED_ROWS, STRAIN
from crashsolve.parts._quad_block import (
    CURVATURE,
    DRILL,
    LAYERS,
    LOSS,
    MEMBRANE,
    MODES,
    PLANE_Q,
    RATE,
    THICKNESS,
    WEIGHT,
)
from crashsolve.parts._viscous import TAKEN, slow_row


@kernel
def mute_strains(blocks, first, work):
    """Deleted elements have no strains or stresses, whatever becomes of their shape.

    Writes: blocks, work.
    """
    for e in range(LANES):
        if blocks[first + LANES * THICKNESS + e] == 0.0:
            for row in range(3):
                work[LANES * (MEMBRANE + row) + e] = 0.0
                work[LANES * (CURVATURE + row) + e] = 0.0
            for row in range(4):
                work[LANES * (MODES + row) + e] = 0.0
            for row in range(PLANE_Q, LAYERS):
                blocks[first + LANES * row + e] = 0.0


@kernel
def mute_forces(blocks, first, work):
    """Deleted elements push nothing and set no step. Writes: work."""
    for e in range(LANES):
        if blocks[first + LANES * THICKNESS + e] == 0.0:
            for row in range(24):
                work[LANES * row + e] = 0.0
            work[LANES * RATE + e] = 0.0


@kernel
def has_failed(blocks, at, p, points):
    """Whether an element that lives has no layer left."""
    if blocks[at + LANES * THICKNESS] == 0.0:
        return False
    for k in range(points * p.layers):
        if blocks[at + LANES * (LAYERS + p.layer_rows * k + STRAIN)] < p.failure:
            return False
    return True


@kernel
def delete(scene, first, stride, corner, e, sides, stored):
    """Take an element of so many sides out, with what is stored in it. Writes: scene.lanes."""
    blocks, at = scene.lanes, first + e
    lost, kinetic = at + stride - FAILED_ROWS * LANES, 0.0
    for c in range(sides):
        b = scene.points[scene.corners[corner + LANES * c + e]]
        kinetic += 0.5 * dot(vec(b.v), vec(b.v))
    blocks[lost] += stored
    blocks[lost + LANES] = blocks[at + LANES * WEIGHT] / sides * kinetic
    blocks[at + LANES * THICKNESS] = 0.0
    for row in range(PLANE_Q, DRILL + 1):
        blocks[at + LANES * row] = 0.0


@kernel
def add_losses(p, blocks, at, stride, out):
    """Plastic work of an element, what damping took, what went with its failure. Writes: out."""
    out.plastic += blocks[at + LANES * LOSS]
    if p.slows == 1:
        out.damping += blocks[slow_row(p, at, stride) + LANES * TAKEN]
    if p.failure > 0.0:
        lost = at + stride - FAILED_ROWS * LANES
        out.eroded += blocks[lost]
        if blocks[at + LANES * THICKNESS] == 0.0:
            out.eroded_kinetic += blocks[lost + LANES]
            out.eroded_mass += blocks[at + LANES * WEIGHT]
            out.deleted += 1.0


@kernel
def diagonal(scene, corner, ahead):
    """From a corner to the one `ahead` of it."""
    a, b = scene.corners[corner], scene.corners[corner + ahead * LANES]
    return sub(vec(scene.points[b].r), vec(scene.points[a].r))
