"""The engine: the compiled step of one scene with its arrays. The only module that calls it."""

from collections.abc import Callable
from importlib import import_module
from math import inf, nextafter
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.compiler.machine import runs_checked, runs_plain
from crashsolve.compiler.table import Tables
from crashsolve.foundation.rows import as_rows, copy_rows
from crashsolve.model import ledger as energy
from crashsolve.model.clock import (
    CORNER,
    PAUSED,
    REACHED,
    REBUILD,
    STOPS_AT_SAMPLE,
    TOUCHED,
)
from crashsolve.model.contact.pairs import renew
from crashsolve.model.corners import corners_in_time
from crashsolve.model.curve_steps import LINE, steps_by_curves
from crashsolve.model.implicit.compliance import compliance
from crashsolve.model.model import Model, State
from crashsolve.model.nodes import ESTIMATE
from crashsolve.system.compose import arrays_of_threads, compose, load
from crashsolve.system.contact.effective_mass import EffectiveMasses
from crashsolve.system.contact.initial_penetration import find_impact_speeds
from crashsolve.system.diagnosis import broken_joints, diagnose, passed_through, velocity_error
from crashsolve.system.placeholders import group_arrays, is_shared, samples_within_steps
from crashsolve.system.swings import swing_warnings

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

# an assembly error above this share of the model's size is an error in the deck, not round-off
ASSEMBLY = 1e-6
# iterations to close the joints, per step on average, beyond which the step is suspect: 1 to 2 are
# common, 8 are taken where the tension of a chain swings its rods at 2.4 times the stable frequency
MANY_ITERATIONS = 4.0
# steps of the first call of the compiled loop, and seconds that a call may take: no request waits
# longer for an answer to a signal
FIRST_CALL, LONGEST_CALL = 16, 0.2
# steps after which work from outside, of a force that grows from nothing, can be compared with
FIRST_CHECKED = 5
# a corner of a curve is met within this share of a step, or of the time: its square is the error
STAGNATION_RATIO, ROUND_OFF = 1e-6, 1e-14
# the record of a balance above its limit, and the negligible part: a share of that limit,
# as the first steps from rest err by much of the little energy there is
MISSING, NEGLIGIBLE_SHARE = ("missing", "missing_share", "missing_time"), 0.01
# methods with stages take steps so many times as long, by the curves of time
WITHIN = 4.0
# at most so many iterations for friction and reactions of the initial state to agree
ITERATIONS = 60


