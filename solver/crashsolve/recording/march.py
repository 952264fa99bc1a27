"""From sample to sample in compiled code; what happens within an interval and its samples miss.

A sample in Python costs as much as tens of steps of a small scene. `march` calls the compiled step
and copies tables by their addresses, so that one machine code serves all scenes; it returns where
a sample needs more than copies (`recording/marching.py`). A snapshot from which an interval can be
run again is taken after the first of its steps, as one of a single step hides nothing.

An interval hides a contact when its ends show too little of the force in it:

    peak:     the largest normal force has grown, and neither end shows SHOWN_SHARE of it
    impulse:  |dI - (F_0 + F_1) dt / 2| is more than MISSING_SHARE of the sum of |dI| so far
    stop:     of the first touch, 2 W / (dI v_0) - 1 < SPEED_LEFT: its work W and impulse state
              that bodies of constant mass have lost that much of their closing speed
    onset:    of the first touch, |dI - (F_0 + F_1) dt / 2| is more than MISSING_SHARE of the
              impulse m v_0 that stops them, m = dI^2 / 2 (v_0 dI - W)

It hides an acceleration that injury measures need when that at its start says too little of it:

    |dv - a_0 dt| is more than CHANGE_SHARE of the largest |dv| of an interval so far, and than
    NO_INJURY dt;  or it was in the last interval, and |dv| itself is so large in this one
"""

from math import sqrt

from crashsolve.foundation.addresses import call_step, copy_bytes, number_at, ticks
from crashsolve.foundation.kernels import entry, kernel
from crashsolve.foundation.motion import arm, point_velocity
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, norm, put, scale, sub, vec
from crashsolve.model.clock import PAUSED, REACHED, STOPS_AT_SAMPLE
from crashsolve.model.contact.body_pairs import BODY_PAIR
from crashsolve.model.ledger import LARGEST, is_spurious_energy
from crashsolve.recording.gather import add_sample, find_extremes
from crashsolve.system.engine import FIRST_CHECKED

# half waves of more than three intervals miss less of a peak and of an impulse, and are not stopped
# to less than cos 60 degrees in one interval
SHOWN_SHARE, MISSING_SHARE, SPEED_LEFT = 0.9, 0.05, 0.5
# half waves of more than 16 intervals change by less; their integrals are within 1 %
CHANGE_SHARE = 0.1
# [m/s^2] 1 g adds 1 in a second to the Severity Index, whose limits are 700 and 1000
NO_INJURY = 9.80665
# why `march` returned: all samples are done; the step returned; the last interval hides a force;
# the last sample must be checked by the caller; the next step is longer or shorter than wanted
DONE, STEPPED, HIDDEN, SUSPECT, OTHER_STEP = range(5)
# bytes of a row of BODY_PAIR
ROW = BODY_PAIR.dtype.itemsize

