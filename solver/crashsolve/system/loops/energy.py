"""Energies of the present state, entry by entry of the ledger (model/ledger.py)."""

from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel, stage
from crashsolve.foundation.vec3 import add, cross, dot, vec
from crashsolve.model.clock import LAW_GAIN, RUNNING
from crashsolve.model.ledger import (
    CONTACT_DISSIPATED,
    CONTACT_STORED,
    DRILLING,
    DRIVER_WORK,
    ELASTIC,
    ERODED,
    FRICTION_DISSIPATED,
    FRICTION_STORED,
    HOURGLASS,
    KINETIC,
    PART_DAMPING,
    PLASTIC,
)
from crashsolve.system import points, ties
from crashsolve.system.contact import body_pairs
from crashsolve.system.energy import (
    NOTHING,
    clear_ledger,
    close_ledger,
    least_energy,
    unseen_distance,
    unseen_energy,
)
from crashsolve.system.gain import (
    NEGLIGIBLE,
    has_gain,
    overstates,
    relative_energy,
)
from crashsolve.system.kinetics import kinetic_energy
from crashsolve.system.placeholders import (
    ASSEMBLED,
    CONTACTS,
    DENSE,
    ELEMENTS,
    FORCES,
    JOINTS,
    KICK_DRIFT_KICK,
    NODAL,
    SEARCHES,
    TIES,
    WATCHED,
)


@kernel
def energy(clock, nodes, scene, ledger):
    """Energies of the present state. Writes: ledger."""
    clear_ledger(ledger)
    ledger[KINETIC] = kinetic_energy(nodes)
    add_laws(clock, scene, ledger)
    add_elements(clock, scene, ledger)
    if ELEMENTS:
        points.check_points(clock, nodes, scene.points)
    add_contacts(clock, scene, ledger)
    add_nodal_contacts(scene, ledger)
    ledger[DRIVER_WORK] = clock.driver_work
    unseen = NOTHING
    if JOINTS:
        # so far joints may stand open
        unseen = max(unseen, scene.control[0].constraint_tolerance)
    kicked = half_kicks(clock, nodes, scene) if KICK_DRIFT_KICK else 0.0
    least = max(least_energy(scene.control[0], nodes, unseen), clock.largest_work)
    close_ledger(ledger, least, kicked)


@stage
def record_outside_work(clock, scene):
    """Record the largest work from outside so far: a body that a pulse moved and another stopped
    between two checks of the balance has it left as round-off alone. Writes: clock.
    """
    total = clock.driver_work
    for group in FORCES:
        if group.works_from_outside:
            for i in range(group.output.shape[0]):
                total += group.history[clock.current, i].dissipated
    clock.largest_work = max(clock.largest_work, abs(total))


@kernel
def half_kicks(clock, nodes, scene):
    """Energy of the last half kick by loads, whose work only the next drift does [J].

    Of a force f on a free mass h^2 f^2 / 8m: it does not add up over steps, but after one step of a
    pulse on a body at rest it is all the energy that there is. Where other forces F - f act beside
    f, h^2 f F / 8m: it grows no faster than they do, so that it cannot explain what they gain.
    """
    total = 0.0
    if ELEMENTS:
        points.set_attached_forces(nodes, scene.points, scene.attached_points)
        if TIES:
            ties.set_tied_forces(scene.points, scene.ties)
    for group in FORCES:
        for i in range(group.output.shape[0]):
            if hasattr(group.law, "present"):
                body = nodes[group.parameters[i].node]
                f, d, torque = group.law.present(group.parameters[i], group.output[i], body.A)
                rotation = matvec(body.W, vec(body.torque))
                total += body.mass_inv * dot(f, vec(body.force))
                total += dot(add(cross(d, f), torque), rotation)
            if ELEMENTS and hasattr(group.law, "kick_rate"):
                if group.members is None:
                    total += group.law.kick_rate(group.parameters[i], group.output[i], scene)
                else:
                    total += group.law.kick_rate(
                        group.parameters[i], group.output[i], scene, group.members
                    )
    if ELEMENTS:
        points.clear_attached_forces(scene.points, scene.attached_points)
        if TIES:
            ties.clear_tied_forces(scene.points, scene.ties)
    if clock.cycle == 0:
        clock.loads_at_start = total
    rise = max(total - clock.loads_at_start, 0.0)
    return 0.125 * clock.kicked_over * clock.kicked_over * rise


