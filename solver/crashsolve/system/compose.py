"""Compose: write, for this deck, the list of calls that make one step, and compile it.

The composed module is a small readable file in the cache folder: the scene's functions (a loop per
group) followed by the integrator's own text. Nothing that the scene lacks appears in it.
`crashsolve explain` prints it.
"""

import ast
import hashlib
from importlib import import_module
from typing import Any

import numpy as np

from crashsolve.foundation.cache import read_own, write_whole
from crashsolve.foundation.compile import PACKAGE, cache_folder
from crashsolve.foundation.machine import Function, machine_code, machine_codes, runs_plain
from crashsolve.foundation.table import Tables
from crashsolve.model.clock import NOT_FINITE
from crashsolve.model.compliance import (
    contact_rows,
    has_nodal_tangents,
    tangent_contacts,
    tangent_groups,
)
from crashsolve.system import area_text, sharing
from crashsolve.system.nodal_text import is_damper, nodal_function

INTEGRATORS = "crashsolve.integrators"
TIMES = "contact_times.time_cards(TIME, h, clock, groups.cards, groups.card_history)"
CARRY = "points.carry(h, nodes, groups.points, groups.riders)"
RENEWAL = [
    "tangents(clock, nodes, curves, compliant, groups)",
    "bend(h, clock, nodes, curves, matrix, groups)",
    "assembled.linearise(rows, compliant, nodes, t, tt)",
    "assembled.factor_compliant(matrix, compliant, rows.shape[0], tt, t)",
]
TABLEAUX = ("dormand_prince_5", "radau_iia_5")  # those that recitals name as examples
SIGNATURES = {
    "residual": "current, time, nodes, rows, curves, groups",
    "jacobian": "current, time, nodes, rows, curves, groups",
    "convective": "current, time, nodes, rows, curves, groups",
    "tangents": "clock, nodes, curves, compliant, groups",
    "elements": "clock, h, groups",
    "keep_elements": "groups",
    "bend": "h, clock, nodes, curves, matrix, groups",
    "renew": "h, clock, nodes, rows, curves, compliant, matrix, t, tt, groups",
    "open_share": "clock, h, groups",
    "deform_share": "clock, h, groups",
    "load_share": "job, groups",
    "close_share": "clock, h, nodes, groups",
    "force_pass": "clock, time, h, nodes, rows, curves, groups",
    "approach": "current, nodes, groups",
    "approach_before": "current, groups",
    "beyond": "current, h, nodes, curves, groups",
    "need_rebuild": "clock, nodes, groups",
    "sum_powers": "current, h, groups",
    "hold": "h, clock, control, nodes, groups",
    "react": "h, clock, nodes, groups",
    "energy": "clock, nodes, groups, ledger",
    "measure": "time, nodes, rows, curves, groups",
}


def compose(model: Any) -> str:
    """Text of the composed module: the recital with its chapters, and the scene's functions.

    What a recital imports from a file of integrators with a leading underscore is a chapter, whose
    text takes the place of the import; the names of a tableau come from that of the deck.
    """
    method = import_module(f"{INTEGRATORS}.{model.integrator}")
    names = {"_collocation": getattr(method, "CHAPTER", ""), **dict.fromkeys(TABLEAUX, "")}
    recital = getattr(method, "RECITAL", model.integrator)
    given = {
        f"{INTEGRATORS}.{old}": f"{INTEGRATORS}.{new or model.integrator}"
        for old, new in names.items()
    }
    if model.elements:
        given |= {"crashsolve.system.timestep": "crashsolve.system.element_step"}
    if is_assembled(model):
        solvers = ("alpha", "collocation", "compliance")
        given |= {f"crashsolve.system.{name}": "crashsolve.system.assembled" for name in solvers}
    text = _insert(recital, given, {"crashsolve.system.scene": scene_text(model)})
    text = text if captures(model) else _without(text, "CAPTURES")
    return text if is_assembled(model) else _without(text, "ASSEMBLED")


def _without(text: str, feature: str) -> str:
    """Text of a recital without its blocks `if FEATURE:`."""
    lines = text.splitlines(keepends=True)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.If) and ast.unparse(node.test) == feature:
            end = node.end_lineno or node.lineno
            lines[node.lineno - 1 : end] = [""] * (end - node.lineno + 1)
    return "".join(lines)


def _insert(name: str, given: dict[str, str], texts: dict[str, str]) -> str:
    """Text of a recital or chapter with others in the place of their imports; each comes once.

    `given` renames modules, `texts` holds what else takes the place of an import.
    """
    lines = (PACKAGE / "integrators" / f"{name}.py").read_text("utf-8").splitlines(keepends=True)
    parts, at = [], 0
    for node in ast.parse("".join(lines)).body:
        if not isinstance(node, ast.ImportFrom) or node.module is None:
            continue
        module = given.get(node.module, node.module)
        assert node.end_lineno is not None
        parts += lines[at : node.lineno - 1]
        imports, at = lines[node.lineno - 1 : node.end_lineno], node.end_lineno
        if module.startswith(f"{INTEGRATORS}._"):
            if module not in texts:
                texts[module] = ""
                parts.append(_insert(module.rpartition(".")[2], given, texts))
        elif module in texts:
            parts.append(texts[module])
            texts[module] = ""
        else:
            parts += [line.replace(node.module, module) for line in imports]
    return "".join([*parts, *lines[at:]])


def load(text: str, tables: Tables) -> Function:
    """The composed step, compiled, under a name and file that depend on nothing but the text."""
    path = cache_folder() / f"crashsolve_step_{hashlib.sha256(text.encode()).hexdigest()[:16]}.py"
    if read_own(path) != text.encode():
        write_whole(path, text.encode())
    if runs_plain():
        return ends_in_nan(machine_code(path, "advance", tables))
    if tables.second is None:
        return machine_code(path, "advance", tables)
    return sharing.together(*machine_codes(path, ("advance", "assist"), tables))


def ends_in_nan(advance: Function) -> Function:
    """Plain Python raises where compiled code goes on with infinity or NaN, and is stopped."""

    def plain(number: float, flag: bool, tables: Any) -> None:
        try:
            advance(number, flag, tables)
        except (ArithmeticError, ValueError) as error:
            is_meant = isinstance(error, ArithmeticError) or "math domain" in str(error)
            if not is_meant and "cannot convert float" not in str(error):
                raise
            tables.clock[0]["status"] = NOT_FINITE

    return plain


