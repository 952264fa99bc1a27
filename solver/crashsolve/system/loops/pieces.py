"""Jobs in pieces, for several threads: what each piece is, who does it, and the loop of a thread.

The first thread calls the others to a job, and takes part (system/threads/worker.py).
"""

from crashsolve.foundation.kernels import entry, kernel
from crashsolve.system import points
from crashsolve.system.placeholders import ELEMENT_LOADS, ELEMENTS
from crashsolve.system.threads import jobs, worker


@kernel
def share(number, pieces, clock, h, scene):
    """Do all pieces of a job, with all threads. Writes: what the job writes."""
    scene.job[0].number, scene.job[0].h = number, h
    called = worker.call(pieces, scene.job[0].threads, scene.turns)
    do_pieces(0, called, clock, scene)
    worker.wait_for_all(pieces, scene.turns)


@kernel
def share_load(group, span, entry, clock, h, scene):
    """Do a load on elements with all threads. Writes: scene.points, block_sums."""
    for number, other in enumerate(ELEMENT_LOADS):
        if other is group:
            scene.job[0].group = number
    scene.job[0].entry, scene.job[0].current = entry, clock.current
    share(jobs.LOAD, span.count, clock, h, scene)
    jobs.take_back(span.first_piece, span.count, scene)


@kernel
def do_pieces(me, called, clock, scene):
    """Pieces of a job until none is left. Writes: what the job writes."""
    threads = scene.job[0].threads
    k = worker.next_piece(me, called, threads, scene.turns)
    while k >= 0:
        do_piece(k, clock, scene)
        worker.finish(scene.turns)
        k = worker.next_piece(me, called, threads, scene.turns)


@kernel
def do_piece(k, clock, scene):
    """One piece of the present job. Writes: what the job writes."""
    job = scene.job[0]
    if ELEMENT_LOADS and job.number == jobs.LOAD:
        load_piece(k, job, scene)
    elif job.number == jobs.OPEN:
        open_piece(k, job.h, scene)
    elif job.number == jobs.DEFORM:
        deform_piece(k, clock, job.h, scene)
    else:
        close_piece(k, clock, job.h, scene)


@kernel
def open_piece(k, h, scene):
    """First kick and drift of some points. Writes: scene.points."""
    at = k
    for group in ELEMENTS:
        if at >= 0 and at < group.pieces.shape[0]:
            points.open_points(h, group.pieces[at], scene.points)
        at -= group.pieces.shape[0]


@kernel
def deform_piece(k, clock, h, scene):
    """Forces of some elements. Writes: scene.points, lanes, pieces."""
    jobs.lend(scene.pieces[k], scene)
    clock.element_rate, clock.limit_element = 0.0, 0
    at = k
    for group in ELEMENTS:
        if at >= 0 and at < group.pieces.shape[0]:
            deform_part(group, group.pieces[at], clock, h, scene)
        at -= group.pieces.shape[0]
    scene.pieces[k].rate, scene.pieces[k].element = clock.element_rate, clock.limit_element


@kernel
def close_piece(k, clock, h, scene):
    """Second kick of some points. Writes: scene.points, pieces."""
    clock.element_rate = 0.0
    at = k
    for group in ELEMENTS:
        if at >= 0 and at < group.pieces.shape[0]:
            points.close_points(clock, h, group.pieces[at], scene.points)
        at -= group.pieces.shape[0]
    scene.pieces[k].rate = clock.element_rate


@kernel
def deform_part(group, p, clock, h, scene):
    """Forces of the elements of a part, or of a piece of it. Writes: scene.points, lanes."""
    for number, material in group.materials:
        if p.law == number:
            for kind in group.kinds:
                kind.deform(p, clock, h, scene, material)


@kernel
def load_piece(k, job, scene):
    """Some blocks of the load that is asked for. Writes: scene.points, block_sums."""
    i = job.entry
    for number, group in enumerate(ELEMENT_LOADS):
        if job.group == number:
            span = group.spans[i]
            jobs.lend(scene.pieces[span.first_piece + k], scene)
            p, old, out = group.pieces[span.first + k], group.history[job.current, i], group.output[i]
            group.law.load_elements(p, old, out, job.h, scene)


@entry
def assist(until, sampling, scene):
    """Loop of a thread: the jobs that the first calls it to."""
    clock, me, called = scene.clock[0], scene.seat[0], 0
    while True:
        called = worker.wait_for_call(called, scene.turns)
        if called == worker.HOME:
            return
        do_pieces(me, called, clock, scene)
