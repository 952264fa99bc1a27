"""Which hinges flow on from a corner of the law of one of them: the others unload.

    f = q - M lambda <= 0,   lambda >= 0,   f . lambda = 0
    M_ij = (k_i + y_i') delta_ij - k_i s_i d_i . u_j,   q_i = k_i s_i d_i . u_0

lambda are the plastic displacements of all hinges that stand at yield, s their directions, d their
rows, y' the slopes of their laws ahead; u_0 is the elastic answer to the load step, u_j that to a
unit of lambda_j. Behind the peak of a hinge another one that still hardens may have to unload: then
both tangents that the last step knew of them are wrong. Where several sets of hinges can flow, the
one of least second-order work is the path that is stable; two that are alike are a fork, and
the model does not determine which is taken. Consequence to test: a hinge unloads at its elastic
stiffness behind the peak of another in series.

References: Maier (1969), Int. J. Solids Struct. 5, 261-276 (linear complementarity); Bazant and
Cedolin (1991), Stability of Structures, 10.2 (the stable path).
"""

from itertools import combinations
from types import SimpleNamespace

import numpy as np

from crashsolve.hinges._law import line_origin, resistance
from crashsolve.statics.elimination import eliminate
from crashsolve.statics.equations import Equations

# a hinge is at yield so near to it, of its moment; the slope ahead is that so far ahead, of its
# elastic range: corners are met to CLOSE of a load step, and slopes change at corners alone
NEAR = 1e-6
# more sets than two to this power are not tried
MAX_CANDIDATES = 10
# works and displacements that differ by less are alike
EQUALITY_TOLERANCE = 1e-6
Set = tuple[int, ...]


class Candidate:
    """A motion of a hinge that stands at yield: its row d (n,), k, direction and slope ahead."""

    def __init__(self, name: str, d: np.ndarray, k: float, side: float, slope: float) -> None:
        self.name, self.d, self.k, self.side, self.slope = name, d, k, side, slope


class Branches:
    """Sets of hinges that can continue to yield over a load step from an accepted state."""

    def __init__(self, engine: Equations, candidates: list[Candidate], time: float) -> None:
        self.candidates = candidates
        self.sets: list[tuple[float, Set, np.ndarray]] = []
        if not 0 < len(self.candidates) <= MAX_CANDIDATES:
            return
        g, self.D, phi = engine.imbalance(time)
        self.elastic = engine.elastic_tangent(time, g, self.D)
        A, push = engine.bordered(self.elastic, g, self.D, phi)
        self.pushes = [
            engine.condense((c.k * c.side * c.d)[:, None], self.D)[:, 0] for c in self.candidates
        ]
        u = eliminate(A, np.column_stack([push, *(-p for p in self.pushes)]))
        rows = np.array([c.k * c.side * c.d for c in self.candidates])
        f = rows @ u
        if np.isfinite(f).all():
            self._solve(np.diag([c.k + c.slope for c in self.candidates]) - f[:, 1:], f[:, 0])

    def _solve(self, M: np.ndarray, q: np.ndarray) -> None:
        """Find all sets that satisfy the conditions, that of least work first. Writes: sets."""
        m = len(q)
        nothing = NEAR * np.abs(q).max(initial=0.0)
        for size in range(m + 1):
            for own in map(list, combinations(range(m), size)):
                displacements = np.zeros(m)
                if size:
                    displacements[own] = eliminate(M[np.ix_(own, own)].copy(), q[own].copy())
                if (displacements[own] > 0.0).all() and (q - M @ displacements <= nothing).all():
                    self.sets.append((-0.5 * float(q @ displacements), tuple(own), displacements))
        self.sets.sort(key=lambda candidates: candidates[0])

    def tangent(self) -> tuple[np.ndarray, np.ndarray] | None:
        """K and D with the set of least work yielding; None without any set."""
        if not self.sets:
            return None
        columns = self.elastic.copy()
        for i in self.sets[0][1]:
            c = self.candidates[i]
            columns += np.multiply.outer(self.pushes[i], c.side * c.k / (c.k + c.slope) * c.d)
        return -columns, self.D

    def bifurcation(self) -> list[str]:
        """Names of hinges any of which may yield while the others unload; [] where it is unique."""
        if len(self.sets) < 2:
            return []
        (work, first, displacements), *others = self.sets
        names = set()
        for more, own, other in others:
            is_as_good = abs(more - work) <= EQUALITY_TOLERANCE * abs(work)
            if (
                is_as_good
                and np.abs(other - displacements).max()
                > EQUALITY_TOLERANCE * np.abs(displacements).max()
            ):
                names |= {self.candidates[i].name for i in {*first} ^ {*own}}
        return sorted(names)


def slope_ahead(
    p: SimpleNamespace, state: SimpleNamespace, c: int, side: float, curves: list[SimpleNamespace]
) -> float | None:
    """Slope y' [N/m or N m/rad] of a law at yield in a direction; None where it does not yield."""
    k = p.stiffness[c]
    force, origin = side * k * (state.x[c] - state.plastic[c]), line_origin(p, state, c, side)
    R, _ = resistance(p, state, c, side, 0.0, origin, curves)
    if not (R > 0.0 and abs(force - R) <= NEAR * R):
        return None
    _, slope = resistance(p, state, c, side, NEAR * R / k, origin, curves)
    return float(slope)
