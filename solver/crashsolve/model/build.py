"""Build: names become indices, words become symbols, cards become Model and State. Runs once."""

from __future__ import annotations

from collections import defaultdict
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.family import CHOSEN, DEFAULT_INTEGRATOR, FamilyError, families
from crashsolve.foundation.curve import pack
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.point import ATTACHED, BLOCK_SUM, HOLD, blocks_of
from crashsolve.foundation.record import Record
from crashsolve.model import attachments
from crashsolve.model.checks import methods
from crashsolve.model.checks.finite import BEYOND_NUMBERS, of_model, refuse_beyond
from crashsolve.model.checks.gyration import gyration_warnings
from crashsolve.model.checks.magnitudes import magnitude_warnings
from crashsolve.model.checks.sampling import step_warnings
from crashsolve.model.checks.statics import is_incremental, refuse_motion
from crashsolve.model.citations import citations, laws_in_use
from crashsolve.model.clock import CLOCK, CONTROL
from crashsolve.model.contact import records
from crashsolve.model.contact.body_pairs import find_body_pairs, mark_bodies
from crashsolve.model.contact.build import build_contacts
from crashsolve.model.contact.groups import ContactGroup, thinnest_of
from crashsolve.model.contact.pieces import cut as cut_pairs
from crashsolve.model.contact.pieces import has_many
from crashsolve.model.curve_steps import warn_of_unseen
from crashsolve.model.elements import (
    build_elements,
    initial_blocks,
    initial_points,
    tables_of_elements,
)
from crashsolve.model.force_columns import (
    FORCE_HISTORY,
    FORCE_OUTPUT,
    ROW_PARAMETERS,
    history_of_force,
)
from crashsolve.model.hubs import longest_arm, plan_of, set_references
from crashsolve.model.integrator_selection import Choice, by_default, choose, resolve
from crashsolve.model.ledger import ENTRIES
from crashsolve.model.materials import fill, laws_of, refuse_different, with_constants, with_memory
from crashsolve.model.model import Group, Joint, Model, State
from crashsolve.model.motions import derivatives_read
from crashsolve.model.nodes import IMPLICIT_STAGE, NODE, ROW, STAGE
from crashsolve.model.phases import build_phases
from crashsolve.model.scene import Scene
from crashsolve.model.welded import touches_welded, with_wholes

if TYPE_CHECKING:
    from crashsolve.deck.reading.deck import Deck
    from crashsolve.deck.reading.items import Entry

# columns of loads on points, whose positions are known when all entries are
FILLED_LATER = ("first_member", "member_count")
# default error of a step
TOLERANCE = 1e-6


def build(deck: Deck) -> tuple[Model, State]:
    """Model and initial State of a deck.

    Raises: DeckErrors naming every card that cannot be built.
    """
    try:
        # they are checked below, card by card
        with np.errstate(all="ignore"):
            model, state = _build(deck)
            model.warnings.extend(warn_of_unseen(model))
            refuse_beyond(deck, model, state)
    except BEYOND_NUMBERS:
        raise DeckErrors([of_model(deck)]) from None
    return model, state


