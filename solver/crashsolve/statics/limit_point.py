"""Whether a load step has passed a limit point, and found an equilibrium far beyond it.

Along a path of equilibria the change of configuration lies between those that the tangents at both
ends give for the change of the load, in steps that are short enough. An equilibrium beyond a limit
point is farther away than both say, or the way back leads elsewhere: under the load of the start,
from the equilibrium found, to another one than the start. Consequence to test: Williams' toggle
stops at its limit load, with any number of load steps.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures 1, ch. 9.
"""

from typing import Protocol

import numpy as np

from crashsolve.model import ledger as energy
from crashsolve.statics.equations import CurvesOfLaws, Equations, YieldingElements

# over the value by both tangents, beyond which a change of configuration has left the path; and
# share of the value by the first of them, below which the load step is examined in halves
FAR, APART = 1.1, 1.5
# a change that is nothing but round-off, in the model's size or rad
NEGLIGIBLE = 1e-12
# a load step that misses less energy than this share of the exchanged energy has not jumped by more
# than a few percent of its displacement: no way back is looked for, which costs as much again
WHOLE = 1e-3
# entries of the energy balance that a load step moves
EXCHANGED = [*energy.MECHANICAL, energy.EXTERNAL_WORK, energy.DRIVER_WORK]
# distance from where the way back ends to the start, over the change, of two equilibria
ELSEWHERE = 0.1

# compliance over the least so far, beyond which a load step that finds no equilibrium is at a limit
# point: towards that it grows as 1 / sqrt(1 - load / limit load), to ten times where the load steps
# are halved to a hundredth of the load
SOFT = 4.0


class Softening:
    """Compliance of the last tangent, and the least so far [1/N]."""

    def __init__(self) -> None:
        self.last, self.least = 0.0, np.inf

    def record(self, change: float, force: float) -> None:
        """Record the change of configuration by a tangent, and the force that causes it [N]."""
        self.last = change / force if force > 0.0 else 0.0
        if self.last > 0.0:
            self.least = min(self.least, self.last)


class LoadSteps(Protocol):
    """Attributes of an engine that takes load steps."""

    checks_limit_points: bool
    softening: Softening

    @property
    def yielding(self) -> CurvesOfLaws: ...
    @property
    def plastic_flow(self) -> YieldingElements: ...


def is_at_limit_point(engine: LoadSteps) -> bool:
    """Whether the last tangent is so soft that the load can hardly rise.

    Of laws that yield nothing is said, nor of equilibria found by motion.
    """
    if engine.yielding.groups or engine.plastic_flow.groups or not engine.checks_limit_points:
        return False
    return bool(engine.softening.last > SOFT * engine.softening.least)


def exchanged(change: np.ndarray) -> float:
    """Largest energy that a load step moves [J], not zero, of changes of the energy balance."""
    return max(float(np.abs(change)[EXCHANGED].max()), 1e-300)


def passes_limit_point(
    engine: Equations, start: np.ndarray, start_time: float, target: float, missing: float
) -> bool:
    """Whether the equilibria at both moments [s] are no neighbours; `start` are the nodes at first,
    `missing` the share of the energy exchanged between both that is not accounted for.

    Laws that yield are not judged: a tangent of loading is not one of unloading.
    """
    if engine.yielding.groups or engine.plastic_flow.groups or start_time < engine.loading.start:
        return False
    change, forward = engine.size_of(engine.change_from(start)), engine.first
    if forward > APART * change + NEGLIGIBLE and target - start_time > 2.0 * engine.least:
        # near a limit point the tangent of the lower equilibrium overestimates the change
        return True
    if change <= FAR * forward + NEGLIGIBLE:
        return missing > WHOLE and _ends_elsewhere(engine, start, start_time, target, change)
    tangent = engine.tangent
    backward = engine.size_of(engine.correction(start_time))
    # as it was: loads of the target, and its tangent
    engine.imbalance(target)
    engine.tangent = tangent
    if change > FAR * max(forward, backward):
        return True
    return missing > WHOLE and _ends_elsewhere(engine, start, start_time, target, change)


def _ends_elsewhere(
    engine: Equations, start: np.ndarray, start_time: float, target: float, change: float
) -> bool:
    """Whether the way back from an equilibrium ends far from the nodes where it began."""
    saved, tangent, first = engine.state.nodes.copy(), engine.tangent, engine.first
    is_found = bool(engine.iterate(start_time))
    rest = engine.size_of(engine.change_from(start))
    engine.state.nodes[:] = saved
    engine.imbalance(target)
    engine.tangent, engine.first = tangent, first
    return is_found and rest > ELSEWHERE * change + NEGLIGIBLE
