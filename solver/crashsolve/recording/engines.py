"""Chooses the engine of a deck, which advances it from sample to sample."""

from collections.abc import Callable

from crashsolve.deck.reading.deck import Deck
from crashsolve.model.checks.statics import is_incremental
from crashsolve.model.model import Model, State
from crashsolve.system.compose import composed
from crashsolve.system.engine import Engine


def is_static(deck: Deck) -> bool:
    """Whether the run is one of equilibria."""
    return deck.control.solution == "quasi_static"


def engine_of(
    deck: Deck,
    model: Model,
    state: State,
    program: str = "",
    does: Callable[[str], None] = lambda _: None,
) -> Engine:
    """Engine in time, or of equilibria; `program`: the composed step of an earlier engine of the
    deck.

    `does` receives words for activities that take long, beside compiling.
    """
    program = program or composed(model, deck.text)
    if not is_static(deck):
        engine = _in_time(model, state, program)
        if deck.control.start == "equilibrium":
            from crashsolve.statics.start import begin_at_rest

            engine.notes.append(begin_at_rest(engine, does))
        return engine
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