@stage
def add_laws(clock, scene, ledger):
    """Add stored and dissipated energies of springs, beams and loads to the entries of their
    kind.
    """
    for group in FORCES:
        for i in range(group.output.shape[0]):
            ledger[group.stored_entry] += group.output[i].stored
            if group.has_work:
                # the loss of an element is plastic work and damping
                ledger[PLASTIC] += group.history[clock.current, i].work
                ledger[group.lost_entry] += (
                    group.history[clock.current, i].dissipated
                    - group.history[clock.current, i].work
                )
            elif group.lost_entry is not None:
                ledger[group.lost_entry] += group.history[clock.current, i].dissipated


@stage
def add_elements(clock, scene, ledger):
    """Add stored and dissipated energies of shell elements. Writes: ledger."""
    for group in ELEMENTS:
        for i in range(group.output.shape[0]):
            o, new = group.output[i], group.history[clock.current, i]
            group.law.energies(group.parameters[i], new, o, scene)
            for number, material in group.materials:
                if group.parameters[i].law == number:
                    for kind in group.kinds:
                        group.blocks.add_energies(kind, group.parameters[i], o, scene, material)
            if not ASSEMBLED:
                # points of implicit steps are bodies
                ledger[KINETIC] += o.kinetic
            ledger[ELASTIC] += o.strain
            ledger[HOURGLASS] += o.hourglass
            ledger[DRILLING] += o.drilling
            ledger[PLASTIC] += o.plastic
            ledger[PART_DAMPING] += o.drag + o.damping
            ledger[ERODED] += o.eroded


@stage
def add_contacts(clock, scene, ledger):
    """Add stored and dissipated energies of contacts, including pairs that left the lists of near
    ones.
    """
    for group in CONTACTS:
        if group.body_pairs is not None:
            for k in range(group.body_pairs.shape[0]):
                both = group.body_pairs[k]
                if body_pairs.has_energy(both):
                    add_pairs(group, both.first, both.end, clock, scene, ledger)
        else:
            add_pairs(group, 0, group.output.shape[0], clock, scene, ledger)
    if SEARCHES:
        for i in range(scene.cards.shape[0]):
            card = scene.card_history[clock.current, i]
            ledger[CONTACT_DISSIPATED] += card.left_dissipated
            ledger[FRICTION_DISSIPATED] += card.left_friction_dissipated


@kernel
def add_pairs(group, first, end, clock, scene, ledger):
    """Add stored and dissipated energies of pairs that follow each other. Writes: ledger."""
    stored, friction_stored = ledger[CONTACT_STORED], ledger[FRICTION_STORED]
    dissipated, lost = ledger[CONTACT_DISSIPATED], ledger[FRICTION_DISSIPATED]
    for i in range(first, end):
        o, old = group.output[i], group.history[clock.current, i]
        stored += o.stored
        friction_stored += o.friction_stored
        dissipated += old.dissipated
        lost += old.friction_dissipated
    ledger[CONTACT_STORED], ledger[FRICTION_STORED] = stored, friction_stored
    ledger[CONTACT_DISSIPATED], ledger[FRICTION_DISSIPATED] = dissipated, lost


@stage
def add_nodal_contacts(scene, ledger):
    """Add stored and dissipated energies of contacts of shell nodes. Writes: ledger."""
    for group in NODAL:
        ledger[CONTACT_STORED] += group.totals[0].stored
        ledger[CONTACT_DISSIPATED] += group.totals[0].dissipated
        if group.friction:
            ledger[FRICTION_STORED] += group.totals[0].bristle_energy
            ledger[FRICTION_DISSIPATED] += group.totals[0].friction_loss


@stage
def check_laws(clock, control, nodes, scene):
    """Stop at a law between two bodies that gives them more than it took. Writes: clock."""
    if clock.status == RUNNING and control.energy_limit > 0.0:
        unseen = unseen_distance(clock, control, nodes)
        least = unseen_energy(clock, scene.ledger)
        for group in WATCHED:
            for i in range(group.output.shape[0]):
                now, stored = group.history[clock.current, i], group.output[i].stored
                limit, bound = control.energy_limit, least
                if group.joins_several:
                    moving = relative_energy(group.parameters[i], group.max_nodes, nodes)
                    bound = max(least, NEGLIGIBLE * moving)
                creates = has_gain(now, stored, limit, unseen, bound)
                if creates or overstates(now, stored, limit, unseen, bound):
                    clock.status = LAW_GAIN


@kernel
def sum_powers(current, h, scene):
    """Energy dissipated since the start of a step of h, by dense output. Writes: new histories."""
    if DENSE:
        # the last row of the tableau has the weights of the sample
        total = scene.stages.shape[0]
        first = total * (total - 1)
        for group in FORCES:
            history, powers = group.history, group.powers
            count = history.shape[1]
            for i in range(count):
                lost = scene.A[first] * history[current, i].power
                for j in range(1, total - 1):
                    lost += scene.A[first + j] * powers[count * j + i]
                history[1 - current, i].dissipated += h * lost