JOB = Record("""
    step      index  address of the compiled step
    present   index  address of its tables at present
    of_sample  index  address of its tables of a sample
    is_dense  flag   whether steps may go beyond a sample
    end       s      time at which the run ends
    limit     1      control.energy_limit
    longest   s      no sample is taken where the next step is longer
    shortest  s      nor where it is not longer than this
    most      count  samples wanted
    count     count  samples done
    cards     count  contact cards
    probes    count  accelerometers that have a role
    before    count  rows of `before`
    snapshot  count  rows of `snapshot`
    both      index  address of two body pairs
    passed    count  rows of `passed`
    why       index  DONE, STEPPED, HIDDEN, SUSPECT or OTHER_STEP
    copies    count  snapshots taken
    stepping  count  ticks of the steps
    total     count  ticks of all
""")
WATCH = Record("""
    watches   flag   whether intervals are watched
    time      s      begin of the interval
    cycle     count  steps by then
    examined  flag   whether this interval has been examined
    hides     flag   whether its ends show too little of a contact
    copied    flag   whether the snapshot is of this interval
""")
# of every contact card, as the interval began
MARK = Record("""
    force    N    3  on side a
    impulse  N s  3  on side a
    work     J       of the normal force on both sides
    normal   N       normal force
    peak     N       largest normal force so far
    borne    N s     sum of |dI| in intervals of several steps
""")
# an accelerometer that has a role: its point, and its motion as the interval began
PROBE = Record("""
    node          index     body
    point         m      3  from the mass centre, body axes
    velocity      m/s    3  of the point, world axes
    acceleration  m/s^2  3  of the point, world axes
    largest       m/s       largest change of the velocity in an interval so far
    changed       flag      whether the last interval hid some of the acceleration
""")
# steps and time before, during and after contact
PHASE = Record("""
    time      s         at the last look
    cycle     count     at the last look
    onsets    count     of contacts so far
    touching  flag      whether anything touched
    steps     count  3  before, during, after contact
    spans     s      3  of these
""")
# bytes to copy
COPY = Record("""
    target  index  address
    source  index  address
    count   count  bytes
""")
# a group whose pairs are skipped while they are apart (system/contact/body_pairs.py), and where
# the snapshot has it
SKIPPING = Record("""
    body_pairs    index  address
    kept_pairs    index  address of their copy
    number        count  of them
    history       index  address
    kept_history  index  address of its copy
    half          count  bytes of a history
    stride        count  bytes of a pair
""")
# columns of times at which a pair passed: not 0 stops the run
PASSED = Record("""
    address  index  of the first number
    stride   count  bytes from one to the next
    number   count  pairs
    half     count  bytes of a history
""")


@entry
def march(_, flag, scene):
    """Samples at scene.times, one after the other. Writes: all of the State, the copies."""
    job, clock = scene.job[0], scene.clock[0]
    begun = ticks()
    job.why, job.count, job.stepping, job.copies = DONE, 0, 0, 0
    while job.why == DONE and job.count < job.most:
        if clock.next_step > job.longest or clock.next_step <= job.shortest:
            job.why = OTHER_STEP
            continue
        until = scene.times[job.count]
        clock.goal = max(until, job.end) if job.is_dense else until
        reach(until, job, clock, scene)
        if clock.status != REACHED:
            job.why = STEPPED
        elif hides_anything(clock, scene):
            job.why = HIDDEN
        elif not sample(until, job, clock, scene):
            job.why = SUSPECT
        else:
            add_sample(scene)
            begin_interval(clock, scene)
            count_interval(clock, scene)
            job.count += 1
    job.total = ticks() - begun


@entry
def take(_, flag, scene):
    """Add the present sample to those taken. Writes: block, joints, origins, memory."""
    add_sample(scene)


@entry
def look(_, flag, scene):
    """Sample the present step, and add it to those taken if it may be. Writes: as of both."""
    job, clock = scene.job[0], scene.clock[0]
    job.count = 0
    if sample(clock.time, job, clock, scene):
        add_sample(scene)
        job.count = 1


@entry
def bound(_, flag, scene):
    """Find the extremes of the samples of a block. Writes: block, extremes."""
    find_extremes(scene)


@entry
def check_interval(_, flag, scene):
    """Whether the interval that ends now hides a force. Writes: watch, marks, probes."""
    hides_anything(scene.clock[0], scene)


@entry
def start_interval(_, flag, scene):
    """An interval begins. Writes: watch, marks, probes."""
    begin_interval(scene.clock[0], scene)


@entry
def copy_interval(_, flag, scene):
    """Take the snapshot of an interval. Writes: watch, job, memory."""
    take_snapshot(scene.job[0], scene.clock[0], scene)


@entry
def finish_interval(_, flag, scene):
    """An interval has ended. Writes: phase."""
    count_interval(scene.clock[0], scene)


