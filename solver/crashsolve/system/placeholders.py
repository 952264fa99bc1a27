"""Placeholders: names in loops and integrators that stand for the groups of a scene.

`compose` gives them their values for a deck (`placeholders`) and copies the loops for them: blocks
that the scene has no use for are left out, and `for group in JOINTS:` stands once for every group.
Here they have their types and meanings, for readers and for the checks. Consequence: nothing in
the compiled step tests the kind of its scene.
"""

from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from crashsolve.model.contact.groups import ContactGroup, NodalGroup
from crashsolve.model.implicit.compliance import (
    has_nodal_tangents,
    tangent_contacts,
    tangent_groups,
)
from crashsolve.model.model import Group, Model, State
from crashsolve.model.welded import touches_welded
from crashsolve.system.contact.effective_mass import groups_with_effective_mass

# groups by the functions of their laws
JOINTS: tuple[Group, ...] = ()  # constraint rows
FORCES: tuple[Group, ...] = ()  # forces between bodies, or on them
WATCHED: tuple[Group, ...] = ()  # of them, those judged by their own work
SENSORS: tuple[Group, ...] = ()  # readings
FOLLOWERS: tuple[Group, ...] = ()  # sensors that are evaluated in every step
ELEMENTS: tuple[Group, ...] = ()  # parts whose elements are kept in blocks
ELEMENT_LOADS: tuple[Group, ...] = ()  # loads on elements kept in blocks
BRANCHES: tuple[Group, ...] = ()  # laws of several branches, with an event function
TANGENTS: tuple[Group, ...] = ()  # laws that state implicit methods their tangents
CONTACTS: tuple[ContactGroup, ...] = ()  # contact pairs
UNILATERAL: tuple[ContactGroup, ...] = ()  # of them, those held by impulses
WITH_EFFECTIVE_MASS: tuple[
    ContactGroup, ...
] = ()  # of them, those whose damping is that of the whole touch
BRANCHED: tuple[ContactGroup, ...] = ()  # of them, those whose forces have branches
TANGENT_CONTACTS: tuple[ContactGroup, ...] = ()  # of them, those that keep all their pairs
NODAL: tuple[NodalGroup, ...] = ()  # nodes on shapes and on the faces of shells

# other content of the scene
SEPARATING = True  # joints that may fail and release their bodies
ATTACHMENTS = True  # nodes welded to rigid bodies
TIES = True  # points that are tied to faces
CUTS = True  # sensors that cut through elements
SEARCHES = True  # lists of near pairs, which are renewed
MANY_PAIRS = True  # contacts whose pairs are done in pieces
RESTING = True  # contacts whose pairs are skipped until they may touch
PAIR_DAMPERS = True  # contacts whose friction depends on the sliding speed alone
WELDED = True  # contacts on bodies that welds join to others
IMPLICIT_DAMPING = True  # contacts whose damping is by the closing speed to which it leads
NODAL_DAMPERS = True  # the same between nodes and faces

# how the scene is stepped
KICK_DRIFT_KICK = True  # one force pass a step, and the work of a step is that of both its ends
ASSEMBLED = True  # implicit, with a matrix of all nodes, for shells and beams
THREADS = True  # several share the elements, and many contact pairs
DENSE = True  # a sample may lie within a step
ONSETS = True  # something may begin within a step
EVENTS = True  # there are laws with an event function
BOUNDS_NEXT_STEP = True  # contacts cut the next step: a list to renew, or sides with an end
COUNTS_ROTATIONS = True  # laws follow angles from step to step, and steps may be long


