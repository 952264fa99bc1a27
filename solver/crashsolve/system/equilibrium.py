"""Quasi-static solution: at every load step the posture in which all accelerations vanish.

    g(q) = M (v_dot, w_dot) at rest,   Phi(q) = 0
    (dg/dq - s D^T D) delta = -g + s D^T Phi

A sample at rest tells g, the forces less what the joints hold of them: what vanishes in
equilibrium. As D M^-1 g = 0 in any posture, both sides of Newton's equation part into g and Phi;
s only balances them. The tangent is the whole one, by differences of samples, with the turning of
forces and the reactions of joints, so that corrections fall quadratically. Equilibrium is a matter
of forces, beside corrections (`balance.py`), and whether it is stable one of the tangent
(`stability.py`). Consequence to test: equilibria are those in which damped motion ends.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.foundation.posture import matrices, matrix, products
from crashsolve.model import ledger as energy
from crashsolve.model.model import Model, State
from crashsolve.system.balance import Forces, Work
from crashsolve.system.diagnosis import curve_end
from crashsolve.system.engine import Engine
from crashsolve.system.loading import Loading
from crashsolve.system.problem import Problem, first_way_out
from crashsolve.system.stability import way_out

# differences: over the model's size, and rad; their errors only slow Newton's method a little
STEP = 1e-7
# largest turn [rad] and way (over the model's size) of a correction
LARGEST_TURN, LARGEST_WAY = 0.3, 0.2
PASSES = 40
# a correction that falls no more is round-off below this, in the model's size or rad
AS_GOOD_AS_IT_GETS = 1e-9
# a way that is nothing but round-off, and an energy, over the largest force times the size
NOWHERE, NOTHING = 1e-15, 1e-12
# of the largest mobility of the rows of joints: lets redundant ones share
SHARED = 1e-10
# of the largest entry: a smaller pivot is round-off, and something moves freely
SINGULAR = 1e-15
# a load step is halved so often where no equilibrium is found
HALVINGS = 7
# of the largest force, and of the way of a load step: where `control.tolerance` says nothing
TOLERANCE = 1e-8


class StaticEngine(Engine):
    """Goes from equilibrium to equilibrium instead of stepping through time."""

    def __init__(self, model: Model, state: State, control: Any) -> None:
        """`control` is the deck's card."""
        self.loading = Loading(model, control.start_time)
        super().__init__(model, state)
        self.tolerance = control.tolerance or TOLERANCE
        model.control[0]["tolerance"] = self.tolerance
        self.limit = 0.0 if control.energy_limit == "off" else float(control.energy_limit)
        self.has_stages = False
        slaves = set(model.slaves["node"])
        self.free = np.array([i for i in range(1, len(state.nodes)) if i not in slaves], int)
        self.beams = [g for g in model.groups if hasattr(g.module, "forces_by_motions")]
        self.differs = self._held_otherwise(slaves)
        self.forces, self.work = Forces(model.size, self.tolerance), Work(self)
        self.notes: list[str] = []
        self.origin = state.nodes.copy()
        self.flutters = False
        # of the last pass: K (6 n, 6 n) and D (m, 6 n)
        self.tangent: tuple[np.ndarray, np.ndarray] | None = None

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

    def start(self) -> None:
        """The equilibrium in which the run begins. Raises SolverError."""
        super().start()
        loading, clock = self.loading, self.clock
        if not loading.rising and not self._rest(loading.start, self.state.nodes).any():
            return
        # nobody can be answered before the files are open
        answer, self.on_pause = self.on_pause, lambda: None
        clock.time = loading.begin
        self._step(loading.start, loading.start)
        self.on_pause = answer
        missing = self._missing_energy()
        if abs(missing) <= NOTHING * self.forces.energy():
            # round-off of what is told as nothing
            clock.driver_work += missing

    def _step(self, until: float, goal: float) -> None:
        """Equilibrium at `until`, by way of others where it must. Raises SolverError."""
        clock, found = self.clock, list[Problem]()
        least = (until - float(clock.time)) / 2**HALVINGS
        while clock.time < until:
            begun, target, kept = float(clock.time), until, self._keep()
            while (problem := self._tries(target)) is not None:
                found.append(problem)
                target = 0.5 * (begun + target)
                is_last = target - begun < least
                if is_last and problem.kind == "balance" and begun < self.loading.start:
                    self._settle()
                    break
                self._take_back(kept)
                if is_last:
                    raise first_way_out(found).error(self, begun)
            self.on_pause()

    def _tries(self, target: float) -> Problem | None:
        """Go to the equilibrium of a moment; why it cannot be had."""
        clock, start = self.clock, self.state.nodes.copy()
        begun, before = float(clock.time), self._missing_energy()
        self.work.begin()
        if not self._reaches(target):
            return Problem("lost", target)
        self.work.count(start, begun, target)
        clock.time, clock.step, clock.next_step = target, target - begun, target - begun
        self._refuse_end_of_curve()
        place = self._way_out()
        if place:
            return Problem("way out", target, place)
        missing = abs(self._missing_energy() - before)
        if self.limit and missing > self.limit * self._largest() + NOTHING * self.forces.energy():
            return Problem("balance", target)
        return None

    def _settle(self) -> None:
        """A first posture far from equilibrium: there is no way, and no balance, from there."""
        self.clock.driver_work += self._missing_energy()
        self.notes.append(
            "the first posture is far from an equilibrium: the energy that is lost on the way to "
            "the one in which the run begins is counted as driver work"
        )

    def _missing_energy(self) -> float:
        """Imbalance of the present state [J]."""
        self._rest(float(self.clock.time), self.state.nodes)
        self.state.ledger[energy.LARGEST] = self.ledger[energy.LARGEST]
        return float(self.ledger[energy.IMBALANCE])

    def _largest(self) -> float:
        return float(self.ledger[energy.LARGEST])

    def _kept(self) -> list[np.ndarray]:
        """Arrays that a load step changes."""
        s = self.state
        return [
            *(s.clock, s.nodes, s.rows, s.ledger, s.points, s.blocks),
            *(g.history for g in self.model.groups),
        ]

    def _keep(self) -> list[np.ndarray]:
        return [array.copy() for array in self._kept()]

    def _take_back(self, kept: list[np.ndarray]) -> None:
        """As before a load step. Writes: the State."""
        for array, old in zip(self._kept(), kept, strict=True):
            array[...] = old

    def finish(self) -> None:
        """Judge the balance of the whole run. Raises SolverError."""
        missing = abs(float(self.ledger[energy.IMBALANCE]))
        if self.limit and missing > self.limit * self._largest() + NOTHING * self.forces.energy():
            raise Problem("balance", float(self.clock.time)).error(self, float(self.clock.time))

    def step_warnings(self) -> list[str]:
        """What the start has met; passes of Newton's method are no sign of long steps."""
        return self.notes

    def sample(self, time: float | None = None) -> None:
        """As of a run in time; with the loads of the moment."""
        self.loading.place(float(self.state.clock[0]["time"]) if time is None else time)
        super().sample(time)

    def _reaches(self, time: float) -> bool:
        """Newton's method for the equilibrium at a time."""
        nodes, start = self.state.nodes, self.state.nodes.copy()
        previous = np.inf
        for passes in range(PASSES):
            way = self._correction(time)
            if passes == 0:
                self.forces.meet(self._imbalance(time)[0], self)
            turn, far = np.abs(way[:, 3:]).max(), np.abs(way[:, :3]).max() / self.model.size
            worst = max(turn, far)
            if not np.isfinite(worst):
                break
            self._shift(nodes, way / max(1.0, turn / LARGEST_TURN, far / LARGEST_WAY))
            share = min(worst / previous, 1.0) if passes else 1.0
            stays = worst >= 0.5 * previous
            is_still = worst * share <= self.tolerance * self._whole_way(start) + NOWHERE
            if is_still or (stays and worst <= AS_GOOD_AS_IT_GETS):
                g, _, phi = self._imbalance(time)
                self.forces.meet_reactions(self)
                if self._is_closed(phi) and self.forces.balance(g, self._round_off()):
                    self._accept(passes + 1)
                    return True
            self.clock.value, previous = worst, worst
        return False

    def _accept(self, passes: int) -> None:
        """What joints remember of the way, and what the run counts."""
        clock = self.clock
        for g in self.model.joint_groups():
            g.history[:] = g.history[1 - int(clock.current)]
        clock.cycle += 1
        clock.iterations += passes

    def _is_closed(self, phi: np.ndarray) -> bool:
        """Whether the joints are. Writes: clock.residual."""
        scale = self.state.rows["scale"]
        error = float((np.abs(phi) / scale[self._whole_rows()]).max(initial=0.0))
        is_closed = error <= float(self.model.control[0]["constraint_tolerance"])
        if is_closed:
            self.clock.residual = max(self.clock.residual, error)
        return is_closed

    def _round_off(self) -> tuple[float, float]:
        """Forces and moments that round-off of positions leaves [N, N m]."""
        assert self.tangent is not None
        n = len(self.free)
        K = np.abs(self.tangent[0]).reshape(n, 6, n, 6).max(axis=(0, 2))
        size = self.model.size
        return size * K[:3, :3].max() + K[:3, 3:].max(), size * K[3:, :3].max() + K[3:, 3:].max()

    def _way_out(self) -> str:
        """Name of the node that leaves the equilibrium most; empty where it is stable."""
        assert self.tangent is not None
        n = len(self.free)
        K, D = self.tangent
        mode, flutters = way_out(K, D, self._masses())
        if flutters and not self.flutters:
            self.flutters = True
            self.notes.append(
                f"vibrations about the equilibrium at t = {float(self.clock.time):.6g} s grow "
                "unless they are damped (flutter): loads follow the motion, or moments keep their "
                "axis; see with solution: transient"
            )
        if mode is None:
            return ""
        most = np.abs(mode.reshape(n, 6)) * [*3 * [1.0], *3 * [self.model.size]]
        return self.name_of(int(self.free[most.max(axis=1).argmax()]))

    def _masses(self) -> np.ndarray:
        """Mass matrix (6 n, 6 n) of the free nodes, world axes."""
        nodes, n = self.state.nodes[self.free], len(self.free)
        M = np.zeros((n, 6, n, 6))
        A, J = nodes["A"].reshape(-1, 3, 3), nodes["J"].reshape(-1, 3, 3)
        M[np.arange(n), :3, np.arange(n), :3] = np.eye(3) / nodes["mass_inv"][:, None, None]
        M[np.arange(n), 3:, np.arange(n), 3:] = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        return M.reshape(6 * n, 6 * n)

    def name_of(self, node: int) -> str:
        """Of a body, or of a node of a shell."""
        is_body = node < len(self.model.bodies)
        return f"body '{self.model.bodies[node]}'" if is_body else self.model.part_at(node)

    def _way_from(self, start: np.ndarray) -> np.ndarray:
        """Displacements and turns (n, 6) of the free nodes since a posture."""
        here = self.state.nodes[self.free]
        turns = _turns(start["q"][self.free], here["q"])
        return np.hstack([here["r"] - start["r"][self.free], turns])

    def _size(self, way: np.ndarray) -> float:
        """Of displacements and turns (n, 6): the largest, in the model's size or rad."""
        far, turn = np.abs(way[:, :3]).max(initial=0.0), np.abs(way[:, 3:]).max(initial=0.0)
        return float(max(far / self.model.size, turn))

    def _whole_way(self, start: np.ndarray) -> float:
        """The larger of the way of a load step and of that since the first posture."""
        return max(self._size(self._way_from(begun)) for begun in (start, self.origin))

    def _correction(self, time: float) -> np.ndarray:
        """Newton's correction (n, 6) of places and turns of the free nodes."""
        g, D, phi = self._imbalance(time)
        columns = self._tangent(time, g, D)
        self.tangent = -columns, D
        scale = np.abs(columns).max(initial=0.0) / max(np.abs(D).max(initial=0.0) ** 2, 1e-300)
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
            nudge(nodes[i], int(k % 6), size)
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
        moved = np.einsum("mni,nij->mnj", D.reshape(-1, len(nodes), 6), mobility).reshape(D.shape)
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

    def _whole_rows(self) -> np.ndarray:
        """Rows that stand for themselves: the first parts of the joints'."""
        return np.array(
            [j.first_row + k for j in self.model.joints for k in range(j.rows)], dtype=int
        )

    def _imbalance(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces and moments that nothing holds (6 n,), D (m, 6 n) and Phi (m,)."""
        g, rows = self._rest(time, self.state.nodes), self.rows
        D = np.zeros((len(rows), len(self.nodes), 6))
        index, first = np.arange(len(rows)), np.arange(len(rows))
        for j in self.model.joints:
            # the parts of a row of more than two bodies add up
            first[j.first_row : j.first_row + j.rows * j.parts] = np.tile(
                j.first_row + np.arange(j.rows), j.parts
            )
        np.add.at(D, (first, rows["node_a"]), rows["D"][index, :6])
        np.add.at(D, (first, rows["node_b"]), rows["D"][index, 6:])
        whole = self._whole_rows()
        return g, D[whole][:, self.free].reshape(len(whole), g.size), rows["phi"][whole]

    def _rest(self, time: float, nodes: np.ndarray) -> np.ndarray:
        """A sample of these nodes: forces and moments (6 n,) that would move the free ones."""
        self.loading.place(time)
        time = self.loading.time(time)
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

    def _refuse_end_of_curve(self) -> None:
        """Raises SolverError for a curve that is read beyond its points."""
        clock, curves = self.clock, self.model.curves
        if curves[0]["fault"] > 0:
            found = curve_end(self.model, clock)
            raise SolverError(float(clock.time), int(clock.cycle), *found)


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


def nudge(row: Any, k: int, size: float) -> None:
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
