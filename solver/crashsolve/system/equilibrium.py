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
from crashsolve.foundation.posture import matrices, matrix, products
from crashsolve.model.model import Model, State
from crashsolve.system.engine import Engine

# differences: over the model's size, and rad; their errors only slow Newton's method a little
STEP = 1e-7
# largest turn [rad] and way (over the model's size) of a correction
LARGEST_TURN, LARGEST_WAY = 0.3, 0.2
PASSES = 40
# of the largest mobility of the rows of joints: lets redundant ones share
SHARED = 1e-10
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
        self.tolerance, self.has_stages = tolerance or TOLERANCE, False
        slaves = set(model.slaves["node"])
        self.free = np.array([i for i in range(1, len(state.nodes)) if i not in slaves])
        self.beams = [g for g in model.groups if hasattr(g.module, "forces_by_motions")]
        self.differs = self._held_otherwise(slaves)

    def _held_otherwise(self, slaves: set[int]) -> np.ndarray:
        """Which free nodes (n,) anything but elements of beams may act on."""
        named = slaves | set(self.model.slaves["body"])
        for g in self.model.groups:
            if not hasattr(g.module, "forces_by_motions"):
                # any whole number may be a node
                whole = [
                    k for k in g.parameters.dtype.names or () if g.parameters[k].dtype.kind in "iu"
                ]
                named |= {int(i) for k in whole for i in g.parameters[k].ravel()}
        for g in self.beams:
            ends = zip(
                g.parameters["node_a"].tolist(), g.parameters["node_b"].tolist(), strict=True
            )
            # what acts on a slave acts on its master
            named |= {i for pair in ends if slaves & set(pair) for i in pair}
        return np.isin(self.free, list(named))

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
        A, J = (nodes[name][self.free].reshape(-1, 3, 3) for name in ("A", "J"))
        inertia = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        nodes["L"][self.free] = np.matmul(inertia, way[:, 3:, None])[:, :, 0]
        self._rest(time, nodes)
        new = 1 - int(self.clock.current)
        return {g.word: g.history[new]["power"].copy() for g in self._loads()}

    def _way_from(self, start: np.ndarray) -> np.ndarray:
        """Displacements and turns (n, 6) of the free nodes since a posture."""
        here = self.state.nodes[self.free]
        turns = _turns(start["q"][self.free], here["q"])
        return np.hstack([here["r"] - start["r"][self.free], turns])

    def _correction(self, time: float) -> np.ndarray:
        """Newton's correction (n, 6) of places and turns of the free nodes."""
        g, D, phi = self._imbalance(time)
        columns = self._tangent(time, g, D)
        scale = np.abs(columns).max() / max(np.abs(D).max(initial=0.0) ** 2, 1e-300)
        held = np.einsum("mi,mj->ij", D, D)
        way = _eliminate(columns - scale * held, -g + scale * np.einsum("mi,m->i", D, phi))
        return way.reshape(-1, 6)

    def _tangent(self, time: float, g: np.ndarray, D: np.ndarray) -> np.ndarray:
        """Derivative (6 n, 6 n) of g by places and turns of the free nodes.

        Of nodes that only elements of beams hold it is theirs; other laws, and joints, are sampled.
        """
        nodes, columns = self.state.nodes.copy(), self._let_go(self._beams(), D)
        for k in np.flatnonzero(np.repeat(self.differs, 6)):
            i, size = self.free[k // 6], STEP * (self.model.size if k % 6 < 3 else 1.0)
            kept = nodes[i].copy()
            _nudge(nodes[i], int(k % 6), size)
            columns[:, k] = (self._rest(time, nodes) - g) / size
            nodes[i] = kept
        return columns

    def _let_go(self, columns: np.ndarray, D: np.ndarray) -> np.ndarray:
        """Less what joints hold of it: D^T (D M^-1 D^T)^-1 D M^-1 of forces (6 n, k)."""
        nodes = self.state.nodes[self.free]
        A, J = nodes["A"].reshape(-1, 3, 3), nodes["J_inv"].reshape(-1, 3, 3)
        mobility = np.zeros((len(nodes), 6, 6))
        mobility[:, :3, :3] = nodes["mass_inv"][:, None, None] * np.eye(3)
        mobility[:, 3:, 3:] = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        moved = np.einsum("mni,nij->mnj", D.reshape(len(D), -1, 6), mobility).reshape(D.shape)
        rows = np.einsum("mi,ki->mk", moved, D)
        rows += SHARED * np.abs(rows).max(initial=0.0) * np.eye(len(D))
        held = _eliminate(rows, np.einsum("mi,ik->mk", moved, columns))
        return columns - np.einsum("mi,mk->ik", D, held)

    def _beams(self) -> np.ndarray:
        """The same of the elements of beams alone."""
        n, nodes = len(self.free), self.state.nodes
        columns, place = np.zeros((n + 1, n + 1, 6, 6)), np.full(len(nodes), n)
        place[self.free] = np.arange(n)
        for g in self.beams:
            p = g.parameters
            found = g.module.forces_by_motions(p, nodes).reshape(-1, 2, 6, 2, 6)
            ends = place[p["node_a"]], place[p["node_b"]]
            for i, j in np.ndindex(2, 2):
                np.add.at(columns, (ends[i], ends[j]), found[:, i, :, j])
        return columns[:n, :n].transpose(0, 2, 1, 3).reshape(6 * n, 6 * n)

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
        moved = nodes[self.free]
        _move(moved, way)
        nodes[self.free] = moved

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
    """Solutions of A x = b (n,) or (n, k), not numbers where A is singular. Writes: A, b.

    LAPACK would wake threads that spin on a busy machine, for a matrix of some hundred rows.
    """
    size = np.abs(A).max(initial=0.0)
    for k in range(len(b)):
        pivot = k + int(np.argmax(np.abs(A[k:, k])))
        if not abs(A[pivot, k]) > SINGULAR * size:
            return np.full_like(b, np.nan)
        A[[k, pivot]], b[[k, pivot]] = A[[pivot, k]], b[[pivot, k]]
        # few rows of a chain have anything in a column
        below = k + 1 + np.flatnonzero(A[k + 1 :, k])
        factor = A[below, k] / A[k, k]
        A[below, k:] -= factor[:, None] * A[k, k:]
        b[below] -= np.multiply.outer(factor, b[k])
    for k in range(len(b) - 1, -1, -1):
        b[k] = (b[k] - np.einsum("i,i...->...", A[k, k + 1 :], b[k + 1 :])) / A[k, k]
    return b


def _move(nodes: np.ndarray, way: np.ndarray) -> None:
    """Move nodes by displacements and turns (n, 6). Writes: nodes."""
    nodes["r"] += way[:, :3]
    half = 0.5 * np.linalg.norm(way[:, 3:], axis=1)[:, None]
    q = products(np.hstack([np.cos(half), 0.5 * np.sinc(half / np.pi) * way[:, 3:]]), nodes["q"])
    nodes["q"] = q / np.linalg.norm(q, axis=1)[:, None]
    nodes["A"] = matrices(nodes["q"]).reshape(-1, 9)


def _nudge(row: Any, k: int, size: float) -> None:
    """Move a node along axis k, or turn it about axis k - 3, by very little. Writes: row."""
    if k < 3:
        row["r"][k] += size
        return
    turn = np.array([1.0, 0.0, 0.0, 0.0])
    turn[k - 2] = 0.5 * size
    row["q"] = products(turn, row["q"])
    row["A"] = matrix(row["q"]).ravel()


def _turns(q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rotation vectors (n, 3), world axes, from postures q to postures p (n, 4)."""
    turn = products(p, q * [1.0, -1.0, -1.0, -1.0])
    turn *= np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    sine = np.linalg.norm(turn[:, 1:], axis=1)[:, None]
    over = 2.0 * np.arctan2(sine, turn[:, :1]) / np.maximum(sine, 1e-12)
    return turn[:, 1:] * np.where(sine > 1e-12, over, 2.0)
