"""Path of equilibria by arc length, through limit points, where the load falls or turns back.

    g(q, lambda) = 0,   Phi(q, lambda) = 0,   |q - q_0| = ds

lambda is the moment at which the curves of loads and motions are read: it is an unknown, and the
distance ds from the last equilibrium is given instead, in displacements over the model's size and
rotations (the cylinder of Crisfield). Newton's equations are solved with both unknowns together, so
that they are regular at a limit point, and a tangent keeps to the direction in which the path came.
Lengths are counted so that a linear model has lambda for them: they are the time of the results.
Loads without a curve act all along. The path ends where lambda reaches the end time.

Consequence to test: the whole path of Williams' toggle, of two bars and of Lee's frame.
References: Riks (1979), International Journal of Solids and Structures 15, 529-551; Crisfield
(1981), Computers and Structures 13, 55-62.
"""

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.run_cards.control import Control
from crashsolve.foundation.errors import RunStopped, SolverError
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import as_rows
from crashsolve.model.model import Model, State
from crashsolve.statics.elimination import eliminate
from crashsolve.statics.equilibrium import (
    HALVINGS,
    MAX_ITERATIONS,
    NEGLIGIBLE,
    STAGNATION_TOLERANCE,
    StaticEngine,
)
from crashsolve.statics.problem import Problem
from crashsolve.statics.stability import count_unstable
from crashsolve.system.diagnosis import curve_end

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

# of the run's span: difference by which the change of loads is found
MOMENT_STEP = 1e-6
# cosine of the angle between two tangents of a step: more would be another path, or a loop
COSINE = 0.9
# of a step: the end is reached within its length
REACHED = 1.0 + 1e-6
# a model that moves less under its full load counts as rigid, in the model's size or rad
UNMOVED = 1e-14

POSITION = Record("""
    moment   s    lambda
    length   s    length of the path so far, as a time
    unit     1/s  length in the metric that the first stiffness gives for a second
    longest  1    step that is tried next, in the metric
""")
# length as a time [s], load factor, unstable modes
Point = tuple[float, float, int]


