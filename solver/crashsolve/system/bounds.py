"""What sets the step, and why: in words, for the log and status.json.

The forces on the body with the least stable step are examined one by one: a sample of copies, in
which nothing else acts, gives the part of one spring, contact or element of a beam in its bound

    omega = sqrt(2 k w + (c w)^2) + c w,   w the mobility of the body where it acts  (timestep.py)

The run itself is not changed.
"""

from __future__ import annotations

from time import monotonic
from typing import NamedTuple

import numpy as np

from crashsolve.compiler.table import Tables
from crashsolve.deck.keywords import SECTIONS
from crashsolve.model.contact.body_pairs import body_pairs_of
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.contact.pieces import tables_of
from crashsolve.model.ledger import ENTRIES
from crashsolve.model.model import Group
from crashsolve.system.diagnosis import chooses_step, limiter
from crashsolve.system.engine import Engine
from crashsolve.system.placeholders import group_arrays

# more of one group on one body are evaluated together
MAX_PER_BODY = 32
# a step is cut into equal ones: a step of less than half of the wanted one has another cause
EQUAL = 0.499
# [s] after which the body that sets the step is determined anew
RENEWAL_INTERVAL = 1.0
# share of the bound that goes when a body cannot rotate, above which its inertia is the cause
BY_ROTATION = 0.9


class Actor(NamedTuple):
    """Entries of one group that act on a body: their name, and arrays of these alone."""

    name: str
    arrays: dict[str, np.ndarray]


class StepBound:
    """The entity that limits the step of a run; searched again after a second for each body."""

    def __init__(self, interval: float, longest: float | None) -> None:
        """`interval` [s] of samples, `longest` [s] the deck's own bound."""
        self._interval, self._longest = interval, longest
        # of each body that has set the step: the cause, and when it was determined
        self._causes: dict[int, tuple[str, float]] = {}
        self._copies: Copies | None = None

    def report(self, engine: Engine) -> str:
        """The entity that limits the present step, and why."""
        control, step = engine.model.control[0], float(engine.clock["step"])
        if step == 0.0:
            return "-"
        if (requested := float(control["fixed_step"])) > 0.0:
            is_cut = requested > self._interval and step < 0.999 * requested
            return "samples" if is_cut else "control.step"
        if self._longest is not None and step > 0.999 * self._longest:
            return "control.step_max"
        if step > 0.4 * float(control["curve_step"]):
            return "a curve over time, which longer steps would miss"
        if chooses_step(engine.model, engine.state):
            if control["resolves"] == 1 and step > 0.98 * self._resolved(engine):
                return "control.resolve: vibrations, rotations and the duration of the run"
            is_whole = step > 0.999 * self._interval
            return "samples" if is_whole else "error of a step, control.tolerance"
        wanted, text = self._stable(engine)
        if step >= EQUAL * wanted:
            return text
        if step >= EQUAL * self._interval:
            return "samples"
        return "onset of contact, or bodies that approach each other"

    def _resolved(self, engine: Engine) -> float:
        """The longest step [s] that resolves the motion of a method that chooses its steps."""
        c, nodes = engine.model.control[0], engine.state.nodes
        vibration = float(_speeds(nodes).max()) / (2.0 * float(c["safety"]))
        rotation = float(np.linalg.norm(nodes["w"], axis=1).max()) / float(c["rotation"])
        return 1.0 / max(vibration, rotation, 1.0 / float(c["step_max"]))

    def _stable(self, engine: Engine) -> tuple[float, str]:
        """The step [s] that stiffness and rotations allow, and the cause of its bound."""
        clock, control = engine.clock, engine.model.control[0]
        rotation, spin = float(control["rotation"]), 0
        h, at, text = float(control["step_max"]), int(clock["limit_node"]), "samples"
        if at:
            rate = float(clock["element_rate"]) ** 0.5
            rate = float(_speeds(engine.state.nodes)[at]) if at > 0 else rate
            if rate * h > 2.0 * float(control["safety"]):
                h, text = 2.0 * float(control["safety"]) / rate, ""
        rotations = np.linalg.norm(engine.state.nodes["w"], axis=1)
        spin = int(rotations.argmax())
        if rotations[spin] * h > rotation:
            name = engine.model.bodies[spin]
            return rotation / float(
                rotations[spin]
            ), f"body '{name}', rotation at {rotations[spin]:.3g} rad/s"
        return h, text or self._stiffest(engine, at)

    def _stiffest(self, engine: Engine, at: int) -> str:
        now, (cause, renewed) = monotonic(), self._causes.get(at, ("", -np.inf))
        if now > renewed + RENEWAL_INTERVAL:
            if self._copies is None or not self._copies.are_of(engine):
                self._copies = Copies(engine)
            cause = stiffest(engine, at, self._copies)
            self._causes[at] = cause, now
        return cause


def _speeds(nodes: np.ndarray) -> np.ndarray:
    """Bound of the frequency [rad/s] of every node by the laws that act on it."""
    damping = nodes["damping"]
    speeds = np.sqrt(2.0 * nodes["stiffness"] + damping**2) + damping
    return np.asarray(np.maximum(speeds, 2.0 * nodes["slip_rate"]))