def _build(deck: Deck) -> tuple[Model, State]:
    scene = Scene(deck)
    methods.refuse_methods(scene)
    curves = _build_curves(deck, scene)
    # the rest needs bodies and curves without errors
    scene.raise_errors()
    groups: list[Group] = []
    joints = _build_joints(deck, scene, groups)
    scene.joints = {joint.name: joint for joint in joints}
    scene.size = max(scene.size, longest_arm(joints))
    for entries in _by_type(deck.entries["parts"]).values():
        is_meshed = hasattr(_module(entries[0]), "KINDS")
        groups.append((build_elements if is_meshed else _build_parts)(entries, scene))
    for keyword in _sections(with_rows=False):
        for entries in _by_type(deck.entries[keyword]).values():
            groups.append(_build_group(keyword, entries, scene))
    contact_groups, nodal_groups = build_contacts(deck, scene)
    phases = build_phases(deck, scene)
    scene.raise_errors()
    refuse_motion(deck, groups)
    scene.warnings += magnitude_warnings(deck.entries, deck.control.solution != "transient")
    scene.warnings += gyration_warnings(scene, groups, joints) + step_warnings(deck)

    model = Model(
        title=deck.title,
        bodies=scene.names,
        mass=np.where(np.isin(np.arange(len(scene.mass)), list(scene.welded)), 0.0, scene.mass),
        attached_nodes=attachments.table(scene),
        mass_centres=scene.offset,
        size=scene.size,
        integrator=deck.control.integrator,
        choice="",
        groups=groups,
        contact_groups=contact_groups,
        contacts=list(deck.entries["contacts"]),
        joints=joints,
        curves=curves,
        curve_names=scene.curves,
        saddle=plan_of(joints, scene.mass),
        control=_control(deck, scene, contact_groups),
        warnings=scene.warnings,
        citations=citations(laws_in_use(groups, [*contact_groups, *nodal_groups])),
        surfaces=scene.surfaces,
        elements=tables_of_elements(groups, scene),
        nodal_groups=nodal_groups,
        phases=phases,
    )
    model.warnings.extend(warn_of_unseen(model))
    return model, _arranged(model, scene)


def _arranged(model: Model, scene: Scene) -> State:
    """The State, and the parts of the Model that depend on the method. Writes: model."""
    if scene.deck.control.solution == "quasi_static" and is_incremental(model.groups):
        # by steps from rest (statics/pseudo_transient.py)
        model.integrator = "newton"
    state = _state(model, scene)
    if model.nodal_groups:
        from crashsolve.model.contact.node_to_surface import loads_of_points

        model.nodal_loads = loads_of_points(len(state.points))
    if model.integrator in CHOSEN:
        model.integrator, model.choice = _choose(model, state, scene)
    methods.refuse_several(model, scene.deck)
    if model.elements:
        _arrange(model, state, scene)
    _share_pairs(model, scene)
    if hasattr(_method(model), "KICK_DRIFT_KICK") and touches_welded(model):
        state.nodes = with_wholes(state.nodes, model)
    state.stages = initial_stages(model, len(state.nodes))
    if hasattr(_method(model), "DENSE"):
        for g in model.force_groups():
            g.powers = np.zeros(len(state.stages) * len(g.names))
    return state


def _choose(model: Model, state: State, scene: Scene) -> tuple[str, str]:
    """The integrator for a deck that names none, and why."""
    is_default = model.integrator == "default"
    if is_default:
        choice = by_default(model, scene.stepwise)
    else:
        choice = choose(model, state, scene.stepwise, float(model.control[0]["tolerance"]))
    if scene.methods and choice.integrator not in scene.methods:
        choice = Choice(scene.methods[0], "known to all families of laws in the deck")
    if is_default and choice.integrator != DEFAULT_INTEGRATOR:
        resolve(model.control)
    return choice


def _arrange(model: Model, state: State, scene: Scene) -> None:
    """Points as the method needs them. Writes: model, state."""
    assert model.elements is not None
    if hasattr(_method(model), "T"):
        from crashsolve.model.implicit.assembly import add_nodes_of_points

        add_nodes_of_points(model, state)
    fixed = state.points["fixed"]
    model.elements.holds = np.flatnonzero((fixed > 0) & (fixed < ATTACHED)).astype(HOLD.dtype)
    blocks = max((int(blocks_of(g.parameters).max()) for g in model.element_loads()), default=0)
    model.elements.block_sums = np.zeros(blocks, BLOCK_SUM.dtype)
    if scene.threads > 1:
        from crashsolve.model.partition import cut

        model.threads = scene.threads
        model.elements.pieces = pieces = cut(model, state, scene.threads)
        for g in [*model.element_groups(), *model.element_loads()]:
            g.pieces, g.spans = pieces.rows[g.word], pieces.spans.get(g.word)


