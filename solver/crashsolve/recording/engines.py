"""Chooses the engine of a deck, which advances it from sample to sample."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from crashsolve.deck.reading.deck import Deck
from crashsolve.model.checks.statics import is_incremental
from crashsolve.model.model import Model, State
from crashsolve.system.compose import composed
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    from collections.abc import Callable

    from crashsolve.statics.shared_start import Equilibrium


class Prepared(NamedTuple):
    """What an engine of a deck has prepared that further ones of it take over."""

    program: str = ""  # the composed step
    equilibrium: Equilibrium | None = None  # from which the run begins


UNPREPARED = Prepared()


def is_static(deck: Deck) -> bool:
    """Whether the run is one of equilibria."""
    return deck.control.solution == "quasi_static"


def engine_of(deck: Deck, model: Model, state: State) -> Engine:
    """Engine in time, or of equilibria."""
    return prepared_engine(deck, model, state)[0]


def prepared_engine(
    deck: Deck,
    model: Model,
    state: State,
    prepared: Prepared = UNPREPARED,
    does: Callable[[str], None] = lambda _: None,
) -> tuple[Engine, Prepared]:
    """Engine of a deck, and what further engines of it take over.

    `prepared` comes from an earlier engine of the deck; `does` receives words for activities that
    take long, beside compiling.
    """
    program = prepared.program or composed(model, deck.text)
    engine, equilibrium = _engine(deck, model, state, program), prepared.equilibrium
    if deck.control.start == "equilibrium" and not is_static(deck):
        if equilibrium is None:
            from crashsolve.statics.start import begin_at_rest

            equilibrium = begin_at_rest(engine, does)
        else:
            equilibrium.restore(engine)
        engine.notes.append(equilibrium.note)
    return engine, Prepared(program, equilibrium)


def _engine(deck: Deck, model: Model, state: State, program: str) -> Engine:
    if not is_static(deck):
        return _in_time(model, state, program)
    if is_incremental(model.groups):
        from crashsolve.statics.pseudo_transient import RestEngine

        return RestEngine(model, state, deck.control, program)
    if deck.control.follows_path:
        from crashsolve.statics.path import PathEngine

        return PathEngine(model, state, deck.control, program)
    from crashsolve.statics.equilibrium import StaticEngine

    return StaticEngine(model, state, deck.control, program)


def _in_time(model: Model, state: State, program: str) -> Engine:
    """Engine in time, with phases or without."""
    if not model.phases:
        return Engine(model, state, program)
    from crashsolve.recording.phased import PhasedEngine

    return PhasedEngine(model, state, program)
