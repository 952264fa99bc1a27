"""How the run is controlled: its duration, its steps and when it must stop."""

import os
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import model_validator

from crashsolve.deck.card import Card, quantity, word
from crashsolve.deck.family import DEFAULT_INTEGRATOR, integrators
from crashsolve.foundation.errors import DeckError, DeckErrors

# one file each in integrators/
Integrator: Any = Literal[(*integrators(), "auto", "default")]  # type: ignore
# fields of fixed steps and of threads: they mean rattle where no method is named
OF_STEPS = ("step", "step_min", "safety", "tolerance", "onset_tolerance", "threads")

# default is rattle where there is anything to share
EXPLICIT_STEPS = ("rattle", "default")

MAX_THREADS = 1024
# variable in which Slurm gives a job its number of cores
CORES_GIVEN = "SLURM_CPUS_PER_TASK"


class Control(Card):
    """Duration, time step and limits of the run."""

    end_time: float = quantity("s", "time at which the run ends", ge=0)
    start_time: float = quantity("s", "time at which the run begins", 0.0)
    integrator: Integrator = word(
        "method of integration; default: dormand_prince_8 for rigid bodies with joints, springs "
        "and loads that are smooth, without contacts and curves, where control gives none of step, "
        "step_min, safety, tolerance, onset_tolerance and threads, else rattle; auto: chosen by "
        "stiffness and smoothness of the model",
        "default",
    )
    accuracy: float | None = quantity(
        "1",
        "largest estimated error of every watched channel, over the largest magnitude that it, "
        "or the vector it is a component of, has in the run (of a sum: the sum, of a time: the "
        "run's duration); "
        "pilot runs find the step or the tolerance",
        None,
        gt=0,
        lt=1,
    )
    tolerance: float | None = quantity(
        "1",
        "where the method chooses its step: error of a step over the model's size and speed, "
        "1e-6 when neither it nor an accuracy is given; of quasi_static: residual force over the "
        "largest force or reaction, and last correction over the change in a load step, 1e-8 when "
        "absent",
        None,
        gt=0,
        lt=1,
    )
    estimate: Literal["auto", "mesh", "full", "off"] = word(
        "errors of watched channels; auto: from one or two further runs in memory, which after a "
        "run of 5 s of CPU or more cost no more than it did, and from runs on coarser meshes where "
        "these cost less than a quarter of it; mesh: coarser meshes at any cost; full: all runs "
        "at any cost",
        "auto",
    )
    spectral_radius: float = quantity(
        "1",
        "of generalized_alpha: ratio of amplitudes after and before a step, of vibrations too fast "
        "for the step",
        0.7,
        ge=0,
        le=1,
    )
    step: float | Literal["auto"] = quantity(
        "s", "time step; auto: from the stiffest active spring and contact", "auto", gt=0
    )
    safety: float = quantity(
        "1",
        "automatic step over the critical step; the default is for the accuracy of springs, shells "
        "are stable at 0.9",
        0.1,
        gt=0,
        le=1,
    )
    step_max: float | None = quantity("s", "largest automatic step", None, gt=0)
    step_min: float | None = quantity("s", "the run stops below this step", None, gt=0)
    onset_tolerance: float | None = quantity(
        "m",
        "largest penetration in the first step of a contact; longer steps are split",
        None,
        gt=0,
    )
    energy_limit: float | Literal["off"] = quantity(
        "1", "the run stops beyond this energy error over the largest energy", 0.05, gt=0
    )
    constraint_tolerance: float = quantity(
        "1", "error of the constraints over the size of the model", 1e-10, gt=0
    )
    check_every: int = word("steps between checks of energy and constraints", 100, ge=1)
    solution: Literal["transient", "quasi_static"] = word(
        "transient: motion; quasi_static: equilibria under the loads of each moment", "transient"
    )
    steps: int = word(
        "of quasi_static: number of equal load steps, each a sample; output.history.interval takes "
        "precedence; loads without a curve act from the start; of path arc_length: steps for the "
        "length that the initial stiffness would give",
        default=10,
        ge=1,
    )
    path: Literal["load", "arc_length"] = word(
        "of quasi_static; load: equilibria under the loads of each moment, up to a limit point; "
        "arc_length: along the path of equilibria through limit points, where the load falls, "
        "until the loads and motions of end_time are reached; times of its results are lengths of "
        "the path",
        "load",
    )
    path_length: float = quantity(
        "1",
        "of arc_length: longest path over the length that the initial stiffness would give",
        10.0,
        ge=1,
        le=1e4,
    )

    threads: int | None = word(
        "number of threads for explicit steps of shells and their contacts, and of rigid contacts "
        "with 1000 elements or more on both sides together; results have the same bits for any "
        "number; when absent 1, and with shells the cores of the job (SLURM_CPUS_PER_TASK)",
        default=None,
        ge=1,
        le=MAX_THREADS,
    )

    resolve: bool = word(
        "true: steps of dormand_prince methods are also limited to the stable step of every "
        "spring, to rotations of 0.7 rad and to a fortieth of the run, whatever their estimated "
        "error; the default integrator does so",
        False,
    )

    start: Literal["as_given", "equilibrium"] = word(
        "equilibrium: the run begins from a static equilibrium, found from the positions given",
        "as_given",
    )

    @model_validator(mode="before")
    @classmethod
    def _keep_stated_steps(cls, given: object) -> object:
        """Rattle for a deck that states steps and no method, or seeks equilibria."""
        if not isinstance(given, Mapping) or "integrator" in given:
            return given
        stated = [word for word in OF_STEPS if given.get(word) not in (None, "auto")]
        if stated or given.get("solution") == "quasi_static":
            return {**given, "integrator": DEFAULT_INTEGRATOR}
        return given

    @model_validator(mode="after")
    def _in_order(self) -> "Control":
        if self.end_time < self.start_time:
            raise ValueError(f"end_time: must not come before start_time, {self.start_time:g} s")
        if self.step_min and self.step_max and self.step_min > self.step_max:
            raise ValueError(f"step_min: must not exceed step_max, {self.step_max:g} s")
        if self.accuracy:
            self._check_accuracy()
        if self.solution == "quasi_static" and (self.accuracy or self.integrator != "rattle"):
            what = "accuracy" if self.accuracy else "integrator"
            raise ValueError(f"{what}: solution quasi_static finds equilibria; leave {what} out")
        if self.solution == "quasi_static" and self.end_time == self.start_time:
            raise ValueError("end_time: must come after start_time for a load step to fit between")
        if self.path == "arc_length" and self.solution != "quasi_static":
            raise ValueError("path: arc_length is for equilibria; set solution: quasi_static")
        if self.threads and self.threads > 1 and not self.is_explicit:
            raise ValueError("threads: only explicit steps are shared; set integrator: rattle")
        return self

    @property
    def is_explicit(self) -> bool:
        """Whether steps are such as threads can share."""
        return bool(self.integrator in EXPLICIT_STEPS and self.solution == "transient")

    @property
    def follows_path(self) -> bool:
        """Whether equilibria are followed through limit points."""
        return self.path == "arc_length"

    @property
    def last_time(self) -> float:
        """Time at which the run ends at the latest [s]: along a path it counts the length."""
        if not self.follows_path:
            return self.end_time
        return self.start_time + self.path_length * (self.end_time - self.start_time)

    def unused(self, has_interval: bool) -> dict[str, str]:
        """Words without use beside the others, and why; `has_interval` of samples of the deck."""
        reasons = {}
        is_static = self.solution == "quasi_static"
        if is_static:
            reasons["step"] = "solution quasi_static has load steps, see `steps`"
        elif self.integrator == "rattle":
            reasons["tolerance"] = "steps of rattle are chosen by safety, not by their error"
        if is_static:
            reasons["start"] = "solution quasi_static begins in equilibrium"
        if is_static or self.integrator not in ("generalized_alpha", "auto"):
            reasons["spectral_radius"] = "it belongs to integrator generalized_alpha"
        if self.resolve and not self.integrator.startswith("dormand_prince"):
            reasons["resolve"] = "it belongs to the dormand_prince methods"
        if not is_static:
            reasons["steps"] = "it belongs to solution quasi_static"
        elif has_interval:
            reasons["steps"] = "output.history.interval takes precedence"
        if not self.follows_path:
            reasons["path_length"] = "it belongs to path arc_length"
        return reasons

    def _check_accuracy(self) -> None:
        """Raises ValueError for fields that `accuracy` chooses itself, or needs."""
        if self.tolerance or self.step != "auto":
            chosen = "tolerance" if self.tolerance else "step"
            raise ValueError(f"{chosen}: is chosen by the accuracy; give one of the two")
        if self.estimate == "off":
            raise ValueError("estimate: must not be off, as an accuracy needs error estimates")


def cores_given() -> int:
    """Cores that the job was given, 1 outside of one. Raises DeckErrors where that is no number."""
    given = os.environ.get(CORES_GIVEN, "1")
    if given.isdecimal() and 1 <= int(given) <= MAX_THREADS:
        return int(given)
    message = f"must be a whole number from 1 to {MAX_THREADS}, not '{given}'"
    advice = "unset it, or set control.threads"
    raise DeckErrors([DeckError("environment", None, None, CORES_GIVEN, message, advice)])