def _share_pairs(model: Model, scene: Scene) -> None:
    """Arrange contact pairs. Raises: DeckErrors for threads without a use. Writes: model."""
    # many are cut into pieces, whether or not there are threads to share them
    groups = [g for g in model.contact_groups if has_many(g)]
    if hasattr(_method(model), "KICK_DRIFT_KICK"):
        for group in groups:
            cut_pairs(group)
        find_body_pairs(model.contact_groups)
    if groups and scene.threads > 1:
        model.threads = scene.threads
    if not groups and not model.elements and (scene.deck.control.threads or 1) > 1:
        raise DeckErrors([scene.deck.unshared()])


def _build_curves(deck: Deck, scene: Scene) -> np.ndarray:
    """All curves as kernels read them; the scene learns where each begins."""
    built, motions = {}, derivatives_read(deck)
    for name, entry in deck.entries["curves"].items():
        law = _module(entry)
        with scene.building(entry):
            if name in motions and hasattr(law, "build_motion"):
                built[name] = law.build_motion(entry.card, scene, motions[name])
            else:
                built[name] = law.build(entry.card, scene)
    for name, entry in deck.entries["hinges"].items():
        with scene.building(entry):
            own = _module(entry).curves(entry.card, built, scene)
            scene.backbones[name] = own
            for field, backbone in own.items():
                # no curve of a deck has a point in its name
                backbone.name = f"{name}.{field}"
                built[backbone.name] = backbone.curve()
    points, starts = pack(list(built.values()))
    scene.curves = dict(zip(built, starts, strict=True))
    scene.curve_points = points
    return points


def _module(entry: Entry) -> ModuleType:
    return import_module(entry.module_name)


def _by_type(entries: dict[str, Entry]) -> dict[str, list[Entry]]:
    entries_of: dict[str, list[Entry]] = defaultdict(list)
    for entry in entries.values():
        entries_of[entry.type].append(entry)
    return entries_of


def _sections(with_rows: bool) -> list[str]:
    """Sections of families whose laws bring constraint rows, or forces or readings alone."""
    return [
        name
        for name, family in families().items()
        if family.acts and family.has_rows == with_rows and family.entry is not None
    ]


def _build_joints(deck: Deck, scene: Scene, groups: list[Group]) -> list[Joint]:
    """Joint groups with their rows, in the order of the groups."""
    joints, row = list[Joint](), 0
    sections = _sections(with_rows=True)
    kinds = [(k, e) for k in sections for e in _by_type(deck.entries[k]).values()]
    _refuse_doubles(deck, sections, scene)
    for keyword, entries in kinds:
        group = _build_group(keyword, entries, scene)
        groups.append(group)
        rows, angular = group.module.ROWS, group.module.ANGULAR
        # a joint of more than two bodies has further parts, see foundation/sparse/saddle.py
        ends = ("node_a", "node_b", *getattr(group.module, "FURTHER_NODES", ()))
        for entry, p in zip(entries, group.parameters, strict=True):
            frame = {name: p[name] for name in p.dtype.names}
            nodes = tuple(int(p[end]) for end in ends)
            joints.append(Joint(entry.name, entry.type, nodes, row, rows, angular, frame))
            p["first_row"] = row
            row += rows * len(nodes) // 2
    return joints


def _refuse_doubles(deck: Deck, sections: list[str], scene: Scene) -> None:
    """Names that occur in two sections of joints. Writes: scene.errors."""
    names: dict[str, str] = {}
    for keyword in sections:
        word = families()[keyword].entry or keyword
        for name, entry in deck.entries[keyword].items():
            first = names.setdefault(name, word)
            if first != word:
                message = f"a {first} has that name; a {word} is a joint"
                scene.errors.append(deck.error(entry, None, message))