@kernel
def reach(until, job, clock, scene):
    """Step to a sample, with a snapshot after the first of several steps. Writes: all of the State,
    watch, job, memory.
    """
    watch = scene.watch[0]
    if watch.watches and watch.copied == 0:
        pause = clock.pause
        clock.pause = clock.cycle + 1
        step_to(until, job)
        clock.pause = pause
        if clock.status != PAUSED:
            return
        take_snapshot(job, clock, scene)
        if clock.cycle >= pause:
            return
    step_to(until, job)


@kernel
def step_to(until, job):
    """Step to a time, and count the ticks. Writes: all of the State, job."""
    begun = ticks()
    call_step(job.step, until, False, job.present)
    job.stepping += ticks() - begun


@kernel
def take_snapshot(job, clock, scene):
    """Copy all that changes. Writes: watch, job, memory."""
    # the pause depends on the speed of the machine, and must not enter a dump
    pause = clock.pause
    clock.pause = 0
    copy(scene.snapshot, job.snapshot)
    copy_changed(scene.skipping, scene.both, job.both)
    clock.pause = pause
    scene.watch[0].copied = 1
    job.copies += 1


@kernel
def copy(table, rows):
    """Copy the pieces in a table of COPY. Writes: memory."""
    for i in range(rows):
        copy_bytes(table[i].target, table[i].source, table[i].count)


@kernel
def copy_changed(groups, both, at):
    """Copy the histories of pairs, but for those that have been skipped without a change since
    their copies were made. `both`, at an address, has room for two rows. Writes: both, memory.
    """
    for i in range(groups.shape[0]):
        group = groups[i]
        for j in range(group.number):
            present, kept = group.body_pairs + j * ROW, group.kept_pairs + j * ROW
            copy_bytes(at, present, ROW)
            copy_bytes(at + ROW, kept, ROW)
            now, before = both[0], both[1]
            if now.skipped == 0 or before.skipped == 0 or now.changes != before.changes:
                first, size = now.first * group.stride, (now.end - now.first) * group.stride
                for k in range(2):
                    half = k * group.half + first
                    copy_bytes(group.kept_history + half, group.history + half, size)
            copy_bytes(kept, at, ROW)


@kernel
def sample(until, job, clock, scene):
    """Take a sample; whether the run may continue. Writes: tables of a sample, clock, ledger."""
    copy(scene.before, job.before)
    call_step(job.step, until, True, job.of_sample)
    sampled, ledger = scene.sample_clock[0], scene.sample_ledger
    clock.sampled = sampled.time
    for status in STOPS_AT_SAMPLE:
        if sampled.status == status:
            return False
    if sampled.cycle >= FIRST_CHECKED and is_spurious_energy(ledger, job.limit):
        return False
    if has_passed(scene.passed, job.passed, clock.current):
        return False
    scene.ledger[LARGEST] = ledger[LARGEST]
    clock.missing = sampled.missing
    clock.missing_share = sampled.missing_share
    clock.missing_time = sampled.missing_time
    return True


@kernel
def has_passed(passed, rows, current):
    """Whether a body has passed the middle of a struck body."""
    for i in range(rows):
        one = passed[i]
        for j in range(one.number):
            if number_at(one.address + current * one.half + j * one.stride) != 0.0:
                return True
    return False


@kernel
def hides_anything(clock, scene):
    """Whether the ends of the interval show too little of any contact or acceleration. Writes:
    watch, marks, probes.
    """
    watch = scene.watch[0]
    if watch.examined or not watch.watches:
        return watch.hides
    watch.examined, watch.hides = 1, 0
    # of one step both ends are samples
    if clock.cycle - watch.cycle < 2:
        return 0
    half = 0.5 * (clock.time - watch.time)
    for i in range(scene.job[0].cards):
        card, history, mark = scene.cards[i], scene.card_history[clock.current, i], scene.marks[i]
        size, missing = 0.0, 0.0
        for k in range(3):
            change = history.impulse[k] - mark.impulse[k]
            average = half * (mark.force[k] + card.force[k])
            size += change * change
            missing += (change - average) * (change - average)
        known = mark.borne
        mark.borne += sqrt(size)
        shown = max(mark.normal, card.normal)
        if history.peak_normal > mark.peak and shown < SHOWN_SHARE * history.peak_normal:
            watch.hides = 1
        if known > 0.0 and sqrt(missing) > MISSING_SHARE * mark.borne:
            watch.hides = 1
        if known == 0.0 and hides_onset(mark, history, sqrt(size), sqrt(missing)):
            watch.hides = 1
    for i in range(scene.job[0].probes):
        if hides_acceleration(scene.probes[i], scene.present_nodes, 2.0 * half):
            watch.hides = 1
    return watch.hides


