"""Jobs in pieces, for several threads: the work of each piece, and the loop of a thread.

The first thread calls the others to a job, and takes part (threads/worker.py).
"""

from crashsolve.foundation.kernels import entry, kernel
from crashsolve.system import points
from crashsolve.system.contact import node_contact
from crashsolve.system.loops.many_pairs import (
    approach_piece,
    load_bodies_piece,
    nearest_of_pieces,
    pair_forces_piece,
    sum_pieces,
)
from crashsolve.system.loops.nodal.searches import search_faces, search_shapes
from crashsolve.system.placeholders import (
    CONTACTS,
    ELEMENT_LOADS,
    ELEMENTS,
    MANY_PAIRS,
    NODAL,
    THREADS,
)
from crashsolve.threads import jobs, worker


@kernel
def share(number, pieces, clock, h, scene):
    """Do all pieces of a job, with all threads. Writes: the tables of the job."""
    scene.job[0].number, scene.job[0].h = number, h
    called = worker.call(pieces, scene.job[0].threads, scene.queues)
    do_pieces(0, called, clock, scene)
    worker.wait_for_all(pieces, scene.queues)
    scene.job[0].number = jobs.NONE


@kernel
def share_search(group, clock, h, scene):
    """Look for the probes of a group with all threads. Writes: tables of the group."""
    for number, other in enumerate(NODAL):
        if other is group:
            scene.job[0].group = number
    share(jobs.SEARCH, group.search_ranges.shape[0], clock, h, scene)


@kernel
def find_fastest(p, clock, h, scene):
    """Largest speed of the points that contact needs, unless it is known. Writes: touched."""
    if not node_contact.is_fastest_known(p, scene):
        share(jobs.SPEED, scene.pieces.shape[0], clock, h, scene)
        node_contact.store_fastest(p, jobs.largest_speed(p, scene), scene)


@kernel
def share_load(group, span, entry, clock, h, scene):
    """Do a load on elements with all threads. Writes: scene.points, block_sums."""
    for number, other in enumerate(ELEMENT_LOADS):
        if other is group:
            scene.job[0].group = number
    scene.job[0].entry, scene.job[0].current = entry, clock.current
    share(jobs.LOAD, span.count, clock, h, scene)
    collect_in_pieces(span.first_collector, span.collector_count, clock, h, scene)


@kernel
def collect_in_pieces(first, pieces, clock, h, scene):
    """Give the forces of replicas of corners to their originals, for some pieces. Writes:
    points.
    """
    scene.job[0].entry = first
    share(jobs.COLLECT, pieces, clock, h, scene)


@kernel
def contact_in_pieces(group, clock, h, scene):
    """Forces of all pairs of a group of many. Writes: nodes, cards, outputs, new histories."""
    if THREADS:
        note_contact(group, scene)
        share(jobs.PAIR_FORCES, group.pieces.shape[0], clock, h, scene)
        share(jobs.BODY_LOADS, group.ranges.shape[0], clock, h, scene)
    else:
        for k in range(group.pieces.shape[0]):
            pair_forces_piece(group, k, clock, h, scene)
    sum_pieces(group, clock, scene)


@kernel
def approach_in_pieces(group, clock, floor, deepest, scene):
    """Largest depth of the pairs of a group of many, and of another [m]. Writes: group.pieces."""
    if THREADS:
        note_contact(group, scene)
        scene.job[0].floor = floor
        share(jobs.APPROACH, group.pieces.shape[0], clock, 0.0, scene)
    else:
        for k in range(group.pieces.shape[0]):
            approach_piece(group, k, clock, floor, scene)
    return nearest_of_pieces(group, deepest, scene)


@kernel
def note_contact(group, scene):
    """The group of many pairs that a job is for. Writes: job."""
    for number, other in enumerate(CONTACTS):
        if other is group:
            scene.job[0].group = number


@kernel
def do_pieces(me, called, clock, scene):
    """Pieces of a job until none is left, by the thread `me`. Writes: the tables of the job."""
    threads = scene.job[0].threads
    k = worker.next_piece(me, called, threads, scene.queues)
    while k >= 0:
        do_piece(k, me, clock, scene)
        worker.finish(scene.queues)
        k = worker.next_piece(me, called, threads, scene.queues)