def _build_group(keyword: str, entries: list[Entry], scene: Scene) -> Group:
    module = _module(entries[0])
    parameters = module.PARAMETERS
    history = getattr(module, "HISTORY", Record())
    output = getattr(module, "OUTPUT", Record())
    if families()[keyword].has_rows:
        parameters = parameters + ROW_PARAMETERS
    if hasattr(module, "force"):
        try:
            history = history + history_of_force(keyword, module, scene)
            output = output + FORCE_OUTPUT
        except ValueError as error:
            message = f"{module.__name__}: {error}; every law of force has these of itself"
            raise FamilyError(message) from None
    table = np.zeros(len(entries), parameters.dtype)
    rest = np.zeros((2, len(entries)), history.dtype)
    for i, entry in enumerate(entries):
        with scene.building(entry):
            scene.refuse_stepwise(module)
            built = module.build(entry.card, scene)
            refuse_different(module, module.PARAMETERS, built, FILLED_LATER)
            fill(table[i], built)
            if hasattr(module, "initial_history"):
                for side in (0, 1):
                    fill(rest[side, i], module.initial_history(entry.card, table[i], scene))
    names = [entry.name for entry in entries]
    result = np.zeros(len(entries), output.dtype)
    some = _members(module, entries, table, scene) if hasattr(module, "members") else None
    group = Group(keyword, entries[0].type, module, names, table, rest, result, some)
    if hasattr(module, "shared_tables") and not scene.errors:
        group.data = module.shared_tables([entry.card for entry in entries], table, scene)
    return group


def _members(
    module: ModuleType, entries: list[Entry], table: np.ndarray, scene: Scene
) -> np.ndarray:
    """Points that the entries act on, one after the other. Writes: table."""
    lists = [np.zeros(0, np.int64)]
    for row, entry in zip(table, [] if scene.errors else entries, strict=not scene.errors):
        with scene.building(entry):
            own = module.members(entry.card, scene)
            row["first_member"], row["member_count"] = sum(map(len, lists)), len(own)
            lists.append(own.astype(np.int64))
    return np.concatenate(lists)


def _build_parts(entries: list[Entry], scene: Scene) -> Group:
    """The elements of all parts of one type, named after their part and counted from 1."""
    module, names, rows = _module(entries[0]), [], []
    laws = laws_of(entries, scene) if hasattr(module, "CALLS_MATERIAL") else []
    for entry in entries:
        with scene.building(entry):
            scene.refuse_stepwise(module)
            own = module.elements(entry.card, scene.part_nodes[entry.name], scene)
            if laws:
                law, _ = scene.law("materials", entry.card.material)
                refuse_different(law, law.PARAMETERS, own[0]["material"])
                own = [row | {"law": laws.index(law)} for row in own]
            names += entry.card.element_names(entry.name)
            rows += own
    columns, history = module.PARAMETERS.dtype, module.HISTORY
    if laws and not scene.errors:
        columns = with_constants(module.PARAMETERS, laws)
        history = with_memory(history, laws, module.MAX_FIBRES)
    elif laws:
        # of a deck with errors nothing will run, and the material has no columns
        rows = [{name: row[name] for name in row if name != "material"} for row in rows]
    table = np.zeros(len(rows), columns)
    for record, row in zip(table, rows, strict=True):
        fill(record, row)
    rest = np.zeros((2, len(rows)), (history + FORCE_HISTORY).dtype)
    result = np.zeros(len(rows), (module.OUTPUT + FORCE_OUTPUT).dtype)
    numbered = tuple(enumerate(laws))
    word = entries[0].type
    return Group("parts", word, module, names, table, rest, result, materials=numbered)