@kernel
def hides_onset(mark, history, impulse, missing):
    """Whether a first touch stops its bodies, or the force that it has at the end of the interval
    is far from linear: `missing` [N s] of the `impulse` is not in a straight line.
    """
    speed = history.fastest
    done = 2.0 * (mark.work - history.work)
    if done < (1.0 + SPEED_LEFT) * impulse * speed:
        return True
    lost = 2.0 * impulse * speed - done
    return missing * lost > MISSING_SHARE * speed * impulse * impulse


@kernel
def hides_acceleration(probe, nodes, dt):
    """Whether the acceleration at the start of an interval of dt shows too little of it. Writes:
    probe.
    """
    body = nodes[probe.node]
    now = point_velocity(body, arm(body, vec(probe.point)))
    change = sub(now, vec(probe.velocity))
    missing = norm(sub(change, scale(dt, vec(probe.acceleration))))
    probe.largest = max(probe.largest, norm(change))
    least = max(CHANGE_SHARE * probe.largest, NO_INJURY * dt)
    # a peak may lie within, with a mean like the value at its start
    hides = missing > least or (probe.changed != 0 and norm(change) > least)
    probe.changed = 1 if missing > least else 0
    return hides


@kernel
def mark_probe(probe, present, sampled):
    """Motion at the start of an interval: at present, and accelerations of the sample. Writes:
    probe.
    """
    body = present[probe.node]
    put(probe.velocity, point_velocity(body, arm(body, vec(probe.point))))
    body = sampled[probe.node]
    d, w = arm(body, vec(probe.point)), vec(body.w)
    spin = add(cross(vec(body.w_dot), d), cross(w, cross(w, d)))
    put(probe.acceleration, add(vec(body.v_dot), spin))


@kernel
def begin_interval(clock, scene):
    """Writes: watch, marks, probes."""
    watch = scene.watch[0]
    watch.examined, watch.hides, watch.copied = 0, 0, 0
    if not watch.watches:
        return
    watch.time, watch.cycle = clock.time, clock.cycle
    for i in range(scene.job[0].cards):
        card, history, mark = scene.cards[i], scene.card_history[clock.current, i], scene.marks[i]
        for k in range(3):
            mark.force[k] = card.force[k]
            mark.impulse[k] = history.impulse[k]
        mark.normal, mark.peak, mark.work = card.normal, history.peak_normal, history.work
    for i in range(scene.job[0].probes):
        mark_probe(scene.probes[i], scene.present_nodes, scene.nodes)


@kernel
def count_interval(clock, scene):
    """An interval is one in contact when something touches at an end, or began. Writes: phase."""
    phase = scene.phase[0]
    onsets, touching = 0, 0
    for i in range(scene.job[0].cards):
        onsets += scene.card_history[clock.current, i].onsets
        if scene.cards[i].touching != 0.0:
            touching = 1
    which = 2 if onsets > 0 else 0
    if touching or phase.touching or onsets > phase.onsets:
        which = 1
    phase.spans[which] += clock.time - phase.time
    phase.steps[which] += clock.cycle - phase.cycle
    phase.time, phase.cycle = clock.time, clock.cycle
    phase.onsets, phase.touching = onsets, touching
