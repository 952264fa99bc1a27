"""A deck read for many runs, of which some have no use for what is set for others.

Where a structure is compared as beams and as shells, `across` is set for the shells. A run is given
what changes its deck; what changes none of them is refused.
"""

from collections.abc import Mapping
from pathlib import Path

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.foundation.errors import DeckError


class Several:
    """Decks of many runs; `idle` has what changes none of them so far, by its name."""

    def __init__(self) -> None:
        self.idle: dict[str, DeckError] | None = None

    def read(self, path: Path, overrides: Mapping[str, str]) -> tuple[Deck, dict[str, str]]:
        """The deck of a run, and those of its overrides that change it. Raises DeckErrors.

        Writes: idle.
        """
        deck = read_deck(path, overrides, refuses_idle=False)
        before = deck.idle if self.idle is None else self.idle
        self.idle = {n: e for n, e in before.items() if n in deck.idle}
        useful = {name: text for name, text in overrides.items() if name not in deck.idle}
        return (read_deck(path, useful) if deck.idle else deck), useful