def group_arrays(model: Any, state: Any) -> dict[str, Any]:
    """Arrays of all groups by their name in the composed module."""
    arrays: dict[str, Any] = {}
    for g in model.groups:
        arrays |= {f"{g.word}_p": g.parameters, f"{g.word}_h": g.history, f"{g.word}_o": g.output}
        if g.members is not None:
            arrays[f"{g.word}_members"] = g.members
    for c in model.contact_groups:
        arrays |= {
            f"{c.word}_a": c.elements_a,
            f"{c.word}_b": c.elements_b,
            **{f"{c.word}_data_{k}": array for k, array in enumerate(c.data)},
            f"{c.word}_p": c.parameters,
            f"{c.word}_h": c.history,
            f"{c.word}_o": c.output,
        }
        if c.search is not None:
            arrays |= {f"{c.word}_{name}": array for name, array in c.search.arrays().items()}
    for n in model.nodal_groups:
        arrays |= {f"{n.word}_{name}": array for name, array in n.arrays.items()}
    arrays |= model.nodal_loads
    if len(model.slaves):
        arrays |= {"slaves": model.slaves}
    if touches(model):
        arrays |= {"cards": state.cards, "card_history": state.card_history}
    if model.elements:
        e = model.elements
        arrays |= {"points": state.points, "lanes": state.blocks}
        arrays |= {"corners": e.corners, "riders": e.riders, "work": e.work, "motion": e.motion}
        if len(e.cuts):
            arrays |= {"taps": e.taps, "cuts": e.cuts}
    if is_halved(model):
        arrays |= sharing.arrays_of_first(model)
    return arrays


def scene_text(model: Any) -> str:
    """The scene's own functions, as Python text."""
    parts = [_imports(model)]
    parts.append(
        f"JOINTS = {bool(model.joints)}\n"
        f"CONTACTS = {bool(model.contact_groups)}\n"
        f"DENSE = {samples_within_steps(model)}\n"
        f"ONSETS = {bool(model.contact_groups or model.piecewise_groups())}\n"
        f"PIECES = {bool(model.piecewise_groups() or model.rubbing_groups())}\n"
        f"REBUILDS = {looks_ahead(model)}\n"
    )
    if captures(model):
        parts.append("CAPTURES = True\n")
    if is_assembled(model):
        parts.append("ASSEMBLED = True\n")
        if model.elements:
            parts.append(_function("elements", _strain_calls(model)))
        parts.append(_function("keep_elements", ["stiffness.keep(groups)"] * bool(model.elements)))
        parts += [_function("bend", _bend_calls(model)), _function("renew", RENEWAL)]
    if is_halved(model):
        parts += [
            _function("open_share", _open_calls(model)),
            _function("deform_share", _deform_calls(model)),
            _function("close_share", _kick_calls(model)),
        ]
        if model.element_loads():
            parts.append(_function("load_share", _load_share_calls(model)))
        parts.append(sharing.assistant(model))
    parts += [_capture(c) if c.captures else _contact(model, c) for c in model.contact_groups]
    parts += [nodal_function(group) for group in model.nodal_groups]
    parts += [
        _function("residual", _joint_calls(model, "residual")),
        _function("jacobian", _joint_calls(model, "jacobian")),
        _function("convective", _joint_calls(model, "convective")),
        _function("force_pass", _force_calls(model)),
        _function("approach", _approach_calls(model)),
        _function("approach_before", _approach_before_calls(model)),
        _function("beyond", _beyond_calls(model)),
        _function("need_rebuild", _rebuild_calls(model)),
        _function("sum_powers", _power_calls(model)),
        _function("energy", _energy_calls(model)),
        _function("measure", _measure_calls(model)),
    ]
    if captures(model):
        parts += [_function("hold", _hold_calls(model)), _function("react", _react_calls(model))]
    if is_implicit(model):
        parts.append(_function("tangents", _tangent_calls(model)))
    return "\n\n".join(parts) + "\n"


def _function(name: str, body: list[str]) -> str:
    lines = "\n".join(f"    {line}" for line in (body or ["pass"]))
    return f"@kernel\ndef {name}({SIGNATURES[name]}):\n{lines}\n"


def _imports(model: Any) -> str:
    modules = {(g.module.__name__, g.word) for g in model.groups}
    kinds = {kind for g in model.element_groups() for kind in _kinds(g)}
    kinds |= {_tangent_of(kind) for kind in kinds} if is_assembled(model) else set()
    modules |= {(kind.__name__, _alias(kind)) for kind in kinds}
    for c in model.contact_groups:
        for module in (c.narrow, None if c.captures else c.normal, c.friction):
            if module is not None:
                modules.add((module.__name__, _alias(module)))
    for n in model.nodal_groups:
        laws = (n.narrow, n.normal, n.friction)
        modules |= {(m.__name__, _alias(m)) for m in laws if m is not None}
    lines = ["from crashsolve.system import contacts" + ", points" * bool(model.elements)]
    if model.nodal_groups:
        rubs = any(n.friction for n in model.nodal_groups)
        lines.append("from crashsolve.system import faces, nodal" + ", rubbing" * rubs)
    lines += area_text.imports(model.contact_groups)
    if model.integrator == "rattle" and touches(model):
        lines.append("from crashsolve.system import work")
    shapes = [n for n in model.nodal_groups if n.narrow is not None]
    if any(_has_ends(c) for c in model.contact_groups) or any(n.has_ends for n in shapes):
        lines.append("from crashsolve.system import passing")
    if touches(model):
        lines.append("from crashsolve.system import contact_times")
    if any(n.is_smooth for n in model.nodal_groups):
        lines.append("from crashsolve.system import normals")
    if any(n.is_round for n in model.nodal_groups):
        lines.append("from crashsolve.system import ellipsoids")
    if model.elements and len(model.elements.cuts):
        lines.append("from crashsolve.parts import _cut")
    if has_slaves(model):
        lines.append("from crashsolve.system import slaves")
    if is_assembled(model):
        lines.append("from crashsolve.system import assembled, stiffness")
    if is_halved(model):
        lines.append("from crashsolve.system import crew")
    if captures(model):
        lines.append("from crashsolve.system import captures")
        lines.append("from crashsolve.model.clock import UNHELD")
    for name, alias in sorted(modules):
        package, _, leaf = name.rpartition(".")
        lines.append(f"from {package} import {leaf} as {alias}")
    lines += [
        "from crashsolve.system.energy import clear_ledger, close_ledger, lose",
        "from crashsolve.system.kinetics import kinetic_energy",
    ]
    if is_implicit(model):
        lines += [
            "from crashsolve.foundation.motion import no_tangent, point_tangent",
            "from crashsolve.foundation.vec3 import cross",
        ]
    return "\n".join(lines) + "\n"


