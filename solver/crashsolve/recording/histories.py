"""From outputs to channels: the families of a scene and their values at the samples of a block."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.family import families
from crashsolve.foundation.orientation import crosses
from crashsolve.foundation.record import Record
from crashsolve.model.contact import records
from crashsolve.model.ledger import ENTRIES, IMBALANCE, LARGEST, MECHANICAL
from crashsolve.model.model import Group, Joint, Model, State
from crashsolve.output.channels import Column, Family
from crashsolve.recording.kept import Columns, SampledTables, Source, identity, merged
from crashsolve.recording.momenta import OF_NODES, Momenta
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    from crashsolve.elements.shells.layout import DiscretisedShell
    from crashsolve.foundation.record import Column as RecordColumn

AXES = ("x", "y", "z")
BODY = (
    ("position", "r", "m", "mass centre"),
    ("velocity", "v", "m/s", "mass centre"),
    ("acceleration", "v_dot", "m/s^2", "mass centre"),
    ("angular_velocity", "w", "rad/s", "world axes"),
    ("angular_acceleration", "w_dot", "rad/s^2", "world axes"),
)
MODEL = (
    ("balance", "", "%", "energy imbalance over the largest energy"),
    ("momentum_error", "", "1", "momentum not accounted for, over the largest sum of |m v|"),
    ("angular_momentum_error", "", "1", "angular momentum not accounted for, over its largest sum"),
    ("residual", "", "1", "largest constraint error so far over the model's size"),
    ("step", "", "s", "time step"),
    ("cycle", "", "1", "steps so far"),
    ("mechanical", "", "J", "kinetic, potential and stored energy"),
)
PATH = (
    ("load_factor", "", "1", "of loads and motions with curves: 0 at start_time, 1 at end_time"),
    ("unstable_modes", "", "1", "number of unstable modes of the equilibrium"),
)
CARD_COLUMNS: tuple[str, ...] = ("impulse", "peak_normal", "peak_depth", "onsets", "touches")
CARD_COLUMNS += ("first_touch", "last_release", "duration")
FAMILY = {name: next(iter(f.channels)) for name, f in families().items() if f.channels}
# a family, the tables it is made of, and how: values (samples, n_id, n_column)
Part = tuple[Family, tuple[Source, ...], Callable[..., np.ndarray]]


@dataclass(frozen=True)
class Start:
    """Attributes of an engine before its step is compiled, from which channels are made."""

    model: Model
    state: State

    @property
    def nodes(self) -> np.ndarray:
        return self.state.nodes

    @property
    def rows(self) -> np.ndarray:
        return self.state.rows

    @property
    def ledger(self) -> np.ndarray:
        return self.state.ledger

    @property
    def sample_clock(self) -> np.ndarray:
        return self.state.clock


def families_of(model: Model, state: State) -> tuple[Family, ...]:
    """Families of channels that a run of a model will write, without compiling its step."""
    return Histories(Start(model, state)).families


class Histories:
    """Families of an engine, all or those named: samples are taken, their values made in blocks."""

    def __init__(self, engine: Engine | Start, names: Container[str] | None = None) -> None:
        self.engine = engine
        self._momenta = Momenta()
        self._margin = self._margins()
        self._ends = [phase.end for phase in engine.model.phases]
        self._parts = [self._model(), self._bodies(), self._joints(), self._contacts()]
        self._parts += self._traces() + self._gauges() + self._cuts()
        self._parts += [self._group(g) for g in engine.model.groups if hasattr(g.module, "OUTPUT")]
        if names is not None:
            self._parts = [part for part in self._parts if part[0].name in names]
        # a family without entities is not written
        self._parts = [part for part in self._parts if part[0].ids and part[0].columns]
        # a table that several families use is stored once
        sources = merged(source for _, own, _ in self._parts for source in own)
        self._kept = SampledTables(list(sources.values()))
        numbers = {key: number for number, key in enumerate(sources)}
        self._positions = [
            [numbers[identity(source)] for source in own] for _, own, _ in self._parts
        ]

    @property
    def families(self) -> tuple[Family, ...]:
        return tuple(family for family, _, _ in self._parts)

    @property
    def memory(self) -> dict[str, np.ndarray]:
        """Arrays that a restart must restore, once the values of all samples taken are computed."""
        return {"momenta/start": self._momenta.start, "momenta/largest": self._momenta.largest}

    @property
    def kept(self) -> SampledTables:
        """Tables of the samples taken."""
        return self._kept

    def take(self) -> bool:
        """Store the tables of the present sample; returns whether the block is full."""
        self._kept.take()
        return self._kept.is_full

    def values(self) -> dict[str, np.ndarray]:
        """Values (samples, n_id, n_column) of every family at the samples taken since the last."""
        tables = self._kept.tables()
        return {
            family.name: make(*(tables[index] for index in indices))
            for (family, _, make), indices in zip(self._parts, self._positions, strict=True)
        }

    def _model(self) -> Part:
        columns = [Column("energy", name, "J", name.replace("_", " ")) for name in ENTRIES]
        columns += [Column(*spec) for spec in MODEL]
        if self._ends:
            columns.append(Column("phase", "", "1", "number of the phase"))
        for name, unit in (("momentum", "N s"), ("angular_momentum", "N m s")):
            columns += [Column(name, axis, unit, "sum over bodies") for axis in AXES]
        columns += [Column(*spec) for spec in self._path()]
        e, elements = self.engine, self.engine.model.elements
        sources: list[Source] = [e.ledger, e.sample_clock, e.state.clock]
        sources.append(Columns(e.nodes, OF_NODES))
        sources += [] if elements is None else [elements.motion]
        return Family("glstat", ("model",), tuple(columns)), tuple(sources), self._model_values

    def _model_values(
        self,
        ledger: np.ndarray,
        sampled: np.ndarray,
        clock: np.ndarray,
        nodes: np.ndarray,
        *elements: np.ndarray,
    ) -> np.ndarray:
        linear, angular, *errors = self._momenta.of(sampled[:, 0], nodes[:, 1:], *elements)
        missing, largest = ledger[:, IMBALANCE], ledger[:, LARGEST]
        balance = np.divide(100.0 * missing, largest, out=np.zeros(len(missing)), where=largest > 0)
        step, (residual, cycle) = clock["step"], (sampled[name] for name in ("residual", "cycle"))
        mechanical = sum(ledger[:, k] for k in MECHANICAL)
        scalars = [balance, *errors, residual[:, 0], step[:, 0], cycle[:, 0], mechanical]
        if self._ends:
            scalars.append(np.searchsorted(self._ends, sampled["time"][:, 0]) + 1)
        path = [clock[name] for name, *_ in self._path()]
        return np.column_stack([ledger, *scalars, linear, angular, *path])[:, None, :]

    def _path(self) -> tuple[tuple[str, str, str, str], ...]:
        """Columns of a run that follows a path of equilibria."""
        return PATH if self.engine.model.control[0]["follows_path"] else ()

    def _bodies(self) -> Part:
        columns = [Column(q, a, unit, m) for q, _, unit, m in BODY for a in AXES]
        columns += [Column("quaternion", c, "1", "body to world") for c in ("w", *AXES)]
        names = [name for _, name, _, _ in BODY] + ["q"]
        count = len(self.engine.model.bodies)
        arms = self.engine.model.mass_centres[1:count]
        has_origins = bool(np.any(arms))
        columns += [Column("origin", a, "m", "origin of the body") for a in AXES if has_origins]
        family = Family("rbdout", tuple(self.engine.model.bodies[1:]), tuple(columns))
        read = frozenset([*names, "A"] if has_origins else names)

        def values(nodes: np.ndarray) -> np.ndarray:
            own = nodes[:, 1:count]
            more = [_origins(own, arms)] if has_origins else []
            return _side_by_side([own[name] for name in names] + more)

        return family, (Columns(self.engine.nodes, read),), values

    def _joints(self) -> Part:
        columns = [Column("force", a, "N", "of the joint on body b, world axes") for a in AXES]
        columns += [Column("moment", a, "N m", "the same, about the joint point") for a in AXES]
        joints, engine = self.engine.model.joints, self.engine
        tables = (
            Columns(engine.nodes, frozenset({"A"})),
            Columns(engine.rows, frozenset({"D", "reaction"})),
        )
        family = Family("jntforc", tuple(joint.name for joint in joints), tuple(columns))
        return family, tables, _reactions_of(joints)

    def _contacts(self) -> Part:
        columns = _columns(records.CARD_OUTPUT)
        history = [c for c in records.CARD_HISTORY.columns if c.name in CARD_COLUMNS]
        columns += [column for c in history for column in _components(c)]
        family = Family("rcforc", tuple(self.engine.model.contacts), tuple(columns))
        state = self.engine.state
        return family, (state.cards, state.card_history, state.clock), self._cards

    def _cards(self, cards: np.ndarray, history: np.ndarray, clock: np.ndarray) -> np.ndarray:
        # pairs farther apart than the margin of a list are not in it
        cards["depth"] = np.maximum(cards["depth"], -self._margin)
        rows, current = np.arange(len(history)), clock["current"][:, 0]
        names = [column.name for column in records.CARD_OUTPUT.columns]
        now = [history[name][rows, current] for name in CARD_COLUMNS]
        return _side_by_side([cards[name] for name in names] + now)

    def _margins(self) -> np.ndarray:
        """Margin of the list of near pairs of every contact card; infinite without a list."""
        margins = np.full(len(self.engine.model.contacts), np.inf)
        for group in self.engine.model.contact_groups:
            if group.search is not None:
                for card in group.search.cards():
                    margins[card] = min(margins[card], group.search.margin)
        return margins

    def _traces(self) -> list[Part]:
        """Nodes of shells whose history the deck asks for."""
        names, numbers = [], []
        for part, meshed, _ in self._meshed():
            names += [f"{part}_{trace.name}" for trace in meshed.card.traces]
            numbers += [meshed.first + k for k in meshed.traced]
        if not names:
            return []
        points = self.engine.state.points
        start = points["r"][numbers]
        columns = [Column("position", a, "m", "of the node") for a in AXES]
        columns += [Column("displacement", a, "m", "since the start") for a in AXES]
        columns += [Column("velocity", a, "m/s", "of the node") for a in AXES]

        def values(r: np.ndarray, v: np.ndarray) -> np.ndarray:
            return np.concatenate([r, r - start, v], axis=2)

        requested = (lambda: points["r"][numbers], lambda: points["v"][numbers])
        return [(Family("nodout-shell", tuple(names), tuple(columns)), requested, values)]

    def _gauges(self) -> list[Part]:
        """Elements of shells whose history the deck asks for."""
        gauged = [(name, meshed, row) for name, meshed, row in self._meshed() if meshed.gauged]
        if not gauged:
            return []
        names = [f"{part}_{g.name}" for part, meshed, _ in gauged for g in meshed.card.gauges]
        fields = self.engine.model.element_groups()[0].module.FIELDS
        columns = []
        for field, (unit, count) in fields.items():
            parts = ("",) if count == 1 else ("xx", "yy", "xy")
            columns += [Column(field, part, unit, "of the element, its axes") for part in parts]
        blocks = self.engine.state.blocks

        def values() -> np.ndarray:
            return np.concatenate([meshed.gauge_values(blocks, row) for _, meshed, row in gauged])

        family = Family("elout-shell", tuple(names), tuple(columns))
        # stored values are overwritten by later samples
        return [(family, (values,), np.copy)]

    def _cuts(self) -> list[Part]:
        """Sections of shells."""
        names = [
            f"{part}_{cut.name}"
            for part, meshed, _ in self._meshed()
            for cut in meshed.card.section_cuts
        ]
        elements = self.engine.model.elements
        if not names or elements is None:
            return []
        from crashsolve.elements.shells.section_cut import CUT, OUTPUT

        columns = [column for c in CUT.columns if c.name in OUTPUT for column in _components(c)]
        family = Family("secforc-shell", tuple(names), tuple(columns))
        return [(family, (elements.cuts,), lambda cuts: _stacked(cuts, OUTPUT))]

    def _meshed(self) -> list[tuple[str, DiscretisedShell, np.void]]:
        """Name, part in place and row of every part with points."""
        groups = self.engine.model.element_groups()
        elements = self.engine.model.elements
        return [
            (name, elements.parts[name], row)
            for g in groups
            for name, row in zip(g.names, g.parameters, strict=True)
            if elements
        ]

    def _group(self, group: Group) -> Part:
        """Outputs of one type; types of a family differ in columns and stand side by side."""
        word = getattr(group.module, "FAMILY", FAMILY[group.keyword])
        columns = tuple(_columns(group.module.OUTPUT))
        names = [c.name for c in group.module.OUTPUT.columns]
        family = Family(f"{word}-{group.type}", tuple(group.names), columns)
        return family, (group.output,), lambda output: _stacked(output, names)


def _reactions_of(joints: list[Joint]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Function of nodes and rows at samples: force and moment of every joint on its body b at the
    joint point, world axes.
    """
    # every joint has a row at least
    firsts = np.cumsum([0, *(joint.rows for joint in joints[:-1])])
    own = [row for j in joints for row in range(j.first_row, j.first_row + j.rows)]
    if np.array_equal(own, np.arange(len(own))):
        # as they lie
        own = slice(len(own))
    pointed = [k for k, joint in enumerate(joints) if "point_b" in joint.frame]
    points = np.array([joints[k].frame["point_b"] for k in pointed])
    bodies = [joints[k].node_b for k in pointed]

    def reactions(nodes: np.ndarray, rows: np.ndarray) -> np.ndarray:
        wrench = rows["D"][:, own, 6:] * rows["reaction"][:, own, None]
        # nothing is 0, not -0
        values = np.add.reduceat(wrench, firsts, axis=1) + 0.0
        if pointed:
            A = nodes["A"][:, bodies].reshape(len(nodes), len(bodies), 3, 3)
            arms = (A @ points[:, :, None])[..., 0]
            values[:, pointed, 3:] -= crosses(arms, values[:, pointed, :3])
        return values

    return reactions


