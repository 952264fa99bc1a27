"""A small deck whose kernels run as plain Python, with the bodies moved by hand.

Nothing is compiled, so that tests are quick and every line is seen by coverage and debugger.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import ArrayLike

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import Rows as Columned
from crashsolve.foundation.rows import as_rows
from crashsolve.foundation.sparse.bordered import BLOCK, SLOT
from crashsolve.model.build import build
from crashsolve.model.model import Group, Model
from crashsolve.model.nodes import COMPLIANT, NODE, ROW

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

BODIES = """
title: bench
control: {end_time: 1}
bodies:
  a: {mass: 2, inertia: [0.5, 0.6, 0.4], position: [0.1, 0.2, -0.1], mass_centre: [0.05, 0, 0.1]}
  b:
    mass: 3
    inertia: [0.7, 0.5, 0.9]
    position: [0.9, 0.4, 0.3]
    rotation: {axis: [1, 2, 3], angle: 0.4}
    mass_centre: [0, -0.1, 0]
"""


# an element of a beam, with WORDS of its part
ONE_BEAM = """
title: one element
control: {end_time: 1}
materials: {soft: {type: elastic, young: 2000, poisson: 0.3, density: 3}}
sections: {plate: {type: rectangle, width: 0.5, height: 0.8}}
parts:
  s:
    type: beam
    mesh: {shape: line, from: [0.2, -0.1, 0.4], to: [1.2, 0.9, 0.1], elements: 1}
    section: plate
    material: soft
    side: [0, 0, 1]
    WORDS