def _alias(module: Any) -> str:
    package, _, leaf = module.__name__.rpartition(".")
    return f"{package.rpartition('.')[2]}_{leaf}"


def _joint_calls(model: Any, stage: str) -> list[str]:
    lines = []
    for g in model.joint_groups():
        p, old = "p[i]", f"groups.{g.word}_h[current, i]"
        lines += [f"p = groups.{g.word}_p", "for i in range(p.shape[0]):"]
        new = f", groups.{g.word}_h[1 - current, i]" if stage == "residual" else ""
        call = f"{p}, {old}{new}, time, nodes, rows, curves"
        lines.append(f"    {g.word}.{stage}({call})")
    return lines


def _force_calls(model: Any) -> list[str]:
    lines = ["slaves.carry(groups.slaves, nodes)"] * has_slaves(model) + _element_calls(model)
    for g in model.force_groups():
        words = "curves, groups" + f", groups.{g.word}_members" * (g.members is not None)
        lines += [
            f"p, history, out = groups.{g.word}_p, groups.{g.word}_h, groups.{g.word}_o",
            "for i in range(p.shape[0]):",
            "    old, new, o = history[clock.current, i], history[1 - clock.current, i], out[i]",
            f"    {g.word}.force(p[i], old, new, o, time, h, nodes, rows, curves)",
            *(
                [f"    {g.word}.force_on_points(p[i], old, new, o, time, h, nodes, {words})"]
                * (model.elements is not None and hasattr(g.module, "force_on_points"))
            ),
            *(f"    {line}" for line in _load_calls(model, g)),
            "    lose(clock, old, new, o.power, o.loss)",
            *(
                [f"    groups.{g.word}_w[clock.stage * p.shape[0] + i] = o.power"]
                * samples_within_steps(model)
            ),
        ]
    for g in model.following_groups():
        lines += [
            f"p, history, out = groups.{g.word}_p, groups.{g.word}_h, groups.{g.word}_o",
            "for i in range(p.shape[0]):",
            "    old, new = history[clock.current, i], history[1 - clock.current, i]",
            f"    {g.word}.follow(p[i], old, new, out[i], nodes)",
        ]
    if touches(model):
        lines += ["contacts.open_cards(groups.cards)"]
        lines += ["contacts.carry_onsets(clock.current, groups.card_history)"]
        groups = (*model.contact_groups, *model.nodal_groups)
        if model.integrator == "rattle" and any(is_damper(c.friction) for c in groups):
            lines += ["contacts.open_rubbing(nodes)"]
        lines += [f"{c.word}(clock, h, nodes, curves, groups)" for c in model.contact_groups]
        if model.nodal_groups:
            rubs = any(is_damper(n.friction) for n in model.nodal_groups)
            lines += ["rubbing.open_rubbing(h, groups)"] * rubs
            lines += ["nodal.open_loads(groups)"]
            lines += [f"{n.word}(clock, h, nodes, curves, groups)" for n in model.nodal_groups]
            lines += ["nodal.close_loads(groups)"]
        lines += ["contacts.close_cards(clock, groups.cards, groups.card_history)"]
        lines += [TIMES.replace("TIME", "time")]
    if model.elements and not is_assembled(model):
        # that of the mesh takes the place of that of its elements
        lines += ["clock.element_rate = 0.0"]
    lines += _closing_calls(model)
    lines += ["nodal.hasten(clock, groups)"] * bool(model.nodal_groups)
    return lines + ["slaves.collect(groups.slaves, nodes)"] * has_slaves(model)


def _load_calls(model: Any, g: Any) -> list[str]:
    """An entry of a group that loads elements, on both of their halves."""
    if not hasattr(g.module, "load_half"):
        return []
    words, total = "old, o, h, groups", f"{g.word}.add_up(o, h, nodes, groups.work)"
    if is_halved(model):
        return [
            "crew.call_for_load(i, clock.current, h, groups)",
            f"{g.word}.load_half(p[i], 0, {words})",
            "crew.wait_for_second(groups)",
            "crew.take_back(clock, groups)",
            total,
            total.replace("work", "second_work"),
        ]
    return [
        line for half in (0, 1) for line in (f"{g.word}.load_half(p[i], {half}, {words})", total)
    ]


def _load_share_calls(model: Any) -> list[str]:
    """The second half of the entry that is asked for."""
    g = model.element_loads()[0]
    arrays = (f"groups.{g.word}_{array}" for array in ("p[i]", "h[job.current, i]", "o[i]"))
    p, old, out = arrays
    return ["i = job.entry", f"{g.word}.load_half({p}, 1, {old}, {out}, job.h, groups)"]


def _element_calls(model: Any) -> list[str]:
    """Motion of the points, and forces of the elements between them."""
    if not model.elements:
        return []
    if is_assembled(model):
        return [CARRY, "elements(clock, h, groups)"]
    between = [CARRY, "clock.element_rate = 0.0"]
    if not is_halved(model):
        return [*_open_calls(model), *between, *_deform_calls(model)]
    return [
        *_shared("OPEN", "open_share(clock, h, groups)"),
        *between,
        *_shared("DEFORM", "deform_share(clock, h, groups)"),
        "crew.take_back(clock, groups)",
    ]


def _shared(job: str, call: str) -> list[str]:
    """One half of a job beside the other."""
    return [f"crew.call(crew.{job}, h, groups)", call, "crew.wait_for_second(groups)"]


def is_halved(model: Any) -> bool:
    """Whether two threads share the elements."""
    return bool(model.elements) and model.elements.halves is not None


