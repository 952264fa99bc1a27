"""Elements of shells: first kick and drift of their points, forces, second kick; on two threads.

Implicit methods move points with the nodes, and ask for forces and tangents alone.
"""

from crashsolve.foundation.kernels import entry, kernel, stage
from crashsolve.system import points
from crashsolve.system.implicit import stiffness
from crashsolve.system.placeholders import ASSEMBLED, ELEMENT_LOADS, ELEMENTS, TWO_THREADS
from crashsolve.system.threads import worker


@stage
def move_elements(clock, h, nodes, scene):
    """Motion of the points, and forces of the elements between them. Writes: scene.points."""
    if ASSEMBLED:
        points.carry(h, nodes, scene.points, scene.attached_points)
        elements(clock, h, scene)
    elif TWO_THREADS:
        worker.call(worker.OPEN, h, scene)
        open_share(clock, h, scene)
        worker.wait_for_second(scene)
        points.carry(h, nodes, scene.points, scene.attached_points)
        clock.element_rate = 0.0
        worker.call(worker.DEFORM, h, scene)
        deform_share(clock, h, scene)
        worker.wait_for_second(scene)
        worker.take_back(clock, scene)
    else:
        open_points(clock, h, scene)
        points.carry(h, nodes, scene.points, scene.attached_points)
        clock.element_rate = 0.0
        deform(clock, h, scene)


@stage
def move_points(clock, h, nodes, scene):
    """What the points end a force pass with. Writes: scene.points, nodes."""
    if ASSEMBLED:
        points.hold_riders(nodes, scene.points)
        points.unload(clock, nodes, scene.points, scene.attached_points)
    elif TWO_THREADS:
        points.unload(clock, nodes, scene.points, scene.attached_points)
        worker.hold_all(nodes, scene)
        worker.call(worker.CLOSE, h, scene)
        close_share(clock, h, nodes, scene)
        worker.wait_for_second(scene)
        worker.keep_faster(clock, scene)
    else:
        points.unload(clock, nodes, scene.points, scene.attached_points)
        close_points(clock, h, nodes, scene)


@kernel
def elements(clock, h, scene):
    """Forces after a step of h from what elements kept before it. Writes: points, lanes."""
    stiffness.begin_again(h, clock, scene)
    deform(clock, h, scene)


@kernel
def keep_elements(scene):
    """What elements keep at the start of a step. Writes: lanes_before."""
    if ELEMENTS:
        stiffness.keep(scene)


@stage
def open_points(clock, h, scene):
    """First kick and drift of the points. Writes: scene.points."""
    for group in ELEMENTS:
        p, history = group.share if TWO_THREADS else group.parameters, group.history
        for i in range(p.shape[0]):
            old, new = history[clock.current, i], history[1 - clock.current, i]
            points.open_points(clock, h, p[i], old, new, scene.points)


@stage
def deform(clock, h, scene):
    """Forces of the elements. Writes: scene.points, lanes."""
    for group in ELEMENTS:
        p = group.share if TWO_THREADS else group.parameters
        for i in range(p.shape[0]):
            for number, material in group.materials:
                if p[i].law == number:
                    for kind in group.kinds:
                        kind.deform(p[i], clock, h, scene, material)


@stage
def close_points(clock, h, nodes, scene):
    """Second kick of the points. Writes: scene.points."""
    for group in ELEMENTS:
        p = group.share if TWO_THREADS else group.parameters
        for i in range(p.shape[0]):
            points.close_points(clock, h, p[i], scene.points, nodes)


@kernel
def open_share(clock, h, scene):
    """The share of one of two threads."""
    open_points(clock, h, scene)


@kernel
def deform_share(clock, h, scene):
    """The share of one of two threads."""
    deform(clock, h, scene)


@kernel
def close_share(clock, h, nodes, scene):
    """The share of one of two threads."""
    close_points(clock, h, nodes, scene)


@kernel
def load_share(job, scene):
    """The second half of the load that is asked for. Writes: scene.lent, work."""
    for group in ELEMENT_LOADS:
        i = job.entry
        old, out = group.history[job.current, i], group.output[i]
        group.law.load_half(group.parameters[i], 1, old, out, job.h, scene)


@entry
def assist(until, sampling, scene):
    """Loop of the second thread: the jobs that the first calls it for."""
    clock, nodes, called = scene.clock[0], scene.nodes, 0
    while True:
        called = worker.wait(scene.turns, worker.CALLED, called)
        if called == worker.HOME:
            return
        job = scene.job[0]
        if job.number == worker.OPEN:
            open_share(clock, job.h, scene)
        elif ELEMENT_LOADS and job.number == worker.LOAD:
            worker.lend(scene)
            load_share(job, scene)
        elif job.number == worker.DEFORM:
            clock.element_rate = 0.0
            worker.lend(scene)
            deform_share(clock, job.h, scene)
        else:
            clock.element_rate = 0.0
            close_share(clock, job.h, nodes, scene)
        worker.store_release(scene.turns, worker.DONE, called)
