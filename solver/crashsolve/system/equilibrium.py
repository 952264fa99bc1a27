"""Quasi-static solution: at every load step the posture in which all accelerations vanish.

    g(q) = M (v_dot, w_dot) at rest,   Phi(q) = 0
    (dg/dq - s D^T D) delta = -g + s D^T Phi

A sample at rest tells g, the forces less what the joints hold of them: what vanishes in
equilibrium. As D M^-1 g = 0 in any posture, both sides of Newton's equation part into g and Phi;
s only balances them. The tangent is the whole one, by differences of samples, with the turning of
forces and the reactions of joints, so that corrections fall quadratically. Work of loads is the
mean of their forces before and after a step on its way. Consequence to test: equilibria are those
in which damped motion ends.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.foundation.posture import matrix
from crashsolve.model.model import Model, State
from crashsolve.system.engine import Engine

# differences: over the model's size, and rad; their errors only slow Newton's method a little
STEP = 1e-7
# largest turn [rad] and way (over the model's size) of a correction
LARGEST_TURN, LARGEST_WAY = 0.3, 0.2
PASSES = 40
# of the largest entry: a smaller pivot is round-off, and something moves freely
SINGULAR = 1e-15
# a load step is halved so often where no equilibrium is found
HALVINGS = 5
# of the size and of a radian: where `control.tolerance` says nothing
TOLERANCE = 1e-9


class StaticEngine(Engine):
    """Goes from equilibrium to equilibrium instead of stepping through time."""

    def __init__(self, model: Model, state: State, tolerance: float | None) -> None:
        super().__init__(model, state)
        self.tolerance = tolerance or TOLERANCE
        slaves = set(model.slaves["node"])
        self.free = np.array([i for i in range(1, len(state.nodes)) if i not in slaves])

    def _step(self, until: float, goal: float) -> None:
        """Equilibrium at `until`, by way of others where it must. Raises SolverError."""
        least = (until - float(self.clock.time)) / 2**HALVINGS
        while self.clock.time < until:
            target = until
            while not self._reaches(target):
                target = 0.5 * (self.clock.time + target)
                if target - self.clock.time < least:
                    raise self._lost()
            self.on_pause()

    def step_warnings(self) -> list[str]:
        """Nothing: passes of Newton's method are no sign of steps that are too long."""
        return []

    def _reaches(self, time: float) -> bool:
        """Newton's method for the equilibrium at a time; the State is left alone if it fails."""
        nodes, start = self.state.nodes, self.state.nodes.copy()
        worst = np.inf
        for passes in range(PASSES):
            way = self._correction(time)
            size = max(np.abs(way[:, :3]).max() / self.model.size, np.abs(way[:, 3:]).max())
            if not np.isfinite(size):
                break
            worst = size
            turn, far = np.abs(way[:, 3:]).max(), np.abs(way[:, :3]).max() / self.model.size
            self._shift(nodes, way / max(1.0, turn / LARGEST_TURN, far / LARGEST_WAY))
            if worst <= self.tolerance:
                self._accept(time, start, passes + 1, worst)
                return True
        nodes[:] = start
        self.clock.value = worst
        return False

    def _accept(self, time: float, start: np.ndarray, passes: int, worst: float) -> None:
        """The equilibrium becomes the present state, with the work of loads on the way."""
        clock, span = self.clock, time - float(self.clock.time)
        way = self._way_from(start) / span
        powers = [self._powers(when, at, way) for when, at in ((clock.time, start), (time, None))]
        for g in self._loads():
            work = 0.5 * span * (powers[0][g.word] + powers[1][g.word])
            g.history["dissipated"] += work
        clock.time, clock.step, clock.next_step = time, span, span
        clock.cycle += 1
        clock.iterations += passes
        clock.residual = max(clock.residual, worst)

    def _loads(self) -> list[Any]:
        return [g for g in self.model.force_groups() if g.keyword == "loads"]

    def _powers(self, time: float, at: np.ndarray | None, way: np.ndarray) -> dict[str, np.ndarray]:
        """Power of every load where the nodes are, moving by `way` [m/s, rad/s]."""
        nodes = (self.state.nodes if at is None else at).copy()
        nodes["v"][self.free], nodes["w"][self.free] = way[:, :3], way[:, 3:]
        for row, w in zip(self.free, way[:, 3:], strict=True):
            A = nodes["A"][row].reshape(3, 3)
            nodes["L"][row] = A @ (nodes["J"][row].reshape(3, 3) @ (A.T @ w))
        self._rest(time, nodes)
        new = 1 - int(self.clock.current)
        return {g.word: g.history[new]["power"].copy() for g in self._loads()}

    def _way_from(self, start: np.ndarray) -> np.ndarray:
        """Displacements and turns (n, 6) of the free nodes since a posture."""
        here = self.state.nodes[self.free]
        turns = [_turn(q, p) for p, q in zip(here["q"], start["q"][self.free], strict=True)]
        return np.hstack([here["r"] - start["r"][self.free], np.array(turns)])

    def _correction(self, time: float) -> np.ndarray:
        """Newton's correction (n, 6) of places and turns of the free nodes."""
        g, D, phi = self._imbalance(time)
        columns = self._tangent(time, g)
        scale = np.abs(columns).max() / max(np.abs(D).max(initial=0.0) ** 2, 1e-300)
        held = np.einsum("mi,mj->ij", D, D)
        way = _eliminate(columns - scale * held, -g + scale * np.einsum("mi,m->i", D, phi))
        return way.reshape(-1, 6)

    def _tangent(self, time: float, g: np.ndarray) -> np.ndarray:
        """Derivative (6 n, 6 n) of g by places and turns of the free nodes."""
        nodes, columns = self.state.nodes.copy(), np.empty((g.size, g.size))
        for k in range(g.size):
            row, way = nodes[self.free[k // 6]], np.zeros(6)
            kept = row.copy()
            way[k % 6] = size = STEP * (self.model.size if k % 6 < 3 else 1.0)
            _move(row, way)
            columns[:, k] = (self._rest(time, nodes) - g) / size
            nodes[self.free[k // 6]] = kept
        return columns

    def _imbalance(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces and moments that nothing holds (6 n,), D (m, 6 n) and Phi (m,)."""
        g, rows = self._rest(time, self.state.nodes), self.rows
        D = np.zeros((len(rows), len(self.nodes), 6))
        index = np.arange(len(rows))
        np.add.at(D, (index, rows["node_a"]), rows["D"][:, :6])
        np.add.at(D, (index, rows["node_b"]), rows["D"][:, 6:])
        return g, D[:, self.free].reshape(len(rows), -1), rows["phi"].copy()

    def _rest(self, time: float, nodes: np.ndarray) -> np.ndarray:
        """A sample of these nodes: forces and moments (6 n,) that would move the free ones."""
        self.nodes[:], self.rows[:] = nodes, self.state.rows
        self.ledger[:], self._clock[:] = self.state.ledger, self.state.clock
        self._clock[0]["time"] = time
        self._advance(time, True, self._sampled)
        g = np.empty((len(self.free), 6))
        g[:, :3] = self.nodes["v_dot"][self.free] / self.nodes["mass_inv"][self.free, None]
        # J w_dot in world axes, J being kept in the nodes' own
        A = self.nodes["A"][self.free].reshape(-1, 3, 3)
        own = np.matmul(self.nodes["w_dot"][self.free][:, None], A)
        J = self.nodes["J"][self.free].reshape(-1, 3, 3)
        g[:, 3:] = np.matmul(np.matmul(own, J), A.transpose(0, 2, 1))[:, 0]
        return g.ravel()

    def _shift(self, nodes: np.ndarray, way: np.ndarray) -> None:
        """Move the free nodes by displacements and turns (n, 6). Writes: nodes."""
        for i, part in zip(self.free, way, strict=True):
            _move(nodes[i], part)

    def _lost(self) -> SolverError:
        """No equilibrium near the last one."""
        clock = self.clock
        cause = f"no equilibrium found behind this one (last correction {float(clock.value):.2g})"
        advice = (
            "let loads rise along a curve, in more steps; hold what can move freely; "
            "where a structure snaps through, say solution: transient with damping"
        )
        return SolverError(float(clock.time), int(clock.cycle), "the model", cause, advice)


def _eliminate(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solution of A x = b, not numbers where A is singular; with partial pivoting. Writes: A, b.

    LAPACK would wake threads that spin on a busy machine, for a matrix of some hundred rows.
    """
    size = np.abs(A).max(initial=0.0)
    for k in range(len(b)):
        pivot = k + int(np.argmax(np.abs(A[k:, k])))
        if not abs(A[pivot, k]) > SINGULAR * size:
            return np.full_like(b, np.nan)
        A[[k, pivot]], b[[k, pivot]] = A[[pivot, k]], b[[pivot, k]]
        factor = A[k + 1 :, k] / A[k, k]
        A[k + 1 :, k:] -= factor[:, None] * A[k, k:]
        b[k + 1 :] -= factor * b[k]
    for k in range(len(b) - 1, -1, -1):
        b[k] = (b[k] - (A[k, k + 1 :] * b[k + 1 :]).sum()) / A[k, k]
    return b


def _move(row: Any, way: np.ndarray) -> None:
    """Move a node by a displacement and a turn (6,). Writes: row."""
    row["r"] += way[:3]
    q = _product(_exponential(way[3:]), row["q"])
    row["q"] = q / np.linalg.norm(q)
    row["A"] = matrix(row["q"]).ravel()


def _exponential(turn: np.ndarray) -> np.ndarray:
    """Unit quaternion of a rotation vector."""
    angle = float(np.linalg.norm(turn))
    return np.array([np.cos(0.5 * angle), *(0.5 * np.sinc(0.5 * angle / np.pi) * turn)])


def _product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of two quaternions."""
    w = p[0] * q[0] - p[1:] @ q[1:]
    return np.array([w, *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


def _turn(q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rotation vector, world axes, from posture q to posture p."""
    w, x, y, z = _product(p, q * [1.0, -1.0, -1.0, -1.0])
    v = np.array([x, y, z]) * (1.0 if w >= 0.0 else -1.0)
    sine = float(np.linalg.norm(v))
    return v * (2.0 * np.arctan2(sine, abs(w)) / sine if sine > 1e-12 else 2.0)