def _rows(model: Any, group: Any) -> str:
    """Rows of the parts whose points and elements are meant."""
    return f"groups.{group.word}_{'share' if is_halved(model) else 'p'}"


def _open_calls(model: Any) -> list[str]:
    """First kick and drift of the points."""
    lines = []
    for g in model.element_groups():
        lines += [
            f"p, history = {_rows(model, g)}, groups.{g.word}_h",
            "for i in range(p.shape[0]):",
            "    old, new = history[clock.current, i], history[1 - clock.current, i]",
            "    points.open_points(clock, h, p[i], old, new, groups.points)",
        ]
    return lines


def _deform_calls(model: Any) -> list[str]:
    lines = []
    for g in model.element_groups():
        lines += [
            f"p = {_rows(model, g)}",
            "for i in range(p.shape[0]):",
            *(f"    {_alias(kind)}.deform(p[i], clock, h, groups)" for kind in _kinds(g)),
        ]
    return lines


def _strain_calls(model: Any) -> list[str]:
    """Forces of the elements from what they kept at the start of the step."""
    return ["stiffness.begin_again(h, clock, groups)", *_deform_calls(model)]


def _stiffness_calls(model: Any) -> list[str]:
    """Stiffness of shells after a step of h."""
    if not model.elements:
        return []
    lines = ["stiffness.take_back(h, groups)", "stiffness.reach(nodes, groups)"]
    for g in model.element_groups():
        lines += [
            f"p = groups.{g.word}_p",
            "for i in range(p.shape[0]):",
            *(f"    {_alias(_tangent_of(k))}.tangent(p[i], h, groups, matrix)" for k in _kinds(g)),
        ]
    return lines


def _kinds(group: Any) -> list[Any]:
    """Files with the kernels of those kinds of elements that a group has."""
    kinds = group.module.KINDS.items()
    used = [name for column, name in kinds if group.parameters[column].any()]
    return [import_module(f"crashsolve.parts.{name}") for name in used]


def _closing_calls(model: Any) -> list[str]:
    """What the points end a force pass with."""
    if model.elements and is_assembled(model):
        return [
            "points.hold_riders(nodes, groups.points)",
            "points.unload(clock, nodes, groups.points, groups.riders)",
        ]
    lines = ["points.unload(clock, nodes, groups.points, groups.riders)"] if model.elements else []
    if is_halved(model):
        return [
            *lines,
            "crew.hold_all(nodes, groups)",
            *_shared("CLOSE", "close_share(clock, h, nodes, groups)"),
            "crew.keep_faster(clock, groups)",
        ]
    return lines + _kick_calls(model)


def _kick_calls(model: Any) -> list[str]:
    """Second kick of the points."""
    lines = []
    for g in model.element_groups():
        lines += [
            f"p = {_rows(model, g)}",
            "for i in range(p.shape[0]):",
            "    points.close_points(clock, h, p[i], groups.points, nodes)",
        ]
    return lines


def _contact(model: Any, c: Any) -> str:
    """The loop over the pairs of one contact group."""
    g, felt = f"groups.{c.word}", _share_felt(model)
    normal, narrow = _alias(c.normal), _alias(c.narrow)
    # one force pass per step: the work over it is that of both its ends
    is_whole = model.integrator == "rattle"
    lines = [
        "@kernel",
        f"def {c.word}(clock, h, nodes, curves, groups):",
        f"    params, history, output = {g}_p, {g}_h, {g}_o",
        "    counts = groups.card_history[1 - clock.current]",
        "    for i in range(params.shape[0]):",
        "        p, out = params[i], output[i]",
        "        old, new = history[clock.current, i], history[1 - clock.current, i]",
        f"        a, b = {g}_a[p.a], {g}_b[p.b]",
        *_indented(2, area_text.gap_calls(c, narrow, _data(c))),
        *_way_of(c),
        "        m, w = nodes[a.node], nodes[b.node]",
    ]
    if is_whole:
        lines += _indented(2, area_text.first_half_calls(c))
    lines += _part(c, is_whole)
    lines += [
        "        rate, slip, d_a, d_b = contacts.closing(m, w, x, n)",
        "        contacts.latch(p, old, new, depth, rate, counts)",
        "        mob_a, mob_b = contacts.pair_mobility(m, w, d_a, d_b, n)",
        "        mass = 1.0 / (mob_a + mob_b)",
        *_indented(2, area_text.radius_calls(c, narrow, _data(c))),
        *_indented(2, area_text.press_calls(c, normal, felt)),
        "        t, t_power, t_loss = (0.0, 0.0, 0.0), 0.0, 0.0",
        "        out.friction_stored = 0.0",
    ]
    if is_whole:
        lines.append("        way = work.way_to(motion, m, x)")
    if c.resists_spin:
        is_eased = is_whole and is_damper(c.friction)
        lines += _indented(2, area_text.rub_calls(_alias(c.friction), is_whole, is_eased))
    elif c.friction:
        lines += _pair_friction(c.friction, is_whole)
    lines += [
        *_indented(2, area_text.end_calls(c, felt)),
        "        contacts.dissipate(clock, old, new, felt, power, loss, t_power, t_loss)",
        *_loss_of_jump(c),
        "        card, card_new = groups.cards[p.card], counts[p.card]",
        "        contacts.sum_card(card, card_new, p.order, felt, f, t, new, out)",
        "        contacts.sum_losses(card, new)",
    ]
    if is_whole:
        lines += _indented(2, area_text.work_calls(c))
    return "\n".join(lines) + "\n"


def _part(c: Any, is_whole: bool) -> list[str]:
    """What a pair does that is apart."""
    lines = [
        "        if depth <= 0.0:",
        "            contacts.separate(clock, old, new, out, depth, x)",
        f"            {_alias(c.normal)}.release(p, old, new)",
    ]
    if _keeps_faces(c):
        lines.append("            new.dissipated += passing.given_up(clock, h, old, n, stored)")
    if c.friction:
        lines.append(f"            {_alias(c.friction)}.release(p, old, new)")
        lines += ["            work.part_pair(old, new, rubbed)"] * is_whole
    return [
        *lines,
        "            contacts.sum_losses(groups.cards[p.card], new)",
        "            continue",
    ]


def _indented(levels: int, lines: list[str]) -> list[str]:
    return ["    " * levels + line for line in lines]


