"""The energy ledger: stored, dissipated and external energy, and the imbalance.

    imbalance = kinetic + potential + stored + dissipated - work from outside - initial total

Every law states its stored energy and the power it dissipates from its own formula; the imbalance
is therefore a measure of the integration error and of any law that breaks its promise.

It is compared with the largest energy so far. Where nothing moves, as under a load on a fully
constrained body, all energies are errors: the work of a force over a displacement below the
round-off of positions may be missing.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, vec
from crashsolve.model.clock import CONTACT_GAIN, ENERGY, NOT_FINITE, RUNNING
from crashsolve.model.ledger import (
    DRIVER_WORK,
    ELASTIC,
    EXTERNAL_WORK,
    IMBALANCE,
    INITIAL,
    INTERNAL,
    KINETIC,
    LARGEST,
    PLASTIC,
    POTENTIAL,
)
from crashsolve.system.contact.touches import card_with_energy_gain, card_with_friction_gain
from crashsolve.system.kinetics import bad_node

# over so much of the model's size, or rotation in rad, the work of a force is round-off; equilibria
# (statics/equilibrium.py) are checked by the same
NOTHING = 1e-12
# round-off of a displacement in a step, over the distance from the origin
EPSILON = 4e-16
# of the speed to which errors of steps are compared: a hundred steps that err by the default
# tolerance, 1e-6, are 1 % of it
UNRESOLVED = 0.01


@kernel
def add_dissipation(clock, old, new, power, loss):
    """Add the dissipation of a law over the step: its power with the weights, and its loss.

    Writes: new.
    """
    total = new.dissipated if clock.opens == 0 else old.dissipated + clock.lead * old.power
    new.dissipated = total + clock.share * power
    if clock.closes == 1:
        new.dissipated += loss
    new.power = power


@kernel
def clear_ledger(ledger):
    """Zero the sums of the ledger; keep the initial and the largest energy. Writes: ledger."""
    for k in range(INITIAL):
        ledger[k] = 0.0


@kernel
def least_energy(control, nodes, unseen):
    """Energy beyond which `control.energy_limit` of it is no work over an unseen motion [J].

    Of the largest applied force or torque over `unseen`, a share of the model's size or a rotation;
    and that of the lightest body at a share of the speed to which errors of steps are compared.
    """
    largest = lightest = 0.0
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        lightest = max(lightest, b.mass_inv)
        largest = max(largest, control.length * norm(vec(b.force)), norm(vec(b.torque)))
    limit = control.energy_limit if control.energy_limit > 0.0 else 1.0
    speed = UNRESOLVED * control.least_speed
    slow = 0.5 * speed * speed / lightest if lightest > 0.0 else 0.0
    return max(unseen * largest / limit, slow)


@kernel
def close_ledger(ledger, least, kicked):
    """Imbalance and largest energy, at least `least` [J], from the entries. Writes: ledger.

    The part of the imbalance explained by the last half kick, `kicked` [J], does not count.
    """
    total = ledger[KINETIC] + ledger[POTENTIAL]
    largest = max(ledger[LARGEST], ledger[KINETIC], abs(ledger[INITIAL]), least)
    for k in range(ELASTIC, EXTERNAL_WORK):
        total += ledger[k]
        largest = max(largest, abs(ledger[k]))
    largest = max(largest, abs(ledger[EXTERNAL_WORK]), abs(ledger[DRIVER_WORK]))
    ledger[LARGEST] = largest
    outside = ledger[EXTERNAL_WORK] + ledger[DRIVER_WORK]
    missing = total - outside - ledger[INITIAL]
    explained = min(max(missing, 0.0), kicked)
    ledger[IMBALANCE] = missing - explained
    ledger[INTERNAL] = ledger[ELASTIC] + ledger[PLASTIC]


@kernel
def check(clock, control, nodes, ledger):
    """Stop at a bad number or a broken balance; note one that is let pass. Writes: clock.

    From rest, the errors of the first steps are large beside the little energy there is: energy
    from outside is judged where its share that is missing falls no more.
    """
    lack = abs(ledger[IMBALANCE]) / (ledger[LARGEST] + 1e-300)
    supplied = abs(ledger[EXTERNAL_WORK]) + abs(ledger[DRIVER_WORK])
    falls = clock.lack == 0.0 or lack < clock.lack
    is_starting = falls and supplied > 0.5 * ledger[LARGEST]
    clock.lack = lack
    if 0.0 < control.energy_limit < lack and abs(ledger[IMBALANCE]) > clock.missing:
        clock.missing, clock.missing_share = abs(ledger[IMBALANCE]), lack
        clock.missing_time = clock.time
    is_due = control.energy_limit > 0.0 and clock.cycle >= control.check_every
    bad = bad_node(nodes)
    if bad >= 0:
        clock.status, clock.index = NOT_FINITE, bad
    elif is_due and not is_starting and not lack <= control.energy_limit:
        clock.status = ENERGY


@kernel
def unseen_distance(clock, control, nodes):
    """Round-off of all displacements so far [m]."""
    farthest = control.length
    for i in range(1, nodes.shape[0]):
        farthest = max(farthest, norm(vec(nodes[i].r)))
    return EPSILON * clock.cycle * farthest


@kernel
def unseen_energy(clock, ledger):
    """Round-off of the sums of work so far [J]: every step adds numbers of the model's scale."""
    return EPSILON * clock.cycle * ledger[LARGEST]


@kernel
def check_contacts(clock, control, nodes, scene):
    """Stop at a contact that gives its bodies energy that it never took. Writes: clock."""
    if clock.status == RUNNING and control.energy_limit > 0.0:
        unseen, limit = unseen_distance(clock, control, nodes), control.energy_limit
        card = card_with_energy_gain(clock.current, limit, unseen, scene.card_history)
        with_friction = card_with_friction_gain(clock.current, limit, unseen, scene.card_history)
        if card >= 0 or with_friction >= 0:
            clock.status, clock.index = CONTACT_GAIN, card if card >= 0 else with_friction
            clock.value = 0.0 if card >= 0 else 1.0