def stiffest(engine: Engine, at: int, copies: Copies | None = None) -> str:
    """The body or element that has the least stable step, and the cause of it.

    `copies` of these tables may serve many times.
    """
    model, nodes = engine.model, engine.state.nodes
    name = limiter(model, at)
    if at > 0 and 2.0 * nodes["slip_rate"][at] >= _speeds(nodes)[at] > 0.0:
        return f"body '{name}', whose sliding changes"
    if at < 0:
        loads, touching = model.nodal_loads, (engine.state.cards["touching"] > 0.0).any()
        is_loaded = touching and "touched" in loads and loads["touched"]["shortened"][0] > 1.0
        return f"element {name}" + (", with contact" if is_loaded else "")
    if model.elements or model.nodal_groups:
        return f"body '{name}', stiffness of the forces on it"
    arrays, tables = (copies or Copies(engine)).renewed()

    def alone(actor: Actor, rotations: bool = True) -> tuple[float, bool]:
        changed = {name: arrays[name].copy() for name in ("nodes", "rows", "clock")}
        if not rotations:
            changed["nodes"]["W"][at] = changed["nodes"]["J_inv"][at] = 0.0
        engine.probe(tables, changed | actor.arrays)
        return _bound(changed["nodes"], at)

    limits = [(*alone(actor), actor) for actor in _actors(engine, at)]
    if not limits:
        return f"body '{name}'"
    speed, is_damped, actor = max(limits, key=lambda one: one[0])
    kind = "damping" if is_damped else "stiffness"
    text = f"body '{model.bodies[at]}', {kind} of {actor.name}"
    without_rotation, _ = alone(actor, rotations=False)
    return f"{text}, by its rotation" if without_rotation < (1.0 - BY_ROTATION) * speed else text


class Copies:
    """Copies of all tables of the step, which a sample may overwrite; no spring or contact acts."""

    def __init__(self, engine: Engine) -> None:
        self._engine, self._bound = engine, engine.bindings
        m, s = engine.model, engine.state
        arrays = group_arrays(m, s) | m.saddle._asdict()
        arrays |= {"control": m.control, "curves": m.curves} | engine.tableau | engine.stages
        arrays |= {"clock": s.clock, "nodes": s.nodes, "rows": s.rows}
        arrays |= {"ledger": np.zeros(len(ENTRIES))}
        no_bodies = np.zeros(0, int)
        for group in (*m.force_groups(), *m.contact_groups):
            if not getattr(group, "is_unilateral", False):
                arrays |= _only(group, no_bodies)
        self._arrays = {name: array.copy() for name, array in arrays.items()}
        self._tables = engine.probing(self._arrays)
        # in bytes, as numpy copies columns one by one
        self._pieces = [(_bytes(a), _bytes(self._arrays[name])) for name, a in arrays.items()]

    def are_of(self, engine: Engine) -> bool:
        """Whether these are still copies of the tables of an engine."""
        return engine is self._engine and engine.bindings == self._bound

    def renewed(self) -> tuple[dict[str, np.ndarray], Tables]:
        """The copies with the present numbers, and tables of them."""
        for now, copy in self._pieces:
            copy[...] = now
        return self._arrays, self._tables


def _bytes(array: np.ndarray) -> np.ndarray:
    return array.reshape(-1).view(np.uint8)


def _actors(engine: Engine, at: int) -> list[Actor]:
    """Springs, elements of beams and contacts that act on a body."""
    model, actors = engine.model, list[Actor]()
    current = int(engine.clock["current"])
    for g in model.force_groups():
        ends = [name for name in g.parameters.dtype.names or () if name.startswith("node")]
        acts = np.zeros(len(g.names), bool)
        for end in ends:
            acts |= (g.parameters[end] == at).reshape(len(acts), -1).any(axis=1)
        word = "element" if g.keyword == "parts" else SECTIONS[g.keyword].singular
        for rows in _split(np.flatnonzero(acts)):
            names = ", ".join(f"'{g.names[i]}'" for i in rows[:3])
            more = f" and {len(rows) - 3} more" if len(rows) > 3 else ""
            actors.append(Actor(f"{word} {names}{more}", _only(g, rows)))
    for c in model.contact_groups:
        if c.is_unilateral:
            continue
        p, old = c.parameters, c.history[current]
        sides = c.elements_a["node"][p["a"]], c.elements_b["node"][p["b"]]
        touching = (old["active"] == 1) & ((sides[0] == at) | (sides[1] == at))
        for rows in _split(np.flatnonzero(touching)):
            others = {int(side[i]) for side in sides for i in rows} - {at}
            names = ", ".join(sorted(f"'{model.bodies[i]}'" for i in others)[:3])
            card = model.contacts[int(p["card"][rows[0]])]
            actors.append(Actor(f"contact '{card}' with {names}", _only(c, rows)))
    return actors


def _split(rows: np.ndarray) -> list[np.ndarray]:
    """Each by itself, or all together where they are many."""
    if len(rows) > MAX_PER_BODY:
        return [rows]
    return [rows[k : k + 1] for k in range(len(rows))]


def _only(group: Group | ContactGroup, rows: np.ndarray) -> dict[str, np.ndarray]:
    """The tables of a group with some of its rows alone."""
    tables = {
        "parameters": group.parameters[rows].copy(),
        "history": np.ascontiguousarray(group.history[:, rows]),
        "output": group.output[rows].copy(),
    }
    if isinstance(group, ContactGroup) and group.in_pieces:
        tables |= tables_of(group, tables["parameters"])
    if isinstance(group, ContactGroup) and group.body_pairs is not None:
        tables["body_pairs"] = body_pairs_of(group, tables["parameters"])
    return {f"{group.word}_{name}": table for name, table in tables.items()}


def _bound(nodes: np.ndarray, at: int) -> tuple[float, bool]:
    """Bound [rad/s] of the frequency of a body by a law that acts on it; whether it is a damper."""
    is_damped = float(nodes["damping"][at]) ** 2 > 2.0 * float(nodes["stiffness"][at])
    return float(_speeds(nodes)[at]), is_damped
