"""A deck read for many runs, some of which do not use the settings of others.

Where a structure is compared as beams and as shells, `across` is set for the shells. A run is given
values that change its deck; a value that changes none of them is refused.
"""

from collections.abc import Mapping
from pathlib import Path

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.foundation.errors import DeckError


class Several:
    """Decks of many runs; `ineffective` holds the values that changed none of them so far, by
    name.
    """

    def __init__(self) -> None:
        self.ineffective: dict[str, DeckError] | None = None

    def read(self, path: Path, overrides: Mapping[str, str]) -> tuple[Deck, dict[str, str]]:
        """The deck of a run, and those of its overrides that change it. Raises DeckErrors.

        Writes: ineffective.
        """
        deck = read_deck(path, overrides, refuses_ineffective=False)
        before = deck.ineffective if self.ineffective is None else self.ineffective
        self.ineffective = {n: e for n, e in before.items() if n in deck.ineffective}
        useful = {name: text for name, text in overrides.items() if name not in deck.ineffective}
        return (read_deck(path, useful) if deck.ineffective else deck), useful
