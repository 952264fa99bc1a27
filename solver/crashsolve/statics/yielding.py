"""Hinges in quasi-static solutions: their tangent, and load steps that end at their corners.

    K = K_e - sum (k_e - k_t) d^T d,      past(s) = 0

A hinge that yields has two slopes where it stands, onward and back, which differences of samples
would mix. They are taken of elastic hinges, K_e, and the reduction of stiffness by yield is put in
place of it, by the hinge's own rows d. An ellipse has no corner but first yield, and a tangent
that depends on the direction: there differences are used. The work of a load step is that of the
mean of its forces, and the law of a hinge has straight branches: a step ends where the first hinge
leaves its own, at the share s found by the Illinois method. Between corners a structure of hinges
is linear but for its geometry. Consequence to test: limit loads, work and dissipated energy are
those of limit analysis, however long the load steps.

References: Neal (1977), The Plastic Methods of Structural Analysis, 1.4 (hinge by hinge); Simo and
Hughes (1998), Computational Inelasticity, 1.4.3 (consistent tangent).
"""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product
from types import SimpleNamespace

import numpy as np

from crashsolve.foundation.curve import HOLD, POINT
from crashsolve.model.model import Group, Model
from crashsolve.model.nodes import COMPLIANT
from crashsolve.statics.branches import Branches, Candidate, slope_ahead
from crashsolve.statics.equations import Equations, Tangent
from crashsolve.statics.problem import Problem

# a corner may be passed by this share of the change over the load step: its square is the error of
# work
CLOSE = 1e-6
# the least share of a load step: past the position of a corner that is met already
LEAST = 1e-8
MAX_ITERATIONS = 60
# so much before a failure a step ends [of its displacement]
BEFORE = 4.0 * CLOSE
# where a corner cannot be passed a load step ends so much before it [of its displacement]
SHORT = 1e-5
# a predicted corner is passed by a little more than the tangent errs
BEHIND = 1.2
# of a hinge that never yields; squares of it are numbers too [N m]
NEVER = 1e150


