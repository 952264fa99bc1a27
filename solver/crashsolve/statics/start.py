"""Equilibrium from which a run begins: its bodies are moved to where nothing accelerates them.

    Z^T g(q) = 0,   Phi(q) = 0,   D Z = 0
    (M / tau^2 - dg/dq) projected on Z, times y = Z^T (g + dg/dq delta_c),   delta = delta_c + Z y

g are the forces at rest that joints do not hold, delta_c closes the joints. tau grows as g falls
(pseudo-transient continuation): small steps along the forces at first, so that a body above its
springs settles on them, Newton's steps in the end. Where a motion grows by itself tau stays below
half the time in which it grows by e: it leads down to a stable equilibrium. Directions in which
nothing acts, as those in which a car rolls, keep their coordinate; where a small force is left in
such a direction, as by the aligning moments of leaning wheels, the run begins with it, and the log
states it. Forces are those without motion: dampers, friction and slip of tyres are zero, but for
the carcass of standing wheels (`standing_tyres.py`). Velocities of the deck remain, except for
components that the joints of the new configuration do not allow. Consequence to test: loads sum to
the weight and divide by their lever arms, and the motion that follows stays below 1 % of them.

Reference: Kelley and Keyes (1998), Convergence analysis of pseudo-transient continuation, SIAM
Journal on Numerical Analysis 35, 508-523.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.model.contact.pairs import renew
from crashsolve.model.jacobian import jacobian, whole_rows
from crashsolve.statics.corrections import (
    GROWTH,
    ROUND_OFF,
    Corrections,
    Matrices,
    RestState,
)
from crashsolve.statics.lifted_tyres import lifted_tyres
from crashsolve.statics.motions import largest_motion, move, perturb
from crashsolve.statics.shared_start import Equilibrium
from crashsolve.statics.stability import SYMMETRY_TOLERANCE
from crashsolve.statics.standing_tyres import StandingTyres
from crashsolve.system.engine import Engine

# differences: over the model's size, and rad
STEP = 1e-7
# largest displacement (over the model's size) and rotation [rad] of a pass
LARGEST_DISPLACEMENT, LARGEST_ROTATION = 0.05, 0.1
# of tau [s]: that of the first pass, the largest, which leaves neutral directions alone, the least
FIRST, LONGEST, SHORTEST = 0.01, 10.0, 1e-7
MAX_ITERATIONS = 300
# searches where wheels stand: a tyre dragged across the road in one is released in the next
SEARCHES = 3
# successive iterations in which a standing tyre slides all over, after which nothing holds it
SLIDES = 40
# successive iterations in which loads pull all tyres off their roads: by now about the model's size
LIFTS = 20
# acceleration in directions that nothing holds, over that of the loads, with which a run begins all
# the same: half of the transient that is allowed; tau [s] from which a search that is left with so
# little stalls where it falls by less than a half, and the successive iterations that show it
DRIFT, STALLED, STALLS = 5e-3, 0.5, 2
# a correction that counts as zero, in the model's size or rad
SMALLEST = 1e-11
# matrices serve further iterations up to this contraction factor, and as near to their state as
# this, in the model's size or rad: geometry changes their entries by as much. With a factor of 0.2
# a car on soft tyres, which slide as it sinks, finds no equilibrium
CONTRACTION, NEARBY = 0.02, 0.02
# coordinates; differences of so many take minutes
MAX_COORDINATES = 3000
# [N/m or N m]: squares of larger numbers overflow
MAX_STIFFNESS = 1e150
SUPPORT = (
    "support it by joints, springs or contacts that carry a static load (friction, dampers and "
    "sliding tyres carry none), or leave out control.start"
)


def begin_at_rest(engine: Engine, report: Callable[[str], None]) -> Equilibrium:
    """Move the nodes to equilibrium, which is returned. Writes: state.nodes.

    `report` is called with a text at every iteration: one of many coordinates lasts seconds.
    Raises SolverError where there is no equilibrium.
    """
    return Equilibrium(engine, _EquilibriumSearch(engine).run(report))


@dataclass
class _Signs:
    """Successive iterations that show that a search leads nowhere, and its last correction over the
    square of its time step [size or rad, 1/s^2].
    """

    slides: int = 0
    lifts: int = 0
    stalls: int = 0
    rate: float = np.inf


class _EquilibriumSearch:
    """Intermediate configurations, as nodes without velocities."""

    def __init__(self, engine: Engine) -> None:
        self.engine, self.model = engine, engine.model
        attached = set(self.model.attached_nodes["node"])
        nodes = engine.state.nodes
        self.free = np.array([i for i in range(1, len(nodes)) if i not in attached], int)
        if len(engine.state.points):
            message = "control.start: equilibrium does not move the nodes of shells"
            raise self._refusal(1, message, "leave out control.start")
        if 6 * len(self.free) > MAX_COORDINATES:
            message = (
                f"the model has {6 * len(self.free)} coordinates; control.start: equilibrium is "
                f"for at most {MAX_COORDINATES}"
            )
            raise self._refusal(1, message, "leave out control.start")
        self.standing_tyres = StandingTyres(self.model, nodes, int(engine.clock["current"]))
        # whether the search is left with a motion that nothing holds
        self.drifts, self.signs = False, _Signs()
        # way from the state of the present matrices
        self.travel = 0.0
        self.nodes = nodes.copy()
        self.nodes["v"] = self.nodes["w"] = self.nodes["L"] = 0.0

    def run(self, report: Callable[[str], None]) -> str:
        """Move the nodes to equilibrium; returns the moved entities, for the log."""
        first, iterations = self.nodes.copy(), 0
        for _ in range(SEARCHES if self.standing_tyres.patches else 1):
            self.standing_tyres.release(self.nodes)
            state, iterations = self._search(iterations, report)
        report("preparing the first step")
        self._refuse_unstable(state.g)
        self._accept(state.D)
        return self._words(first, iterations, state)

    def _search(self, iterations: int, report: Callable[[str], None]) -> tuple[RestState, int]:
        """Iterate from the present configuration to an equilibrium; returns it, its matrices those
        of the search, and the number of all iterations.
        """
        state, tau = self._at_rest(self.nodes), FIRST
        self.standing_tyres.accept(self.nodes)
        self.drifts, self.signs = False, _Signs()
        corrections = self._renewed(state, tau)
        while True:
            count = f"{iterations} of at most {MAX_ITERATIONS} iterations"
            report(f"searching the equilibrium, after {count}")
            corrections = corrections.changed(tau, self.drifts)
            change = corrections.of(state)
            if self._begins_to_drift(change, tau):
                corrections = corrections.changed(tau, self.drifts)
                change = corrections.of(state)
            size = largest_motion(change, self.model.size)
            is_fresh = corrections.matrices.state is state
            if self._is_equilibrium(state, size, tau):
                if is_fresh:
                    self.matrices = corrections.matrices
                    self._shift(self.nodes, change)
                    return self._at_rest(self.nodes), iterations
                # by the matrices of this very state it may not be one
                self.signs.rate = np.inf
                corrections = self._renewed(state, tau)
                continue
            self._refuse_hopeless(state, iterations)
            iterations += 1
            trial, change = self.nodes.copy(), self._limited(change)
            self._shift(trial, change)
            next_state = self._at_rest(trial)
            # the correction that the same matrix would make there: natural monotonicity
            next_size = largest_motion(corrections.of(next_state), self.model.size)
            growth = next_size / max(size, 1e-300)
            if not growth <= 2.0 and size > SMALLEST and (tau > SHORTEST or not is_fresh):
                if is_fresh:
                    tau *= 0.25
                else:
                    corrections = self._renewed(state, tau)
                self._forces(self.nodes)
                continue
            missed = corrections.contraction(state, change, next_state)
            self.nodes, state = trial, next_state
            self.standing_tyres.accept(self.nodes)
            tau = self._next_tau(tau, growth, size, corrections.matrices)
            self._find_near_pairs()
            self.travel += largest_motion(change, self.model.size)
            # Newton's steps begin with their own, as they move neutral directions by any force left
            is_newton = corrections.tau < tau == LONGEST
            if is_newton or not missed <= CONTRACTION or self.travel > NEARBY:
                corrections = self._renewed(state, tau)

    def _renewed(self, state: RestState, tau: float) -> Corrections:
        """Corrections by the matrices of the present configuration."""
        self.travel = 0.0
        matrices = Matrices(state, self._tangent(state.g), self._mass())
        self._forces(self.nodes)
        return Corrections(matrices, tau, self.drifts, self.model.size)

    def _begins_to_drift(self, change: np.ndarray, tau: float) -> bool:
        """Whether nothing is left of a search but a slow motion that nothing holds, which moves on
        by as much in every iteration. Writes: drifts, signs.

        `change` (n, 6) is the correction; of light bodies on stiff springs accelerations are
        large by the square of that motion, and corrections are not.
        """
        rate = largest_motion(change, self.model.size) / tau**2
        has_stalled = tau >= STALLED and rate > 0.5 * self.signs.rate
        self.signs.stalls = self.signs.stalls + 1 if has_stalled else 0
        self.signs.rate = rate
        if self.drifts or self.signs.stalls < STALLS or not self._is_slow(rate, DRIFT):
            return False
        self.drifts = True
        return True

    def _is_equilibrium(self, state: RestState, size: float, tau: float) -> bool:
        """Whether corrections of this size are none."""
        is_small = size <= SMALLEST and (tau == LONGEST or state.largest_acceleration == 0.0)
        return is_small and bool(np.abs(state.phi).max(initial=0.0) <= self._gap_tolerance())

    def _refuse_hopeless(self, state: RestState, iterations: int) -> None:
        """Raises SolverError where iterations lead to no equilibrium. Writes: signs."""
        signs = self.signs
        signs.slides = signs.slides + 1 if self.standing_tyres.sliding() else 0
        lifted = self._lifted_tyres(state)
        signs.lifts = signs.lifts + 1 if lifted else 0
        if signs.lifts == LIFTS:
            raise self._pulled_off(lifted)
        if iterations == MAX_ITERATIONS or signs.slides == SLIDES:
            raise self._no_equilibrium(state, iterations)

    def _next_tau(self, tau: float, growth: float, size: float, matrices: Matrices) -> float:
        """tau [s] after an iteration."""
        if growth <= 1.0 or size <= SMALLEST:
            return min(2.0 * tau / max(growth, 0.1), LONGEST)
        limit = 0.0 if self.drifts else matrices.time_of_growth
        # forces grow as it leaves an unstable equilibrium
        return min(2.0 * tau, limit, LONGEST) if tau < limit else tau

    def _limited(self, change: np.ndarray) -> np.ndarray:
        """A correction (n, 6), not longer than one iteration may move."""
        displacement = np.abs(change[:, :3]).max(initial=0.0) / (
            LARGEST_DISPLACEMENT * self.model.size
        )
        angle = np.abs(change[:, 3:]).max(initial=0.0) / LARGEST_ROTATION
        return np.asarray(change / max(1.0, displacement, angle))

    def _is_slow(self, rate: float, share: float) -> bool:
        """Whether an acceleration [size or rad, 1/s^2] is below a share of that of the loads."""
        nodes = self.engine.nodes
        load = float(np.linalg.norm(nodes["external"][0, :3]))
        mass = float((1.0 / nodes["mass_inv"][self.free]).sum())
        return rate * self.model.size * mass <= share * load

    def _forces(self, nodes: np.ndarray) -> np.ndarray:
        """g (6 n,) of a configuration without velocities; the engine keeps its sample."""
        return self._forces_of(*(part[None] for part in self._rates(nodes)))[0]

    def _rates(self, nodes: np.ndarray) -> tuple[np.ndarray, ...]:
        """Accelerations (n, 3), angular ones and axes (n, 9) of the same; writes the sample."""
        self.standing_tyres.follow(nodes)
        self.engine.sample_of(nodes)
        # column by column: rows of all columns cost more than the sample
        own = self.engine.nodes
        return own["v_dot"][self.free], own["w_dot"][self.free], own["A"][self.free]

    def _forces_of(self, v_dot: np.ndarray, w_dot: np.ndarray, A: np.ndarray) -> np.ndarray:
        """g (k, 6 n) of the rates (k, n, ...) of k configurations."""
        mass = 1.0 / self.nodes["mass_inv"][self.free]
        J = self.nodes["J"][self.free].reshape(-1, 3, 3)
        A = A.reshape(*A.shape[:-1], 3, 3)
        own = np.matmul(w_dot[..., None, :], A)
        turned = np.matmul(A, np.matmul(J, own.swapaxes(-1, -2)))[..., 0]
        return np.concatenate([mass[:, None] * v_dot, turned], axis=-1).reshape(len(v_dot), -1)

    def _at_rest(self, nodes: np.ndarray) -> RestState:
        """The state of rest in a configuration."""
        g, engine = self._forces(nodes), self.engine
        free_nodes = engine.nodes[self.free]
        D = jacobian(self.model.joints, engine.rows, len(nodes))[:, self.free]
        phi = engine.rows["phi"][whole_rows(self.model.joints)].copy()
        # rotations count by the model's size
        rates = np.hstack([free_nodes["v_dot"], free_nodes["w_dot"] * self.model.size])
        return RestState(g, D.reshape(len(D), g.size), phi, rates)

    def _mass(self) -> np.ndarray:
        """M (6 n, 6 n) of the present configuration."""
        nodes, n = self.nodes[self.free], len(self.free)
        M = np.zeros((n, 6, n, 6))
        A, J = (nodes[name].reshape(-1, 3, 3) for name in ("A", "J"))
        turned = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
        for i in range(n):
            M[i, :3, i, :3] = np.eye(3) / nodes["mass_inv"][i]
            M[i, 3:, i, 3:] = turned[i]
        return M.reshape(6 * n, 6 * n)

    def _momenta(self) -> np.ndarray:
        """Momenta and angular momenta (6 n,) at the start, about mass centres."""
        nodes = self.engine.state.nodes[self.free]
        return np.hstack([nodes["v"] / nodes["mass_inv"][:, None], nodes["L"]]).ravel()

    def _tangent(self, g: np.ndarray, step: float = STEP) -> np.ndarray:
        """dg/dq (6 n, 6 n) by differences, to one side."""
        nodes, rates = self.nodes.copy(), []
        sizes = step * np.tile([self.model.size] * 3 + [1.0] * 3, len(self.free))
        for k, size in enumerate(sizes):
            i = self.free[k // 6]
            perturb(nodes[i], k % 6, size)
            rates.append(self._rates(nodes))
            for name in ("r", "q", "A"):
                nodes[name][i] = self.nodes[name][i]
        changes = self._forces_of(*(np.array(part) for part in zip(*rates, strict=True))) - g
        columns = (changes / sizes[:, None]).T
        is_sound = (np.abs(columns) < MAX_STIFFNESS).all(axis=0)
        if not is_sound.all():
            raise self._refusal(
                int(self.free[int(is_sound.argmin()) // 6]),
                "the stiffness of the forces on it is too large a number",
                "look for numbers of the deck that are far too large",
            )
        return columns

    def _shift(self, nodes: np.ndarray, change: np.ndarray) -> None:
        moved = nodes[self.free]
        move(moved, change)
        nodes[self.free] = moved

    def _gap_tolerance(self) -> float:
        return float(self.model.control[0]["constraint_tolerance"]) * self.model.size

    def _find_near_pairs(self) -> None:
        """Find the pairs that are near in the new configuration. Writes: contact groups, state."""
        state = self.engine.state
        if any(group.search is not None for group in self.model.contact_groups):
            state.nodes["r"], state.nodes["q"] = self.nodes["r"], self.nodes["q"]
            state.nodes["A"] = self.nodes["A"]
            renew(self.model.contact_groups, state)
            self.engine.bind()

    def _refuse_unstable(self, g: np.ndarray) -> None:
        """Raises SolverError for an unstable equilibrium, whose matrices are the last ones."""
        matrices = self.matrices
        Z, M = matrices.Z, matrices.M
        if not Z.shape[1]:
            return
        # to both sides: a spring that begins to act here has the mean of its stiffnesses, where
        # differences to one side have it for the motion of one end and not for that of the other
        K = 0.5 * (matrices.K - Z.T @ self._tangent(g, -STEP) @ Z)
        half = np.linalg.inv(np.linalg.cholesky(0.5 * (M + M.T)))
        K = half @ K @ half.T
        values, modes = np.linalg.eigh(0.5 * (K + K.T))
        # differences err by a share of the stiffest mode
        limit = max(GROWTH**2, ROUND_OFF * values[-1])
        if values[0] < -limit and np.abs(K - K.T).max() > SYMMETRY_TOLERANCE * values[-1]:
            # loads that follow the motion: only a real eigenvalue is left without vibration
            values, modes = np.linalg.eig(K)
            values = np.where(np.abs(values.imag) < limit, values.real, np.inf)
        # the motion with which the bodies begin is no disturbance, as of a car on a wavy road
        p = half @ Z.T @ self._momenta()
        values = np.where((modes.T.real @ p) ** 2 > 0.5 * (p @ p), np.inf, values)
        k = values.argmin()
        if values[k] < -limit:
            mode = np.abs((Z @ half.T @ modes[:, k].real).reshape(-1, 6))
            mode[:, 3:] *= self.model.size
            node = int(self.free[mode.max(axis=1).argmax()])
            raise self._refusal(
                node,
                "the equilibrium is unstable: a disturbance grows as "
                f"exp({(-values[k]) ** 0.5:.3g} t)",
            )

    def _accept(self, D: np.ndarray) -> None:
        """Take the configuration found, and velocities that joints allow. Writes: state.nodes."""
        nodes = self.engine.state.nodes
        for name in ("r", "q", "A"):
            nodes[name] = self.nodes[name]
        self._at_rest(self.nodes)
        self.standing_tyres.commit()
        self.engine.sample_of(nodes)
        given = np.hstack([nodes["v"][self.free], nodes["w"][self.free]]).ravel()
        if len(D):
            inverse = np.linalg.inv(self._mass())
            nu = self.engine.rows["nu"][whole_rows(self.model.joints)]
            moved = inverse @ D.T
            given -= moved @ np.linalg.lstsq(D @ moved, D @ given - nu, rcond=1e-12)[0]
        v, w = np.split(given.reshape(-1, 6), 2, axis=1)
        nodes["v"][self.free], nodes["w"][self.free] = v, w
        A, J = (nodes[name][self.free].reshape(-1, 3, 3) for name in ("A", "J"))
        nodes["L"][self.free] = np.einsum("nij,njk,nlk,nl->ni", A, J, A, w)

    def _words(self, first: np.ndarray, iterations: int, state: RestState) -> str:
        """Displacement of the bodies in words, for the log."""
        moved = np.linalg.norm(self.nodes["r"] - first["r"], axis=1)
        node = int(moved.argmax())
        displacement = f"by up to {moved[node]:.4g} m ({self._name(node)})"
        message = (
            f"equilibrium found in {iterations} iterations: mass centres were moved {displacement}"
        )
        if not self.drifts:
            return message
        # what moves freely: accelerations of stiff ones are round-off
        whole = Corrections(self.matrices, LONGEST, False, self.model.size)
        rates = whole.of(state) / LONGEST**2 * ([1.0] * 3 + [self.model.size] * 3)
        if self._is_slow(float(np.abs(rates).max()) / self.model.size, ROUND_OFF):
            return message
        node, rate = self._fastest(rates)
        return f"{message}; nothing supports {self._name(node)}, which accelerates by {rate}"

    def _fastest(self, rates: np.ndarray) -> tuple[int, str]:
        """The node with the largest of accelerations (n, 6), and that in words."""
        k, axis = divmod(int(np.abs(rates).argmax()), 6)
        rate = abs(rates[k, axis]) / (self.model.size if axis > 2 else 1.0)
        unit = "rad/s^2 about" if axis > 2 else "m/s^2 along"
        return int(self.free[k]), f"{rate:.4g} {unit} {'xyz'[axis % 3]}"

    def _no_equilibrium(self, state: RestState, iterations: int) -> SolverError:
        node, rate = self._fastest(state.rates)
        sliding = self.standing_tyres.sliding()
        slides = f"; these tyres slide and carry no more force: {sliding}" if sliding else ""
        return self._refusal(
            node,
            f"there is no equilibrium: after {iterations} iterations its acceleration is still "
            f"{rate}{slides}",
        )

    def _lifted_tyres(self, state: RestState) -> list[str]:
        return lifted_tyres(
            self.model, self.engine.nodes, state.g.reshape(-1, 6)[:, :3].sum(axis=0)
        )

    def _pulled_off(self, tyres: list[str]) -> SolverError:
        load = self.engine.nodes["external"][0, :3]
        k = int(np.abs(load).argmax())
        return self._refusal(
            int(self.free[0]),
            f"there is no equilibrium: the loads, {load[k]:.4g} N along {'xyz'[k]}, pull it off "
            f"its roads, and no tyre carries them ({', '.join(tyres)})",
            "let gravity point to the road, or leave out control.start",
        )

    def _refusal(self, node: int, cause: str, advice: str = SUPPORT) -> SolverError:
        time = float(self.engine.clock["time"])
        return SolverError(time, 0, self._name(node), cause, advice)

    def _name(self, node: int) -> str:
        if node < len(self.model.bodies):
            return f"body '{self.model.bodies[node]}'"
        return self.model.part_at(node)
