"""Quasi-static solution: at every load step the configuration in which all accelerations vanish.

    g(q) = M (v_dot, w_dot) at rest,   Phi(q) = 0
    (dg/dq - s D^T D) delta = -g + s D^T Phi

A sample at rest gives g, the forces less the reactions of the joints, which vanishes in
equilibrium. As D M^-1 g = 0 in any configuration, both sides of Newton's equation part into g and
Phi; s only balances them. The tangent is the whole one, by differences of samples, with the turning
of forces and the reactions of joints, so that corrections fall quadratically. Equilibrium is a
matter of forces, beside corrections (`balance.py`), and whether it is stable one of the tangent
(`stability.py`). Consequence to test: equilibria are those in which damped motion ends.
Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

import numpy as np

from crashsolve.deck.run_cards.control import Control
from crashsolve.foundation.errors import RunStopped
from crashsolve.model import ledger as energy
from crashsolve.model.jacobian import jacobian, whole_rows
from crashsolve.model.model import Model, State
from crashsolve.statics.balance import Forces, Work
from crashsolve.statics.differences import nodes_with_other_forces
from crashsolve.statics.elimination import eliminate
from crashsolve.statics.equations import Tangent
from crashsolve.statics.limit_point import Softening, exchanged, passes_limit_point
from crashsolve.statics.loading import Loading, equal_part
from crashsolve.statics.motions import largest_motion, move, perturb, rotations
from crashsolve.statics.plastic_flow import PlasticFlow
from crashsolve.statics.problem import Problem, explanation
from crashsolve.statics.stability import mass_matrix, unstable_mode
from crashsolve.statics.yielding import Yielding
from crashsolve.system.engine import Engine

# differences: over the model's size, and rad; their errors only slow Newton's method a little
STEP = 1e-7
# largest rotation [rad] and displacement (over the model's size) of a correction
LARGEST_ROTATION, LARGEST_DISPLACEMENT = 0.3, 0.2
MAX_ITERATIONS = 40
# a correction that falls no more is round-off below this, in the model's size or rad
STAGNATION_TOLERANCE = 1e-9
# a displacement that is nothing but round-off, and an energy, over the largest force times the size
NEGLIGIBLE, NOTHING = 1e-15, 1e-12
# of the largest mobility of the rows of joints: lets redundant ones share
SHARED = 1e-10
# a load step is halved so often where no equilibrium is found
HALVINGS = 7
# of the largest force, and of the change over a load step: default of `control.tolerance`
TOLERANCE = 1e-8


class StaticEngine(Engine):
    """Goes from equilibrium to equilibrium instead of stepping through time."""

    def __init__(self, model: Model, state: State, control: Control, program: str = "") -> None:
        """`control` is the deck's card."""
        self.loading, self.yielding = Loading(model, control.start_time), Yielding(model)
        super().__init__(model, state, program)
        self.tolerance = control.tolerance or TOLERANCE
        model.control[0]["tolerance"] = self.tolerance
        self.limit = 0.0 if control.energy_limit == "off" else float(control.energy_limit)
        self.has_stages = False
        attached = set(model.attached_nodes["node"])
        self.free = np.array([i for i in range(1, len(state.nodes)) if i not in attached], int)
        self.beams = [g for g in model.groups if hasattr(g.module, "forces_by_motions")]
        self.plastic_flow = PlasticFlow(self.beams)
        self.by_differences = nodes_with_other_forces(model, self.free, self.beams)
        self.forces, self.work = Forces(model.size, self.tolerance), Work(self)
        self.notes: list[str] = []
        self.origin = state.nodes.copy()
        self.flutters, self.softening = False, Softening()
        self.free_motion = ""  # name of a node that moves without an end in the load step
        self.least = self.first = 0.0  # shortest load step [s], change by the last tangent
        self.checks_limit_points, self.halvings, self.growth = True, HALVINGS, 2.0
        self.width = np.inf  # length of the last load step where they are short [s]
        # of the last pass: K (6 n, 6 n) and D (m, 6 n)
        self.tangent: Tangent | None = None
        # of the last equilibrium, where there are hinges
        self.known_tangent: Tangent | None = None

    def start(self) -> None:
        """The equilibrium in which the run begins. Raises SolverError."""
        super().start()
        loading, clock = self.loading, self.clock
        if not loading.rising and not self.forces_at_rest(loading.start, self.state.nodes).any():
            return
        # before the files are open there is nothing to dump
        answer, self.on_pause = self.on_pause, self.on_iteration
        clock.time = loading.begin
        self._step(loading.start, loading.start)
        self.on_pause = answer
        missing = self._missing_energy()
        if abs(missing) <= NOTHING * self.forces.energy():
            # round-off of forces that count as zero
            clock.driver_work += missing

    def _step(self, until: float, goal: float) -> None:
        """Equilibrium at `until`, through others where necessary. Raises SolverError."""
        clock, problems = self.clock, list[Problem]()
        self.least = (until - float(clock.time)) / 2**self.halvings
        while clock.time < until:
            start_time, saved, tangent = float(clock.time), self.save_state(), self.known_tangent
            # steps towards a limit point double: a long one from nearby may jump over it
            target = equal_part(start_time, until, self.growth * self.width)
            while (problem := self._attempt_from(saved, target)) is not None:
                problems.append(problem)
                target = 0.5 * (start_time + target)
                is_last = target - start_time < self.least
                if is_last and problem.kind == "balance" and start_time < self.loading.start:
                    self._count_initial_energy()
                    break
                self.restore_state(saved)
                self.known_tangent = tangent
                if is_last:
                    ahead = [problem for problem in problems if problem.target > start_time]
                    raise explanation(self, ahead).error(self, start_time)
            is_short = target < until and np.isfinite(self.width)
            # laws that yield continue to do so in the next load steps
            if is_short or any(p.kind == "jump" or not self.checks_limit_points for p in problems):
                self.width = float(clock.time) - start_time
            self.on_pause()
        if self.checks_limit_points:
            self.width = np.inf

    def _attempt_from(self, saved: list[np.ndarray], target: float) -> Problem | None:
        """Attempt a load step; a request to stop is met in the equilibrium `saved` before it.

        Raises RunStopped.
        """
        try:
            return self._attempt(target)
        except RunStopped:
            self.restore_state(saved)
            self.on_pause()
            raise

    def _attempt(self, target: float) -> Problem | None:
        """Move to the equilibrium at a time [s], or at one before it; returns why that failed."""
        saved, tangent = self.save_state(), self.known_tangent
        problem = self._solve_to(target)
        if problem is None or not self.yielding.straight or self.yielding.is_least:
            return problem
        # a corner that one long step cannot pass is approached by a step that ends just before it
        self.restore_state(saved)
        self.known_tangent = tangent
        near = self.yielding.before_corner(self, target)
        return problem if near >= target or self._solve_to(near) else None

    def _solve_to(self, target: float) -> Problem | None:
        """Move to the equilibrium at a time, or at a corner before it; returns why that failed."""
        clock, start = self.clock, self.state.nodes.copy()
        start_time, before = float(clock.time), self._missing_energy()
        energies = self.ledger.copy()
        self.work.begin()
        reached = self._solve_at(target)
        if reached is None:
            free = self.free_motion
            return Problem("free motion", target, free) if free else Problem("lost", target)
        target = reached
        self.work.count(start, start_time, target)
        clock.time, clock.step, clock.next_step = target, target - start_time, target - start_time
        is_beyond = self.model.curves[0]["fault"] != 0
        if location := self._unstable():
            return Problem("unstable mode", target, location)
        total = self._missing_energy()
        missing = abs(total - before)
        share = missing / max(exchanged(self.ledger - energies), NOTHING * self.forces.energy())
        if self.checks_limit_points and passes_limit_point(self, start, start_time, target, share):
            return Problem("jump", target)
        # all steps together miss no more than one of them may
        if self._is_out_of_balance(max(missing, abs(total) if abs(total) > abs(before) else 0.0)):
            return Problem("balance", target)
        return Problem("end of curve", target) if is_beyond else None

    def _count_initial_energy(self) -> None:
        """Count the energy between the initial configuration and the first equilibrium."""
        self.clock.driver_work += self._missing_energy()
        self.notes.append(
            "the initial configuration is far from equilibrium: the energy lost between it and "
            "the equilibrium in which the run begins is counted as driver work"
        )

    def _missing_energy(self) -> float:
        """Imbalance of the present state [J]."""
        self.forces_at_rest(float(self.clock.time), self.state.nodes)
        self.state.ledger[energy.LARGEST] = self.ledger[energy.LARGEST]
        return float(self.ledger[energy.IMBALANCE])

    def _is_out_of_balance(self, missing: float) -> bool:
        """Whether a missing energy [J] exceeds control.energy_limit and round-off."""
        least = NOTHING * self.forces.energy()
        return bool(self.limit and missing > self.limit * self.ledger[energy.LARGEST] + least)

    def _changing_arrays(self) -> list[np.ndarray]:
        """Arrays that a load step changes."""
        s = self.state
        return [
            *(s.clock, s.nodes, s.rows, s.ledger, s.points, s.blocks),
            *(g.history for g in self.model.groups),
        ]

    def save_state(self) -> list[np.ndarray]:
        return [array.copy() for array in self._changing_arrays()]

    def restore_state(self, saved: list[np.ndarray]) -> None:
        """Restore the state before a load step. Writes: the State."""
        for array, old in zip(self._changing_arrays(), saved, strict=True):
            array[...] = old

    def finish(self) -> None:
        """Judge the balance of the whole run. Raises SolverError."""
        if self._is_out_of_balance(abs(float(self.ledger[energy.IMBALANCE]))):
            raise Problem("total", float(self.clock.time)).error(self, float(self.clock.time))

    def step_warnings(self) -> list[str]:
        """Warnings of the run; iterations of Newton's method are no sign of long steps."""
        return self.notes

    def sample(self, time: float | None = None) -> None:
        """Take a sample, as in a transient run, with the loads of its time."""
        self.loading.set_time(float(self.state.clock[0]["time"]) if time is None else time)
        super().sample(time)

    def _solve_at(self, time: float) -> float | None:
        """Move to the equilibrium at a time or at a corner before it; its time [s], or None."""
        start, whole = self.state.nodes.copy(), time
        if self.yielding.groups:
            time = self.yielding.predicted(self, time)
        if self.plastic_flow.groups:
            time = self.plastic_flow.predicted(self, time)
        if self.yielding.is_least:
            self.known_tangent = self.yielding.branch(self, whole) or self.known_tangent
        count = self.iterate(time)
        if count and self.yielding.groups:
            time, count = self.yielding.first_corner(self, start, time, count)
        if not count:
            return None
        self._accept(count)
        return time

    def iterate(self, time: float) -> int:
        """Number of Newton's iterations to the equilibrium at a time [s]; 0 without convergence."""
        start, previous = self.state.nodes.copy(), np.inf
        for count in range(MAX_ITERATIONS):
            self.on_iteration()
            change = self.correction(time, self.known_tangent if count == 0 else None)
            if count == 0:
                self.first = self.size_of(change)
                g = self.imbalance(time)[0]
                self.forces.include(g, self)
                self.softening.record(self.first, float(np.abs(g).max(initial=0.0)))
            size = self.size_of(change)
            if not np.isfinite(size) or self.plastic_flow.is_diverging(self.step_fraction(change)):
                break
            self.plastic_flow.take(self, time, change * self.step_fraction(change))
            contraction = min(size / previous, 1.0) if count else 1.0
            stagnates = size >= 0.5 * previous
            bound = self.tolerance * self._largest_change(start) + NEGLIGIBLE
            if size * contraction <= bound or (stagnates and size <= STAGNATION_TOLERANCE):
                # trials may lead past the end of a curve, which only the answer must not
                self.model.curves[0]["fault"] = 0
                if self.is_balanced(time):
                    return count + 1
            self.clock.value, previous = size, size
        return 0

    def is_balanced(self, time: float) -> bool:
        """Whether forces are in balance at a time [s], and the joints closed."""
        g, _, phi = self.imbalance(time)
        self.forces.include_reactions(self)
        return self._is_closed(phi) and bool(self.forces.balance(g, self._round_off()))

    def _accept(self, count: int) -> None:
        """Accept an equilibrium: histories along the path, counts of steps and iterations."""
        clock = self.clock
        for g in (*self.model.joint_groups(), *self.plastic_flow.groups):
            g.history[:] = g.history[1 - int(clock.current)]
        clock.cycle += 1
        clock.iterations += count
        # at the onset of yield the tangent depends on the direction in which a hinge continues
        can_yield = self.yielding.groups or self.plastic_flow.groups
        self.known_tangent = self.tangent if can_yield else None

    def _is_closed(self, phi: np.ndarray) -> bool:
        """Whether the joints are. Writes: clock.residual."""
        scale = self.state.rows["scale"]
        error = float((np.abs(phi) / scale[whole_rows(self.model.joints)]).max(initial=0.0))
        is_closed = error <= float(self.model.control[0]["constraint_tolerance"])
        if is_closed:
            self.clock.residual = max(self.clock.residual, error)
        return is_closed

    def _round_off(self) -> tuple[float, float]:
        """Forces and moments [N, N m] by round-off of positions, over epsilon."""
        assert self.tangent is not None
        n = len(self.free)
        K = np.abs(self.tangent[0]).reshape(n, 6, n, 6).max(axis=(0, 2))
        size = self.model.size
        return size * K[:3, :3].max() + K[:3, 3:].max(), size * K[3:, :3].max() + K[3:, 3:].max()

    def _unstable(self) -> str:
        """Name of the node that leaves the equilibrium most; empty where it is stable."""
        assert self.tangent is not None
        n = len(self.free)
        K, D = self.tangent
        mode, flutters = unstable_mode(K, D, mass_matrix(self.state.nodes[self.free]))
        if flutters and not self.flutters:
            self.flutters = True
            self.notes.append(
                f"vibrations about the equilibrium at t = {float(self.clock.time):.6g} s grow "
                "unless they are damped (flutter), because loads follow the motion or moments keep "
                "their axis; check it with solution: transient"
            )
        if mode is None:
            return ""
        most = np.abs(mode.reshape(n, 6)) * [*3 * [1.0], *3 * [self.model.size]]
        return self.name_of(int(self.free[most.max(axis=1).argmax()]))

    def name_of(self, node: int) -> str:
        """Name of a body, or of a node of a shell."""
        is_body = node < len(self.model.bodies)
        return f"body '{self.model.bodies[node]}'" if is_body else self.model.part_at(node)

    def change_from(self, start: np.ndarray) -> np.ndarray:
        """Displacements and rotations (n, 6) of the free nodes since a configuration."""
        nodes = self.state.nodes[self.free]
        rotated = rotations(start["q"][self.free], nodes["q"])
        return np.hstack([nodes["r"] - start["r"][self.free], rotated])

    def size_of(self, change: np.ndarray) -> float:
        """The largest of displacements [model's size] and rotations [rad] (n, 6)."""
        return largest_motion(change, self.model.size)

    def step_fraction(self, change: np.ndarray) -> float:
        """The fraction [1] of a correction (n, 6) within the bounds of an iteration."""
        angle, far = np.abs(change[:, 3:]).max(), np.abs(change[:, :3]).max() / self.model.size
        return float(1.0 / max(1.0, angle / LARGEST_ROTATION, far / LARGEST_DISPLACEMENT))

    def _largest_change(self, start: np.ndarray) -> float:
        """The larger of the change over a load step and of that since the first configuration."""
        return max(self.size_of(self.change_from(nodes)) for nodes in (start, self.origin))

    def correction(self, time: float, known_tangent: Tangent | None = None) -> np.ndarray:
        """Newton's correction (n, 6) of positions and rotations, by a known tangent."""
        g, D, phi = self.imbalance(time)
        self.tangent = known_tangent or (-self._tangent(time, g, D), D)
        return eliminate(*self.bordered(-self.tangent[0], g, D, phi)).reshape(-1, 6)

    def bordered(
        self, columns: np.ndarray, g: np.ndarray, D: np.ndarray, phi: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Matrix (6 n, 6 n) and right side (6 n,) of Newton's equation, of dg/dq in columns."""
        scale = self._constraint_stiffness(columns) / max(np.abs(D).max(initial=0.0) ** 2, 1e-300)
        penalty = np.einsum("mi,mj->ij", D, D)
        return columns - scale * penalty, -g + scale * np.einsum("mi,m->i", D, phi)

    def _constraint_stiffness(self, columns: np.ndarray) -> float:
        """The scale [N/m] of constraint rows, above round-off also where drivers hold all nodes."""
        own, reaction = self.nodes[self.free], np.abs(self.rows["reaction"]).max(initial=0.0)
        stiffest = (own["stiffness"] / own["mass_inv"]).max(initial=0.0)
        largest = max(np.abs(columns).max(initial=0.0), stiffest, reaction / self.model.size)
        # larger than the stiffness, which softening might cancel otherwise
        return 10.0 * float(largest) or 1.0

    def _tangent(self, time: float, g: np.ndarray, D: np.ndarray) -> np.ndarray:
        """Derivative (6 n, 6 n) of g by positions and rotations of the free nodes.

        Of nodes on which only beam elements act it is theirs; of others by differences of samples.
        """
        current, still = int(self.clock.current), self.state.nodes
        stiff = self._of_free(self.yielding.stiffness(current, still))
        with self.yielding.elastic_hinges(current):
            elastic = self._of_free(self.yielding.stiffness(current, still))
        return self.elastic_tangent(time, g, D) + self.condense(elastic - stiff, D)

    def elastic_tangent(self, time: float, g: np.ndarray, D: np.ndarray) -> np.ndarray:
        """The derivative (6 n, 6 n) with elastic hinges, but for those that yield on an ellipse."""
        current, still = int(self.clock.current), self.state.nodes
        with self.yielding.elastic_hinges(current):
            nodes, columns = still.copy(), self.condense(self._beams(), D)
            for k in np.flatnonzero(np.repeat(self.by_differences, 6)):
                self.on_iteration()
                i, size = self.free[k // 6], STEP * (self.model.size if k % 6 < 3 else 1.0)
                saved = nodes[i].copy()
                perturb(nodes[i], int(k % 6), size)
                columns[:, k] = (self.forces_at_rest(time, nodes) - g) / size
                nodes[i] = saved
        return columns

    def _of_free(self, K: np.ndarray) -> np.ndarray:
        """The part (6 n, 6 n) of the free nodes in a matrix of all (N, 6, N, 6)."""
        return K[self.free][:, :, self.free].reshape(2 * [6 * len(self.free)])

    def condense(self, columns: np.ndarray, D: np.ndarray) -> np.ndarray:
        """Forces (6 n, k) less the reactions of joints, D^T (D M^-1 D^T)^-1 D M^-1 of them."""
        nodes = self.state.nodes[self.free]
        A, J = nodes["A"].reshape(-1, 3, 3), nodes["J_inv"].reshape(-1, 3, 3)
        mobility = np.zeros((len(nodes), 6, 6))
        mobility[:, :3, :3] = nodes["mass_inv"][:, None, None] * np.eye(3)
        mobility[:, 3:, 3:] = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        moved = np.einsum("mni,nij->mnj", D.reshape(-1, len(nodes), 6), mobility).reshape(D.shape)
        rows = np.einsum("mi,ki->mk", moved, D)
        rows += SHARED * np.abs(rows).max(initial=0.0) * np.eye(len(D))
        eliminated = eliminate(rows, np.einsum("mi,ik->mk", moved, columns))
        return columns - np.einsum("mi,mk->ik", D, eliminated)

    def _beams(self) -> np.ndarray:
        """The derivative (6 n, 6 n) of the forces of beam elements alone."""
        n, nodes = len(self.free), self.state.nodes
        columns, location = np.zeros((n + 1, n + 1, 6, 6)), np.full(len(nodes), n)
        location[self.free] = np.arange(n)
        for g in self.beams:
            p = g.parameters
            state = self.plastic_flow.state(g, int(self.clock.current))
            curves = self.yielding.curves()
            forces = g.module.forces_by_motions(p, state, nodes, curves).reshape(-1, 2, 6, 2, 6)
            ends = location[p["node_a"]], location[p["node_b"]]
            for i, j in np.ndindex(2, 2):
                np.add.at(columns, (ends[i], ends[j]), forces[:, i, :, j])
        return columns[:n, :n].transpose(0, 2, 1, 3).reshape(6 * n, 6 * n)

    def imbalance(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Unbalanced forces and moments (6 n,), D (m, 6 n) and Phi (m,)."""
        g, rows = self.forces_at_rest(time, self.state.nodes), self.rows
        D = jacobian(self.model.joints, rows, len(self.nodes))[:, self.free]
        phi = rows["phi"][whole_rows(self.model.joints)]
        return g, D.reshape(len(phi), g.size), phi

    def forces_at_rest(self, time: float, nodes: np.ndarray) -> np.ndarray:
        """Unbalanced forces and moments (6 n,) of free nodes, from a sample of `nodes` at rest."""
        self.loading.set_time(time)
        time = self.loading.time(time)
        self.nodes[:], self.rows[:] = nodes, self.state.rows
        self.ledger[:], self.sample_clock[:] = self.state.ledger, self.state.clock
        self.sample_clock[0]["time"] = time
        self._advance(time, True, self._sampled)
        g = np.empty((len(self.free), 6))
        g[:, :3] = self.nodes["v_dot"][self.free] / self.nodes["mass_inv"][self.free, None]
        # J w_dot in world axes, J being in the nodes' own
        A = self.nodes["A"][self.free].reshape(-1, 3, 3)
        own = np.matmul(self.nodes["w_dot"][self.free][:, None], A)
        J = self.nodes["J"][self.free].reshape(-1, 3, 3)
        g[:, 3:] = np.matmul(np.matmul(own, J), A.transpose(0, 2, 1))[:, 0]
        return g.ravel()

    def shift(self, nodes: np.ndarray, change: np.ndarray) -> None:
        """Move the free nodes by displacements and rotations (n, 6). Writes: nodes."""
        moved = nodes[self.free]
        move(moved, change)
        nodes[self.free] = moved
