"""Elements of shells: first kick and drift of their points, forces, second kick.

With several threads each of these is a job in pieces (`pieces.py`). Implicit methods move points
with the nodes, and ask for forces and tangents alone.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system import points, ties
from crashsolve.system.implicit import stiffness
from crashsolve.system.loops.pieces import collect_in_pieces, deform_part, share
from crashsolve.system.placeholders import ASSEMBLED, ELEMENTS, THREADS, TIES
from crashsolve.threads import jobs


@stage
def move_elements(clock, h, nodes, scene):
    """Motion of the points, and forces of the elements between them. Writes: scene.points."""
    if ASSEMBLED:
        points.move_attached(h, nodes, scene.points, scene.attached_points)
        elements(clock, h, scene)
    else:
        open_points(clock, h, scene)
        points.move_attached(h, nodes, scene.points, scene.attached_points)
        if TIES:
            ties.carry_tied(h, scene.points, scene.ties)
        clock.element_rate = 0.0
        if THREADS:
            limit = clock.limit_element
            share(jobs.DEFORM, scene.pieces.shape[0], clock, h, scene)
            collect_in_pieces(0, scene.pieces.shape[0], clock, h, scene)
            jobs.note_rates(clock, limit, scene)
        else:
            deform(clock, h, scene)


@stage
def move_points(clock, h, nodes, scene):
    """Second kick of the points, at the end of a force pass. Writes: scene.points, nodes."""
    if ASSEMBLED:
        points.transfer_attached_reactions(nodes, scene.points)
        points.transfer_to_bodies(clock, nodes, scene.points, scene.attached_points)
        points.transfer_own_reactions(nodes, scene.points, scene.attached_points)
    else:
        if TIES:
            ties.unload_tied(scene.points, scene.ties)
        points.transfer_to_bodies(clock, nodes, scene.points, scene.attached_points)
        points.transfer_reactions(nodes, scene.points, scene.holds)
        close_points(clock, h, scene)


@kernel
def elements(clock, h, scene):
    """Forces after a step of h from the state of the elements before it. Writes: points, lanes."""
    stiffness.restart_elements(h, clock, scene)
    deform(clock, h, scene)


@kernel
def save_elements(scene):
    """Copy the blocks of elements at the start of a step. Writes: lanes_before."""
    if ELEMENTS:
        stiffness.save_blocks(scene)


@stage
def open_points(clock, h, scene):
    """First kick and drift of the points, and the loss by drag. Writes: scene.points, clock."""
    if THREADS:
        share(jobs.OPEN, scene.pieces.shape[0], clock, h, scene)
    for group in ELEMENTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            old, new = history[clock.current, i], history[1 - clock.current, i]
            if not THREADS:
                points.first_kick_and_drift(h, p[i], scene.points)
            points.apply_drag(clock, h, p[i], old, new, scene.points)


@stage
def deform(clock, h, scene):
    """Forces of the elements. Writes: scene.points, lanes."""
    for group in ELEMENTS:
        p = group.parameters
        for i in range(p.shape[0]):
            deform_part(group, p[i], clock, h, scene)


@stage
def close_points(clock, h, scene):
    """Second kick of the points. Writes: scene.points, clock."""
    if THREADS:
        rate = clock.element_rate
        share(jobs.CLOSE, scene.pieces.shape[0], clock, h, scene)
        clock.element_rate = max(rate, jobs.largest_rate(scene))
    else:
        for group in ELEMENTS:
            p = group.parameters
            for i in range(p.shape[0]):
                points.second_kick(clock, h, p[i], scene.points)