def _pair_friction(friction: Any, is_whole: bool) -> list[str]:
    """Friction of a pair; what is a damper near rest is no stiffness for a step of `rattle`."""
    is_eased, law = is_whole and is_damper(friction), _alias(friction)
    way, ease = ("work.along_plane(way, n)" if is_whole else "None"), "0.0"
    lines, seen = [], "        u = contacts.along(t, slip, n)"
    mobilities = "        mob_t, mob_u = contacts.pair_mobility(m, w, d_a, d_b, u)"
    if is_eased:
        ease = "contacts.ease_of_pair(clock, h, m, w, mob_t, mob_u, f)"
        lines += ["        u = contacts.ahead(old, slip, n)", mobilities]
    lines += [
        f"        ease = {ease}",
        f"        t, out.friction_stored, t_power, t_loss, t_k, t_c = {law}.friction_force(",
        f"            p, old, new, f, slip, {way}, n, mass, ease, curves",
        "        )",
    ]
    if not is_eased:
        counted = "        contacts.count_stiffness(m, w, mob_t, mob_u, t_k, t_c)"
        lines += [seen, mobilities, counted]
    return lines


def _keeps_faces(c: Any) -> bool:
    """Whether a touch may go on by another face than the nearest."""
    return _has_ends(c) and hasattr(c.narrow, "gap_by")


def _has_ends(c: Any) -> bool:
    """Whether the pairs of a contact group remember their way out."""
    return "passed" in c.history.dtype.names


def _way_of(c: Any) -> list[str]:
    """What a pair does to go on by its own face, and to notice that it has passed the middle."""
    if not _keeps_faces(c):
        call = "passing.note_way(clock, h, p, old, new, depth, n)"
        return [f"        {call}"] * _has_ends(c)
    return [
        "        held, over, stored = False, -1.0, out.stored",
        "        if passing.is_another_face(old, depth, n, a.radius):",
        "            v_a = passing.velocity_at(nodes[a.node], x)",
        "            v_b = passing.velocity_at(nodes[b.node], x)",
        f"            kept = {_alias(c.narrow)}.gap_by(a, b, nodes, {_data(c)}, old.normal)",
        "            if passing.keeps_face(old, v_a, v_b, n, kept):",
        "                held = True",
        "                depth, n, x, over = kept",
        *_beyond_middle(c),
        "        passing.note_face(clock, h, p, old, new, held, over, depth, n)",
    ]


def _beyond_middle(c: Any) -> list[str]:
    """How far a pair is beyond the middle of a round face."""
    past = f"max(over, depth - {_alias(c.narrow)}.middle(a, b, nodes, n))"
    lines = ["        if depth > a.radius:", f"            over = {past}"]
    return lines if hasattr(c.narrow, "middle") else []


def _own_face(c: Any) -> list[str]:
    """The gap of a pair that goes on by its own face, where forces are not to be found anew."""
    if not _keeps_faces(c):
        return []
    call = f"{_alias(c.narrow)}.gap_by(a, b, nodes, {_data(c)}, old.normal)"
    return ["if old.held == 1:", f"    depth, n, x, _ = {call}"]


def _loss_of_jump(c: Any) -> list[str]:
    """Energy that a pair loses which leaves its own face sideways, deep within."""
    lost = "max(passing.given_up(clock, h, old, n, stored) - out.stored, 0.0)"
    lines = ["        if old.held == 1 and not held:", f"            new.dissipated += {lost}"]
    return lines if _keeps_faces(c) else []


def _share_felt(model: Any) -> str:
    """How much of the force of a contact counts in the step in which it begins."""
    whole = model.integrator == "rattle"
    return "share_felt(old, depth, rate, h)" if whole else "begun_before(clock, old, h)"


def touches(model: Any) -> bool:
    """Whether there is contact of any kind."""
    return bool(model.contact_groups or model.nodal_groups)


def has_slaves(model: Any) -> bool:
    """Whether nodes are welded to rigid bodies."""
    return len(model.slaves) > 0


def captures(model: Any) -> list[Any]:
    """Contact groups whose law is a constraint instead of a force."""
    return [c for c in model.contact_groups if c.captures]


def _capture(c: Any) -> str:
    """The loop over the pairs of one contact group that finds what is held, and where."""
    g = f"groups.{c.word}"
    lines = [
        "@kernel",
        f"def {c.word}(clock, h, nodes, curves, groups):",
        f"    params, history, output = {g}_p, {g}_h, {g}_o",
        "    for i in range(params.shape[0]):",
        "        old, new = history[clock.current, i], history[1 - clock.current, i]",
        f"        a, b = {g}_a[params[i].a], {g}_b[params[i].b]",
        f"        depth, n, x = {_alias(c.narrow)}.gap(a, b, nodes, {_data(c)})",
        "        m, w = nodes[a.node], nodes[b.node]",
        "        captures.look(clock, h, old, new, output[i], m, w, depth, n, x)",
    ]
    return "\n".join(lines) + "\n"


def _pairs(c: Any) -> str:
    """Parameters, history and elements of a group, as functions of captures take them."""
    g = f"groups.{c.word}"
    return f"{g}_p, {g}_h, ({g}_a, {g}_b)"


def _sweeps(model: Any, is_half: bool, is_blow: bool) -> list[str]:
    """Sweeps over the pairs of all groups until their impulses agree."""
    lines = ["for _ in range(captures.SWEEPS):", "    change, most = 0.0, 0.0"]
    for c in captures(model):
        call = f"{is_half}, {is_blow}, clock.current, {_pairs(c)}, nodes, change, most"
        lines.append(f"    change, most = captures.sweep({call})")
    return [*lines, "    if change <= captures.SETTLED * most:", "        break"]