class Engine:
    """Steps a State through a Model; `nodes` and `rows` are the copies of the last sample."""

    # a path of equilibria may end before the end time
    is_complete = False

    def __init__(self, model: Model, state: State, program: str = "") -> None:
        """`program` is that of another engine of the same deck: composing takes a while."""
        self.model, self.state = model, state
        self.nodes, self.rows = state.nodes.copy(), state.rows.copy()
        self.ledger, self.sample_clock = state.ledger.copy(), state.clock.copy()
        self._limit = float(model.control[0]["energy_limit"])
        self._corners = corners_in_time(model)
        # [s] of pieces between corners, however long the steps before them
        self._least_piece = float(np.diff(self._corners).min(initial=inf))
        # of motion: an equilibrium has none
        self.has_stages = len(state.stages) > 0
        # stages lie within the step, and its error is judged
        self._stage_fraction = WITHIN if self.has_stages else 1.0
        method = import_module(f"crashsolve.integrators.{model.integrator}")
        parts = LINE * self._stage_fraction if method.ORDER == 2 else 0.0
        self._curve_starts, self._curve_steps = steps_by_curves(model, parts)
        self.is_dense = samples_within_steps(model)
        self.tableau = self._tableau()
        # rates at the stages of the last step
        self.stages = {"stages": state.stages} if self.has_stages else {}
        # a sample within a step begins from the histories of the step's start
        kept = model.groups if self.is_dense else []
        self._histories = {f"{g.word}_history": (g.history, g.history.copy()) for g in kept}
        self.copied = self._in_bytes()
        # how often tables have been bound: others by then are not those of a copy
        self.bindings = 0
        self.bind()
        self._advance = load(program or compose(model), self._present)
        self.masses = EffectiveMasses(self.model)
        self.notes: list[str] = []  # of how the run begins, for the log
        # called from time to time between two samples; may raise
        self.on_pause: Callable[[], None] = lambda: None
        # called within load steps of statics, where there is nothing to dump; may raise RunStopped
        self.on_iteration: Callable[[], None] = lambda: None
        self.on_message: Callable[[str], None] = lambda text: None  # for the log
        # arrays of a dump beside the State
        self.aside: dict[str, np.ndarray] = {}
        self._steps_per_call = 1 if runs_plain() else FIRST_CALL
        # of an interval that is run again: steps between checks, steps done, step of the next check
        self._stride = self._done = self._pause = 0

    @property
    def addresses(self) -> tuple[int, int, int] | None:
        """Addresses of the compiled step, of its present tables, and of those of a sample.

        None where it is no function of one thread that code without checks may call.
        """
        step: int | None = getattr(self._advance, "address", None)
        if step is None or runs_checked():
            return None
        return step, self._present.pointer, self._sampled.pointer

    def has_no_corner(self, until: float) -> bool:
        """Whether no curve of time has a corner or another bound on steps by `until` [s]."""
        is_free = self._is_free_of_curves()
        return is_free and self.clock["kinked"] != CORNER and self._next_corner(until) > until

    def _in_bytes(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Copies of a sample, from and to, in bytes, as numpy copies columns one by one."""
        s = self.state
        pairs = [(s.nodes, self.nodes), (s.rows, self.rows), (s.clock, self.sample_clock)]
        pairs += [(s.ledger, self.ledger), *self._histories.values()]
        return [
            (old.reshape(-1).view(np.uint8), new.reshape(-1).view(np.uint8)) for old, new in pairs
        ]

    def bind(self) -> None:
        """Hand the present arrays to the compiled step: the State, and the copies of a sample."""
        m, s = self.model, self.state
        self.bindings += 1
        # time, step, cycle and totals: at present, and of the last sample
        self.clock: RowOfTable = as_rows(s.clock)[0]
        self.sampled: RowOfTable = as_rows(self.sample_clock)[0]
        shared = (
            group_arrays(m, s) | m.saddle._asdict() | {"control": m.control, "curves": m.curves}
        )
        shared |= self.tableau | self.stages
        state = {"clock": s.clock, "nodes": s.nodes, "rows": s.rows, "ledger": s.ledger}
        copied = (self.sample_clock, self.nodes, self.rows, self.ledger)
        copies = dict(zip(state, copied, strict=True))
        copies |= {name: copy for name, (_, copy) in self._histories.items()}
        # the clock of the first thread, which the others know by this name
        leaders = [{"leader": own["clock"]} if is_shared(m) else {} for own in (state, copies)]
        own = arrays_of_threads(m)
        self._present, self._sampled = (
            self._tables(shared | step | leader, own)
            for step, leader in zip((state, copies), leaders, strict=True)
        )

    @staticmethod
    def _tables(arrays: dict[str, np.ndarray], others: list[dict[str, np.ndarray]]) -> Tables:
        """Tables of the first thread, and of others that have some of their own."""
        tables = Tables(arrays)
        tables.of_threads = [Tables(arrays | own) for own in others]
        return tables

    def _tableau(self) -> dict[str, np.ndarray]:
        """Coefficients of a Runge-Kutta method; a sample is one more stage of it."""
        method = import_module(f"crashsolve.integrators.{self.model.integrator}")
        if not hasattr(method, "STAGES"):
            return {}
        if not hasattr(method, "EXTRA"):
            names = [name for name in ("A", "C", "T", "E") if hasattr(method, name)]
            return {name: getattr(method, name).ravel() for name in names} | compliance(
                self.model, self.state, method.STAGES - 1
            )
        rows = method.STAGES + method.EXTRA + 1
        A = np.zeros((rows, rows))
        A[:-1, :-1] = method.A
        errors = np.zeros((method.ESTIMATES, len(self.nodes)), ESTIMATE.dtype)
        given = {"C": method.C, "E": method.E.ravel(), "D": method.DENSE.ravel()}
        return given | {"A": A.ravel(), "errors": errors}

    def start(self) -> None:
        """Forces and reactions of the initial state; energy from which the balance is counted."""
        s = self.state
        reactions = s.rows["reaction"].tolist()
        # friction in joints needs the reactions, which need the friction
        for count in range(ITERATIONS):
            known = reactions
            self._advance(self.clock["time"], True, self._present)
            if count == 0 and any([find_impact_speeds(self.model, s), self.masses.find(s)]):
                continue
            reactions = s.rows["reaction"].tolist()
            change = max((abs(a - b) for a, b in zip(reactions, known, strict=True)), default=0.0)
            if change <= 1e-12 * max(map(abs, known), default=0.0):
                break
        s.rows["multiplier"] = s.rows["before"] = s.rows["reaction"]
        ledger = s.ledger.tolist()
        stored = [ledger[k] for k in energy.MECHANICAL]
        s.ledger[energy.INITIAL], s.ledger[energy.LARGEST] = sum(stored), max(0.0, *stored)
        s.ledger[energy.IMBALANCE] = 0.0
        # before there was an energy to count from
        s.clock[0]["missing"] = 0.0

    def advance(self, until: float) -> None:
        """Step to exactly `until` [s]. Raises SolverError at a numerical stop."""
        self._step_by_corners(until, until)

    def reach(self, until: float) -> None:
        """Step to `until` [s], beyond it where samples may lie in a step. Raises SolverError."""
        end = float(self.model.control[0]["end"])
        self._step_by_corners(until, max(until, end) if self.is_dense else until)

    def revisit(self, until: float, stride: int, look: Callable[[], None], done: int = 0) -> None:
        """Reach `until` [s] with a look every `stride` steps, but for the last; `done` of them."""
        kept, self.on_pause = self.on_pause, look
        self._stride, self._done = stride, done
        try:
            self.reach(until)
        finally:
            self.on_pause, self._stride, self._done = kept, 0, 0

    def _step_by_corners(self, until: float, goal: float) -> None:
        """Step to `until`, one corner of a curve of time after the other."""
        clock = self.state.clock[0]
        while clock["time"] < until:
            if clock["kinked"] == CORNER:
                self._renew_after_corner()
            corner = self._next_corner(until)
            # stages at the end of a step belong to the time before a corner
            end = nextafter(corner, -inf) if self.has_stages else corner
            change = self._next_curve_step(min(max(until, goal), end))
            self._step(min(until, end, change), min(goal, end, change))
            if clock["time"] >= end:
                clock["time"], clock["kinked"] = corner, CORNER

    def _step(self, until: float, goal: float) -> None:
        s = self.state
        s.clock[0]["goal"] = goal
        while True:
            status = self._call(until)
            if status == REACHED:
                return
            self.answer(status)

    def answer(self, status: int) -> None:
        """Handle a return of the loop before its goal. Raises SolverError."""
        s = self.state
        if status == PAUSED:
            self.on_pause()
        elif status == TOUCHED:
            self.masses.find(s)
            self._renew_forces()
            if self._stride and int(s.clock[0]["cycle"]) >= self._pause:
                self.on_pause()
        elif status == REBUILD:
            self._check_pass_through()
            renew(self.model.contact_groups, s)
            if self.model.nodal_groups:
                from crashsolve.model.contact.node_to_surface import make_room

                make_room(self.model.nodal_groups)
            self.bind()
        else:
            raise diagnose(self.model, s, self.clock, s.ledger)

    def _next_corner(self, until: float) -> float:
        """Time of the next corner of a curve of time [s]; infinite where there is none."""
        if not len(self._corners):
            return inf
        step = min(float(self.clock.next_step), self._least_piece)
        near = max(STAGNATION_RATIO * step, ROUND_OFF * abs(until))
        at = int(np.searchsorted(self._corners, float(self.clock.time) + near, side="right"))
        if at == len(self._corners):
            return inf
        corner = float(self._corners[at])
        # one that a sample lies on to the last digits is met with it
        return until if abs(corner - until) <= near else corner

    def _is_free_of_curves(self) -> bool:
        """Whether no curve of time bounds steps: a stated one, where it is short enough for all."""
        if not len(self._curve_steps):
            return True
        control = self.model.control[0]
        steps = self._curve_steps * float(control["curve_share"])
        return bool(steps.min(initial=inf) >= (float(control["fixed_step"]) or inf))

    def _next_curve_step(self, goal: float) -> float:
        """Time [s] until which one bound by curves of time holds; `goal` where no step is shorter.
        Writes: control, clock.
        """
        control, clock, starts = self.model.control[0], self.state.clock[0], self._curve_starts
        if self._is_free_of_curves():
            return inf
        now = float(clock["time"])
        steps = self._curve_steps * (float(control["curve_share"]) * self._stage_fraction)
        at = max(int(np.searchsorted(starts, now, side="right")) - 1, 0)
        if control["fixed_step"] > 0.0:
            # the remaining time, but for round-off, is one step
            is_cut = steps[at] < min(control["fixed_step"], (1.0 - STAGNATION_RATIO) * (goal - now))
            return now + float(steps[at]) if is_cut else inf
        last = int(np.searchsorted(starts, goal, side="left"))
        if steps[at:last].min(initial=inf) >= goal - now:
            control["curve_step"] = inf
            return inf
        control["curve_step"] = steps[at]
        if clock["next_step"] > 0.0:
            clock["next_step"] = min(clock["next_step"], steps[at])
        if last <= at + 1:
            return inf
        change = float(starts[at + 1])
        return change if change - now > ROUND_OFF * abs(goal) else inf

    def _renew_after_corner(self) -> None:
        """Renew forces after a step that ends at a corner, for methods that reuse them."""
        if self.has_stages:
            self._renew_forces()
        self.state.clock[0]["kinked"] = 1

    def _renew_forces(self) -> None:
        """Evaluate the forces at the present time, with which the next step begins, again."""
        clock = self.state.clock[0]
        step = float(clock["step"])
        self._advance(clock["time"], True, self._present)
        clock["step"] = step

    def _call(self, until: float) -> int:
        """One call of the compiled loop, of about LONGEST_CALL at most; returns its status."""
        return self.within_pause(lambda: self._advance(until, False, self._present))

    def within_pause(self, act: Callable[[], None]) -> int:
        """Call the compiled loop, for LONGEST_CALL at most or `_stride` steps; its status."""
        clock, begun = self.state.clock[0], monotonic()
        self._pause = int(clock["cycle"]) + (self._stride or self._steps_per_call) - self._done
        clock["pause"], self._done = self._pause, 0
        act()
        # no trace of how long it took may reach a dump
        clock["pause"] = 0
        spent = monotonic() - begun
        if self._stride:
            return int(clock["status"])
        if spent > LONGEST_CALL or clock["status"] == PAUSED:
            share = min(max(0.5 * LONGEST_CALL / max(spent, 1e-6), 0.5), 1e3)
            self._steps_per_call = max(int(self._steps_per_call * share), 1)
        return int(clock["status"])

    def sample(self, time: float | None = None) -> None:
        """Outputs and energies now, or at a time [s] in the last step. Raises SolverError."""
        for now, copy in self.copied:
            copy[:] = now
        clock = self.sample_clock[0]
        points = self.state.points
        # dampers push by a predicted velocity in a step, by the present one in a sample
        names = ("force", "torque") if self.model.nodal_groups else ()
        forces = {name: points[name].copy() for name in names}
        self._advance(clock["time"] if time is None else time, True, self._sampled)
        for name, kept in forces.items():
            points[name] = kept
        self.state.clock[0]["sampled"] = clock["time"]
        self._check_pass_through()
        is_stopped = clock["status"] in STOPS_AT_SAMPLE
        is_checked = clock["cycle"] >= FIRST_CHECKED
        if is_stopped or (is_checked and energy.is_spurious_energy(self.ledger, self._limit)):
            raise diagnose(self.model, self.state, clock, self.ledger)
        self.state.ledger[energy.LARGEST] = self.ledger[energy.LARGEST]
        for name in MISSING:
            self.state.clock[0][name] = clock[name]

    def sample_of(self, nodes: np.ndarray) -> None:
        """A sample of other positions and velocities, at present; the run is as before."""
        copy_rows(nodes, self.nodes)
        copy_rows(self.state.rows, self.rows)
        copy_rows(self.state.ledger, self.ledger)
        copy_rows(self.state.clock, self.sample_clock)
        self.sample_clock[0]["factored"] = 0.0
        self._advance(self.sample_clock[0]["time"], True, self._sampled)

    def probing(self, arrays: dict[str, np.ndarray]) -> Tables:
        """Tables of this scene for `probe`, of copies of its arrays."""
        return Tables(arrays | ({"leader": arrays["clock"]} if is_shared(self.model) else {}))

    def probe(self, tables: Tables, arrays: dict[str, np.ndarray]) -> None:
        """A sample of tables, some arrays of which, and the clock, are others. Writes: arrays."""
        leader = {"leader": arrays["clock"]} if is_shared(self.model) else {}
        time = float(arrays["clock"][0]["time"])
        arrays["clock"][0]["factored"] = 0.0
        self._advance(time, True, tables.replaced(arrays | leader))

    def after_restore(self) -> None:
        """Called when a dump or a copy of the State has been restored."""

    def finish(self) -> None:
        """Judge the balance of the whole run, however few its steps. Raises SolverError."""
        self._check_pass_through()
        broken = broken_joints(self.model, self.state)
        if broken is not None:
            raise broken
        if energy.is_broken(self.ledger, self._limit):
            raise diagnose(self.model, self.state, self.clock, self.ledger)

    def _check_pass_through(self) -> None:
        """Raises SolverError where a body has passed the middle of a struck body."""
        passed = passed_through(self.model, self.state)
        if passed is not None:
            raise passed

    def step_warnings(self) -> list[str]:
        """Signs that the step is too long for the forces of joints, which have no stiffness."""
        from crashsolve.system.joint_balance import joint_warnings

        warnings = self._balance_warnings() + swing_warnings(self.clock, self.model.bodies)
        warnings += joint_warnings(self.model, self.state)
        cycles = int(self.clock["cycle"])
        iterations = int(self.clock["iterations"]) / max(cycles, 1)
        if self.model.integrator != "rattle" or iterations <= MANY_ITERATIONS:
            return warnings
        return [
            *warnings,
            f"the joints took {iterations:.1f} iterations per step: the step may be too long for "
            "their forces; halve control.step or control.step_max, and compare the results",
        ]

    def _balance_warnings(self) -> list[str]:
        """Warning that the energy balance was above its limit, by more than a negligible energy."""
        clock, largest = self.clock, float(self.ledger[energy.LARGEST])
        if float(clock["missing"]) <= NEGLIGIBLE_SHARE * self._limit * largest:
            return []
        return [
            f"at t = {float(clock['missing_time']):.6g} s the energy balance was off by "
            f"{100 * float(clock['missing_share']):.3g} % of the largest energy by then, more than "
            f"control.energy_limit, {100 * self._limit:.3g} %; compare the results with those of a "
            "shorter step"
        ]

    def assembly_errors(self) -> list[tuple[str, str]]:
        """Joints that the initial configuration or velocity violates: (joint, cause)."""
        rows, errors = self.state.rows, []
        gap = np.abs(rows["phi"]) / rows["scale"]
        speed = velocity_error(self.model, self.state)
        nodes = self.state.nodes
        fastest = max(np.abs(nodes["v"]).max(), self.model.size * np.abs(nodes["w"]).max())
        # a model at rest may begin with the round-off of a curve's slope
        scale = max(float(fastest), 1e-3)
        for joint in self.model.joints:
            part = slice(joint.first_row, joint.first_row + joint.rows)
            if gap[part].max() > ASSEMBLY:
                worst = np.abs(rows["phi"][part]).max()
                violation = f"is violated by the initial positions: {worst:.3g} (SI)"
                errors.append((joint.name, violation))
            elif (speed[part] / rows["scale"][part]).max() > ASSEMBLY * scale / self.model.size:
                worst = speed[part].max()
                violation = f"is violated by the initial velocities: {worst:.3g} (SI)"
                errors.append((joint.name, violation))
        return errors
