"""What a model may not be at its start: joints that do not close, contacts that touch already."""

from collections.abc import Iterator
from typing import Any

from crashsolve.deck.keywords import answering
from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.system.engine import Engine


def refuse_inconsistencies(deck: Deck, engine: Engine) -> None:
    """Raises DeckErrors, each at the card of the joint or contact."""
    found = [
        deck.error(card, None, text, advice)
        for card, text, advice in _inconsistencies(deck, engine)
    ]
    if found:
        raise DeckErrors(found)


def _inconsistencies(deck: Deck, engine: Engine) -> Iterator[tuple[Any, str, str]]:
    """Card, what is wrong, and advice."""
    entries = deck.entries
    joints = {name: card for k in answering("joints") for name, card in entries[k].items()}
    for name, text in engine.assembly_errors():
        yield joints[name], text, "correct the joint or the bodies"
    for name, text in engine.overlaps():
        yield entries["contacts"][name], text, "move the bodies apart"
