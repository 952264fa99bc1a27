"""Criterion of force balance, and the work of loads, drivers and gravity up to an equilibrium.

    |f| <= tolerance max(F, M / l)  and  |m| <= tolerance max(M, F l)

f and m are the residual force and moment on any node, F and M the largest that the run has
met: before the nodes moved in a load step, and in the joints; l the model's size. What positions
of sixteen digits cannot resolve, epsilon K l, is nothing.

Work of loads, prescribed motions and gravity is that of the mean of their forces before and after
a load step over its motion, so that the balance of energy closes to second order in the step. What
the first configuration lacks of an equilibrium, beside loads that rise, is held there and released
at once. Consequence to test: the work is the energy stored, however few the load steps, where
forces rise linearly.
"""

import numpy as np

from crashsolve.model.model import Group
from crashsolve.statics.equations import Equations
from crashsolve.statics.loading import potential

# of stiffness times size: round-off of positions, in sums of some terms
ROUND_OFF = 10.0 * np.finfo(float).eps
# of the largest force: where round-off is below this, forces decide whether there is balance
RESOLVED = 1e-3
EQUAL, ROUND = 2, 1


class Forces:
    """The largest forces [N] and moments [N m] of a run, and the present residual."""

    def __init__(self, size: float, tolerance: float) -> None:
        self.size, self.tolerance = size, tolerance
        self.largest = [0.0, 0.0]
        self.left = (0.0, 0.0)

    def include(self, g: np.ndarray, engine: Equations) -> None:
        """Include forces and moments (6 n,) before any displacement in the largest."""
        self._raise_largest(*_largest(g))
        self.include_reactions(engine)

    def include_reactions(self, engine: Equations) -> None:
        """Include the reactions of joints in the last sample."""
        sizes = np.abs(engine.rows["reaction"])
        rotations = np.zeros(len(sizes), bool)
        for joint in engine.model.joints:
            rows = slice(joint.first_row, joint.first_row + joint.rows * joint.parts)
            rotations[rows] = np.tile(joint.angular, joint.parts)
        self._raise_largest(sizes[~rotations].max(initial=0.0), sizes[rotations].max(initial=0.0))

    def _raise_largest(self, force: float, moment: float) -> None:
        self.largest = [max(self.largest[0], float(force)), max(self.largest[1], float(moment))]

    def balance(self, g: np.ndarray, stiffness: tuple[float, float]) -> int:
        """EQUAL where the residual (6 n,) is within tolerance, ROUND where it is round-off, else 0.

        `stiffness` is that of forces and moments, times the size [N, N m].
        """
        self.left = _largest(g)
        sides = list(zip(self.left, self._scales(), stiffness, strict=True))
        if all(left <= self.tolerance * scale for left, scale, _ in sides):
            return EQUAL
        is_round = all(
            left <= max(self.tolerance * scale, ROUND_OFF * stiff) for left, scale, stiff in sides
        )
        if is_round and all(ROUND_OFF * stiff <= RESOLVED * scale for _, scale, stiff in sides):
            return EQUAL
        return ROUND if is_round else 0

    def _scales(self) -> tuple[float, float]:
        force, moment = self.largest
        return max(force, moment / self.size), max(moment, force * self.size)

    def energy(self) -> float:
        """Work of the largest force over the model's size [J]."""
        return self._scales()[0] * self.size

    def share_left(self) -> float:
        """The present residual over the largest forces and moments [1]."""
        return max(
            left / scale if scale > 0.0 else 0.0
            for left, scale in zip(self.left, self._scales(), strict=True)
        )

    def message(self) -> str:
        """The residual, for a message."""
        return f"{self.share_left():.2g} of the largest force out of balance"


def _largest(g: np.ndarray) -> tuple[float, float]:
    """Largest force and moment on a node, of (6 n,)."""
    parts = np.abs(g.reshape(-1, 6))
    return float(parts[:, :3].max(initial=0.0)), float(parts[:, 3:].max(initial=0.0))


