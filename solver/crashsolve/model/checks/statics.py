"""Refuses models that a quasi-static solution does not support: path-dependent, or free to move."""

from collections.abc import Iterator

import numpy as np

from crashsolve.deck.family import families
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.reading.items import Entry
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.model import Group

# history columns of every law of force
KEPT = {"dissipated", "power", "unused"}


def is_incremental(groups: list[Group]) -> bool:
    """Whether there are path-dependent parts: steps from rest take them along it."""
    return any(g.keyword == "parts" and getattr(g.module, "STEPWISE", False) for g in groups)


def follows_load_steps(group: Group) -> bool:
    """Whether load steps, which have no length, take these path-dependent laws along their path."""
    return "at_rest" in (group.parameters.dtype.names or ())


def refuse_motion(deck: Deck, groups: list[Group]) -> None:
    """Raises DeckErrors for the cards whose laws need the course of time."""
    if deck.control.solution != "quasi_static":
        return
    errors = [
        deck.error(entry, None, f"{reason}; set solution: transient")
        for entry, reason in _inconsistencies(deck, groups)
    ]
    if deck.control.follows_path:
        errors += [
            deck.error(entry, None, text) for entry, text in _refused_by_arc_length(deck, groups)
        ]
    if errors:
        raise DeckErrors(errors)


def _refused_by_arc_length(deck: Deck, groups: list[Group]) -> Iterator[tuple[Entry, str]]:
    """Entries that cannot follow a path of equilibria yet."""
    beyond = "path: arc_length does not follow {} yet; set path: load"
    for entry in deck.entries["hinges"].values():
        yield entry, beyond.format("hinges")
    for g in groups:
        by_steps = g.keyword == "parts" and getattr(g.module, "STEPWISE", False)
        if by_steps or follows_load_steps(g):
            for entry in (e for e in deck.entries[g.keyword].values() if e.type == g.type):
                yield entry, beyond.format(f"parts of type {g.type}")


def _inconsistencies(deck: Deck, groups: list[Group]) -> Iterator[tuple[Entry, str]]:
    """Entries that a quasi-static solution cannot have, and why."""
    yield from _with_velocities(deck)
    for entry in deck.entries["contacts"].values():
        yield entry, "a quasi-static solution has no contacts yet"
    if is_incremental(groups):
        yield from _refused_by_pseudo_transient(deck)
    for g in groups:
        if _is_path_dependent(g):
            for entry in (e for e in deck.entries[g.keyword].values() if e.type == g.type):
                yield entry, "a quasi-static solution has no path-dependent laws yet"


def _with_velocities(deck: Deck) -> Iterator[tuple[Entry, str]]:
    for entry in [*deck.entries["bodies"].values(), *deck.entries["parts"].values()]:
        card = entry.card
        moves = bool(np.any(card.velocity) or np.any(card.angular_velocity))
        if moves or bool(getattr(card, "velocities", ())):
            yield entry, "a quasi-static solution has no velocities"


def _refused_by_pseudo_transient(deck: Deck) -> Iterator[tuple[Entry, str]]:
    """Entries that cannot be combined with parts that take steps from rest."""
    for entry in deck.entries["bodies"].values():
        if entry.card.welded or entry.card.part_of:
            message = "a quasi-static solution with shells or fibre beams has no welded nodes"
            yield entry, f"{message}; take a joint instead"
    for entry in deck.entries["hinges"].values():
        yield entry, "a quasi-static solution with shells or fibre beams has no hinges yet"


def _is_path_dependent(group: Group) -> bool:
    """Whether its law of force remembers more than losses, and quasi-static runs refuse that."""
    remembers = set(group.history.dtype.names or ()) - KEPT and not follows_load_steps(group)
    is_refused = hasattr(group.module, "force") and not families()[group.keyword].at_rest
    return bool(is_refused and remembers)