"""


Vector = Sequence[float] | np.ndarray | None


class Bench:
    """The bodies a and b (nodes 1 and 2) and whatever `text` adds to the deck."""

    def __init__(self, folder: Path, text: str, bodies: str = BODIES) -> None:
        path = folder / "bench.yaml"
        path.write_text(bodies + text, "utf-8")
        self._read(path)

    @classmethod
    def of_deck(cls, path: Path) -> Bench:
        """The bodies of a deck as it is."""
        bench = cls.__new__(cls)
        bench._read(path)
        return bench

    def _read(self, path: Path) -> None:
        self.model, state = build(read_deck(path))
        self.tables = {"nodes": state.nodes, "rows": state.rows, "curves": self.model.curves}
        self.nodes: Columned = as_rows(state.nodes)
        self.rows: Columned = as_rows(state.rows)
        self.curves: Columned = as_rows(self.model.curves)
        for node in range(1, len(self.nodes)):
            self.move(node)

    def move(
        self, node: int, r: Vector = None, q: Vector = None, v: Vector = None, w: Vector = None
    ) -> None:
        """Give a body position, unit quaternion, velocity, angular velocity; None keeps what is."""
        b = self.nodes[node]
        for name, value in (("r", r), ("q", q), ("v", v), ("w", w)):
            if value is not None:
                b[name] = value
        A = matrix(b.q)
        W = A @ b.J_inv.reshape(3, 3) @ A.T
        b.A, b.W = A.ravel(), W.ravel()
        b.L = np.linalg.solve(W, b.w)

    def rotation(self, node: int, rotation: ArrayLike) -> None:
        """Turn a body by a rotation vector in world axes [rad]."""
        self.move(node, q=product(exponential(rotation), self.nodes[node].q))

    def shake(self, seed: int, speed: float = 1.0, rotation: float = 0.8) -> None:
        """Any configurations and velocities, and the ground at rest."""
        rng = np.random.default_rng(seed)
        for node in range(1, len(self.nodes)):
            self.rotation(node, rng.uniform(-rotation, rotation, 3))
            r = self.nodes[node].r + rng.uniform(-0.3, 0.3, 3)
            self.move(node, r=r, v=speed * rng.normal(size=3), w=speed * rng.normal(size=3))

    def drift(self, time: float) -> None:
        """Move every body by its present velocity."""
        for node in range(1, len(self.nodes)):
            b = self.nodes[node]
            self.rotation(node, time * b.w)
            self.move(node, r=b.r + time * b.v)

    def carry_away(self) -> np.ndarray:
        """Turn and move all bodies together, with their velocities. Returns the rotation (3, 3)."""
        rotation = np.array([0.3, -0.5, 0.9])
        R = matrix(exponential(rotation))
        for node in range(1, len(self.nodes)):
            b = self.nodes[node]
            self.rotation(node, rotation)
            self.move(node, r=R @ b.r + [5, -3, 2], v=R @ b.v, w=R @ b.w)
        return R

    def state(self) -> Columned:
        return self.nodes.copy()

    def law(self, keyword: str, name: str) -> Law:
        return Law(self, keyword, name)


class Law:
    """One entry of the deck: call it as the step does."""

    def __init__(self, bench: Bench, keyword: str, name: str) -> None:
        group = next(g for g in bench.model.groups if g.keyword == keyword and name in g.names)
        i = group.names.index(name)
        self.bench, self.module, self.group, self.i = bench, group.module, group, i
        # its kernel as plain Python; a test may put a compiled one here
        self.kernel: Callable[..., None] = getattr(group.module, "force", _no_force)
        self.p = as_rows(group.parameters)[i]
        self.old = as_rows(group.history)[0, i]
        self.new = as_rows(group.history)[1, i]
        self.out = as_rows(group.output)[i]
        # that of its material, where its kernels call one
        self.materials = [law for number, law in group.materials if self.p.law == number]

    def force(self, h: float = 1.0, t: float = 0.0) -> RowOfTable:
        """Forces of this law alone; h = 0 is a sample. Returns its outputs."""
        nodes = self.bench.nodes
        for name in ("force", "torque", "stiffness", "damping", "external"):
            nodes[name] = 0.0
        spoil(self.new, getattr(self.module, "HISTORY", Record()))
        spoil(self.out, self.module.OUTPUT)
        args = (t, h, nodes, self.bench.rows, self.bench.curves, *self.materials)
        self.kernel(self.p, self.old, self.new, self.out, *args)
        return self.out

    def power_on_bodies(self) -> float:
        """Power of the forces of this law."""
        n = self.bench.nodes
        return float((n.force * n.v).sum() + (n.torque * n.w).sum())

    def growth(self, time: float) -> float:
        """Rate of the stored energy as the bodies move on: difference over -time to time [W]."""
        start, stored = self.bench.state(), []
        for t in (-time, time):
            self.bench.nodes[:] = start
            self.bench.drift(t)
            stored.append(float(self.force().stored))
        self.bench.nodes[:] = start
        return (stored[1] - stored[0]) / (2.0 * time)

    def accept(self) -> None:
        """The step is accepted: new becomes old."""
        for name in self.old.dtype.names:
            self.old[name] = self.new[name]

    def measure(self, t: float = 0.0) -> RowOfTable:
        """Outputs of a sensor, every column written."""
        spoil(self.out, self.module.OUTPUT)
        bench = self.bench
        if hasattr(self.module, "follow"):
            self.module.follow(self.p, self.old, self.new, self.out, bench.nodes)
        self.module.measure(self.p, self.out, t, bench.nodes, bench.rows, bench.curves)
        return self.out


def check_power(law: Law, draws: int, **tolerances: float) -> None:
    """In random states the power on the bodies is what the law stores and loses; it loses."""
    start, touched, free = law.bench.state(), 0, 0
    for seed in range(draws):
        law.bench.nodes[:] = start
        law.bench.shake(seed)
        out = law.force()
        given, lost = law.power_on_bodies(), float(out.power)
        touched, free = touched + (out.stored > 0.0), free + (out.stored == 0.0)
        assert given == pytest.approx(-law.growth(1e-6) - lost, **tolerances)
        assert lost >= 0.0
    assert touched >= 5 and free >= 5


def _no_force(*args: object) -> None:
    raise AssertionError("the law has no force")


class Rows:
    """Constraint rows of one joint with its own nodes, movable by hand."""

    def __init__(self, model: Model, state: Any, group: Group, name: str) -> None:
        joint = next(j for j in model.joints if j.name == name)
        k = group.names.index(name)
        self.module = group.module
        self.p = as_rows(group.parameters.copy())[k]
        self.old, self.new = as_rows(group.history.copy())[:, k]
        self.parts, self.m = joint.parts, joint.rows
        self.ends = joint.nodes
        self.curves = as_rows(model.curves)
        self.nodes: Columned = as_rows(np.zeros(len(state.nodes), NODE.dtype))
        self.nodes[:] = state.nodes
        self.rows = as_rows(np.zeros(joint.parts * joint.rows, ROW.dtype))
        self.p.first_row = 0
        self.t = 0.0

    def scramble(self, rng: np.random.Generator) -> None:
        """Random configuration, velocity and time: the rows need not hold."""
        self.t = rng.uniform(0.2, 1.5)
        for node in self.nodes[1:]:
            q = rng.normal(size=4)
            node.A[:] = matrix(q / np.linalg.norm(q)).ravel()
            node.r[:], node.v[:], node.w[:] = rng.normal(size=(3, 3))

    def move(self, h: float, time: bool = False) -> None:
        """All bodies for the time h at their constant velocities, the clock as well if asked."""
        for node in self.nodes[1:]:
            node.r[:] += h * node.v
            angle = h * np.linalg.norm(node.w)
            q = [np.cos(angle / 2), *(0.5 * h * np.sinc(angle / (2 * np.pi)) * node.w)]
            node.A[:] = (matrix(q) @ node.A.reshape(3, 3)).ravel()
        self.t += h if time else 0.0

    def phi(self) -> np.ndarray:
        call = (self.p, self.old, self.new, self.t, self.nodes, self.rows, self.curves)
        write_rows(self.module, "residual", *call)
        return self.total(self.rows.phi)

    def jacobian(self) -> None:
        call = (self.p, self.old, self.t, self.nodes, self.rows, self.curves)
        write_rows(self.module, "jacobian", *call)

    def gamma(self) -> np.ndarray:
        call = (self.p, self.old, self.t, self.nodes, self.rows, self.curves)
        write_rows(self.module, "convective", *call)
        return self.total(self.rows.gamma)

    def total(self, column: np.ndarray) -> np.ndarray:
        """Sum over the parts of each row."""
        total: np.ndarray = column.reshape(self.parts, self.m).sum(axis=0)
        return total

    def rate(self) -> np.ndarray:
        """D v - nu."""
        self.jacobian()
        return self.total(np.array(self.dense() @ self.velocity())) - self.total(self.rows.nu)

    def dense(self) -> np.ndarray:
        """D of each row of each part, six columns per node."""
        D = np.zeros((len(self.rows), 6 * len(self.nodes)))
        for part in range(self.parts):
            a, b = self.ends[2 * part : 2 * part + 2]
            for i in range(part * self.m, (part + 1) * self.m):
                D[i, 6 * a : 6 * a + 6] += self.rows[i].D[:6]
                D[i, 6 * b : 6 * b + 6] += self.rows[i].D[6:]
        return D

    def velocity(self) -> np.ndarray:
        return np.array([[*node.v, *node.w] for node in self.nodes]).ravel()


def write_rows(law: ModuleType, word: str, p: RowOfTable, old: RowOfTable, *rest: object) -> None:
    """Residual, Jacobian or convective term of all rows of a joint, as the step has them."""
    nodes, rows, _ = rest[-3:]
    first = p.first_row
    for basic in law.CONSTRAINTS:
        getattr(basic, word)(p, nodes, rows, first)
        first += len(basic.ANGULAR)
    if hasattr(law, word):
        getattr(law, word)(p, old, *rest)
    if hasattr(law, "release_rows"):
        law.release_rows(p, old, rows, law.ROWS)


def refusal(folder: Path, text: str) -> str:
    """What is reported a deck that cannot be built."""
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    return str(caught.value)


def assert_balanced(nodes: Columned) -> None:
    """That there are forces on the bodies, and that their sum and their moment vanish."""
    assert np.abs(nodes.torque).max() > 0.1
    moment = (nodes.torque + np.cross(nodes.r, nodes.force)).sum(axis=0)
    # sums of six products of numbers below 1e3
    np.testing.assert_allclose(nodes.force.sum(axis=0), 0.0, atol=1e-11)
    np.testing.assert_allclose(moment, 0.0, atol=1e-11)


def pair_of_blocks(flips: int) -> tuple[Columned, Columned]:
    """Place of nodes a and b, and empty blocks of a, b and both; that has rows of b if it flips."""
    position = as_rows(np.array((0, 1, 2, flips), SLOT.dtype))
    return position, as_rows(np.zeros(3, BLOCK.dtype))


def matrix_of_pair(blocks: Columned, flips: int) -> np.ndarray:
    """Such blocks as one matrix (12, 12)."""
    K = np.zeros((12, 12))
    K[:6, :6], K[6:, 6:] = (blocks[k].stiff.reshape(6, 6) for k in (0, 1))
    below, above = blocks[2].stiff.reshape(6, 6), blocks[2].stiff_above.reshape(6, 6).T
    K[:6, 6:], K[6:, :6] = (above, below) if flips else (below, above)
    return K


def spoil(values: RowOfTable, record: Record) -> None:
    """Fill with what nobody would write, so that a column left out is seen."""
    for column in record.columns:
        values[column.name] = np.nan if column.format[1] is np.float64 else -(2**40)


def written(values: RowOfTable, record: Record) -> bool:
    """Whether every column has been written since it was spoilt."""
    spoilt = {True: np.isnan, False: lambda x: np.equal(x, -(2**40))}
    return not any(
        np.any(spoilt[column.format[1] is np.float64](values[column.name]))
        for column in record.columns
    )


def exponential(rotation: ArrayLike) -> np.ndarray:
    """Unit quaternion of a rotation vector."""
    x = np.asarray(rotation, float)
    angle = np.linalg.norm(x)
    return np.array([np.cos(angle / 2), *(0.5 * np.sinc(angle / (2 * np.pi)) * x)])


def product(p: Sequence[float] | np.ndarray, q: Sequence[float] | np.ndarray) -> np.ndarray:
    """Quaternion p q: first q, then p."""
    v, w = np.asarray(p[1:]), np.asarray(q[1:])
    return np.array([p[0] * q[0] - v @ w, *(p[0] * w + q[0] * v + np.cross(v, w))])


class Tangents(NamedTuple):
    """Compliant rows over the motions of some bodies: D and G (rows, 6 bodies), slopes (rows,)."""

    D: np.ndarray
    G: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray


def tangents_of(law: Law, bodies: list[int]) -> Tangents:
    """What a law reports to implicit methods at the present position; parts of a row add up."""
    several = np.ndim(law.p.node) if "node" in law.p.dtype.names else 0
    ends = np.ravel(law.p.node) if several else np.array([law.p.node_a, law.p.node_b])
    count = law.module.TANGENTS
    tangent_rows = as_rows(np.zeros(count * len(ends) // 2, COMPLIANT.dtype))
    law.module.tangent(law.p, law.old, law.bench.nodes, law.bench.curves, tangent_rows, 0)
    sums = np.zeros((2, count, 6 * len(bodies)))
    for j, body in enumerate(ends.tolist()):
        if body in bodies:
            rows = slice(count * (j // 2), count * (j // 2 + 1))
            own, half = 6 * bodies.index(body), 6 * (j % 2)
            for k, name in enumerate("DG"):
                sums[k, :, own : own + 6] += tangent_rows[name][rows, half : half + 6]
    return Tangents(
        *sums, tangent_rows.stiffness[:count].copy(), tangent_rows.damping[:count].copy()
    )
