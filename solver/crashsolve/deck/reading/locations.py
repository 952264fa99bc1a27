"""Where an error of a card stands: in a file, or among the words of the command line."""

from crashsolve.deck.diagnostics import Diagnostic
from crashsolve.deck.reading.items import Item
from crashsolve.deck.reading.overrides import location_given
from crashsolve.deck.source import locate
from crashsolve.foundation.errors import DeckError


def placed(item: Item, diagnostic: Diagnostic) -> DeckError:
    """An error of a card with its location in the deck."""
    path = diagnostic.path
    location: tuple[str, int | None, int | None] = locate(
        item.where, item.value, path, diagnostic.key
    )
    given = location_given(item, path, diagnostic.key)
    if given:
        location = given, None, None
    below = path[:-1] if diagnostic.key or path[-1:] == ("type",) else path
    field = ".".join(step for step in below if isinstance(step, str))
    message = f"{field}: {diagnostic.message}" if field else diagnostic.message
    return DeckError(*location, item.title, message, diagnostic.advice)
