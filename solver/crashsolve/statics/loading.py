"""Loads and prescribed motions at a moment of a quasi-static run.

    f = s f_0,   s from 0 to 1 before the start      of a load without a curve of its own

What acts from the start has to come from somewhere: before the first moment of the run such loads
rise from nothing, so that the model settles to the equilibrium in which the run begins. Moments
before `start`, down to `start` - 1, are that rise: s is the part beyond `start` - 1. A driver moves
from configuration to configuration and has no rate: between them its curve stands still, so that
nothing in the step sees f' or f''. Consequence to test: work of the loads is the energy stored,
gravity included.
"""

from math import ceil
from types import ModuleType

import numpy as np

from crashsolve.foundation.curve import HOLD, LINEAR, POINT
from crashsolve.foundation.errors import SolverError
from crashsolve.model.model import Group, Model

# of a load step: a remainder below this is joined to the last one
NEGLIGIBLE = 1e-6


def equal_part(start_time: float, until: float, longest: float) -> float:
    """End of the first of equal parts of an interval, each at most `longest`."""
    parts = ceil(max((until - start_time) / longest - NEGLIGIBLE, 1.0))
    return until if parts == 1 else start_time + (until - start_time) / parts


class Loading:
    """Writes the parameters of loads and drivers for a moment."""

    def __init__(self, model: Model, start: float) -> None:
        """`start` of the run [s]. Writes: model.curves, parameters: as before the rise."""
        self.start, self.begin = start, start - 1.0
        self.curves, still = model.curves, _constant_curve(model)
        self.driven = []
        # along a path of equilibria curves are read before the start as well
        self.follows_path = False
        # a group of loads and the number of an entry that does not act
        self.silent: tuple[Group, int] | None = None
        self.rising = loads_without_curve(model)
        for g in model.groups:
            p = g.parameters
            if hasattr(g.module, "CONSTRAINTS") and hasattr(g.module, "CURVES_OF_TIME"):
                self.driven.append((g.names, p, p["curve"].copy(), p["offset"].copy()))
                p["curve"] = still
        self.set_time(self.begin)

    def load_factor(self, moment: float) -> float:
        """Factor [1], 0 to 1, on loads without a curve at a moment [s]."""
        return 1.0 if self.follows_path else min(max(moment - self.begin, 0.0), 1.0)

    def time(self, moment: float) -> float:
        """Time at which curves are read [s]."""
        return moment if self.follows_path else max(moment, self.start)

    def message(self, moment: float) -> str:
        """A moment in words of the user, for messages."""
        if moment < self.start:
            return f"{100.0 * self.load_factor(moment):.4g} % of the loads that have no curve"
        return f"t = {moment:.6g} s"

    def set_time(self, moment: float) -> None:
        """Set the parameters of loads and drivers to a moment. Writes: parameters.

        Raises SolverError for a curve that is read outside its range.
        """
        for g, rises, full in self.rising:
            column = g.parameters[g.module.AMPLITUDE]
            column[:] = full
            column[rises] *= self.load_factor(moment)
            if self.silent is not None and self.silent[0] is g:
                column[self.silent[1]] = 0.0
        for names, p, curves, offsets in self.driven:
            for i, (curve, offset) in enumerate(zip(curves, offsets, strict=True)):
                p["offset"][i] = offset - self._read(int(curve), moment, names[i])

    def positions(self, moment: float) -> np.ndarray:
        """Values (drivers,) of the curves of all drivers, in their units [m, rad]."""
        return np.array(
            [
                self._read(int(curve), moment, name)
                for names, _, curves, _ in self.driven
                for name, curve in zip(names, curves, strict=True)
            ]
        )

    def full(self) -> list[tuple[ModuleType, np.ndarray]]:
        """Modules of loads, and the amplitudes of each."""
        return [(g.module, full) for g, _, full in self.rising]

    def rows(self) -> list[int]:
        """First constraint row of every driver."""
        return [int(row) for _, p, _, _ in self.driven for row in p["first_row"]]

    def _read(self, k: int, moment: float, driver: str) -> float:
        """Value of the curve that begins at point k."""
        x = self.time(moment)
        points = self.curves[k : int(self.curves[k]["last"]) + 1]
        first, last, beyond = points["x"][0], points["x"][-1], points["beyond"][0]
        if not first <= x <= last and beyond not in (HOLD, LINEAR):
            cause = f"its curve is read at {x:.6g}, outside its range {first:.6g} to {last:.6g}"
            advice = "extend the curve, or set extrapolate: hold or linear on its card"
            raise SolverError(x, 0, f"joint '{driver}'", cause, advice)
        at = min(max(x, float(first)), float(last))
        i = min(int(np.searchsorted(points["x"], at, side="right")) - 1, len(points) - 2)
        c, s = points["c"][i], at - float(points["x"][i])
        value = c[0] + s * (c[1] + s * (c[2] + s * c[3]))
        slope = c[1] + s * (2.0 * c[2] + 3.0 * s * c[3])
        return float(value + (slope * (x - at) if beyond == LINEAR else 0.0))


def loads_without_curve(model: Model) -> list[tuple[Group, np.ndarray, np.ndarray]]:
    """Groups of loads, which entries of each have no curve, and the amplitudes of all entries."""
    loads = []
    for g in model.groups:
        if hasattr(g.module, "AMPLITUDE"):
            p = g.parameters
            # gravity has no curve at all
            has_none = (
                p["curve"] == 0 if "curve" in (p.dtype.names or ()) else np.ones(len(p), bool)
            )
            loads.append((g, has_none, p[g.module.AMPLITUDE].copy()))
    return loads


def _constant_curve(model: Model) -> int:
    """First point of a curve that is 0 everywhere. Writes: model.curves."""
    points, first = np.zeros(2, POINT.dtype), len(model.curves)
    points["x"], points["last"], points["beyond"] = (0.0, 1.0), first + 1, HOLD
    model.curves = np.concatenate([model.curves, points])
    return first


def potential(model: Model, nodes: np.ndarray, loading: Loading) -> float:
    """Potential energy [J] of the bodies under full gravity."""
    total, moving = 0.0, nodes[1:]
    moments = (
        moving["r"][moving["mass_inv"] > 0.0] / moving["mass_inv"][moving["mass_inv"] > 0.0, None]
    ).sum(axis=0)
    for module, full in loading.full():
        if getattr(module, "LEDGER", "") == "potential":
            total -= float((full @ moments).sum())
    return total