class Work:
    """Counts the work that load steps do, in the histories of loads and in clock.driver_work."""

    def __init__(self, engine: Equations) -> None:
        self.engine = engine
        self.residuals, self.reactions = np.zeros(0), np.zeros(0)
        # of loads that count their own work: work so far, and force on the free nodes
        self.before: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def begin(self) -> None:
        """Store residual forces and reactions of drivers before a load step."""
        engine = self.engine
        self.residuals = engine.forces_at_rest(float(engine.clock.time), engine.state.nodes)
        self.reactions = engine.rows["reaction"][engine.loading.rows()].copy()
        now, current = float(engine.clock.time), int(engine.clock.current)
        self.before = {
            g.word: (g.history["dissipated"][current].copy(), self._forces(g, now))
            for g in self._of_surfaces()
        }

    def count(self, start: np.ndarray, start_time: float, now: float) -> None:
        """Add the work from the nodes `start` at `start_time` to the present ones at `now` [s]."""
        engine, loading = self.engine, self.engine.loading
        clock, change = engine.clock, engine.change_from(start)
        first, last = (self._powers(t, at, change) for t, at in ((start_time, start), (now, None)))
        for g in self._loads():
            g.history["dissipated"] += 0.5 * (first[g.word] + last[g.word])
        for g in self._of_surfaces():
            done, pushed = self.before[g.word]
            g.history["dissipated"] = done + 0.5 * (pushed + self._forces(g, now)) @ change.ravel()
        clock.driver_work += self._of_drivers(start_time, now)
        shares = loading.load_factor(start_time), loading.load_factor(now)
        positions = (
            potential(engine.model, start, loading),
            potential(engine.model, engine.state.nodes, loading),
        )
        # the ledger has the potential of the weight there is now: raising it is no work
        raised = shares[1] * positions[1] - shares[0] * positions[0]
        clock.driver_work += raised - 0.5 * sum(shares) * (positions[1] - positions[0])
        if start_time == loading.begin:
            clock.driver_work -= 0.5 * float(self.residuals @ change.ravel())
        loading.set_time(now)

    def _of_drivers(self, start_time: float, now: float) -> float:
        """Work [J] of prescribed motions: their mean reactions times their displacements."""
        engine, rows = self.engine, self.engine.loading.rows()
        if not rows:
            return 0.0
        travel = engine.loading.positions(now) - engine.loading.positions(start_time)
        engine.forces_at_rest(now, engine.state.nodes)
        return float(0.5 * (self.reactions + engine.rows["reaction"][rows]) @ travel)

    def _loads(self) -> list[Group]:
        return [g for g in self.engine.model.force_groups() if hasattr(g.module, "AMPLITUDE")]

    def _of_surfaces(self) -> list[Group]:
        """Loads on elements: their own steps give no mean of their forces."""
        return [
            g
            for g in self._loads()
            if hasattr(g.module, "load_elements")
            or (hasattr(g.module, "force_on_points") and not hasattr(g.module, "LEDGER"))
        ]

    def _forces(self, g: Group, moment: float) -> np.ndarray:
        """Forces and moments (entries, 6 n) of loads on the free nodes: with them less without."""
        loading, residuals = self.engine.loading, []
        for i in range(len(g.names)):
            whole = self._applied(moment)
            loading.silent = (g, i)
            residuals.append(whole - self._applied(moment))
            loading.silent = None
        loading.set_time(moment)
        return np.array(residuals)

    def _applied(self, moment: float) -> np.ndarray:
        """All forces and moments (6 n,) on the free nodes but those of joints."""
        engine = self.engine
        engine.forces_at_rest(moment, engine.state.nodes)
        own = engine.nodes[engine.free]
        return np.hstack([own["force"], own["torque"]]).ravel()

    def _powers(
        self, time: float, at: np.ndarray | None, change: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Work of every load on a change (n, 6) of the nodes, by its force where they are."""
        engine = self.engine
        nodes = (engine.state.nodes if at is None else at).copy()
        free = engine.free
        nodes["v"][free], nodes["w"][free] = change[:, :3], change[:, 3:]
        A, J = (nodes[name][free].reshape(-1, 3, 3) for name in ("A", "J"))
        inertia = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        nodes["L"][free] = np.matmul(inertia, change[:, 3:, None])[:, :, 0]
        engine.forces_at_rest(time, nodes)
        new = 1 - int(engine.clock.current)
        return {g.word: g.history[new]["power"].copy() for g in self._loads()}
