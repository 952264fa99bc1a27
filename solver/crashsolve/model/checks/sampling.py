"""A stated step that samples cut short: the run takes another step than that of the deck."""

from importlib import import_module

from crashsolve.deck.family import CHOSEN
from crashsolve.deck.reading.deck import Deck

# a step longer than the interval by this share is cut
SAME = 1e-9


def step_warnings(deck: Deck) -> list[str]:
    """The warning of a `control.step` longer than the time between samples."""
    control, step = deck.control, deck.control.step
    if step == "auto" or control.solution == "quasi_static" or control.integrator in CHOSEN:
        return []
    method = import_module(f"crashsolve.integrators.{control.integrator}")
    # samples lie within steps (system/placeholders.py)
    if hasattr(method, "DENSE") and not deck.entries["contacts"]:
        return []
    interval = deck.sample_interval
    if not 0.0 < interval < step * (1.0 - SAME):
        return []
    is_requested = deck.output.history.interval is not None
    whose = "that output.history.interval asks for" if is_requested else "that a run has by default"
    return [
        f"control.step: {step:.6g} s is cut to the {interval:.6g} s between samples {whose}; "
        f"give output.history.interval: {step:.6g} to take the step"
    ]
