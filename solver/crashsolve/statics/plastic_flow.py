"""Segments that yield in quasi-static solutions: how a correction of Newton's method is taken.

A correction rotates the bodies of a stiff chain, and so stretches it by the squares of their
rotations. Elastic segments return from that in the next iterations; those that yield follow it, and
the iteration diverges. So the flow over a correction is found to first order, where rotations
stretch nothing, and kept, while some elastic iterations bring the chain back together. The law
itself is evaluated again in the next pass, and in the equilibrium.
"""

import numpy as np

from crashsolve.model.checks.statics import follows_load_steps
from crashsolve.model.model import Group
from crashsolve.springs._segment_yield import FLOWS, FROZEN
from crashsolve.statics.equations import Equations

# elastic iterations at most, and the correction that ends them, over that which they follow
ITERATIONS, CONVERGED = 6, 1e-3
# a mechanism that flows is not followed by so small a share of a correction
LOST = 1e-2
# corrections below this stretch nothing, in the model's size or rad
NEAR = 1e-5


class PlasticFlow:
    """The segments of a quasi-static run."""

    def __init__(self, groups: list[Group]) -> None:
        self.groups = [g for g in groups if follows_load_steps(g)]

    def is_diverging(self, step_fraction: float) -> bool:
        """Whether the iteration diverges: only this fraction of a correction is allowed."""
        return bool(self.groups) and step_fraction < LOST

    def state(self, group: Group, current: int) -> np.ndarray:
        """History of a group: the accepted one, or that of the present correction."""
        is_frozen = group in self.groups and bool((group.parameters["at_rest"] == FROZEN).any())
        return group.history[1 - current if is_frozen else current]

    def predicted(self, engine: Equations, time: float) -> float:
        """Time [s] a little after the first yield of a segment, by the tangent; at most `time`.

        A step far beyond yield would find a chain of segments that all flow: a mechanism.
        """
        change = engine.correction(time, engine.known_tangent)
        if not np.isfinite(change).all():
            return time
        start_time, step_fraction = float(engine.clock.time), engine.step_fraction(change)
        whole, current = (
            self._of_all_nodes(engine, step_fraction * change),
            int(engine.clock.current),
        )
        nodes, curves = engine.state.nodes, engine.yielding.curves()
        fraction = min(
            g.module.load_factor_to_yield(g.parameters, g.history[current], nodes, whole, curves)
            for g in self.groups
        )
        return (
            start_time + step_fraction * fraction * (time - start_time) if fraction < 1.0 else time
        )

    def _of_all_nodes(self, engine: Equations, change: np.ndarray) -> np.ndarray:
        """Displacements and rotations (N, 6) of all nodes from those (n, 6) of the free ones."""
        whole = np.zeros((len(engine.state.nodes), 6))
        whole[engine.free] = change
        return whole

    def take(self, engine: Equations, time: float, change: np.ndarray) -> None:
        """Move by a correction (n, 6) of the free nodes. Writes: the State."""
        nodes, size = engine.state.nodes, engine.size_of(change)
        if not self.groups or size < NEAR:
            engine.shift(nodes, change)
            return
        current, saved = int(engine.clock.current), engine.tangent
        whole = self._of_all_nodes(engine, change)
        for g in self.groups:
            p, old, new = g.parameters, g.history[current], g.history[1 - current]
            g.module.predict(p, old, new, nodes, whole, engine.yielding.curves())
            p["at_rest"] = FROZEN
        engine.shift(nodes, change)
        for _ in range(ITERATIONS):
            more = engine.correction(time)
            if not np.isfinite(more).all():
                break
            engine.shift(nodes, more * engine.step_fraction(more))
            if engine.size_of(more) < CONVERGED * size:
                break
        for g in self.groups:
            g.parameters["at_rest"] = FLOWS
        engine.tangent = saved
