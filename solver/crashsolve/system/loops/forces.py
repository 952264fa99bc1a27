"""Applied forces: one pass over attachments, elements, laws between bodies, and contacts.

The order is fixed: elements and nodes of shells come before the stages that need them.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system import attachments
from crashsolve.system.contact import (
    damping,
    node_contact,
    resting,
    surface_friction,
    times,
    touches,
)
from crashsolve.system.contact.work import load_work
from crashsolve.system.energy import add_dissipation
from crashsolve.system.gain import (
    applied_loads,
    keep_applied_loads,
    record_work,
    record_work_of_several,
)
from crashsolve.system.loops.contact_pairs import contact_pairs
from crashsolve.system.loops.elements import move_elements, move_points
from crashsolve.system.loops.mobilities import begin_contacts, share_contacts
from crashsolve.system.loops.nodal.node_to_shape import node_to_shape
from crashsolve.system.loops.nodal.node_to_surface import node_to_surface
from crashsolve.system.loops.pieces import contact_in_pieces, share_load
from crashsolve.system.loops.unilateral import find_touching
from crashsolve.system.placeholders import (
    ASSEMBLED,
    ATTACHMENTS,
    CONTACTS,
    DENSE,
    ELEMENTS,
    FOLLOWERS,
    FORCES,
    IMPLICIT_DAMPING,
    KICK_DRIFT_KICK,
    NODAL,
    NODAL_DAMPERS,
    PAIR_DAMPERS,
    THREADS,
    WELDED,
)


@kernel
def force_pass(clock, time, h, nodes, rows, curves, scene):
    """Applied forces at the end of a step of length h. Writes: nodes, outputs, new histories."""
    if ATTACHMENTS:
        attachments.move_nodes(scene.attached_nodes, nodes)
    if ELEMENTS:
        move_elements(clock, h, nodes, scene)
    apply_laws(clock, time, h, nodes, rows, curves, scene)
    if CONTACTS or NODAL:
        apply_contacts(clock, time, h, nodes, curves, scene)
    if ELEMENTS:
        if not ASSEMBLED:
            # that of the mesh replaces that of its elements
            clock.element_rate = 0.0
        move_points(clock, h, nodes, scene)
    if NODAL:
        node_contact.shorten_step(clock, scene)
    if ATTACHMENTS:
        attachments.transfer_forces(scene.attached_nodes, nodes)


@stage
def apply_laws(clock, time, h, nodes, rows, curves, scene):
    """Forces of springs, beams and loads. Writes: nodes, outputs, new histories."""
    for group in FORCES:
        p, history, out = group.parameters, group.history, group.output
        for i in range(p.shape[0]):
            old, new, o = history[clock.current, i], history[1 - clock.current, i], out[i]
            works = KICK_DRIFT_KICK and not ELEMENTS and h > 0.0
            work_of_load = 0.0
            if works and hasattr(group.law, "present"):
                body = nodes[p[i].node]
                work_of_load = load_work(group.law.present(p[i], o, body.start_A), body)
            if group.is_watched and group.joins_several:
                keep_applied_loads(p[i], group.max_nodes, new, nodes)
            elif group.is_watched:
                before = applied_loads(p[i], nodes)
            if group.materials:
                for number, material in group.materials:
                    if p[i].law == number:
                        group.fibre_law.force(
                            p[i], old, new, o, time, h, nodes, rows, curves, material
                        )
            elif group.data:
                group.law.force_with_tables(
                    p[i], old, new, o, time, h, nodes, rows, curves, group.data
                )
            else:
                group.law.force(p[i], old, new, o, time, h, nodes, rows, curves)
            if ELEMENTS and hasattr(group.law, "force_on_points"):
                if group.members is None:
                    group.law.force_on_points(p[i], old, new, o, time, h, nodes, curves, scene)
                else:
                    group.law.force_on_points(
                        p[i], old, new, o, time, h, nodes, curves, scene, group.members
                    )
            if hasattr(group.law, "load_elements"):
                if THREADS:
                    share_load(group, group.spans[i], i, clock, h, scene)
                else:
                    group.law.load_elements(p[i], old, o, h, scene)
                group.law.add_up(p[i], o, h, nodes, scene.block_sums)
            if works and hasattr(group.law, "present"):
                body = nodes[p[i].node]
                work_of_load += load_work(group.law.present(p[i], o, body.A), body)
                o.power, o.loss = 0.0, work_of_load
            add_dissipation(clock, old, new, o.power, o.loss)
            if group.is_watched:
                if group.joins_several:
                    record_work_of_several(p[i], group.max_nodes, old, new, h, nodes)
                else:
                    record_work(p[i], old, new, before, h, nodes)
                is_first = clock.cycle == 0 and h == 0.0
                new.initially_stored = o.stored if is_first else old.initially_stored
            if DENSE:
                group.powers[clock.stage * p.shape[0] + i] = o.power
    for group in FOLLOWERS:
        p, history, out = group.parameters, group.history, group.output
        for i in range(p.shape[0]):
            old, new = history[clock.current, i], history[1 - clock.current, i]
            group.law.follow(p[i], old, new, out[i], nodes)


@stage
def apply_contacts(clock, time, h, nodes, curves, scene):
    """Forces of all contacts. Writes: nodes, scene.cards, outputs, new histories."""
    touches.clear_cards(scene.cards, resting.least_depth(h, clock, scene.control[0]))
    touches.copy_onsets(clock.current, scene.card_history)
    if KICK_DRIFT_KICK and PAIR_DAMPERS:
        touches.clear_friction_stiffness(nodes)
    if IMPLICIT_DAMPING:
        damping.clear_dampers(nodes)
    if WELDED:
        begin_contacts(nodes)
    for group in CONTACTS:
        if group.is_unilateral:
            find_touching(group, clock, h, nodes, scene)
        elif group.in_pieces:
            contact_in_pieces(group, clock, h, scene)
        else:
            contact_pairs(group, 0, clock, h, nodes, curves, scene)
    if NODAL:
        apply_nodal_contacts(clock, h, nodes, curves, scene)
    if WELDED:
        share_contacts(nodes)
    if not KICK_DRIFT_KICK:
        touches.integrate_powers(clock, scene.card_history)
    touches.finish_cards(clock, scene.cards, scene.card_history)
    times.time_cards(time, h, clock, scene.cards, scene.card_history)


@stage
def apply_nodal_contacts(clock, h, nodes, curves, scene):
    """Forces of contacts of the nodes of shells. Writes: as above, scene.points."""
    if NODAL_DAMPERS:
        surface_friction.clear_friction_stiffness(h, scene)
    node_contact.clear_loads(scene)
    for group in NODAL:
        if group.narrow is None:
            node_to_surface(group, clock, h, nodes, curves, scene)
        else:
            node_to_shape(group, clock, h, nodes, curves, scene)
    node_contact.sum_stiffness_bounds(scene)