def _control(deck: Deck, scene: Scene, contacts: list[ContactGroup]) -> np.ndarray:
    card = deck.control
    control = np.zeros(1, CONTROL.dtype)
    c = control[0]
    fixed = 0.0 if card.step == "auto" else float(card.step)
    span = max(card.end_time - card.start_time, 0.0)
    c["fixed_step"] = fixed
    c["step_max"] = card.step_max or span or 1.0
    c["step_min"] = card.step_min or 1e-12 * (span or 1.0)
    c["curve_step"], c["curve_share"] = np.inf, 1.0
    c["safety"] = card.safety
    c["rotation"] = card.safety / 5.0
    c["constraint_tolerance"] = card.constraint_tolerance
    c["onset_tolerance"] = card.onset_tolerance or 0.0
    is_free = card.energy_limit == "off" or card.solution == "quasi_static"
    c["energy_limit"] = 0.0 if is_free else float(card.energy_limit)
    c["length"], c["thinnest"] = scene.size, thinnest_of(contacts)
    c["spectral_radius"], c["gaps"] = card.spectral_radius, 1
    c["tolerance"] = card.tolerance or card.accuracy or TOLERANCE
    c["start"], c["end"] = card.start_time, card.end_time
    c["check_every"], c["follows_path"] = card.check_every, card.follows_path
    if card.resolve:
        resolve(control)
    return control


def _state(model: Model, scene: Scene) -> State:
    clock = np.zeros(1, CLOCK.dtype)
    clock[0]["time"] = start = scene.deck.control.start_time
    card_history = np.zeros((2, len(model.contacts)), records.CARD_HISTORY.dtype)
    card_history["first_touch"] = card_history["last_release"] = start - 1.0
    nodes = initial_nodes(scene)
    set_references(nodes, model.joints)
    mark_bodies(nodes, model.contact_groups)
    # the ground never moves
    nodes["start_q"], nodes["start_A"] = nodes["q"], nodes["A"]
    return State(
        clock=clock,
        nodes=nodes,
        rows=initial_rows(model),
        cards=np.zeros(len(model.contacts), records.CARD_OUTPUT.dtype),
        card_history=card_history,
        ledger=np.zeros(len(ENTRIES)),
        points=initial_points(model, scene),
        blocks=initial_blocks(model, scene.deck, scene),
        stages=np.zeros(0),
    )


def _method(model: Model) -> object:
    module = import_module(f"crashsolve.integrators.{model.integrator}")
    methods.refuse_incomplete_method(module)
    return module


def initial_stages(model: Model, nodes: int) -> np.ndarray:
    """Room (stages, nodes) for a Runge-Kutta method; none for others."""
    method = _method(model)
    rows = getattr(method, "STAGES", 0)
    if hasattr(method, "EXTRA"):
        # those of the dense output, and the sample itself
        rows += method.EXTRA + 1
    kind = IMPLICIT_STAGE if hasattr(method, "T") else STAGE
    return np.zeros((rows, nodes), kind.dtype)


def initial_nodes(scene: Scene) -> np.ndarray:
    """Node table (nodes,) at the start; the ground has no inverse mass and never moves."""
    n = len(scene.names)
    nodes = np.zeros(n, NODE.dtype)
    for name in ("r", "q", "A", "v", "w", "J"):
        nodes[name] = getattr(scene, name)
    A, J = scene.A.reshape(n, 3, 3), scene.J.reshape(n, 3, 3)
    nodes["L"] = np.einsum("nij,njk,nlk,nl->ni", A, J, A, scene.w)
    nodes["mass_inv"][1:] = 1.0 / scene.mass[1:]
    nodes["J_inv"][1:] = np.linalg.inv(J[1:]).reshape(-1, 9)
    attachments.transfer_inertia(nodes, attachments.table(scene))
    return nodes


def initial_rows(model: Model) -> np.ndarray:
    """Constraint rows (rows,) with their nodes and scales."""
    rows = np.zeros(sum(joint.rows * joint.parts for joint in model.joints), ROW.dtype)
    for joint in model.joints:
        for k in range(joint.parts):
            start = joint.first_row + k * joint.rows
            part = rows[start : start + joint.rows]
            part["node_a"], part["node_b"] = joint.nodes[2 * k : 2 * k + 2]
            part["scale"] = np.where(joint.angular, 1.0, model.size)
    return rows