@kernel
def do_piece(k, me, clock, scene):
    """One piece of the present job. Writes: the tables of the job."""
    job = scene.job[0]
    if ELEMENT_LOADS and job.number == jobs.LOAD:
        load_piece(k, job, scene)
    elif NODAL and job.number == jobs.SEARCH:
        search_piece(k, me, job.group, scene)
    elif NODAL and job.number == jobs.SPEED:
        speed_piece(k, scene)
    elif ELEMENTS and job.number == jobs.OPEN:
        open_piece(k, job.h, scene)
    elif ELEMENTS and job.number == jobs.DEFORM:
        deform_piece(k, clock, job.h, scene)
    elif ELEMENTS and job.number == jobs.COLLECT:
        jobs.collect_replicas(scene.pieces[job.entry + k], scene)
    elif ELEMENTS and job.number == jobs.CLOSE:
        close_piece(k, clock, job.h, scene)
    elif MANY_PAIRS:
        pairs_piece(k, job, scene)


@kernel
def pairs_piece(k, job, scene):
    """Some pairs of a contact, or some of their bodies. Writes: the tables of the job."""
    for number, group in enumerate(CONTACTS):
        if group.in_pieces and job.group == number:
            if job.number == jobs.PAIR_FORCES:
                pair_forces_piece(group, k, scene.leader[0], job.h, scene)
            elif job.number == jobs.BODY_LOADS:
                load_bodies_piece(group, k, scene)
            else:
                approach_piece(group, k, scene.leader[0], job.floor, scene)


@kernel
def open_piece(k, h, scene):
    """First kick and drift of some points. Writes: scene.points."""
    at = k
    for group in ELEMENTS:
        if at >= 0 and at < group.pieces.shape[0]:
            points.first_kick_and_drift(h, group.pieces[at], scene.points)
        at -= group.pieces.shape[0]


@kernel
def deform_piece(k, clock, h, scene):
    """Forces of some elements. Writes: scene.points, lanes, pieces."""
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
            points.second_kick(clock, h, group.pieces[at], scene.points)
        at -= group.pieces.shape[0]
    scene.pieces[k].rate = clock.element_rate


@kernel
def speed_piece(k, scene):
    """Largest speed of some points. Writes: scene.pieces."""
    at, fastest = k, 0.0
    for group in ELEMENTS:
        if at >= 0 and at < group.pieces.shape[0]:
            one = group.pieces[at]
            fastest = node_contact.fastest_of(one.first_point, one.point_count, scene.points)
        at -= group.pieces.shape[0]
    scene.pieces[k].speed = fastest


@kernel
def search_piece(k, me, number, scene):
    """Search with some probes of a contact. Writes: tables of the group."""
    for number_of, group in enumerate(NODAL):
        if number == number_of and not group.keeps_faces:
            search_probes(group, k, me, scene)


@kernel
def search_probes(group, k, me, scene):
    """Look for those probes of a range that are due. Writes: tables of the group."""
    one, last, count = group.search_ranges[k], group.probes.shape[0], 0
    if k + 1 < group.search_ranges.shape[0]:
        last = group.search_ranges[k + 1].first
    for i in range(one.first, last):
        if group.due[i] > group.totals[0].travel:
            continue
        if group.narrow is None:
            search_faces(group, i, group.hits[i], scene.nodes, scene)
            touches = node_contact.touches_faces(
                group.hits[i], group.probe_states, group.slot_in_use, i
            )
        else:
            hit = group.hits[i, 0]
            search_shapes(group, i, group.a[me], (0.0, 0.0, 0.0), hit, scene.nodes, scene)
            touches = hit.depth > 0.0 or group.probe_states[group.slot_in_use[i], i].active == 1
        if touches:
            group.touching_probes[one.first + count].probe = i
            count += 1
    one.count = count


@kernel
def deform_part(group, p, clock, h, scene):
    """Forces of the elements of a part, or of a piece of it. Writes: scene.points, lanes."""
    for number, material in group.materials:
        if p.law == number:
            for kind in group.kinds:
                group.blocks.deform(kind, p, clock, h, scene, material)


@kernel
def load_piece(k, job, scene):
    """Some blocks of the requested load. Writes: scene.points, block_sums."""
    i = job.entry
    for number, group in enumerate(ELEMENT_LOADS):
        if job.group == number:
            span = group.spans[i]
            p, old, out = (
                group.pieces[span.first + k],
                group.history[job.current, i],
                group.output[i],
            )
            group.law.load_elements(p, old, out, job.h, scene)


@entry
def assist(until, sampling, scene):
    """Loop of a thread: the jobs that the first calls it to."""
    clock, me, called = scene.clock[0], scene.thread_number[0], 0
    while True:
        called = worker.wait_for_call(called, scene.queues)
        if called == worker.LAST_ROUND:
            return
        do_pieces(me, called, clock, scene)