class Yielding:
    """The hinges of a quasi-static run."""

    def __init__(self, model: Model) -> None:
        """Writes: model.curves."""
        self.groups = [g for g in model.joint_groups() if hasattr(g.module, "event")]
        self.straight = [g for g in self.groups if not _is_curved(g)]
        self.model, self.elastic = model, len(model.curves)
        self.points: list[SimpleNamespace] = []
        # share of a load step that goes past a corner at its start, and whether this one is it
        self.least, self.is_least = LEAST, False
        if self.groups:
            points = np.zeros(2, POINT.dtype)
            points["x"], points["last"], points["beyond"] = (0.0, 1.0), self.elastic + 1, HOLD
            points["c"][:, 0] = NEVER
            model.curves = np.concatenate([model.curves, points])

    @contextmanager
    def elastic_hinges(self, current: int) -> Iterator[None]:
        """Make all hinges elastic about the state of the last sample, within this context."""
        saved = [(g.history.copy(), g.parameters.copy()) for g in self.straight]
        for g in self.straight:
            # a joint that a failure would free has its rows until the step is accepted
            g.parameters["is_apart"] *= g.history["failed"][current] == 1
            g.history[current] = g.history[1 - current]
            g.parameters["backbone"], g.parameters["cyclic"] = self.elastic, 0
            g.parameters["failure"] = np.inf
        yield
        for g, (history, parameters) in zip(self.straight, saved, strict=True):
            g.history[:], g.parameters[:] = history, parameters

    def stiffness(self, current: int, nodes: np.ndarray) -> np.ndarray:
        """sum k d^T d (n, 6, n, 6) of the hinges, n all nodes."""
        K = np.zeros((len(nodes), 6, len(nodes), 6))
        for g, p, state, position in self._entries(current, nodes, self.straight):
            if state.fails:
                continue
            rows = [plain(row) for row in np.zeros(g.module.TANGENTS, COMPLIANT.dtype)]
            g.module.tangent(p, state, position, self.curves(), rows, 0)
            for row in rows:
                d = np.array(row.D).reshape(2, 6)
                for (i, a), (j, b) in product(enumerate((p.node_a, p.node_b)), repeat=2):
                    K[a, :, b] += row.stiffness * np.multiply.outer(d[i], d[j])
        return K

    def predicted(self, engine: Equations, time: float) -> float:
        """Time [s] a little after the first corner, by the tangent; at most `time`.

        Newton's method then has one corner before it, where a long step might lead it far away.
        """
        start_time = float(engine.clock.time)
        change = engine.correction(time, engine.known_tangent)
        if not np.isfinite(change).all():
            return time
        step_fraction = engine.step_fraction(change)
        fraction = BEHIND * step_fraction * self._crossing(engine, step_fraction * change)
        # a hinge that stands at its corner is led past it; longer each time that this does not help
        self.is_least = fraction <= self.least == LEAST
        fraction, self.least = (
            (self.least, 100.0 * self.least) if fraction <= self.least else (fraction, LEAST)
        )
        return start_time + min(fraction, 1.0) * (time - start_time)

    def before_corner(self, engine: Equations, time: float) -> float:
        """Time [s] a little before the first corner on the path to `time`, by the tangent."""
        start_time = float(engine.clock.time)
        change = engine.correction(time, engine.known_tangent)
        if not np.isfinite(change).all():
            return time
        step_fraction = engine.step_fraction(change)
        fraction = step_fraction * self._crossing(engine, step_fraction * change, SHORT)
        return start_time + (1.0 - 2.0 * SHORT) * fraction * (time - start_time)

    def branch(self, engine: Equations, time: float) -> Tangent | None:
        """Tangent K and D beyond a corner with the hinges that continue to yield; None if unknown.

        Raises SolverError at a bifurcation, where one of several may.
        """
        branches = Branches(engine, self.at_yield(engine), time)
        if bifurcation := branches.bifurcation():
            raise Problem("bifurcation", time, " and ".join(bifurcation)).error(
                engine, float(engine.clock.time)
            )
        return branches.tangent()

    def at_yield(self, engine: Equations) -> list[Candidate]:
        """The motions of hinges that stand at yield."""
        current, nodes, candidates = (
            int(engine.clock.current),
            engine.state.nodes,
            list[Candidate](),
        )
        index = np.full(len(nodes), -1)
        index[engine.free] = np.arange(len(engine.free))
        ahead = [
            [
                {side: slope_ahead(p, state, c, side, self.curves()) for side in (1.0, -1.0)}
                for c in range(g.module.TANGENTS)
            ]
            for g, p, state, _ in self._entries(current, nodes, self.straight)
        ]
        names = [f"hinge '{name}'" for g in self.straight for name in g.names]
        with self.elastic_hinges(current):
            each = self._entries(current, nodes, self.straight)
            for name, motions, (g, p, state, position) in zip(names, ahead, each, strict=True):
                rows = [plain(row) for row in np.zeros(g.module.TANGENTS, COMPLIANT.dtype)]
                g.module.tangent(p, state, position, self.curves(), rows, 0)
                for row, slopes in zip(rows, motions, strict=True):
                    d = np.zeros((len(engine.free), 6))
                    for node, part in zip(
                        (p.node_a, p.node_b), (row.D[:6], row.D[6:]), strict=True
                    ):
                        if index[node] >= 0:
                            # rows contain the derivative of the deformation as -D
                            d[index[node]] -= part
                    for side, slope in slopes.items():
                        if slope is not None and row.stiffness > 0.0:
                            candidates.append(
                                Candidate(name, d.ravel(), row.stiffness, side, slope)
                            )
        return candidates

    def _crossing(self, engine: Equations, change: np.ndarray, tolerance: float = 0.1) -> float:
        """Fraction [1] of a motion (n, 6) of the free nodes at the first corner; 1 without one.

        To a relative `tolerance`, and not before the corner.
        """
        nodes, current = engine.state.nodes, int(engine.clock.current)
        start, low, high = nodes.copy(), 0.0, 1.0
        fraction = high
        while high > LEAST and high - low > tolerance * high:
            nodes[:] = start
            engine.shift(nodes, fraction * change)
            if self._beyond_branch(current, nodes).max() > 0.0:
                high = fraction
            else:
                low = fraction
            fraction = 0.5 * (low + high)
        nodes[:] = start
        return high

    def first_corner(
        self, engine: Equations, start: np.ndarray, time: float, count: int
    ) -> tuple[float, int]:
        """Time [s] of the first corner between nodes `start` and the equilibrium at `time`, and the
        number of iterations.

        `time` without a corner; 0 iterations where an equilibrium in between is not found.
        Writes: the State.
        """
        nodes, current = engine.state.nodes, int(engine.clock.current)
        start_time, end = float(engine.clock.time), self._beyond_branch(current, nodes).max()
        if end <= 0.0 or self.is_least:
            return time, count
        at_low = min(self._beyond_branch(current, start).max(), 0.0)
        # a little behind the corner, so that the next load step begins on the new branch
        goal = 0.5 * CLOSE * (end - at_low)
        low, high, at_low, at_high = 0.0, 1.0, at_low - goal, end - goal
        bracketed, side = (engine.save_state(), engine.tangent), 0
        for k in range(MAX_ITERATIONS):
            if at_high <= goal:
                break
            # a curved function needs bisection now and then
            part = 0.5 if k % 4 == 3 else -at_low / (at_high - at_low)
            fraction = max(low + part * (high - low), LEAST)
            nodes[:] = start
            more = engine.iterate(start_time + fraction * (time - start_time))
            if not more:
                return time, 0
            count, past = count + more, self._beyond_branch(current, nodes).max() - goal
            if past >= -goal:
                high, at_high, bracketed = fraction, past, (engine.save_state(), engine.tangent)
                at_low *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                low, at_low = fraction, past
                at_high *= 0.5 if side == -1 else 1.0
                side = -1
        saved, engine.tangent = bracketed
        engine.restore_state(saved)
        if self._fails(current) and high > BEFORE:
            # a failed hinge does no work: it is removed in a step of almost no length
            nodes[:] = start
            high -= BEFORE
            more = engine.iterate(start_time + high * (time - start_time))
            count = count + more if more else 0
        return start_time + high * (time - start_time), count

    def _fails(self, current: int) -> bool:
        """Whether a hinge has failed since the load step began."""
        return any(
            (g.history[1 - current]["failed"] > g.history[current]["failed"]).any()
            for g in self.groups
        )

    def _beyond_branch(self, current: int, nodes: np.ndarray) -> np.ndarray:
        """Deformation of each hinge beyond the branch on which the load step began [rad or m]."""
        return np.array(
            [
                g.module.event(p, state, 0.0, position, self.curves())
                for g, p, state, position in self._entries(current, nodes, self.groups)
            ]
        )

    def _entries(
        self, current: int, nodes: np.ndarray, groups: list[Group]
    ) -> Iterator[tuple[Group, SimpleNamespace, SimpleNamespace, dict[int, SimpleNamespace]]]:
        """Group, parameters, accepted history with `fails`, and both nodes of every hinge."""
        for g in groups:
            old, new = g.history[current], g.history[1 - current]
            for row, before, after in zip(g.parameters, old, new, strict=True):
                p, state = plain(row), plain(before)
                state.fails = bool(after["failed"])
                yield g, p, state, {i: plain(nodes[i]) for i in (p.node_a, p.node_b)}

    def curves(self) -> list[SimpleNamespace]:
        """Copies of the points of all curves: trials past their ends do not mark the model."""
        if not self.points:
            self.points = [plain(point) for point in self.model.curves]
        return self.points


def _is_curved(group: Group) -> bool:
    """Whether any of these hinges yields on an ellipse."""
    p = group.parameters
    return "is_elliptic" in (p.dtype.names or ()) and bool(p["is_elliptic"].any())


def plain(row: np.void) -> SimpleNamespace:
    """A record as numbers and lists, which Python reads faster."""
    return SimpleNamespace(**{name: row[name].tolist() for name in row.dtype.names or ()})
