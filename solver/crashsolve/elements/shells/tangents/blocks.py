"""Block after block through the elements of one kind: the columns of their tangents.

Functions common to all kinds. A kind is a module (`reduced`, `full`, `triangle`) that has the
CORNERS, `span` and `strain` of its elements (elements/shells/forces/blocks.py) and

    DAMPING                                where in `base` the tangent of damping belongs
    stress                                 stresses of a block, and the tangents of its layers
    set_base                               the data common to all columns
    strain_by_position, _by_rotation       change of the strains with a motion of a corner
    stress_by                              change of the stresses with that of the strains
    corner_forces_by_position, _rotation   change of the forces with a motion of a corner
    corner_forces_by_stress                the forces of the present stresses
"""

from crashsolve.elements.shells.damping import damp
from crashsolve.elements.shells.forces.corners import gather
from crashsolve.elements.shells.hourglass_return import reset_shear_factor
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
    reset_shear_factor(work)
    while done < span.count:
        first, corner = span.first + done // LANES * span.stride, span.corner + 4 * done
        gather(scene.points, scene.corners, corner, work)
        kind.strain(scene.lanes, first, work, h, p)
        kind.stress(first, span.stride, h, p, scene, material)
        if p.is_damped == 1:
            damp(scene.lanes, first, span.stride, work, h, p)
            add_damping(scene.base, kind.DAMPING, work, h, p)
        kind.set_base(scene.lanes, scene.lanes_before, first, work, scene.base, h)
        add_columns(kind, p, h, scene, matrix, corner, min(LANES, span.count - done))
        done += LANES


@kernel
def add_columns(kind, p, h, scene, matrix, corner, live):
    """All columns of a block into the matrix. Writes: matrix.blocks, scene.change."""
    base, work, change = scene.base, scene.work, scene.change
    if scene.counts[0].arms > 0:
        kind.corner_forces_by_stress(base, change)
        rotation_arms(scene, matrix, change, corner, live, kind.CORNERS)
    for b in range(kind.CORNERS):
        for k in range(3):
            kind.strain_by_position(base, change, b, k)
            kind.stress_by(base, change, p)
            kind.corner_forces_by_position(base, work, change, b, k)
            add_column(scene, matrix, change, corner, live, b, k, kind.CORNERS)
        for k in range(3):
            rotate_corner(work, change, b, k, h)
            kind.strain_by_rotation(base, change, b)
            kind.stress_by(base, change, p)
            kind.corner_forces_by_rotation(base, change)
            add_column(scene, matrix, change, corner, live, b, 3 + k, kind.CORNERS)
