"""Curves of a study: the runs of one series in one channel; and refinements, its curves by mesh.

    x_m = x of the shortest steps on elements divided by m,   x* from x_1, x_2, x_4 as from steps

A refinement takes the limit over the steps of each mesh, and so gives the error of the mesh alone.
Consequence to test: x = 1 + h^2 + 1 / m^2 has order 2 in both, and leads to 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan

import numpy as np

from crashsolve.study.convergence import Convergence, analyse
from crashsolve.study.methods import order_of
from crashsolve.study.settings import Series
from crashsolve.study.trials import Trial


@dataclass
class Curve:
    """The trials of one series that count, from the longest step to the shortest.

    `sizes` are the abscissae of the order: average steps [s], or factors on automatic ones,
    which may be bound by samples most of the time and yet matter in contact.
    """

    series: Series
    trials: list[Trial]
    sizes: list[float]
    times: np.ndarray
    values: list[np.ndarray]
    convergence: Convergence


@dataclass
class Refinement:
    """The curves of one method and description, from the coarsest mesh to the finest."""

    curves: list[Curve]
    convergence: Convergence

    @property
    def name(self) -> str:
        """Name for tables and plots."""
        meshes = f"meshes x{self.curves[0].series.mesh} to x{self.curves[-1].series.mesh}"
        return f"{self.curves[0].series._replace(mesh=1).name}, {meshes}"

    @property
    def is_of_one_step(self) -> bool:
        """Whether no mesh has runs with two steps, so that the error of the step is not known."""
        return all(len(curve.trials) == 1 for curve in self.curves)

    @property
    def limit(self) -> Convergence:
        """The limit of finer meshes and shorter steps together; of one step that of the meshes."""
        convergence = self.convergence
        by_steps = 0.0 if self.is_of_one_step else self.curves[-1].convergence.error
        error = convergence.error + by_steps
        return Convergence(
            *(convergence.value, error, convergence.orders, convergence.stalls),
            *(convergence.is_extrapolated, convergence.has_floor, convergence.grows),
        )


@dataclass
class Source:
    """The value to which some runs converge, and the curve of the finest of them.

    `mesh_error` is the possible error of its mesh, `apart` the distance to the limit of another
    method.
    """

    name: str
    convergence: Convergence
    finest: Curve
    mesh_error: float = 0.0
    apart: float = 0.0

    @property
    def is_steady(self) -> bool:
        """Whether its estimated error can be relied on; of meshes three that shrink are enough."""
        convergence = self.convergence
        return convergence.is_steady or (self.mesh_error > 0.0 and isfinite(convergence.order))


def curves_of(at: int, trials: Sequence[Trial]) -> list[Curve]:
    """Curves of the answers number `at`; without runs that took the steps of another."""
    curves = []
    for series in dict.fromkeys(trial.setting.series for trial in trials):
        own = [
            t
            for t in trials
            if t.setting.series == series
            and (t.has_finished and not t.is_same and "value" in t.answers[at])
        ]
        own.sort(key=lambda trial: -trial.step)
        values = [np.atleast_1d(np.array(t.answers[at]["value"], float)) for t in own]
        if not own or len({len(value) for value in values}) > 1 or not len(values[0]):
            continue
        times = np.array(own[-1].answers[at].get("time", [nan]))
        sizes = _sizes(own)
        convergence = analyse(sizes, values, order_of(series.method))
        curves.append(Curve(series, own, sizes, times, values, convergence))
    return curves


def _sizes(trials: list[Trial]) -> list[float]:
    factors = [trial.setting.factor for trial in trials]
    known = [factor for factor in factors if factor is not None]
    return known if len(known) == len(trials) else [trial.step for trial in trials]


def refinements_of(curves: Sequence[Curve], order: float | None) -> list[Refinement]:
    """Ladders of two meshes or more; `order` is the declared one of the elements."""
    groups: dict[Series, list[Curve]] = {}
    for curve in curves:
        groups.setdefault(curve.series._replace(mesh=1), []).append(curve)
    refinements = []
    for group in groups.values():
        group.sort(key=lambda curve: curve.series.mesh)
        values = [curve.convergence.value for curve in group]
        if len(group) > 1 and len({len(value) for value in values}) == 1:
            sizes = [1.0 / curve.series.mesh for curve in group]
            refinements.append(Refinement(group, analyse(sizes, values, order)))
    return refinements


def sources(curves: Sequence[Curve], refinements: Sequence[Refinement]) -> list[Source]:
    """The values to which the runs converge: a refinement stands for its curves."""
    refined = [
        Source(
            refinement.name, refinement.limit, refinement.curves[-1], refinement.convergence.error
        )
        for refinement in refinements
    ]
    return refined + [
        Source(curve.series.name, curve.convergence, curve)
        for curve in curves
        if refinement_of(curve, refinements) is None
    ]


def refinement_of(curve: Curve, refinements: Sequence[Refinement]) -> Refinement | None:
    """The refinement that a curve belongs to."""
    return next((x for x in refinements if any(c is curve for c in x.curves)), None)


def sort_key(source: Source) -> tuple[bool, float]:
    """Divergence and error, by which sources are ordered, the best first."""
    error = source.convergence.error
    return source.convergence.diverges, error if isfinite(error) else float("inf")
