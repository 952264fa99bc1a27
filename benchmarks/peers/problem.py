"""What a problem and a way to solve it are, and how one run is measured."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from statistics import median

import numpy as np

# runs longer than this [s] are repeated less often, so that the whole stays short
LONG = 2.0


@dataclass
class Run:
    """A model ready to go: `solve` is timed, then `watched` gives the values to judge."""

    solve: Callable[[], object]
    watched: Callable[[], np.ndarray]


@dataclass
class Method:
    """One integrator of one code, over its steps or tolerances, coarse to fine."""

    code: str
    name: str
    knob: str
    values: Sequence[float]
    prepare: Callable[[float], Run]


@dataclass
class Problem:
    """Data and reference of a problem; `angles` lists the watched values that count modulo a
    revolution.
    """

    name: str
    title: str
    measure: str
    reference: np.ndarray
    methods: list[Method]
    angles: bool = False
    notes: list[str] = field(default_factory=list)

    def error(self, values: np.ndarray) -> float:
        difference = np.asarray(values, float) - self.reference
        if self.angles:
            difference = np.arctan2(np.sin(difference), np.cos(difference))
        worst = float(np.abs(difference).max())
        return worst if isfinite(worst) else float("inf")


@dataclass
class Point:
    """One line of the table. CPU times in seconds."""

    code: str
    method: str
    knob: str
    value: float
    error: float
    cpu: float
    build: float
    note: str = ""


@dataclass
class Trial:
    """One method at one value, with the times of its runs so far."""

    problem: Problem
    method: Method
    value: float
    solves: list[float] = field(default_factory=list)
    builds: list[float] = field(default_factory=list)
    error: float = float("inf")
    note: str = ""

    def run(self) -> None:
        """One run from a new model."""
        begun = time.process_time()
        run = self.method.prepare(self.value)
        built = time.process_time()
        try:
            run.solve()
        except Exception as stop:
            # a code that stops itself has no answer at this setting; that is its result
            self.note = f"stopped: {type(stop).__name__}"
        self.solves.append(time.process_time() - built)
        self.builds.append(built - begun)
        if not self.note:
            self.error = self.problem.error(run.watched())

    def is_done(self) -> bool:
        """Long runs are repeated less often, and failures not at all."""
        return bool(self.note) or (len(self.solves) >= 2 and sum(self.solves) > LONG)

    def point(self) -> Point:
        method = self.method
        return Point(
            method.code,
            method.name,
            method.knob,
            self.value,
            self.error,
            median(self.solves),
            median(self.builds),
            self.note,
        )


def sweep(problem: Problem, repeats: int) -> list[Point]:
    """Every method of a problem over its values.

    All run once before any runs again: when the machine is busy for a while, all methods suffer.
    """
    for method in problem.methods:
        # compile, import and fill caches; not counted
        Trial(problem, method, method.values[0]).run()
    trials = [
        Trial(problem, method, value) for method in problem.methods for value in method.values
    ]
    for _ in range(repeats):
        for trial in trials:
            if not trial.is_done():
                trial.run()
    return [trial.point() for trial in trials]
