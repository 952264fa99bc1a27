"""Quasi-static solution of path-dependent laws: steps from rest, until forces are in balance.

    2 M / h^2 delta = g(q + delta)         h is not a time, but sets how little inertia may restrain

One step leaves 1 / (1 + (omega h)^2 / 2) of the distance to equilibrium in a vibration of frequency
omega (`integrators/_rest_stage.py`), so the displacements of two steps give the rest after
them. h begins at so many periods of the fastest vibration, and grows where steps converge slowly;
it does not depend on the time of the run. Inertia restrains motions without stiffness, as some
spins of the nodes of a shell about its normal. Elements of shells and fibre beams strain along the
path from equilibrium to equilibrium, as plasticity requires. Consequence to test: the answer does
not depend on end_time.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

from math import sqrt

import numpy as np

from crashsolve.deck.keywords import SECTIONS
from crashsolve.deck.run_cards.control import Control
from crashsolve.model.clock import (
    CURVE_END,
    NOT_FINITE,
    PAUSED,
    REACHED,
    STEP_TOO_SMALL,
    TOUCHED,
    UNSOLVED,
)
from crashsolve.model.model import Group, Model, State
from crashsolve.statics.balance import EQUAL, ROUND
from crashsolve.statics.equilibrium import NEGLIGIBLE, STAGNATION_TOLERANCE, STEP, StaticEngine
from crashsolve.statics.motions import perturb
from crashsolve.statics.stability import mass_matrix, unstable_mode, unstable_modes
from crashsolve.system.diagnosis import diagnose

# most steps for one load; a model that needs more can move freely
REPEATS = 150
# so many of them in succession, each of which leaves so much of the residual: all 150 would leave
# 86 % of it, as where nothing holds what moves
VAIN_REPEATS, VAIN = 20, 0.999
# h over 1 / omega of the fastest vibration: at first, at most, and how it grows
FIRST, LONGEST, GROWTH = 1e3, 1e8, 32.0
# the same where unstable modes are looked for
FOR_STABILITY = 1e7
# residual that a step may leave, of the distance to equilibrium
SLOW, UNKNOWN = 0.1, 0.9
# how h grows where Newton's method has failed
CAUTIOUS_GROWTH, RELAXATION = 4.0, 1.2
# h over 1 / omega where corrections that go too far are shortened: with more inertia a step from
# rest ends far from equilibrium, and the plastic flow on that detour remains; with less the nodes
# between two elements that flow spin freely
SHORTENED_START = FIRST * GROWTH**2
# load steps after which one of twice the length is tried
STEPS_BEFORE_GROWTH = 5
# first yield may lie so many halvings within a load step
HALVINGS = 13
STILL = ("v", "w", "L")
# loads and joints that a warning names
NAMED = 3


class RestEngine(StaticEngine):
    """Goes from equilibrium to equilibrium by steps from rest."""

    def __init__(self, model: Model, state: State, control: Control, program: str = "") -> None:
        super().__init__(model, state, control, program)
        # elements that yield load by one tangent and unload by another
        self.checks_limit_points, self.halvings = False, HALVINGS
        self.shortens_corrections = False  # whether corrections that go too far are shortened
        self.highest_frequency = self.pseudo = 0.0
        self.good_steps = 0
        message = warning_of_rotating_loads(model.groups)
        if message:
            self.notes.append(message)

    def _solve_at(self, time: float) -> float | None:
        """Step from rest to the equilibrium at a time [s]; returns it, None without convergence."""
        clock, nodes = self.clock, self.state.nodes
        start_time, start, previous = float(clock.time), nodes.copy(), np.inf
        growth, highest, last_good, cycle = GROWTH, LONGEST, 0.0, int(clock.cycle)
        self.free_motion, left_before, in_vain = "", np.inf, 0
        self.forces.include(self.forces_at_rest(time, nodes), self)
        self._set_first_step()
        first = self.pseudo
        # a longer load step is tried after some that were good
        self.good_steps += 1
        self.growth = 2.0 if self.good_steps % STEPS_BEFORE_GROWTH == 0 else 1.0
        for _ in range(REPEATS):
            self.on_iteration()
            saved = self.save_state()
            if not self._relax(start_time, time):
                self.restore_state(saved)
                if self.shortens_corrections:
                    # the load step is too long
                    break
                # too far for Newton's method: more inertia, and less at a time
                self.pseudo = last_good if last_good else self.pseudo / GROWTH
                ratio = self.pseudo * self.highest_frequency
                growth, highest = CAUTIOUS_GROWTH, ratio * (1.0 if last_good else GROWTH)
                if ratio < 0.5 * FIRST:
                    # more inertia would leave all of the motion to the elements beside a driver;
                    # the load step is too long
                    break
                continue
            used = self.pseudo
            change, total = self.size_of(self.change_from(saved[1])), self._largest_change(start)
            # one step alone does not show it
            is_known = 0.0 < previous < np.inf
            left = min(change / previous, UNKNOWN) if is_known else UNKNOWN * (change > 0.0)
            is_balanced = self._is_balanced_at(time, change, left, total)
            # a load step counts as one
            clock.cycle, clock.value = cycle + 1, change
            if is_balanced:
                return time
            out_of_balance = self.forces.share_left()
            in_vain = in_vain + 1 if out_of_balance >= VAIN * left_before else 0
            left_before = out_of_balance
            if in_vain == VAIN_REPEATS:
                self.free_motion = self._fastest(saved[1])
                break
            if (
                (left > SLOW or change == 0.0)
                and previous < np.inf
                and not self.shortens_corrections
            ):
                self.pseudo = min(self.pseudo * growth, highest / self.highest_frequency)
            # a step that failed far from equilibrium may converge near it
            highest, last_good, previous = min(highest * RELAXATION, LONGEST), used, change
        self.pseudo = (
            max(first, SHORTENED_START / self.highest_frequency)
            if self.shortens_corrections
            else first
        )
        return None

    def _is_balanced_at(self, time: float, change: float, left: float, total: float) -> bool:
        """Whether forces are in balance at a time [s], and the step has moved little.

        `change` of the step, `total` of the load step, and `left`, the rate of convergence [1].
        """
        g = self.forces_at_rest(time, self.state.nodes)
        self.forces.include_reactions(self)
        balance, is_longest = self.forces.balance(g, self._round_off()), self._is_longest_step()
        is_small = change * left <= self.tolerance * total * (1.0 - left) + NEGLIGIBLE
        if is_small and (balance == EQUAL or (balance == ROUND and is_longest)):
            return True
        stagnates = left > SLOW and change <= STAGNATION_TOLERANCE * total / SLOW
        return is_longest and bool(balance) and stagnates

    def _fastest(self, start: np.ndarray) -> str:
        """Name of the node that has moved most since a configuration."""
        change = np.abs(self.change_from(start)) / [*3 * [self.model.size], *3 * [1.0]]
        return self.name_of(int(self.free[change.max(axis=1).argmax()]))

    def _is_longest_step(self) -> bool:
        """Whether h has reached its largest value."""
        return self.pseudo >= 0.5 * LONGEST / self.highest_frequency

    def _set_first_step(self) -> None:
        """Set h from the highest frequency of elements and springs. Writes: self."""
        if self.pseudo:
            return
        springs = float(self.nodes["stiffness"][1:].max(initial=0.0))
        self.highest_frequency = sqrt(max(float(self.sampled.element_rate), 2.0 * springs, 1e-300))
        self.pseudo = FIRST / self.highest_frequency

    def _relax(self, start_time: float, time: float) -> bool:
        """Take one step from rest under the loads of a time; whether its iteration converges.

        Where full corrections diverge, shortened ones are tried, and used from then on.
        """
        saved, pseudo = self.save_state(), self.pseudo
        is_found = self._iterate(start_time, time)
        if is_found or self.shortens_corrections:
            return is_found
        self.restore_state(saved)
        self.shortens_corrections, self.pseudo = (
            True,
            max(pseudo, SHORTENED_START / self.highest_frequency),
        )
        if self._iterate(start_time, time):
            return True
        self.shortens_corrections, self.pseudo = False, pseudo
        return False

    def _iterate(self, start_time: float, time: float) -> bool:
        """One such step with full or shortened corrections."""
        clock, control = self.clock, self.model.control[0]
        impulses = clock.impulse.copy(), clock.angular_impulse.copy()
        clock.time, clock.kinked, clock.factored = 0.0, 1, 0.0
        clock.goal = self.loading.time(time)
        control["fixed_step"] = control["step_min"] = clock.next_step = self.pseudo
        control["searches"] = self.shortens_corrections
        clock.pause = clock.cycle + 1
        self.loading.set_time(time)
        self._advance(self.pseudo, False, self._present)
        clock.pause, clock.time = 0, start_time
        clock.impulse, clock.angular_impulse = impulses
        if clock.status == CURVE_END:
            raise diagnose(self.model, self.state, clock, self.state.ledger)
        for name in STILL:
            self.state.nodes[name] = 0.0
        if clock.status in (UNSOLVED, STEP_TOO_SMALL, NOT_FINITE):
            clock.rejected += 1
            return False
        assert clock.status in (PAUSED, REACHED, TOUCHED)
        if clock.status == TOUCHED:
            self.masses.find(self.state)
        return True

    def _round_off(self) -> tuple[float, float]:
        """Forces and moments [N, N m] by round-off of positions, over epsilon."""
        columns = self.tableau["columns_0"]
        diagonal = columns["pivot"][columns["node"] > 0] / (0.5 * self.pseudo**2)
        stiff, warning_of_rotating_loads = diagonal[:, :3].max(), diagonal[:, 3:].max()
        size = self.model.size
        return stiff * size, warning_of_rotating_loads + sqrt(
            stiff * warning_of_rotating_loads
        ) * size

    def _unstable(self) -> str:
        """Name of the node that leaves the equilibrium; empty where it is stable.

        A step with hardly any inertia, which would hide an unstable mode, shows the pivots.
        """
        now = float(self.clock.time)
        location = self._unstable_bodies(now)
        if location:
            return location
        saved, pseudo = self.save_state(), self.pseudo
        self.pseudo = FOR_STABILITY / self.highest_frequency
        self._iterate(now, now)
        self.pseudo = pseudo
        self.restore_state(saved)
        count, node = unstable_modes(self.tableau["columns_0"])
        return self.name_of(node) if count > 0 else ""

    def _unstable_bodies(self, now: float) -> str:
        """Name of the body that leaves the equilibrium, with elements at rest; empty where none
        does.
        """
        element_nodes = (
            set(self.model.elements.attached_points["node"].tolist())
            if self.model.elements
            else set()
        )
        for g in self.model.groups:
            if g.keyword == "parts" and "node_a" in (g.parameters.dtype.names or ()):
                element_nodes |= set(g.parameters["node_a"].tolist())
                element_nodes |= set(g.parameters["node_b"].tolist())
        own = np.flatnonzero(~np.isin(self.free, list(element_nodes)))
        if not len(own):
            return ""
        imbalance, D, _ = self.imbalance(now)
        columns, nodes = [], self.state.nodes.copy()
        for k in range(6 * len(own)):
            i, size = int(self.free[own[k // 6]]), STEP * (self.model.size if k % 6 < 3 else 1.0)
            saved = nodes[i].copy()
            perturb(nodes[i], k % 6, size)
            columns.append((imbalance - self.forces_at_rest(now, nodes)) / size)
            nodes[i] = saved
        at = (6 * own[:, None] + np.arange(6)).ravel()
        mode, _ = unstable_mode(
            np.array(columns).T[at],
            D[:, at],
            mass_matrix(self.state.nodes[self.free])[np.ix_(at, at)],
        )
        if mode is None:
            return ""
        return self.name_of(int(self.free[own[np.abs(mode).argmax() // 6]]))


def warning_of_rotating_loads(groups: list[Group]) -> str | None:
    """Warning of rotating loads that the check of stability leaves out; None without any."""
    names = [name for g in groups for name in _rotating(g)]
    if not names:
        return None
    listed = ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" * (len(names) > NAMED))
    return (
        f"{listed}: these are follower loads, or joints whose forces have a lever arm to a mass "
        "centre. Equilibria take them into account in full; the check for stability of shells and "
        "fibre beams leaves out that their forces and moments change with rotation, so that "
        "buckling or flutter may be missed, or found at another load. To be sure, hold the load "
        "constant in solution: transient, disturb the structure a little and see whether it comes "
        "to rest there"
    )


def _rotating(group: Group) -> list[str]:
    """Names of follower loads, and of joints whose forces have a lever arm."""
    p = group.parameters
    names = set(p.dtype.names or ())
    rotates = np.zeros(len(p), bool)
    if hasattr(group.module, "CONSTRAINTS"):
        for side in "ab":
            if f"point_{side}" in names:
                rotates |= (p[f"point_{side}"] != 0.0).any(axis=1) & (p[f"node_{side}"] > 0)
    elif hasattr(group.module, "AMPLITUDE"):
        if "rotates" in names:
            rotates |= p["rotates"] != 0
        # of a pressure, along the normals of the elements
        rotates |= hasattr(group.module, "load_elements")
    word = SECTIONS[group.keyword].singular
    return [f"{word} '{group.names[i]}'" for i in np.flatnonzero(rotates)]