def _hold_calls(model: Any) -> list[str]:
    groups, worst = captures(model), "worst = 0.0"
    lines = [f"captures.forget(clock.current, groups.{c.word}_h)" for c in groups]
    lines += [worst, "for _ in range(captures.PASSES):"]
    body = [*_sweeps(model, True, False), worst]
    for c in groups:
        g = f"groups.{c.word}"
        body += [
            f"captures.drift_held(clock.current, h, {_pairs(c)}, nodes)",
            f"params, history = {g}_p, {g}_h",
            "for i in range(params.shape[0]):",
            "    old, new = history[clock.current, i], history[1 - clock.current, i]",
            "    if old.active == 1:",
            f"        a, b = {g}_a[params[i].a], {g}_b[params[i].b]",
            f"        depth, _, _ = {_alias(c.narrow)}.gap(a, b, nodes, {_data(c)})",
            "        worst = max(worst, captures.aim(old, new, depth, h))",
        ]
    body += ["if worst <= captures.CLOSED * control.length:", "    break"]
    lines += [f"    {line}" for line in body]
    lines += ["if not worst <= captures.CLOSED * control.length:"]
    lines += ["    clock.status, clock.value = UNHELD, worst"]
    return lines + [f"captures.rub_open(clock.current, {_pairs(c)}, nodes)" for c in groups]


def _react_calls(model: Any) -> list[str]:
    groups = captures(model)
    lines = ["if h > 0.0:", *(f"    {line}" for line in _sweeps(model, False, False))]
    lines.append("    fresh = 0")
    for c in groups:
        call = f"h, clock.current, {_pairs(c)}, nodes"
        lines.append(f"    fresh += captures.note_reactions({call})")
    lines.append("    if fresh > 0:")
    lines += [f"        {line}" for line in _sweeps(model, False, True)]
    for c in groups:
        call = f"clock.current, {_pairs(c)}, nodes, groups.card_history"
        lines.append(f"        captures.note_blows({call})")
    for c in groups:
        params, history, elements = _pairs(c).split(", ", 2)
        call = f"{params}, {history}, groups.{c.word}_o, {elements}"
        lines.append(f"captures.settle(h, clock, {call}, nodes, groups.cards, groups.card_history)")
    return [*lines, TIMES.replace("TIME", "clock.time + h")]


def _data(c: Any) -> str:
    """The arrays that all elements of a gap routine share, as a tuple."""
    names = ", ".join(f"groups.{c.word}_data_{k}" for k in range(len(c.data)))
    return f"({names})" if len(c.data) != 1 else f"({names},)"


def _tangent_of(kind: Any) -> Any:
    """The file with the tangent of a kind of elements."""
    leaf = kind.__name__.rpartition(".")[2].lstrip("_")
    return import_module(f"crashsolve.parts._{leaf}_tangent")


def is_implicit(model: Any) -> bool:
    """Whether the integrator asks for the tangents of the laws."""
    return hasattr(import_module(f"crashsolve.integrators.{model.integrator}"), "T")


def is_assembled(model: Any) -> bool:
    """Whether implicit equations are those of all nodes at once, for shells and beams."""
    return is_implicit(model) and has_nodal_tangents(model)


# what adds to the blocks of nodes, with what it is given of one element or spring
ON_BLOCKS = {
    "bend": "p[i], history[clock.current, i], nodes, curves",
    "turn_force": "p[i], out[i], nodes",
}


def _bend_calls(model: Any) -> list[str]:
    """Stiffness of shells, and what turns the forces of beams and springs, in the matrix."""
    lines = ["assembled.open_blocks(nodes, matrix)", *_stiffness_calls(model)]
    for k, g in enumerate(tangent_groups(model)):
        for name, given in ON_BLOCKS.items():
            if hasattr(g.module, name):
                lines += [
                    f"p, history, out = groups.{g.word}_p, groups.{g.word}_h, groups.{g.word}_o",
                    f"first = groups.tangents[{k}].first",
                    "for i in range(p.shape[0]):",
                    f"    place = matrix.pairs[first + {g.module.TANGENTS} * i]",
                    f"    {g.word}.{name}({given}, place, matrix.blocks)",
                ]
    return lines


def _tangent_calls(model: Any) -> list[str]:
    lines, k = [], 0
    for g in tangent_groups(model):
        lines += [
            f"p, history = groups.{g.word}_p, groups.{g.word}_h",
            f"first = groups.tangents[{k}].first",
            "for i in range(p.shape[0]):",
            f"    at = first + {g.module.TANGENTS} * i",
            f"    {g.word}.tangent(p[i], history[clock.current, i], nodes, curves, compliant, at)",
        ]
        k += 1
    for c in tangent_contacts(model):
        lines += _contact_tangent(c, k)
        k += 1
    return lines


def _contact_tangent(c: Any, k: int) -> list[str]:
    """The loop over the pairs of one contact group that writes their tangents."""
    g, normal, rows = f"groups.{c.word}", _alias(c.normal), contact_rows(c)
    lines = [
        f"params, history, first = {g}_p, {g}_h, groups.tangents[{k}].first",
        "for i in range(params.shape[0]):",
        f"    p, old, at = params[i], history[clock.current, i], first + {rows} * i",
        "    if old.active == 0:",
        f"        for j in range({rows}):",
        "            no_tangent(compliant[at + j])",
        "        continue",
        f"    a, b = {g}_a[p.a], {g}_b[p.b]",
        f"    depth, n, x = {_alias(c.narrow)}.gap(a, b, nodes, {_data(c)})",
        *(f"    {line}" for line in _own_face(c)),
        "    depth = max(depth, 0.0)",
        "    m, w = nodes[a.node], nodes[b.node]",
        "    rate, slip, d_a, d_b = contacts.closing(m, w, x, n)",
        "    mob_a, mob_b = contacts.pair_mobility(m, w, d_a, d_b, n)",
        "    mass = 1.0 / (mob_a + mob_b)",
        f"    k, c = {normal}.normal_tangent(p, old, depth, rate, mass, curves)",
        *["    k, c = a.share * k, a.share * c"] * c.has_shares,
        "    point_tangent(compliant[at], n, d_a, d_b, k, c)",
    ]
    if c.friction or c.is_flat:
        lines += [
            f"    f, _, _, _, _, _ = {normal}.normal_force("
            "p, old, history[1 - clock.current, i], 0.0, depth, rate, mass, curves)",
            *["    f = a.share * f"] * c.has_shares,
        ]
    lines += _indented(1, area_text.radius_calls(c, _alias(c.narrow), _data(c)))
    lines += _indented(1, area_text.tilt_calls(c))
    if c.resists_spin:
        lines += _indented(1, area_text.rub_tangent_calls(c, _alias(c.friction)))
    elif c.friction:
        lines += [
            f"    c, c_across = {_alias(c.friction)}.friction_tangent(p, f, slip)",
            "    u = contacts.along((0.0, 0.0, 0.0), slip, n)",
            "    point_tangent(compliant[at + 1], u, d_a, d_b, 0.0, c)",
            "    point_tangent(compliant[at + 2], cross(n, u), d_a, d_b, 0.0, c_across)",
        ]
    return lines


