"""Two threads: the second does its share of the points and elements whenever the first calls it.

    first:   job, called += 1,   its own share,   until done == called
    second:  until called has changed,   its share of the job,   done = called

A part is cut into two halves at the border of two blocks, and its points into two. Each half has
its own tables: rows of parts with fewer points and elements, room between loops, a clock. Corners
of the second half at points of the first are points of their own, one to each corner, that follow
those they stand for; the first thread adds their forces, in the order of the elements. So every
sum has the order that it has in one thread. Consequence to test: the same bits in one and two.
"""

from crashsolve.foundation.atomic import give_way, load_acquire, store_release
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import load_point
from crashsolve.foundation.vec3 import put, vec
from crashsolve.system.points import hold

OPEN, DEFORM, LOAD, CLOSE = range(4)
# places in `turns`, as far apart as cache lines; what `called` is when the second thread is to end
CALLED, DONE, TURNS, HOME = 0, 8, 16, -1
# looks, some 20 microseconds, before the core is offered to others
PATIENCE = 4000


@kernel
def call(job, h, scene):
    """Have the second thread do its share of a job. Writes: scene.job, turns."""
    scene.job[0].number, scene.job[0].h = job, h
    store_release(scene.turns, CALLED, scene.turns[CALLED] + 1)


@kernel
def call_for_load(entry, current, h, scene):
    """Have the second thread load its half of the elements. Writes: scene.job, turns."""
    scene.job[0].entry, scene.job[0].current = entry, current
    call(LOAD, h, scene)


@kernel
def wait(turns, k, before):
    """Until a word is no longer what it was; returns what it is."""
    looks = 0
    now = load_acquire(turns, k)
    while now == before:
        looks += 1
        if looks > PATIENCE:
            give_way()
        now = load_acquire(turns, k)
    return now


@kernel
def wait_for_second(scene):
    """Until the second thread has done what it was called for."""
    wait(scene.turns, DONE, scene.turns[CALLED] - 1)


@kernel
def lend(scene):
    """Points that stand for others follow them, free of forces: for the second thread alone.

    Writes: scene.lent.
    """
    points, loans = scene.points, scene.loans
    for k in range(loans.shape[0]):
        b, own = scene.lent[k], points[loans[k].point]
        put(b.r, vec(own.r))
        put(b.v, vec(own.v))
        put(b.w, vec(own.w))
        put(b.force, (0.0, 0.0, 0.0))
        put(b.torque, (0.0, 0.0, 0.0))
        b.mass_inv, b.J_inv, b.load, b.spin_load = own.mass_inv, own.J_inv, 0.0, 0.0


@kernel
def take_back(clock, scene):
    """What points that stand for others have of elements, and the stiffest of the second half.

    Writes: scene.points, clock.
    """
    loans, second = scene.loans, scene.second_clock[0]
    for k in range(loans.shape[0]):
        b, own = scene.lent[k], scene.points[loans[k].point]
        add_to(own.force, vec(b.force))
        add_to(own.torque, vec(b.torque))
        load_point(own, b.load, b.spin_load, loans[k].slows)
    rate, is_first = second.element_rate, second.limit_element < clock.limit_element
    if rate > clock.element_rate or (rate > 0.0 and rate == clock.element_rate and is_first):
        clock.element_rate, clock.limit_element = rate, second.limit_element


@kernel
def keep_faster(clock, scene):
    """The larger bound of frequency of the two halves. Writes: clock."""
    clock.element_rate = max(clock.element_rate, scene.second_clock[0].element_rate)


@kernel
def hold_all(nodes, scene):
    """What holds points acts from outside; in the order of the points. Writes: points, nodes."""
    for k in range(scene.holds.shape[0]):
        hold(scene.points[scene.holds[k].point], nodes[0])