def _columns(record: Record) -> list[Column]:
    return [column for c in record.columns for column in _components(c)]


def _components(c: RecordColumn) -> list[Column]:
    unit = "1" if c.unit == "count" else c.unit
    if c.size == 1:
        return [Column(c.name, "", unit, c.meaning)]
    parts = AXES if c.size == 3 else tuple(str(k + 1) for k in range(c.size))
    return [Column(c.name, part, unit, c.meaning) for part in parts]


def _stacked(tables: np.ndarray, names: Iterable[str]) -> np.ndarray:
    """Columns of tables (samples, n) as numbers (samples, n, total width)."""
    return _side_by_side([tables[name] for name in names])


def _side_by_side(columns: list[np.ndarray]) -> np.ndarray:
    """Columns (samples, n) or (samples, n, width) as numbers (samples, n, total width).

    In memory a column stands in one piece, as it does in the history.
    """
    # widths from shapes: numpy cannot infer one where there are no samples
    widths = [int(np.prod(column.shape[2:], dtype=int)) for column in columns]
    samples, n = columns[0].shape[:2]
    found, first = np.empty((sum(widths), samples, n)), 0
    for column, width in zip(columns, widths, strict=True):
        found[first : first + width] = column.reshape(samples, n, width).transpose(2, 0, 1)
        first += width
    return found.transpose(1, 2, 0)


def _origins(nodes: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Positions (samples, n, 3) of the origins of bodies [m], by their mass centres from these."""
    A = nodes["A"].reshape(*nodes.shape, 3, 3)
    return np.asarray(nodes["r"] - np.einsum("tnij,nj->tni", A, arms))