def _approach_calls(model: Any) -> list[str]:
    lines = ["deepest = -1e300"]
    for c in model.contact_groups:
        g = f"groups.{c.word}"
        measure = [
            f"a, b = {g}_a[params[i].a], {g}_b[params[i].b]",
            f"depth, _, _ = {_alias(c.narrow)}.gap(a, b, nodes, {_data(c)})",
        ]
        lines += [f"params, history = {g}_p, {g}_h", "for i in range(params.shape[0]):"]
        if _locates_ends(model):
            lines += [f"    {line}" for line in measure]
            lines += [
                "    deepest = max(deepest, depth if history[current, i].active == 0 else -depth)"
            ]
        else:
            lines += ["    if history[current, i].active == 0:"]
            if hasattr(c.narrow, "bound"):
                call = f"{_alias(c.narrow)}.bound(a, b, nodes, {_data(c)})"
                measure[1:] = [
                    f"if {call} > deepest:",
                    f"    {measure[1]}",
                    "    deepest = max(deepest, depth)",
                ]
                lines += _indented(2, measure)
            else:
                lines += [f"        {line}" for line in [*measure, "deepest = max(deepest, depth)"]]
    return [*lines, "return deepest"]


def _approach_before_calls(model: Any) -> list[str]:
    lines = ["deepest = -1e300"]
    for c in model.contact_groups:
        lines += [
            f"history = groups.{c.word}_h",
            "for i in range(history.shape[1]):",
            "    depth = history[current, i].depth",
        ]
        if _locates_ends(model):
            lines += [
                "    deepest = max(deepest, depth if history[current, i].active == 0 else -depth)"
            ]
        else:
            lines += [
                "    if history[current, i].active == 0:",
                "        deepest = max(deepest, depth)",
            ]
    return [*lines, "return min(deepest, 0.0)"]


def _beyond_calls(model: Any) -> list[str]:
    lines = ["farthest = -1e300"]
    for g in model.piecewise_groups():
        lines += [
            f"p, history = groups.{g.word}_p, groups.{g.word}_h",
            "for i in range(p.shape[0]):",
            f"    past = {g.word}.beyond(p[i], history[current, i], h, nodes, curves)",
            "    farthest = max(farthest, past)",
        ]
    for c in model.rubbing_groups():
        g = f"groups.{c.word}"
        lines += [
            f"params, history = {g}_p, {g}_h",
            "for i in range(params.shape[0]):",
            "    p, old = params[i], history[current, i]",
            "    if old.active == 1:",
            f"        a, b = {g}_a[p.a], {g}_b[p.b]",
            f"        depth, n, x = {_alias(c.narrow)}.gap(a, b, nodes, {_data(c)})",
            *(f"        {line}" for line in _own_face(c)),
            "        if depth > 0.0:",
            "            _, slip, _, _ = contacts.closing(nodes[a.node], nodes[b.node], x, n)",
            *_indented(3, area_text.radius_calls(c, _alias(c.narrow), _data(c))),
            *["            slip = areas.sliding(nodes[a.node], nodes[b.node], slip, n, radius)"]
            * c.resists_spin,
            f"            past = h * {_alias(c.friction)}.regime_left(p, old, slip)",
            "            farthest = max(farthest, past)",
        ]
    return [*lines, "return farthest"]


def _locates_ends(model: Any) -> bool:
    """Whether steps are cut at the end of a contact too: a method of high order feels that kink."""
    return bool(model.integrator != "rattle")


def samples_within_steps(model: Any) -> bool:
    """Whether samples are taken from the dense output of steps that they do not cut.

    What a contact keeps of a step, as its impact speed and its peak, is known at the ends alone.
    """
    method = import_module(f"crashsolve.integrators.{model.integrator}")
    return hasattr(method, "DENSE") and not model.contact_groups


def _power_calls(model: Any) -> list[str]:
    if not samples_within_steps(model):
        return []
    # the last row of the tableau has the weights of the sample
    lines = ["total = groups.stages.shape[0]", "first = total * (total - 1)"]
    for g in model.force_groups():
        lines += [
            f"history, powers = groups.{g.word}_h, groups.{g.word}_w",
            "count = history.shape[1]",
            "for i in range(count):",
            "    lost = groups.A[first] * history[current, i].power",
            "    for j in range(1, total - 1):",
            "        lost += groups.A[first + j] * powers[count * j + i]",
            "    history[1 - current, i].dissipated += h * lost",
        ]
    return lines


def _looks_ahead(c: Any) -> bool:
    """Whether the next step of a contact group must be cut: a list to renew, sides with an end."""
    return c.search is not None or bool(np.isfinite(c.parameters["thick"]).any())


def looks_ahead(model: Any) -> bool:
    """Whether the step must be asked about before it is taken."""
    return bool(model.nodal_groups or any(_looks_ahead(c) for c in model.contact_groups))


def _rebuild_calls(model: Any) -> list[str]:
    lines = ["stale = False"]
    for n in model.nodal_groups:
        p, tally = f"groups.{n.word}_p[0]", f"groups.{n.word}_tally[0]"
        lines.append(f"nodal.hold_back(clock, {p}, {tally})")
        if n.narrow is None:
            lines.append(f"stale |= faces.is_crowded({p}, {tally})")
    for c in model.contact_groups:
        if c.search is not None:
            g = f"groups.{c.word}"
            for side in ("a", "b"):
                call = f"contacts.strayed(clock, {g}_{side}, nodes, {g}_seen_{side}, {g}_slack[0])"
                lines.append(f"stale |= {call}")
        elif _looks_ahead(c):
            g = f"groups.{c.word}"
            call = f"clock, {g}_p, {g}_h, {g}_a, {g}_b, nodes"
            lines.append(f"contacts.hold_back({call})")
    return [*lines, "return stale"]


