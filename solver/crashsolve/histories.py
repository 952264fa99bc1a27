"""From outputs to channels: the families of a scene and their values at a sample."""

from collections.abc import Callable, Container
from typing import Any

import numpy as np

from crashsolve.deck.family import families
from crashsolve.foundation.record import Record
from crashsolve.model import touch
from crashsolve.model.ledger import ENTRIES, IMBALANCE, LARGEST, MECHANICAL
from crashsolve.model.model import Group
from crashsolve.output.channels import Column, Family
from crashsolve.system.engine import Engine

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
CARD_COLUMNS: tuple[str, ...] = ("impulse", "peak_normal", "peak_depth", "onsets", "touches")
CARD_COLUMNS += ("first_touch", "last_release", "duration")
FAMILY = {n: f.channels[0] for n, f in families().items() if f.channels} | {"parts": "elout"}
Part = tuple[Family, Callable[[], np.ndarray]]


class Histories:
    """All families of an engine; `row()` is one sample of all of them."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        # what errors of momentum are measured from, known at the first sample, and over
        self._start = np.full((2, 3), np.nan)
        self._largest = np.zeros(2)
        self._margin = self._margins()
        self._parts = [self._model(), self._bodies(), self._joints(), self._contacts()]
        self._parts += self._traces() + self._gauges() + self._cuts()
        self._parts += [self._group(g) for g in engine.model.groups if g.keyword in FAMILY]

    @property
    def families(self) -> tuple[Family, ...]:
        return tuple(family for family, _ in self._parts)

    @property
    def memory(self) -> dict[str, np.ndarray]:
        """What a restart must bring back."""
        return {"momenta/start": self._start, "momenta/largest": self._largest}

    def row(self, names: Container[str] | None = None) -> dict[str, np.ndarray]:
        """Values (n_id, n_column) of every family at the present sample, or of those named."""
        wanted = ((f.name, values) for f, values in self._parts if names is None or f.name in names)
        return {name: values() for name, values in wanted}

    def _model(self) -> Part:
        columns = [Column("energy", name, "J", name.replace("_", " ")) for name in ENTRIES]
        columns += [Column(*spec) for spec in MODEL]
        for name, unit in (("momentum", "N s"), ("angular_momentum", "N m s")):
            columns += [Column(name, axis, unit, "sum over bodies") for axis in AXES]
        return Family("glstat", ("model",), tuple(columns)), self._model_values

    def _model_values(self) -> np.ndarray:
        e = self.engine
        ledger, clock = e.ledger, e.sampled
        linear, angular, sums = self._momenta()
        if np.isnan(self._start[0, 0]):
            self._start[:] = linear, angular
        self._largest[:] = np.maximum(self._largest, sums)
        errors = [
            _share(linear - self._start[0] - clock["impulse"], self._largest[0]),
            _share(angular - self._start[1] - clock["angular_impulse"], self._largest[1]),
        ]
        balance = 100.0 * ledger[IMBALANCE] / ledger[LARGEST] if ledger[LARGEST] > 0 else 0.0
        mechanical = sum(ledger[k] for k in MECHANICAL)
        scalars = [balance, *errors, clock["residual"], e.clock["step"], clock["cycle"], mechanical]
        return np.concatenate([ledger, scalars, linear, angular])[None, :]

    def _momenta(self) -> list[np.ndarray]:
        """Momentum, angular momentum about the world origin, and sums of the sizes of both."""
        nodes, elements = self.engine.nodes[1:], self.engine.model.elements
        total = _moments(nodes["r"].T, nodes["v"].T / nodes["mass_inv"], nodes["L"].T)
        if elements is None:
            return total
        own = elements.motion[0]
        sizes = np.array([own["linear_size"], own["angular_size"]])
        return [x + y for x, y in zip(total, (own["linear"], own["angular"], sizes), strict=True)]

    def _bodies(self) -> Part:
        columns = [Column(q, a, unit, m) for q, _, unit, m in BODY for a in AXES]
        columns += [Column("quaternion", c, "1", "body to world") for c in ("w", *AXES)]
        family = Family("rbdout", tuple(self.engine.model.bodies[1:]), tuple(columns))
        names = [name for _, name, _, _ in BODY] + ["q"]
        count = len(self.engine.model.bodies)
        return family, lambda: np.hstack([self.engine.nodes[name][1:count] for name in names])

    def _joints(self) -> Part:
        columns = [Column("force", a, "N", "of the joint on body b, world axes") for a in AXES]
        columns += [Column("moment", a, "N m", "the same, about the joint point") for a in AXES]
        ids = tuple(joint.name for joint in self.engine.model.joints)
        return Family("jntforc", ids, tuple(columns)), self._reactions

    def _reactions(self) -> np.ndarray:
        """Force and moment of every joint on its body b at the joint point, world axes."""
        e = self.engine
        values = np.zeros((len(e.model.joints), 6))
        wrench = e.rows["D"][:, 6:] * e.rows["reaction"][:, None]
        for value, joint in zip(values, e.model.joints, strict=True):
            value[:] = wrench[joint.first_row : joint.first_row + joint.rows].sum(0)
            if "point_b" in joint.frame:
                arm = e.nodes["A"][joint.node_b].reshape(3, 3) @ joint.frame["point_b"]
                value[3:] -= np.cross(arm, value[:3])
        return values

    def _contacts(self) -> Part:
        columns = _columns(touch.CARD_OUTPUT)
        history = [c for c in touch.CARD_HISTORY.columns if c.name in CARD_COLUMNS]
        columns += [column for c in history for column in _spread(c)]
        return Family("rcforc", tuple(self.engine.model.contacts), tuple(columns)), self._cards

    def _cards(self) -> np.ndarray:
        s = self.engine.state
        now, cards = s.card_history[self.engine.clock["current"]], s.cards.copy()
        # pairs farther apart than the margin of a list are not in it
        cards["depth"] = np.maximum(cards["depth"], -self._margin)
        return np.hstack([_flat(cards, None), _flat(now, CARD_COLUMNS)])

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
        for part, laid, row in self._laid():
            names += [f"{part}_{trace.name}" for trace in laid.card.traces]
            numbers += [int(row["first_point"]) + k for k in laid.traced]
        if not names:
            return []
        points = self.engine.state.points
        start = points["r"][numbers].copy()
        columns = [Column("position", a, "m", "of the node") for a in AXES]
        columns += [Column("displacement", a, "m", "since the start") for a in AXES]
        columns += [Column("velocity", a, "m/s", "of the node") for a in AXES]
        return [
            (
                Family("nodout-shell", tuple(names), tuple(columns)),
                lambda: np.hstack(
                    [points["r"][numbers], points["r"][numbers] - start, points["v"][numbers]]
                ),
            )
        ]

    def _gauges(self) -> list[Part]:
        """Elements of shells whose history the deck asks for."""
        gauged = [(name, laid, row) for name, laid, row in self._laid() if laid.gauged]
        if not gauged:
            return []
        names = [f"{part}_{g.name}" for part, laid, _ in gauged for g in laid.card.gauges]
        fields = self.engine.model.element_groups()[0].module.FIELDS
        columns = []
        for field, (unit, count) in fields.items():
            parts = ("",) if count == 1 else ("xx", "yy", "xy")
            columns += [Column(field, part, unit, "of the element, its axes") for part in parts]
        blocks = self.engine.state.blocks

        def values() -> np.ndarray:
            return np.concatenate([laid.gauge_values(blocks, row) for _, laid, row in gauged])

        return [(Family("elout-shell", tuple(names), tuple(columns)), values)]

    def _cuts(self) -> list[Part]:
        """Sections of shells."""
        names = [f"{part}_{cut.name}" for part, laid, _ in self._laid() for cut in laid.card.cuts]
        elements = self.engine.model.elements
        if not names or elements is None:
            return []
        from crashsolve.parts._cut import CUT, OUTPUT

        columns = [column for c in CUT.columns if c.name in OUTPUT for column in _spread(c)]
        family, cuts = Family("secforc-shell", tuple(names), tuple(columns)), elements.cuts
        return [(family, lambda: _flat(cuts, OUTPUT))]

    def _laid(self) -> list[tuple[str, Any, Any]]:
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
        columns = tuple(_columns(getattr(group.module, "OUTPUT", Record())))
        names = [c.name for c in getattr(group.module, "OUTPUT", Record()).columns]
        family = Family(f"{word}-{group.type}", tuple(group.names), columns)
        return family, lambda: _flat(group.output, names)


def _moments(r: np.ndarray, p: np.ndarray, L: np.ndarray) -> list[np.ndarray]:
    """Sums over columns (3, n) of p, of r x p + L, and of the sizes of p and of |r| |p| + |L|."""
    # rows side by side: np.cross and np.linalg.norm take ten times as long
    r, p, L = (np.ascontiguousarray(u) for u in (r, p, L))
    (x, y, z), (a, b, c) = r, p
    turned = np.array([y @ c - z @ b, z @ a - x @ c, x @ b - y @ a])
    size = _lengths(p)
    sizes = [size.sum(), _lengths(r) @ size + _lengths(L).sum()]
    return [p.sum(1), turned + L.sum(1), np.array(sizes)]


def _lengths(u: np.ndarray) -> np.ndarray:
    return np.sqrt(np.einsum("ij,ij->j", u, u))


def _share(error: np.ndarray, scale: float) -> float:
    return float(np.linalg.norm(error) / scale) if scale > 0.0 else 0.0


def _columns(record: Record) -> list[Column]:
    return [column for c in record.columns for column in _spread(c)]


def _spread(c: Any) -> list[Column]:
    unit = "1" if c.unit == "count" else c.unit
    if c.size == 1:
        return [Column(c.name, "", unit, c.meaning)]
    parts = AXES if c.size == 3 else tuple(str(k + 1) for k in range(c.size))
    return [Column(c.name, part, unit, c.meaning) for part in parts]


def _flat(table: np.ndarray, names: Any) -> np.ndarray:
    """Columns of a structured array as (n, total width)."""
    chosen = names if names is not None else table.dtype.names or ()
    width = {name: table.dtype[name].shape[0] if table.dtype[name].shape else 1 for name in chosen}
    return np.hstack(
        [table[name].reshape(len(table), width[name]).astype(float) for name in chosen]
    )
