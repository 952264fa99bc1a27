"""Block after block through the elements of one kind: the columns of their tangents.

What is the same for all kinds. A kind is a module (`reduced`, `full`, `triangle`) that has the
CORNERS, `span` and `strain` of its elements (elements/blocks.py) and

    DAMPING                  where in `seen` the tangent of damping belongs
    stress                   stresses of a block after the step, and the tangents of its layers
    see                      what all columns need
    strain_by_position, _turn   change of the strains as a corner moves, or turns
    stress_by                change of the stresses with that of the strains
    push_by_position, _turn     change of the forces; push_at_rest: the forces themselves
"""

from crashsolve.elements.shells.damping import damp
from crashsolve.elements.shells.forces.corners import gather
from crashsolve.elements.shells.hourglass_return import clear_weak
from crashsolve.elements.shells.tangents.columns import (
    add_column,
    add_damping,
    rotate_corner,
    rotation_arms,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES


@kernel
def tangent(kind, p, h, scene, matrix, material):
    """Tangents of the elements of a kind in a part at the end of a step of h [s].

    Writes: matrix.blocks, scene.lanes, work, seen, change.
    """
    span, done, work = kind.span(p), 0, scene.work
    clear_weak(work)
    while done < span.count:
        first, corner = span.first + done // LANES * span.stride, span.corner + 4 * done
        gather(scene.points, scene.corners, corner, work)
        kind.strain(scene.lanes, first, work, h, p)
        kind.stress(first, span.stride, h, p, scene, material)
        if p.slows == 1:
            damp(scene.lanes, first, span.stride, work, h, p)
            add_damping(scene.seen, kind.DAMPING, work, h, p)
        kind.see(scene.lanes, scene.lanes_before, first, work, scene.seen, h)
        add_columns(kind, p, h, scene, matrix, corner, min(LANES, span.count - done))
        done += LANES


@kernel
def add_columns(kind, p, h, scene, matrix, corner, live):
    """All columns of a block into the matrix. Writes: matrix.blocks, scene.change."""
    seen, work, change = scene.seen, scene.work, scene.change
    if scene.counts[0].arms > 0:
        kind.push_at_rest(seen, change)
        rotation_arms(scene, matrix, change, corner, live, kind.CORNERS)
    for b in range(kind.CORNERS):
        for k in range(3):
            kind.strain_by_position(seen, change, b, k)
            kind.stress_by(seen, change, p)
            kind.push_by_position(seen, work, change, b, k)
            add_column(scene, matrix, change, corner, live, b, k, kind.CORNERS)
        for k in range(3):
            rotate_corner(work, change, b, k, h)
            kind.strain_by_rotation(seen, change, b)
            kind.stress_by(seen, change, p)
            kind.push_by_rotation(seen, change)
            add_column(scene, matrix, change, corner, live, b, 3 + k, kind.CORNERS)
