"""Quasi-static solution of what remembers its way: implicit steps from rest, until nothing moves.

    2 M / h^2 delta = g(q + delta)         generalized-alpha, spectral radius 0, v = 0 at its start

A step leaves 1 / (1 + (omega h)^2 / 2) of what is missing to the equilibrium of its load in a
vibration of frequency omega: few are enough where the load step h is long beside the vibrations.
Inertia holds what no stiffness does, as some spins of the nodes of a shell about its normal.
Elements of shells and fibre beams strain on the way from equilibrium to equilibrium, as what yields
must. Consequence to
test: work of the loads is the energy stored.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.model.clock import PAUSED, REACHED
from crashsolve.system.diagnosis import diagnose
from crashsolve.system.equilibrium import StaticEngine

# steps for one load; what needs more is slower than the load, or moves freely
REPEATS = 60
STILL = ("v", "w", "L", "force", "torque", "joint_force", "joint_torque", "external")


class RestEngine(StaticEngine):
    """Goes from equilibrium to equilibrium by steps from rest."""

    def _step(self, until: float, goal: float) -> None:
        """Equilibrium at `until`. Raises SolverError."""
        begun, clock = float(self.clock.time), self.clock
        self.model.control[0]["fixed_step"] = clock.next_step = until - begun
        for repeat in range(REPEATS):
            clock.time, clock.factored = begun, clock.factored if repeat else 0.0
            clock.value, pieces = self._go(begun, until)
            # a step cut short moves little wherever it is
            if clock.value <= self.tolerance and pieces == 1:
                return
        raise self._lost()

    def _go(self, begun: float, until: float) -> tuple[float, int]:
        """From rest, `begun` to `until`: the way, over the model's size or rad, and its steps."""
        clock, whole, pieces = self.clock, self.state.nodes.copy(), 0
        while clock.time < until:
            pieces += 1
            start = self.state.nodes.copy()
            spent = [g.history[clock.current].copy() for g in self._loads()]
            clock.kinked, clock.pause = 1, clock.cycle + 1
            self._advance(until, False, self._present)
            clock.pause = 0
            if clock.status not in (PAUSED, REACHED):
                raise diagnose(self.model, self.state, clock, self.state.ledger)
            self._count_work(start, (begun, until), spent)
            for name in STILL:
                self.state.nodes[name] = 0.0
            self.on_pause()
        way = self._way_from(whole)
        size = max(np.abs(way[:, :3]).max() / self.model.size, np.abs(way[:, 3:]).max())
        return float(size), pieces

    def _count_work(
        self, start: np.ndarray, times: tuple[float, float], spent: list[np.ndarray]
    ) -> None:
        """Work of the loads on the way of a step, in the place of what its velocities tell.

        It is that of the mean of the loads before and after the load step, on all of the way.
        """
        clock, span = self.clock, float(self.clock.step)
        way = self._way_from(start) / span
        kept = [g.history[clock.current].copy() for g in self._loads()]
        first, last = self._powers(times[0], start, way), self._powers(times[1], None, way)
        for g, old, new in zip(self._loads(), spent, kept, strict=True):
            told = 0.5 * span * (old["power"] + new["power"])
            work = 0.5 * span * (first[g.word] + last[g.word])
            new["dissipated"] += work - told
            g.history[clock.current] = new

    def _lost(self) -> SolverError:
        """Still moving."""
        clock = self.clock
        cause = f"no equilibrium in {REPEATS} steps from rest (last way {float(clock.value):.2g})"
        advice = (
            "hold what can move freely; let loads rise in a longer time, beside which vibrations "
            "are short; where a structure snaps through, say solution: transient with damping"
        )
        return SolverError(float(clock.time), int(clock.cycle), "the model", cause, advice)
