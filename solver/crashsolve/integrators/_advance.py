"""The loop over time: steps and samples, the balance of energy, and why it ends.

The same for every method; its stepper (`_kick_drift_kick`, `_runge_kutta` or `_implicit`) defines a
step and a sample, in three functions.
"""

from crashsolve.foundation.kernels import entry
from crashsolve.foundation.sparse.saddle import saddle_of
from crashsolve.integrators._kick_drift_kick import finish, prepare_sample, take_step
from crashsolve.model.clock import CURVE_END, PAUSED, REACHED, REBUILD, RUNNING, TOUCHED
from crashsolve.system.contact.effective_mass import needs_effective_mass
from crashsolve.system.energy import check, check_contacts
from crashsolve.system.loops.energy import check_laws, energy, record_outside_work
from crashsolve.system.loops.events import need_rebuild
from crashsolve.system.placeholders import (
    BOUNDS_NEXT_STEP,
    CONTACTS,
    COUNTS_ROTATIONS,
    NODAL,
    WATCHED,
    WITH_EFFECTIVE_MASS,
)
from crashsolve.system.timestep import count_rotations


@entry
def advance(until, sampling, scene):
    """Step from the present time to exactly `until` [s], or to an event that stops it. Writes: all
    of the State.

    A sample is a step of no length, taken on copies: outputs, reactions, accelerations, energies.
    """
    clock, control, ledger = scene.clock[0], scene.control[0], scene.ledger
    nodes, rows, curves = scene.nodes, scene.rows, scene.curves
    saddle = saddle_of(scene)
    clock.status = RUNNING
    while clock.status == RUNNING and (sampling or clock.time < until):
        h = 0.0
        if sampling:
            time = prepare_sample(until, clock, nodes, rows, saddle, scene)
        else:
            if BOUNDS_NEXT_STEP and need_rebuild(clock, nodes, scene):
                clock.status = REBUILD
                return
            time, h = take_step(until, clock, nodes, rows, saddle, scene)
            if clock.status != RUNNING:
                return
        finish(time, h, sampling, clock, nodes, rows, saddle, scene)
        if not sampling:
            record_outside_work(clock, scene)
        if sampling or clock.cycle % control.check_every == 0:
            energy(clock, nodes, scene, ledger)
            check(clock, control, nodes, ledger)
            if CONTACTS or NODAL:
                check_contacts(clock, control, nodes, scene)
            if WATCHED:
                check_laws(clock, control, nodes, scene)
        if sampling:
            return
        if COUNTS_ROTATIONS:
            count_rotations(h, clock, control, nodes)
        if curves[0].fault != 0:
            clock.status = CURVE_END
        for group in WITH_EFFECTIVE_MASS:
            if clock.status == RUNNING and needs_effective_mass(
                group.parameters, group.history, clock.current
            ):
                clock.status = TOUCHED
        # last: a pause depends on the speed of the machine, and must not put off the others
        if clock.cycle >= clock.pause and clock.status == RUNNING and clock.time < until:
            clock.status = PAUSED
    if clock.status == RUNNING:
        clock.status = REACHED
