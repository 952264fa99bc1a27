"""The engine of a run in phases: it stops at their ends, and passes the State on.

Between phases velocities may be set to zero or to initial values. Energy, impulse and angular
impulse of such a change count as external, as those of a prescribed motion: energy in
`driver_work`.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.foundation.point import ATTACHED
from crashsolve.foundation.record import Record
from crashsolve.model import ledger as energy
from crashsolve.model.jacobian import jacobian, whole_rows
from crashsolve.model.model import Model, State
from crashsolve.model.phases import Phase
from crashsolve.recording.momenta import Momenta
from crashsolve.statics.loading import loads_without_curve
from crashsolve.statics.stability import mass_matrix
from crashsolve.system.engine import Engine

# state of a run with phases beside the State
MEMORY = Record("""
    phase     index     number of the present phase
    begun     flag      whether it has been begun
    launched  flag      whether the velocities of the deck have been set
    kinetic   J         kinetic energy after the last step, 0 after a halt
    share     1         of the loads without a curve that acts
    halts     count     how often the motion was halted in this phase
    taken     J         kinetic energy removed by that
""")


class PhasedEngine(Engine):
    """Steps a State through the phases of a run, one after the other."""

    def __init__(self, model: Model, state: State, program: str = "") -> None:
        super().__init__(model, state, program)
        self.table = np.zeros(1, MEMORY.dtype)
        self.memory: np.void = self.table[0]
        self.aside = {"phases": self.table}
        self.rising = loads_without_curve(model)
        self.memory["share"] = 1.0
        self.given = {name: state.nodes[name].copy() for name in ("v", "w")}
        self.given_points = {name: state.points[name].copy() for name in ("v", "w")}
        attached = set(model.attached_nodes["node"])
        self.free = np.array([i for i in range(1, len(state.nodes)) if i not in attached], int)

    @property
    def phase(self) -> Phase:
        """The present phase."""
        return self.model.phases[int(self.memory["phase"])]

    def start(self) -> None:
        """Prepare the initial state for the first phase."""
        self.phase.module.start(self.phase.p, self)
        # the balance is counted from this state
        self.clock.driver_work = self.clock.largest_work = 0.0
        super().start()

    def after_restore(self) -> None:
        """Set the loads that act, which are no part of the State."""
        self._set_loads()

    def _step_by_corners(self, until: float, goal: float) -> None:
        """Step to `until`, from one phase to the next. Raises SolverError."""
        while float(self.clock.time) < until:
            if self.clock.time >= self.phase.end and self.phase is not self.model.phases[-1]:
                self._close()
                self.memory["phase"] += 1
                self.memory["begun"] = 0
            if not self.memory["begun"]:
                self._begin()
            end = self.phase.end
            super()._step_by_corners(min(until, end), min(goal, end))

    def _begin(self) -> None:
        memory = self.memory
        memory["begun"], memory["kinetic"], memory["taken"], memory["halts"] = 1, 0.0, 0.0, 0
        self.phase.module.begin(self.phase.p, self)
        self.on_message(f"phase '{self.phase.name}' begins at t = {float(self.clock.time):.6g} s")

    def _close(self) -> None:
        """End a phase. Raises SolverError where its condition is not met."""
        self.phase.module.end(self.phase.p, self)
        if self.memory["halts"]:
            halts, taken = int(self.memory["halts"]), float(self.memory["taken"])
            self.on_message(
                f"phase '{self.phase.name}' ends: its motion was halted {halts} times, which "
                f"removed {taken:.4g} J of kinetic energy"
            )

    def finish(self) -> None:
        """End the last phase. Raises SolverError."""
        super().finish()
        if self.memory["begun"]:
            self._close()

    def _call(self, until: float) -> int:
        """Step until a time, as every engine does, with a call of the phase after every step."""
        after_step = getattr(self.phase.module, "after_step", None)
        if after_step is None:
            return super()._call(until)
        self._steps_per_call, cycle = 1, int(self.clock.cycle)
        status = super()._call(until)
        if self.clock.cycle > cycle:
            after_step(self.phase.p, self)
        return status

    def kinetic(self) -> float:
        """Kinetic energy of all that moves [J]."""
        nodes, points = self.state.nodes[self.free], self.state.points
        total = 0.5 * float((nodes["v"] ** 2 / nodes["mass_inv"][:, None]).sum())
        total += 0.5 * float((nodes["w"] * nodes["L"]).sum())
        moving = points[points["mass_inv"] > 0.0]
        return total + 0.5 * float((moving["v"] ** 2 / moving["mass_inv"][:, None]).sum())

    def halt(self) -> None:
        """Set all velocities to zero. Writes: the State."""
        self.memory["halts"] += 1
        with self._external_change() as taken:
            self.set_velocities(None)
        self.memory["taken"] -= taken[0]

    def launch(self) -> None:
        """Set the velocities of the deck, once. Writes: the State."""
        if not self.memory["launched"]:
            self.memory["launched"] = 1
            with self._external_change():
                self.set_velocities(self.given)

    def raise_loads(self, share: float) -> None:
        """Apply a share of the loads without a curve. Writes: the Model, the State.

        The ledger contains the potential of the weight that acts: raising the weight is external
        work.
        """
        if share == self.memory["share"]:
            return
        before = self._potential()
        self.memory["share"] = share
        self._set_loads()
        self.clock.driver_work += self._potential() - before
        # the next step begins with the loads that act in it
        self._renew_forces()

    def _potential(self) -> float:
        self._evaluate_now()
        return float(self.ledger[energy.POTENTIAL])

    def _set_loads(self) -> None:
        for group, rises, full in self.rising:
            column = group.parameters[group.module.AMPLITUDE]
            column[rises] = full[rises] * self.memory["share"]

    def require_equilibrium(self, tolerance: float) -> None:
        """Raises SolverError where a residual force is above a share of the largest force."""
        self._evaluate_now()
        residuals = np.concatenate([self._residuals_on_bodies(), self._residuals_on_points()])
        largest = self._largest_force()
        if not len(residuals) or residuals.max() <= tolerance * largest:
            return
        worst, bodies = int(residuals.argmax()), len(self.model.bodies)
        force, points = residuals[worst], range(bodies, bodies + len(self.state.points))
        node = [*self.free.tolist(), *points][worst]
        raise SolverError(
            float(self.clock.time),
            int(self.clock.cycle),
            f"body '{self.model.bodies[node]}'" if node < bodies else self.model.part_at(node),
            f"phase '{self.phase.name}' does not end in equilibrium: {force:.3g} N on it are not "
            f"balanced, {force / max(largest, 1e-300):.2g} of the largest force",
            "let the phase last longer, support what moves freely, or raise its tolerance; where "
            "the method chooses its step, bound it by control.step_max",
        )

    def _residuals_on_bodies(self) -> np.ndarray:
        """Unbalanced forces (free nodes,) in the last sample [N]; moments over the model's size."""
        nodes = self.nodes[self.free]
        A, J = (nodes[name].reshape(-1, 3, 3) for name in ("A", "J"))
        inertia = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        moments = np.linalg.norm(np.einsum("nij,nj->ni", inertia, nodes["w_dot"]), axis=1)
        forces = np.linalg.norm(nodes["v_dot"], axis=1) / nodes["mass_inv"]
        return np.maximum(forces, moments / self.model.size)

    def _residuals_on_points(self) -> np.ndarray:
        """Unbalanced forces (points,) in the last sample along free motions [N]."""
        points = self.state.points
        is_held = points["fixed"][:, None] & np.array([1, 2, 4]) != 0
        is_held |= (points["fixed"][:, None] & ATTACHED) != 0
        return np.linalg.norm(np.where(is_held, 0.0, points["force"]), axis=1)

    def _largest_force(self) -> float:
        """Largest force of all laws in the last sample [N], including moments over the model's
        size.
        """
        sizes = [0.0]
        for group in self.model.groups:
            for column in getattr(group.module, "OUTPUT", Record()).columns:
                share = {"N": 1.0, "N m": 1.0 / self.model.size}.get(column.unit)
                if share is not None:
                    sizes.append(share * float(np.abs(group.output[column.name]).max(initial=0.0)))
        sizes.append(float(np.abs(self.state.cards["force"]).max(initial=0.0)))
        held = self.rows["D"] * self.rows["reaction"][:, None]
        forces = np.abs(held[:, [0, 1, 2, 6, 7, 8]]).max(initial=0.0)
        return max(*sizes, float(forces))

    @contextmanager
    def _external_change(self) -> Iterator[list[float]]:
        """Book a change of velocities as external energy and impulse; yields the energy."""
        change = [0.0]
        before = self._energy_and_momenta()
        yield change
        after = self._energy_and_momenta()
        change[0] = after[0] - before[0]
        self.clock.driver_work += change[0]
        self.clock.impulse[:] += after[1] - before[1]
        self.clock.angular_impulse[:] += after[2] - before[2]
        # forces of dampers change, and stages restart
        self._renew_forces()
        self.clock.kinked = 1

    def _energy_and_momenta(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Kinetic energy, momentum and angular momentum of the present state."""
        self._evaluate_now()
        elements = self.model.elements
        motion = () if elements is None else (elements.motion[:1],)
        linear, angular, *_ = Momenta().of(self.sample_clock, self.nodes[None, 1:], *motion)
        return float(self.ledger[energy.KINETIC]), linear[0], angular[0]

    def _evaluate_now(self) -> None:
        """Evaluate a sample of the present state that is not part of the run."""
        for now, copy in self.copied:
            copy[:] = now
        self._advance(float(self.clock.time), True, self._sampled)

    def set_velocities(self, given: dict[str, np.ndarray] | None) -> None:
        """Set all velocities, or zero, as far as joints allow. Writes: the State."""
        nodes, points = self.state.nodes, self.state.points
        for name in ("v", "w"):
            nodes[name] = 0.0 if given is None else given[name]
            points[name] = 0.0 if given is None else self.given_points[name]
        free = self.free
        if len(self.model.joints) and len(free):
            self._fit_to_joints()
        A, J = (nodes[name][free].reshape(-1, 3, 3) for name in ("A", "J"))
        nodes["L"][free] = np.einsum("nij,njk,nlk,nl->ni", A, J, A, nodes["w"][free])

    def _fit_to_joints(self) -> None:
        """The nearest velocities with D v = nu, by the kinetic energy of the difference.

        Writes: state.nodes.
        """
        nodes, free = self.state.nodes, self.free
        self._evaluate_now()
        D = jacobian(self.model.joints, self.rows, len(nodes))[:, free]
        D = D.reshape(len(D), 6 * len(free))
        nu = self.rows["nu"][whole_rows(self.model.joints)]
        given = np.hstack([nodes["v"][free], nodes["w"][free]]).ravel()
        residual = D @ given - nu
        if not residual.any():
            return
        moved = np.linalg.solve(mass_matrix(nodes[free]), D.T)
        given -= moved @ np.linalg.lstsq(D @ moved, residual, rcond=1e-12)[0]
        nodes["v"][free], nodes["w"][free] = np.split(given.reshape(-1, 6), 2, axis=1)
