"""Phases of a run: stretches of its time, each with its own method from sample to sample."""

from typing import Any, Protocol

from crashsolve.deck.family import ANY, Family
from crashsolve.deck.roles import Built


class PhaseLaw(Built, Protocol):
    """What the file of a phase provides: `build` returns what the others are given as `p`.

    `look(p, engine)`, where there is one, is called after every step. `engine` is that of
    recording/phased.py; all phases step the same State of the same Model.
    """

    def start(self, p: Any, engine: Any) -> Any:
        """Before the initial state of a run that begins with it is evaluated. Writes: the State."""

    def begin(self, p: Any, engine: Any) -> Any:
        """Before its first step. Writes: the State."""

    def end(self, p: Any, engine: Any) -> Any:
        """After its last step; raises SolverError where it has not reached what it promises."""


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
