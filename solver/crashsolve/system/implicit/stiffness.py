"""Elements of shells within implicit steps: their state at the start, and their tangent matrix.

    K_ab = -df_a / dx_b,   at the end of the step, or at a stage of it, as iterated

An iteration strains the elements from their state at the start of the step to its end, or to one
of its stages as if that were a step of its own; the last stage is the end. Their
tangents (elements/shells/tangents) are those of the step as
it is computed, with the plastic return, the stress that stiffens, the rotation of the axes
and the middle of the step in which strains are measured. K is not symmetric: strains are those of
the middle of the step, forces those of its end, and the symmetric part alone has -E A theta^2 / 16
against a rotation by theta within the step, more than the bending stiffness.
"""

from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import vec


@kernel
def update_arms(nodes, scene):
    """Arms of the points that are part of a body, world axes. Writes: scene.arms."""
    for i in range(scene.attached_points.shape[0]):
        attached_point = scene.attached_points[i]
        arm = matvec(nodes[attached_point.node].A, vec(attached_point.spot))
        for k in range(3):
            # points attached to the ground do not rotate with it
            scene.arms[3 * attached_point.point + k] = arm[k] if attached_point.node > 0 else 0.0


@kernel
def save_blocks(scene):
    """Copy the blocks of elements at the start of a step. Writes: scene.lanes_before."""
    for i in range(scene.counts[0].numbers):
        scene.lanes_before[i] = scene.lanes[i]


@kernel
def restart_elements(h, clock, scene):
    """Restore the elements before a step of h; a sample leaves them. Writes: scene.lanes, clock."""
    clock.element_rate = 0.0
    restore_elements(h, scene)


@kernel
def restore_elements(h, scene):
    """Restore the elements before a step of h. Writes: scene.lanes."""
    if h > 0.0:
        for i in range(scene.counts[0].numbers):
            scene.lanes[i] = scene.lanes_before[i]
