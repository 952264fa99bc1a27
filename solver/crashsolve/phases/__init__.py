"""Phases of a run: intervals of its time, each with a condition; their engine is in recording/."""

from typing import Any, Protocol

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class PhasedEngine(Protocol):
    """Functions of the engine that a phase may call (recording/phased.py)."""

    model: Any
    memory: Any  # row of MEMORY
    clock: np.void

    @property
    def phase(self) -> Any:
        """The present phase: its name and end [s]."""

    def kinetic(self) -> float:
        """Kinetic energy of all that moves [J]."""

    def halt(self) -> None:
        """Sets all velocities to zero, which counts as work. Writes: the State."""

    def launch(self) -> None:
        """Gives the velocities of the deck, once. Writes: the State."""

    def raise_loads(self, share: float) -> None:
        """Applies a share of the loads without a curve. Writes: the Model, the State."""

    def require_equilibrium(self, tolerance: float) -> None:
        """Raises SolverError where a force is left above a share of the largest one."""

    def set_velocities(self, given: dict[str, np.ndarray] | None) -> None:
        """Sets velocities, None for zero. Writes: the State."""


class PhaseLaw(Built, Protocol):
    """Functions of a phase's file: `build` returns the parameters `p` of the others.

    `after_step(p, engine)`, where there is one, is called after every step. `engine` is that of
    recording/phased.py; all phases step the same State of the same Model.
    """

    def start(self, p: Columns, engine: PhasedEngine) -> None:
        """Before the initial state of a run that begins with it is evaluated. Writes: the State."""

    def begin(self, p: Columns, engine: PhasedEngine) -> None:
        """Before its first step. Writes: the State."""

    def end(self, p: Columns, engine: PhasedEngine) -> None:
        """After its last step; raises SolverError where its condition is not met."""


FAMILY = Family(
    entry="phase",
    follows="loads",
    law=PhaseLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
