"""Equilibrium from which a run begins: its bodies are moved to where nothing accelerates them.

    Z^T g(q) = 0,   Phi(q) = 0,   D Z = 0
    (M / tau^2 - dg/dq) projected on Z, times y = Z^T (g + dg/dq delta_c),   delta = delta_c + Z y

g are the forces at rest that joints do not hold, delta_c closes the joints. tau grows as g falls
(pseudo-transient continuation): small steps along the forces at first, so that what hangs above its
springs settles on them, Newton's steps in the end. Directions in which nothing acts, as those in
which a car rolls, keep their coordinate; where a small force is left in such a direction, as by the
aligning moments of wheels that lean, the run begins with it, and the log states it. Forces are
those without motion: dampers, friction and slip of tyres rest, but for the carcass of wheels that
stand (`standing.py`). Velocities of the deck
stay, but for what joints of the new configuration do not allow. Consequence to test: loads sum to
the weight and divide by their lever arms, and the motion that follows stays below 1 % of them.

Reference: Kelley and Keyes (1998), Convergence analysis of pseudo-transient continuation, SIAM
Journal on Numerical Analysis 35, 508-523.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.model.contact.pairs import renew
from crashsolve.model.jacobian import jacobian, null_space, whole_rows
from crashsolve.statics.motions import move, nudge
from crashsolve.statics.standing import Standing
from crashsolve.system.engine import Engine

# differences: over the model's size, and rad
STEP = 1e-7
# largest displacement (over the model's size) and rotation [rad] of a pass
FAR, ANGLE = 0.05, 0.1
# of tau [s]: that of the first pass, the largest, which leaves neutral directions alone, the least
FIRST, LONGEST, SHORTEST = 0.01, 10.0, 1e-7
PASSES = 300
# searches where wheels stand: what one drags across the road as it is set down, the next releases
SEARCHES = 3
# passes on end in which a tyre that stands slides all over, after which nothing will hold it
SLIDES = 40
# acceleration in directions that nothing holds, over that of the loads, with which a run begins all
# the same: half of the transient that is allowed; tau [s] from which a search that is left with so
# little stalls where it falls by less than a half, and the passes on end that show it
DRIFT, STALLED, STALLS = 5e-3, 0.5, 2
# a correction that is none, in the model's size or rad
STILL = 1e-11
# growth of a motion away from the equilibrium that is none of round-off [1/s]
GROWTH, ROUND_OFF = 0.1, 1e-9
# coordinates; differences of so many take minutes
MOST = 3000
SUPPORT = (
    "support it by joints, springs or contacts that carry a static load (friction, dampers and "
    "sliding tyres carry none), or leave out control.start"
)


def begin_at_rest(engine: Engine, does: Callable[[str], None]) -> str:
    """Move the nodes to equilibrium; returns what was moved. Writes: state.nodes.

    `does` takes words for every pass, since one of many coordinates lasts seconds.

    Raises SolverError where there is none.
    """
    return _Settling(engine).run(does)


@dataclass
class _Rest:
    """What acts in a configuration: g (6 n,), D (m, 6 n), Phi (m,) and accelerations (n, 6)."""

    g: np.ndarray
    D: np.ndarray
    phi: np.ndarray
    rates: np.ndarray

    @property
    def worst(self) -> float:
        return float(np.abs(self.rates).max(initial=0.0))

    @property
    def motions(self) -> np.ndarray:
        """Z (6 n, k): motions that the joints allow."""
        return null_space(self.D) if len(self.D) else np.eye(self.g.size)


@dataclass
class _Pass:
    """A correction (n, 6), its size before it is cut, and the matrices it is made by."""

    D: np.ndarray
    Z: np.ndarray
    G: np.ndarray
    inverse: np.ndarray
    change: np.ndarray
    size: float

    def again(self, rest: "_Rest") -> np.ndarray:
        """The correction (n, 6) that these matrices make of another configuration."""
        n = rest.g.size
        closing = np.linalg.lstsq(self.D, -rest.phi, rcond=1e-12)[0] if len(self.D) else np.zeros(n)
        free = self.Z @ (self.inverse @ (self.Z.T @ (rest.g + self.G @ closing)))
        return np.asarray((closing + free).reshape(-1, 6))


def _held(matrix: np.ndarray, M: np.ndarray, tau: float) -> np.ndarray:
    """Inverse of `matrix` but for motions that nothing holds, which keep their coordinates."""
    half = np.linalg.inv(np.linalg.cholesky(0.5 * (M + M.T)))
    U, values, V = np.linalg.svd(half @ matrix @ half.T)
    kept = values > 1.0 / tau**2 + GROWTH**2
    inverse = V[kept].T @ ((U[:, kept] / values[kept]).T)
    return np.asarray(half.T @ inverse @ half)


class _Settling:
    """Intermediate configurations, as nodes without velocities."""

    def __init__(self, engine: Engine) -> None:
        self.engine, self.model = engine, engine.model
        attached = set(self.model.attached_nodes["node"])
        nodes = engine.state.nodes
        self.free = np.array([i for i in range(1, len(nodes)) if i not in attached], int)
        if len(engine.state.points):
            message = "control.start: equilibrium does not move the nodes of shells"
            raise self._refusal(1, message, "leave out control.start")
        if 6 * len(self.free) > MOST:
            message = (
                f"the model has {6 * len(self.free)} coordinates; control.start: equilibrium is "
                f"for at most {MOST}"
            )
            raise self._refusal(1, message, "leave out control.start")
        self.standing = Standing(self.model, nodes, int(engine.clock["current"]))
        # whether the search is left with a motion that nothing holds
        self.drifts = False
        self.nodes = nodes.copy()
        self.nodes["v"] = self.nodes["w"] = self.nodes["L"] = 0.0

    def run(self, does: Callable[[str], None]) -> str:
        """The whole search; returns what it found."""
        first, passes = self.nodes.copy(), 0
        for _ in range(SEARCHES if self.standing.patches else 1):
            self.standing.begin(self.nodes)
            here, passes = self._search(passes, does)
        does("preparing the first step")
        self._refuse_unstable(here)
        self._take_over(here.D)
        return self._words(first, passes, here)

    def _search(self, passes: int, does: Callable[[str], None]) -> tuple["_Rest", int]:
        """Passes from the present configuration to an equilibrium; what acts there, all passes."""
        here, tau, slides, stalls = self._at_rest(self.nodes), FIRST, 0, 0
        self.standing.accept(self.nodes)
        self.drifts, before = False, np.inf
        while True:
            does(f"searching the equilibrium, after {passes} of at most {PASSES} iterations")
            is_small = self._is_small(here)
            stalls = stalls + 1 if tau >= STALLED and here.worst > 0.5 * before else 0
            self.drifts, before = is_small and (self.drifts or stalls >= STALLS), here.worst
            pass_ = self._pass(here, tau)
            is_still = pass_.size <= STILL and (tau == LONGEST or here.worst == 0.0)
            if is_still and np.abs(here.phi).max(initial=0.0) <= self._closed():
                return here, passes
            slides = slides + 1 if self.standing.sliding() else 0
            if passes == PASSES or slides == SLIDES:
                raise self._no_equilibrium(here, passes)
            passes += 1
            tried = self.nodes.copy()
            self._shift(tried, pass_.change)
            there = self._at_rest(tried)
            # the correction that the same matrix would make there: natural monotonicity
            growth = self._size(pass_.again(there)) / max(pass_.size, 1e-300)
            if not growth <= 2.0 and tau > SHORTEST and pass_.size > STILL:
                tau *= 0.25
                continue
            self.nodes, here = tried, there
            self.standing.accept(self.nodes)
            if growth <= 1.0 or pass_.size <= STILL:
                tau = min(2.0 * tau / max(growth, 0.1), LONGEST)
            self._look_again()

    def _is_small(self, here: "_Rest") -> bool:
        """Whether what is left is no more than a run may begin with."""
        nodes = self.engine.nodes
        pulled = float(np.linalg.norm(nodes["external"][0, :3]))
        mass = float((1.0 / nodes["mass_inv"][self.free]).sum())
        return here.worst * mass <= DRIFT * pulled

    def _at_rest(self, nodes: np.ndarray) -> "_Rest":
        """What acts in a configuration without velocities."""
        engine = self.engine
        self.standing.follow(nodes)
        engine.sample_of(nodes)
        found = engine.nodes[self.free]
        g = np.empty((len(self.free), 6))
        g[:, :3] = found["v_dot"] / found["mass_inv"][:, None]
        A, J = (found[name].reshape(-1, 3, 3) for name in ("A", "J"))
        own = np.einsum("nji,nj->ni", A, found["w_dot"])
        g[:, 3:] = np.einsum("nij,njk,nk->ni", A, J, own)
        D = jacobian(self.model.joints, engine.rows, len(nodes))[:, self.free]
        phi = engine.rows["phi"][whole_rows(self.model.joints)].copy()
        # rotations count by the model's size
        rates = np.hstack([found["v_dot"], found["w_dot"] * self.model.size])
        return _Rest(g.ravel(), D.reshape(len(D), g.size), phi, rates)

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

    def _tangent(self, g: np.ndarray) -> np.ndarray:
        """dg/dq (6 n, 6 n) by differences."""
        nodes, columns = self.nodes.copy(), np.empty((g.size, g.size))
        for k in range(g.size):
            i, size = self.free[k // 6], STEP * (self.model.size if k % 6 < 3 else 1.0)
            kept = nodes[i].copy()
            nudge(nodes[i], k % 6, size)
            columns[:, k] = (self._at_rest(nodes).g - g) / size
            nodes[i] = kept
        return columns

    def _pass(self, here: "_Rest", tau: float) -> "_Pass":
        """The correction of one pass."""
        Z, G = here.motions, self._tangent(here.g)
        M = Z.T @ self._mass() @ Z
        matrix = M / tau**2 - Z.T @ G @ Z
        inverse = _held(matrix, M, tau) if self.drifts else np.linalg.pinv(matrix, rcond=1e-15)
        found = _Pass(here.D, Z, G, inverse, np.zeros((0, 6)), 0.0)
        change = found.again(here)
        found.size = self._size(change)
        far = np.abs(change[:, :3]).max(initial=0.0) / (FAR * self.model.size)
        angle = np.abs(change[:, 3:]).max(initial=0.0) / ANGLE
        found.change = change / max(1.0, far, angle)
        return found

    def _size(self, change: np.ndarray) -> float:
        """Of a correction (n, 6): in the model's size or rad."""
        far = np.abs(change[:, :3]).max(initial=0.0) / self.model.size
        return float(max(far, np.abs(change[:, 3:]).max(initial=0.0)))

    def _shift(self, nodes: np.ndarray, change: np.ndarray) -> None:
        moved = nodes[self.free]
        move(moved, change)
        nodes[self.free] = moved

    def _closed(self) -> float:
        return float(self.model.control[0]["constraint_tolerance"]) * self.model.size

    def _look_again(self) -> None:
        """Pairs that are near in the new configuration."""
        state = self.engine.state
        if any(group.search is not None for group in self.model.contact_groups):
            state.nodes["r"], state.nodes["q"] = self.nodes["r"], self.nodes["q"]
            state.nodes["A"] = self.nodes["A"]
            renew(self.model.contact_groups, state)
            self.engine.bind()

    def _refuse_unstable(self, here: "_Rest") -> None:
        """Raises SolverError for an equilibrium that any disturbance ends."""
        Z = here.motions
        if not Z.shape[1]:
            return
        K, M = -Z.T @ self._tangent(here.g) @ Z, Z.T @ self._mass() @ Z
        half = np.linalg.inv(np.linalg.cholesky(0.5 * (M + M.T)))
        values, modes = np.linalg.eigh(half @ (0.5 * (K + K.T)) @ half.T)
        # differences err by a share of the stiffest mode
        if values[0] < -max(GROWTH**2, ROUND_OFF * values[-1]):
            mode = np.abs((Z @ half.T @ modes[:, 0]).reshape(-1, 6))
            mode[:, 3:] *= self.model.size
            node = int(self.free[mode.max(axis=1).argmax()])
            raise self._refusal(
                node,
                "the equilibrium is unstable: a disturbance grows as "
                f"exp({(-values[0]) ** 0.5:.3g} t)",
            )

    def _take_over(self, D: np.ndarray) -> None:
        """The configuration, and velocities that its joints allow. Writes: state.nodes."""
        nodes = self.engine.state.nodes
        for name in ("r", "q", "A"):
            nodes[name] = self.nodes[name]
        self._at_rest(self.nodes)
        self.standing.keep()
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

    def _words(self, first: np.ndarray, passes: int, here: "_Rest") -> str:
        """What was moved, for the log."""
        moved = np.linalg.norm(self.nodes["r"] - first["r"], axis=1)
        node = int(moved.argmax())
        far = f"by up to {moved[node]:.4g} m ({self._name(node)})"
        found = f"equilibrium found in {passes} iterations: mass centres were moved {far}"
        if not self.drifts:
            return found
        node, rate = self._worst(here)
        return f"{found}; nothing holds {self._name(node)}, which accelerates by {rate}"

    def _worst(self, here: "_Rest") -> tuple[int, str]:
        """The node with the largest acceleration, and that in words."""
        k, axis = divmod(int(np.abs(here.rates).argmax()), 6)
        rate = abs(here.rates[k, axis]) / (self.model.size if axis > 2 else 1.0)
        unit = "rad/s^2 about" if axis > 2 else "m/s^2 along"
        return int(self.free[k]), f"{rate:.4g} {unit} {'xyz'[axis % 3]}"

    def _no_equilibrium(self, here: "_Rest", passes: int) -> SolverError:
        node, rate = self._worst(here)
        sliding = self.standing.sliding()
        slides = f"; these tyres slide and hold no more: {sliding}" if sliding else ""
        return self._refusal(
            node,
            f"there is no equilibrium: after {passes} iterations its acceleration is still "
            f"{rate}{slides}",
        )

    def _refusal(self, node: int, cause: str, advice: str = SUPPORT) -> SolverError:
        time = float(self.engine.clock["time"])
        return SolverError(time, 0, self._name(node), cause, advice)

    def _name(self, node: int) -> str:
        if node < len(self.model.bodies):
            return f"body '{self.model.bodies[node]}'"
        return self.model.part_at(node)