def placeholders(model: Model) -> dict[str, Any]:
    """Values of the names above in a scene."""
    contacts, nodal = model.contact_groups, model.nodal_groups
    damped = [n.friction_damps for n in nodal]
    return {
        "JOINTS": tuple(model.joint_groups()),
        "SEPARATING": any(g.can_separate for g in model.joint_groups()),
        "FORCES": tuple(model.force_groups()),
        "WATCHED": tuple(g for g in model.force_groups() if g.is_watched),
        "SENSORS": tuple(model.sensor_groups()),
        "FOLLOWERS": tuple(model.following_groups()),
        "ELEMENTS": tuple(model.element_groups()),
        "ELEMENT_LOADS": tuple(model.element_loads()),
        "BRANCHES": tuple(model.branching_groups()),
        "TANGENTS": tuple(tangent_groups(model)),
        "CONTACTS": tuple(contacts),
        "UNILATERAL": tuple(c for c in contacts if c.is_unilateral),
        "WITH_EFFECTIVE_MASS": groups_with_effective_mass(model),
        "BRANCHED": tuple(model.branching_contacts()),
        "TANGENT_CONTACTS": tuple(tangent_contacts(model)),
        "NODAL": tuple(nodal),
        "ATTACHMENTS": len(model.attached_nodes) > 0,
        "TIES": model.elements is not None and len(model.elements.ties) > 0,
        "CUTS": model.elements is not None and len(model.elements.cuts) > 0,
        "SEARCHES": any(c.search is not None for c in contacts),
        "MANY_PAIRS": any(c.in_pieces for c in contacts),
        "RESTING": hasattr(method(model), "KICK_DRIFT_KICK")
        and any(c.skips or c.follows_exit for c in contacts),
        "PAIR_DAMPERS": any(damped) or any(c.friction_damps for c in contacts),
        "IMPLICIT_DAMPING": hasattr(method(model), "KICK_DRIFT_KICK")
        and any(c.resolves_damping for c in contacts),
        "WELDED": hasattr(method(model), "KICK_DRIFT_KICK") and touches_welded(model),
        "NODAL_DAMPERS": any(damped),
        "KICK_DRIFT_KICK": hasattr(method(model), "KICK_DRIFT_KICK"),
        "ASSEMBLED": is_assembled(model),
        "THREADS": is_shared(model),
        "DENSE": samples_within_steps(model),
        "ONSETS": bool(contacts or model.branching_groups()),
        "EVENTS": bool(model.branching_groups() or model.branching_contacts()),
        "BOUNDS_NEXT_STEP": bool(nodal or any(c.bounds_next_step for c in contacts)),
        "COUNTS_ROTATIONS": counts_rotations(model),
    }


def method(model: Model) -> ModuleType:
    """Module of the integrator."""
    return import_module(f"crashsolve.integrators.{model.integrator}")


def is_implicit(model: Model) -> bool:
    """Whether the integrator needs the tangents of the laws."""
    return hasattr(method(model), "T")


def is_assembled(model: Model) -> bool:
    """Whether implicit equations are those of all nodes at once, for shells and beams."""
    return is_implicit(model) and has_nodal_tangents(model)


def is_shared(model: Model) -> bool:
    """Whether several threads share its steps."""
    return model.threads > 1


def counts_rotations(model: Model) -> bool:
    """Whether laws follow angles from step to step, and a step may rotate a body far."""
    is_short = hasattr(method(model), "KICK_DRIFT_KICK") and not model.control[0]["fixed_step"] > 0
    return not is_short and any(hasattr(g.module, "COUNTS_ROTATIONS") for g in model.groups)


def samples_within_steps(model: Model) -> bool:
    """Whether samples are taken from the dense output of steps that they do not cut.

    What a contact keeps of a step, as its impact speed and its peak, is known at the ends alone.
    """
    return hasattr(method(model), "DENSE") and not model.contact_groups


def group_arrays(model: Model, state: State) -> dict[str, np.ndarray]:
    """Arrays of all groups by their name in the composed module."""
    arrays: dict[str, np.ndarray] = {}
    groups: list[Group | ContactGroup | NodalGroup] = [
        *model.groups,
        *model.contact_groups,
        *model.nodal_groups,
    ]
    for group in groups:
        arrays |= {f"{group.word}_{name}": array for name, array in group.tables().items()}
    arrays |= model.nodal_loads
    if len(model.attached_nodes):
        arrays |= {"attached_nodes": model.attached_nodes}
    if model.contact_groups or model.nodal_groups:
        arrays |= {"cards": state.cards, "card_history": state.card_history}
    if model.elements:
        e = model.elements
        arrays |= {"points": state.points, "lanes": state.blocks}
        arrays |= {
            "corners": e.corners,
            "attached_points": e.attached_points,
            "work": e.work,
            "motion": e.motion,
            "holds": e.holds,
        }
        if len(e.block_sums):
            arrays |= {"block_sums": e.block_sums}
        if len(e.ties):
            arrays |= {"ties": e.ties}
        if len(e.cuts):
            arrays |= {"element_cuts": e.element_cuts, "cuts": e.cuts}
    if not is_shared(model):
        return arrays
    from crashsolve.threads.sharing import shared_arrays

    return arrays | shared_arrays(model)