# entries of what laws store and of what they lose, by the word LEDGER of their module
BOOKED = {
    "spring": ("SPRING_STORED", "SPRING_DISSIPATED"),
    "hinge": ("HINGE_STORED", "HINGE_DISSIPATED"),
    "joint": ("JOINT_STORED", "JOINT_DISSIPATED"),
    "brake": ("BRAKE_STORED", "BRAKE_DISSIPATED"),
    "external": ("POTENTIAL", "EXTERNAL_WORK"),
    "potential": ("POTENTIAL", ""),
}


def _law_energies(g: Any, e: Any) -> list[str]:
    """What the laws of a group hold, and have lost, in the entries of their kind."""
    kind = getattr(g.module, "LEDGER", "external" if g.keyword == "loads" else "spring")
    stored, lost = BOOKED[kind]
    lines = [f"    ledger[{getattr(e, stored)}] += groups.{g.word}_o[i].stored"]
    if lost:
        value = f"groups.{g.word}_h[clock.current, i].dissipated"
        lines.append(f"    ledger[{getattr(e, lost)}] += {value}")
    return lines


def _beam_energies(g: Any, e: Any) -> list[str]:
    """What elements of beams hold, lost by plastic work, and lost by damping."""
    lost = f"groups.{g.word}_h[clock.current, i]"
    lines = [f"    ledger[{e.ELASTIC}] += groups.{g.word}_o[i].stored"]
    if "work" not in (g.history.dtype.names or ()):
        return [*lines, f"    ledger[{e.PART_DAMPING}] += {lost}.dissipated"]
    return [
        *lines,
        f"    ledger[{e.PLASTIC}] += {lost}.work",
        f"    ledger[{e.PART_DAMPING}] += {lost}.dissipated - {lost}.work",
    ]


def _nodal_energies(n: Any, e: Any) -> list[str]:
    """What the touches of a group of nodes hold, and have lost."""
    tally = f"groups.{n.word}_tally[0]"
    lines = [
        f"ledger[{e.CONTACT_STORED}] += {tally}.stored",
        f"ledger[{e.CONTACT_DISSIPATED}] += {tally}.dissipated",
    ]
    if n.friction:
        lines += [
            f"ledger[{e.FRICTION_STORED}] += {tally}.bristled",
            f"ledger[{e.FRICTION_DISSIPATED}] += {tally}.rubbed",
        ]
    return lines


def _energy_calls(model: Any) -> list[str]:
    from crashsolve.model import ledger as e

    lines = ["clear_ledger(ledger)", f"ledger[{e.KINETIC}] = kinetic_energy(nodes)"]
    for g in model.force_groups():
        lines.append(f"for i in range(groups.{g.word}_o.shape[0]):")
        lines += _beam_energies(g, e) if g.keyword == "parts" else _law_energies(g, e)
    for g in model.element_groups():
        lines += [
            f"for i in range(groups.{g.word}_o.shape[0]):",
            f"    o, new = groups.{g.word}_o[i], groups.{g.word}_h[clock.current, i]",
            f"    {g.word}.energies(groups.{g.word}_p[i], new, o, groups)",
            *(f"    {_alias(k)}.add_energies(groups.{g.word}_p[i], o, groups)" for k in _kinds(g)),
            # points of implicit steps are bodies
            *([] if is_assembled(model) else [f"    ledger[{e.KINETIC}] += o.kinetic"]),
            f"    ledger[{e.ELASTIC}] += o.strain",
            f"    ledger[{e.HOURGLASS}] += o.hourglass",
            f"    ledger[{e.DRILLING}] += o.drilling",
            f"    ledger[{e.PLASTIC}] += o.plastic",
            f"    ledger[{e.PART_DAMPING}] += o.drag + o.damping",
            f"    ledger[{e.ERODED}] += o.eroded",
        ]
    if model.elements:
        lines += ["points.guard(clock, nodes, groups.points)"]
    for c in model.contact_groups:
        lines += [
            f"for i in range(groups.{c.word}_o.shape[0]):",
            f"    o, old = groups.{c.word}_o[i], groups.{c.word}_h[clock.current, i]",
            f"    ledger[{e.CONTACT_STORED}] += o.stored",
            f"    ledger[{e.FRICTION_STORED}] += o.friction_stored",
            f"    ledger[{e.CONTACT_DISSIPATED}] += old.dissipated",
            f"    ledger[{e.FRICTION_DISSIPATED}] += old.friction_dissipated",
        ]
    for n in model.nodal_groups:
        lines += _nodal_energies(n, e)
    if any(c.search is not None for c in model.contact_groups):
        lines += [
            "for i in range(groups.cards.shape[0]):",
            "    card = groups.card_history[clock.current, i]",
            f"    ledger[{e.CONTACT_DISSIPATED}] += card.left_dissipated",
            f"    ledger[{e.FRICTION_DISSIPATED}] += card.left_friction_dissipated",
        ]
    return [*lines, f"ledger[{e.DRIVER_WORK}] = clock.driver_work", "close_ledger(ledger)"]


def _cut_calls(model: Any) -> list[str]:
    """Blocks of the elements of sections once more, one after the other."""
    lines = ["_cut.open_cuts(groups)", "before = -1", "for k in range(groups.taps.shape[0]):"]
    lines += ["    tap = groups.taps[k]", "    if tap.first != before:"]
    for g in model.element_groups():
        places = list(g.module.KINDS.values())
        for kind in _kinds(g):
            number = places.index(kind.__name__.rpartition(".")[2])
            call = f"{_alias(kind)}.respond(groups.{g.word}_p[tap.part], 0.0, tap.first, "
            lines.append(f"        if tap.kind == {number}:")
            lines.append(f"            {call}tap.corner, groups)")
    lines += ["        before = tap.first", "    _cut.add_tap(tap, groups)"]
    return [*lines, "_cut.close_cuts(groups)"]


def _measure_calls(model: Any) -> list[str]:
    lines = ["points.add_up_motion(groups.points, groups.motion[0])"] * bool(model.elements)
    lines += _cut_calls(model) if model.elements and len(model.elements.cuts) else []
    for g in model.sensor_groups():
        lines += [
            f"p, out = groups.{g.word}_p, groups.{g.word}_o",
            "for i in range(p.shape[0]):",
            f"    {g.word}.measure(p[i], out[i], time, nodes, rows, curves)",
        ]
    return lines