class PathEngine(StaticEngine):
    """Follows a path of equilibria by steps of given arc length."""

    def __init__(self, model: Model, state: State, control: Control, program: str = "") -> None:
        super().__init__(model, state, control, program)
        self.begin, self.end = control.start_time, control.end_time
        position = np.zeros(1, POSITION.dtype)
        self.at: RowOfTable = as_rows(position)[0]
        self.at.moment = self.at.length = self.begin
        self.at.longest = np.inf
        # tangent of unit length, of positions and rotations in the metric, and of lambda
        self.direction = np.zeros(6 * len(self.free) + 1)
        self.aside = {"path/position": position, "path/direction": self.direction}
        self.points: list[Point] = []

    @property
    def _metric(self) -> np.ndarray:
        """Weights (6 n,) of displacements [1/m] and rotations [1/rad] in the arc length."""
        return np.tile([*3 * [1.0 / self.model.size], *3 * [1.0]], len(self.free))

    def start(self) -> None:
        """The equilibrium in which the path begins, and its tangent. Raises SolverError."""
        super().start()
        self.loading.follows_path = True
        A, _, rate = self._equations(self.begin)
        first = eliminate(A, rate) * self._metric
        self.at.unit = float(np.linalg.norm(first))
        if not self.at.unit * (self.end - self.begin) > UNMOVED:
            raise SolverError(
                self.begin,
                0,
                "the model",
                "at the start no load or prescribed motion changes, or its change moves nothing",
                "control.path: arc_length needs a load or a driver with a curve that rises",
            )
        self.direction[:] = np.append(first, 1.0) / self.at.unit
        self._record_point()

    def reach(self, until: float) -> None:
        """Equilibria along the path until its length is a time [s]. Raises SolverError."""
        clock, self.loading.follows_path = self.clock, True
        if not self.points:
            # of the equilibrium that a dump has brought
            self._equations(self.at.moment)
            self._record_point()
        least = self.at.unit * (until - self.at.length) / 2**HALVINGS
        clock.time = self.at.moment
        while self.at.length < until and not self.is_complete:
            left = self.at.unit * (until - self.at.length)
            tried = min(left, self.at.longest)
            step = self._take_step(tried, least)
            self.at.longest = max(2.0 * step, self.at.longest if step == tried else 0.0)
            clock.step = step / self.at.unit
            self.at.length = until if step == left else self.at.length + clock.step
            self.at.moment = float(clock.time)
            self._record_point()
            clock.time = self.at.length
            self.on_pause()
            clock.time = self.at.moment
        clock.time = self.at.length

    advance = reach

    def sample(self, time: float | None = None) -> None:
        """Take a sample with the loads of this equilibrium. Raises SolverError."""
        super().sample(self.at.moment)
        self.sampled.time = self.clock.sampled = self.at.length

    def _take_step(self, step: float, least: float) -> float:
        """Take a step, or a shorter one; returns its arc length. Raises SolverError."""
        while True:
            saved, direction = self.save_state(), self.direction.copy()
            try:
                far = self._attempt_step(step)
            except RunStopped:
                self.restore_state(saved)
                self.direction[:] = direction
                self.clock.time = self.at.length
                self.on_pause()
                raise
            if far:
                return far
            self.restore_state(saved)
            self.direction[:] = direction
            step *= 0.5
            if step < least:
                raise Problem("lost path", float(self.clock.time)).error(
                    self, float(self.clock.time)
                )

    def _attempt_step(self, step: float) -> float:
        """Try a step, at most to the end of the path; returns its arc length, 0 where it fails."""
        start, start_time = self.state.nodes.copy(), float(self.clock.time)
        before = self._missing_energy()
        self.work.begin()
        count = self._correct(step)
        if self.clock.time > self.end:
            # the loads of the end time are passed within this step
            self.state.nodes[:] = start
            count, self.clock.time = self.iterate(self.end), self.end
            self.is_complete = True
        if self.model.curves[0]["fault"] != 0:
            causes = curve_end(self.model, self.state, self.clock)
            raise SolverError(start_time, int(self.clock.cycle), *causes)
        far = self._length(self.change_from(start)) if count else 0.0
        is_fit = 0.0 < far <= REACHED * step and self._is_smooth(start, start_time)
        if is_fit:
            self.work.count(start, start_time, float(self.clock.time))
            is_fit = not self._is_out_of_balance(abs(self._missing_energy() - before))
        if not is_fit:
            self.is_complete = False
            return 0.0
        self._accept(count)
        return min(far, step) if self.is_complete else step

    def _correct(self, step: float) -> int:
        """Number of Newton's iterations to an equilibrium a `step` away; 0 without convergence.

        They stop where lambda passes the end. Writes: the nodes, clock.time as lambda.
        """
        clock, start = self.clock, self.state.nodes.copy()
        ahead = self.direction * step
        time = float(clock.time) + ahead[-1]
        self.forces.include(self.imbalance(min(time, self.end))[0], self)
        self.shift(self.state.nodes, (ahead[:-1] / self._metric).reshape(-1, 6))
        previous = np.inf
        for count in range(MAX_ITERATIONS):
            self.on_iteration()
            clock.time = time
            if time > self.end:
                return 0
            secant = self.change_from(start).ravel() * self._metric
            excess = float(0.5 * (secant @ secant / step - step))
            change = self._solve(time, secant / step, -excess)
            moved = change[:-1].reshape(-1, 6)
            if not np.isfinite(change).all():
                return 0
            size = self.size_of(moved)
            step_fraction = self.step_fraction(moved)
            self.shift(self.state.nodes, moved * step_fraction)
            time += step_fraction * change[-1]
            contraction = min(size / previous, 1.0) if count else 1.0
            largest = self._largest_change(start)
            is_small = size * contraction <= self.tolerance * largest + NEGLIGIBLE
            stagnates = size >= 0.5 * previous and size <= STAGNATION_TOLERANCE
            if step_fraction == 1.0 and (is_small or stagnates) and time <= self.end:
                clock.time = time
                self.model.curves[0]["fault"] = 0
                if self.is_balanced(time):
                    return count + 1
            previous = size
        return 0

    def _is_smooth(self, start: np.ndarray, start_time: float) -> bool:
        """Whether the direction of the path changes little over a step. Writes: direction."""
        secant = self.change_from(start).ravel() * self._metric
        ahead = self._solve(min(float(self.clock.time), self.end), secant, 1.0, is_tangent=True)
        if not np.isfinite(ahead).all():
            return False
        ahead[:-1] *= self._metric
        ahead /= np.linalg.norm(ahead[:-1])
        is_near = bool(ahead[:-1] @ self.direction[:-1] >= COSINE)
        self.direction[:] = ahead
        return is_near

    def _solve(
        self, time: float, row: np.ndarray, right: float, is_tangent: bool = False
    ) -> np.ndarray:
        """Change (6 n + 1,) of positions, rotations and lambda by Newton's equations at a moment.

        `row` times the change of positions in the metric is `right`; for a tangent b is zero.
        """
        A, b, rate = self._equations(time)
        n, stiff = len(b), np.abs(A).max()
        # rows and columns of one size
        across = stiff / max(np.abs(rate).max(), 1e-300)
        along = row * self._metric
        down = stiff / max(np.abs(along).max(), 1e-300)
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n], whole[:n, n], whole[n, :n] = A, -across * rate, down * along
        solution = eliminate(whole, np.append(np.zeros(n) if is_tangent else b, down * right))
        solution[n] *= across
        return solution

    def _equations(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Newton's matrix (6 n, 6 n) and right side (6 n,), and its change with lambda [1/s]."""
        g, D, phi = self.imbalance(time)
        self.tangent = (-self._tangent(time, g, D), D)
        A, b = self.bordered(-self.tangent[0], g, D, phi)
        ahead = MOMENT_STEP * (self.end - self.begin)
        ahead *= -1.0 if time + ahead > self.end else 1.0
        other, _, closed = self.imbalance(time + ahead)
        scale = self._constraint_stiffness(-self.tangent[0]) / max(
            np.abs(D).max(initial=0.0) ** 2, 1e-300
        )
        rate = -(other - g) + scale * np.einsum("mi,m->i", D, closed - phi)
        return A, b, rate / ahead

    def _length(self, change: np.ndarray) -> float:
        """Arc length [1] of displacements and rotations (n, 6)."""
        return float(np.linalg.norm(change.ravel() * self._metric))

    def step_warnings(self) -> list[str]:
        """Limit and branch points of the path, and where it ends."""
        time, factor, count = self.points[-1]
        where = "the loads of end_time"
        if not self.is_complete:
            where = (
                f"the length of control.path_length, {self.at.length:.6g} s, before it reached "
                "the loads of end_time"
            )
        left = f"an equilibrium with {count} unstable modes" if count else "a stable equilibrium"
        ended = f"the path ended at {where}: load factor {factor:.6g}, in {left}"
        return [
            *self.notes,
            *special_points(self.points),
            *([ended] if count or not self.is_complete else []),
        ]

    def _record_point(self) -> None:
        """Append arc length, load factor and number of unstable modes to the points of the path."""
        assert self.tangent is not None
        factor = (self.at.moment - self.begin) / (self.end - self.begin)
        count = count_unstable(*self.tangent)
        self.clock.load_factor, self.clock.unstable_modes = factor, count
        self.points.append((self.at.length, factor, count))


def special_points(points: list[Point]) -> list[str]:
    """Limit points of a path, and where equilibria lose or gain stability elsewhere, in words."""
    times, factors, counts = (np.array(column) for column in zip(*points, strict=True))
    rises = np.diff(factors)
    extremes = [k for k in range(1, len(points) - 1) if rises[k - 1] * rises[k] < 0.0]
    notes = []
    for k in extremes:
        time, factor = _vertex(times[k - 1 : k + 2], factors[k - 1 : k + 2])
        kind = "maximum" if rises[k] < 0.0 else "minimum"
        after = _stability(int(counts[min(k + 2, len(points) - 1)]))
        text = (
            f"limit point at t = {time:.5g} s: a {kind} of the load factor, {factor:.6g}; {after}"
        )
        notes.append((time, text))
    for k in map(int, np.flatnonzero(np.diff(counts))):
        if not any(abs(i - k - 0.5) < 2.0 for i in extremes):
            text = (
                f"stability changes at t = {times[k]:.5g} to {times[k + 1]:.5g} s, load factor "
                f"{factors[k]:.6g} to {factors[k + 1]:.6g}, away from limit points: another path "
                f"branches off (bifurcation); {_stability(int(counts[k + 1]))}"
            )
            notes.append((float(times[k]), text))
    return [text for _, text in sorted(notes)]


def _stability(count: int) -> str:
    """Stability of the equilibria that follow, under constant loads, in words."""
    return (
        f"beyond it equilibria have {count} unstable modes"
        if count
        else "beyond it equilibria are stable"
    )


def _vertex(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """x and y of the vertex of the parabola through three points."""
    c = np.polyfit(x - x[1], y, 2)
    at = -0.5 * c[1] / c[0]
    return float(x[1] + at), float(np.polyval(c, at))
