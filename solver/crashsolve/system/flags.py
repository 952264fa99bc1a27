"""Flags that laws have raised in a run, with their words: WARNINGS are faults, REMARKS are not."""

import numpy as np

from crashsolve.deck.family import families
from crashsolve.model.contact.groups import ContactGroup, NodalGroup
from crashsolve.model.contact.pairs import flags_of
from crashsolve.model.model import Model, State


def law_warnings(model: Model, state: State) -> list[str]:
    """Warnings of laws outside their range of validity, per card."""
    current = int(state.clock[0]["current"])
    others = [
        f"{families()[g.keyword].entry} '{name}': {text}"
        for g in model.force_groups()
        for column, text in getattr(g.module, "WARNINGS", {}).items()
        for name in np.array(g.names)[g.history[column][current] != 0]
    ]
    raised = sorted(contact_flags(model, state, "WARNINGS"))
    return others + [f"contact '{model.contacts[card]}': {text}" for card, text in raised]


def contact_flags(model: Model, state: State, table: str) -> set[tuple[int, str]]:
    """Contact cards whose normal law has raised flags of a table, with the words of the flag."""
    current = int(state.clock[0]["current"])
    left = state.card_history["left_warnings"][current]
    flags: set[tuple[int, str]] = set()
    for group in model.contact_groups:
        flags |= _of_pairs(group, table, current, left)
    for nodal in model.nodal_groups:
        flags |= _of_probes(nodal, table)
    return flags


def _of_pairs(
    group: ContactGroup, table: str, current: int, left: np.ndarray
) -> set[tuple[int, str]]:
    flags, bits = set(), flags_of(group.normal)
    for name, text in getattr(group.normal, table, {}).items():
        raised = group.history[name][current] != 0
        cards = {int(card) for card in group.parameters["card"][raised]}
        # of pairs that have left the list of near ones, the card remembers
        is_set = left >> bits.index(name) & 1
        cards |= {card for card in (group.search.cards() if group.search else ()) if is_set[card]}
        flags |= {(card, text) for card in cards}
    return flags


def _of_probes(nodal: NodalGroup, table: str) -> set[tuple[int, str]]:
    return {
        (int(nodal.arrays["p"]["card"][0]), text)
        for name, text in getattr(nodal.normal, table, {}).items()
        if nodal.arrays["probe_states"][name].any()
    }
