"""From outputs to channels: the families of a scene and their values at the samples of a block."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crashsolve.deck.family import families
from crashsolve.foundation.record import Record
from crashsolve.model.contact import records
from crashsolve.model.ledger import ENTRIES, IMBALANCE, LARGEST, MECHANICAL
from crashsolve.model.model import Group, Model, State
from crashsolve.output.channels import Column, Family
from crashsolve.recording import gather
from crashsolve.recording.kept import Block, Columns, Later, Source, sources_of
from crashsolve.recording.momenta import OF_CLOCK, OF_ELEMENTS, OF_NODES, Momenta
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
# columns of the model that the motion of all bodies gives
MOMENTA = ("momentum", "angular_momentum", "momentum_error", "angular_momentum_error")
PATH = (
    ("load_factor", "", "1", "of loads and motions with curves: 0 at start_time, 1 at end_time"),
    ("unstable_modes", "", "1", "number of unstable modes of the equilibrium"),
)
CARD_COLUMNS: tuple[str, ...] = ("impulse", "peak_normal", "peak_depth", "onsets", "touches")
CARD_COLUMNS += ("first_touch", "last_release", "duration")
FAMILY = {name: next(iter(f.channels)) for name, f in families().items() if f.channels}


@dataclass(eq=False)
class Part:
    """A family, where its columns are at a sample, and how those that are computed are."""

    family: Family
    columns: Columns
    # of values (n_column, samples, n_id): writes the columns that are no copies
    finish: Callable[[np.ndarray], None] = lambda values: None
    # a column, and the least value (n_id,) of it
    least: tuple[int, np.ndarray] | None = None
    # columns and entities that are written, where others are needed to compute them
    written: tuple[np.ndarray, ...] | None = None

    def of(self, written: Container[str]) -> Part:
        """This part with the quantities and the entities of which a channel is written."""
        family, names = self.family, self.family.channels()
        flags = np.array([name in written for name in names], bool)
        table = flags.reshape(len(family.ids), len(family.columns))
        if table.all() or not table.any():
            return self if table.any() else Part(Family(family.name, (), ()), Columns(0))
        columns, rows = (np.flatnonzero(table.any(axis)) for axis in (0, 1))
        own = tuple(family.columns[k] for k in columns)
        kept = Family(family.name, tuple(family.ids[k] for k in rows), own)
        if not self.columns.are_copies:
            return Part(kept, self.columns, self.finish, None, (columns, rows))
        least = None
        if self.least is not None and self.least[0] in columns:
            least = int(np.searchsorted(columns, self.least[0])), self.least[1][rows]
        return Part(kept, self.columns.chosen(columns.tolist(), rows.tolist()), least=least)

    def complete(self, values: np.ndarray) -> np.ndarray:
        """Values (n_column, samples, n_id) that are written, of those stored. Writes: values."""
        self.finish(values)
        if self.least is not None:
            np.maximum(values[self.least[0]], self.least[1], out=values[self.least[0]])
        if self.written is None:
            return values
        columns, rows = self.written
        return values[np.ix_(columns, np.arange(values.shape[1]), rows)]

    def extremes(self, own: np.ndarray) -> np.ndarray:
        """Extremes (n_column, n_id) of what is written, from those of the values at samples."""
        return own if self.written is None else own[np.ix_(*self.written)]


class Start(NamedTuple):
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


def families_of(
    model: Model, state: State, written: Container[str] | None = None
) -> tuple[Family, ...]:
    """Families of channels that a run of a model will write, without compiling its step."""
    return Histories(Start(model, state), written).families


class Histories:
    """Families of an engine: samples are taken, their values made in blocks.

    `written` has the names of the channels that are needed, None all of them.
    """

    def __init__(self, engine: Engine | Start, written: Container[str] | None = None) -> None:
        self.engine = engine
        self._momenta = Momenta()
        self._ends = [phase.end for phase in engine.model.phases]
        joints, origins = _joints(engine.model, written), _origins(engine.model)
        self._parts = [self._model(), self._bodies(origins), self._joints(joints)]
        self._parts += [self._contacts(), *self._traces(), *self._gauges(), *self._cuts()]
        self._parts += [self._group(g) for g in engine.model.groups if hasattr(g.module, "OUTPUT")]
        if written is not None:
            self._parts = [part.of(written) for part in self._parts]
            if not any(c.quantity == "origin" for f in self.families for c in f.columns):
                origins = origins[:0]
        # a family without entities is not written
        self._parts = [part for part in self._parts if part.family.ids and part.family.columns]
        sums = any(c.quantity in MOMENTA for f in self.families for c in f.columns)
        self._motion = self._columns_of_motion() if sums else []
        self._moved: list[np.ndarray] = []
        tables = {"nodes": engine.nodes, "rows": engine.rows, "clock": engine.state.clock}
        every = [part.columns for part in self._parts] + self._motion
        self._kept = Block(every, tables, joints, origins, len(self._parts))

    @property
    def families(self) -> tuple[Family, ...]:
        return tuple(part.family for part in self._parts)

    @property
    def needs_gaps(self) -> bool:
        """Whether samples need the gaps of contacts that do not touch, by their depth below 0."""
        contacts = (family for family in self.families if family.word == "rcforc")
        return any(c.quantity == "depth" for family in contacts for c in family.columns)

    @property
    def memory(self) -> dict[str, np.ndarray]:
        """Arrays that a restart must restore, once the values of all samples taken are computed."""
        return {"momenta/start": self._momenta.start, "momenta/largest": self._momenta.largest}

    @property
    def kept(self) -> Block:
        """Numbers of the samples taken."""
        return self._kept

    def take(self) -> None:
        """Store the numbers of the present sample."""
        self._kept.take()

    def values(self) -> dict[str, np.ndarray]:
        """Values (samples, n_id, n_column) of every family at the samples taken since the last.

        In memory a column stands in one piece, as in the history; the next sample overwrites it.
        """
        blocks = self._kept.values()
        self._moved = blocks[len(self._parts) :]
        return {
            part.family.name: part.complete(values).transpose(1, 2, 0)
            for part, values in zip(self._parts, blocks, strict=False)
        }

    def extremes(self, count: int) -> dict[str, np.ndarray] | None:
        """Extremes (n_column, n_id) of every family in the `count` samples of the last values, as
        rows of gather.EXTREME; None where they are not known.
        """
        extremes = self._kept.extremes(count)
        if extremes is None:
            return None
        both = zip(self._parts, extremes, strict=True)
        return {part.family.name: part.extremes(own) for part, own in both}

    def _model(self) -> Part:
        e = self.engine
        sampled, clock = e.sample_clock, e.state.clock
        columns = [Column("energy", name, "J", name.replace("_", " ")) for name in ENTRIES]
        columns += [Column(*spec) for spec in MODEL]
        sources: list[Source | Later] = [Source(e.ledger[None, :])]
        # balance and errors; residual, step and cycle; mechanical energy
        sources += [Later(3), Source(sampled["residual"]), Source(clock["step"])]
        sources += [Source(sampled["cycle"]), Later(1)]
        if self._ends:
            columns.append(Column("phase", "", "1", "number of the phase"))
            # the time in its place, at first
            sources.append(Source(sampled["time"]))
        for name, unit in (("momentum", "N s"), ("angular_momentum", "N m s")):
            columns += [Column(name, axis, unit, "sum over bodies") for axis in AXES]
        columns += [Column(*spec) for spec in self._path()]
        sources += [Later(6), *sources_of(clock, (name for name, *_ in self._path()))]
        family = Family("glstat", ("model",), tuple(columns))
        return Part(family, Columns(1, sources), self._finish_model)

    def _columns_of_motion(self) -> list[Columns]:
        """Columns that the momenta of the model are made of."""
        e, elements = self.engine, self.engine.model.elements
        columns = [
            Columns(1, sources_of(e.sample_clock, OF_CLOCK)),
            Columns(len(e.nodes) - 1, sources_of(e.nodes[1:], OF_NODES)),
        ]
        if elements is not None:
            columns.append(Columns(1, sources_of(elements.motion[:1], OF_ELEMENTS)))
        return columns

    def _finish_model(self, values: np.ndarray) -> None:
        """Writes: the columns of values (n_column, samples, 1) that are no copies."""
        at = values[:, :, 0]
        balance, mechanical = len(ENTRIES), len(ENTRIES) + len(MODEL) - 1
        missing, largest = at[IMBALANCE], at[LARGEST]
        at[balance] = 0.0
        np.divide(100.0 * missing, largest, out=at[balance], where=largest > 0)
        at[mechanical] = sum(at[k] for k in MECHANICAL)
        first = mechanical + 1
        if self._ends:
            at[first] = np.searchsorted(self._ends, at[first]) + 1
            first += 1
        if not self._motion:
            return
        clock, nodes, *elements = self._moved
        linear, angular, *errors = self._momenta.of(
            _named(self._motion[0], OF_CLOCK, clock[:, :, 0]),
            _named(self._motion[1], OF_NODES, nodes),
            *(_named(self._motion[2], OF_ELEMENTS, own[:, :, 0]) for own in elements),
        )
        at[balance + 1 : balance + 3] = errors
        at[first : first + 3], at[first + 3 : first + 6] = linear.T, angular.T

    def _path(self) -> tuple[tuple[str, str, str, str], ...]:
        """Columns of a run that follows a path of equilibria."""
        return PATH if self.engine.model.control[0]["follows_path"] else ()

    def _bodies(self, origins: np.ndarray) -> Part:
        columns = [Column(q, a, unit, m) for q, _, unit, m in BODY for a in AXES]
        columns += [Column("quaternion", c, "1", "body to world") for c in ("w", *AXES)]
        count = len(self.engine.model.bodies)
        own = self.engine.nodes[1:count]
        sources = sources_of(own, [*(name for _, name, _, _ in BODY), "q"])
        if len(origins):
            columns += [Column("origin", a, "m", "origin of the body") for a in AXES]
            sources += sources_of(origins, ("r",))
        family = Family("rbdout", tuple(self.engine.model.bodies[1:]), tuple(columns))
        return Part(family, Columns(count - 1, sources))

    def _joints(self, joints: np.ndarray) -> Part:
        columns = [Column("force", a, "N", "of the joint on body b, world axes") for a in AXES]
        columns += [Column("moment", a, "N m", "the same, about the joint point") for a in AXES]
        names = tuple(self.engine.model.joints[k].name for k in joints["joint"])
        own = Columns(len(joints), sources_of(joints, ("force", "moment")))
        return Part(Family("jntforc", names, tuple(columns)), own)

    def _contacts(self) -> Part:
        columns = _columns(records.CARD_OUTPUT)
        history = [c for c in records.CARD_HISTORY.columns if c.name in CARD_COLUMNS]
        columns += [column for c in history for column in _components(c)]
        cards, both = self.engine.state.cards, self.engine.state.card_history
        sources = sources_of(cards, (column.name for column in records.CARD_OUTPUT.columns))
        sources += [Source(both[0][name], both.strides[0]) for name in CARD_COLUMNS]
        # pairs farther apart than the margin of a list are not in it
        least = [c.path for c in columns].index("depth"), -self._margins()
        family = Family("rcforc", tuple(self.engine.model.contacts), tuple(columns))
        return Part(family, Columns(len(cards), sources), least=least)

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
        start = points["r"][numbers].T[:, None, :]
        columns = [Column("position", a, "m", "of the node") for a in AXES]
        columns += [Column("displacement", a, "m", "since the start") for a in AXES]
        columns += [Column("velocity", a, "m/s", "of the node") for a in AXES]

        def finish(values: np.ndarray) -> None:
            np.subtract(values[:3], start, out=values[3:6])

        r, v = (Source(points[name], rows=numbers) for name in "rv")
        family = Family("nodout-shell", tuple(names), tuple(columns))
        return [Part(family, Columns(len(names), [r, Later(3), v]), finish)]

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

        def request() -> np.ndarray:
            return np.concatenate([meshed.gauge_values(blocks, row) for _, meshed, row in gauged])

        family = Family("elout-shell", tuple(names), tuple(columns))
        return [Part(family, Columns(len(names), [Later(len(columns))], request))]

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
        return [Part(family, Columns(len(names), sources_of(elements.cuts, OUTPUT)))]

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
        names = (c.name for c in group.module.OUTPUT.columns)
        family = Family(f"{word}-{group.type}", tuple(group.names), columns)
        return Part(family, Columns(len(group.names), sources_of(group.output, names)))


def _joints(model: Model, written: Container[str] | None) -> np.ndarray:
    """Rows of gather.JOINT: every joint that is written, its force and moment on body b."""
    channels = [f"{quantity}.{axis}" for quantity in ("force", "moment") for axis in AXES]
    chosen = [
        (k, joint)
        for k, joint in enumerate(model.joints)
        if written is None or any(f"jntforc.{joint.name}.{own}" in written for own in channels)
    ]
    joints = np.zeros(len(chosen), gather.JOINT.dtype)
    for row, (k, joint) in zip(joints, chosen, strict=True):
        row["node"], row["first"], row["rows"] = joint.node_b, joint.first_row, joint.rows
        row["joint"], row["point"] = k, joint.frame.get("point_b", 0.0)
    return joints


def _origins(model: Model) -> np.ndarray:
    """Rows of gather.ORIGIN: every body, where any has its origin beside its mass centre."""
    count = len(model.bodies)
    arms = model.mass_centres[1:count]
    origins = np.zeros(count - 1 if np.any(arms) else 0, gather.ORIGIN.dtype)
    if len(origins):
        origins["node"], origins["arm"] = np.arange(1, count), arms
    return origins


def _named(columns: Columns, names: Sequence[str], values: np.ndarray) -> dict[str, np.ndarray]:
    """Numbers and vectors at samples, by name, of values (n_column, samples, ...)."""
    named, at = {}, 0
    for name, source in zip(names, columns.sources, strict=True):
        own = values[at : at + source.width]
        named[name] = own[0] if source.width == 1 else np.moveaxis(own, 0, -1)
        at += source.width
    return named


def _columns(record: Record) -> list[Column]:
    return [column for c in record.columns for column in _components(c)]


def _components(c: RecordColumn) -> list[Column]:
    unit = "1" if c.unit == "count" else c.unit
    if c.size == 1:
        return [Column(c.name, "", unit, c.meaning)]
    parts = AXES if c.size == 3 else tuple(str(k + 1) for k in range(c.size))
    return [Column(c.name, part, unit, c.meaning) for part in parts]
