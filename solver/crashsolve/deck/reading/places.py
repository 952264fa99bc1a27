"""Where a mistake of a card stands: in a file, or among the words of the command line."""

from crashsolve.deck.mistakes import Mistake
from crashsolve.deck.reading.items import Item
from crashsolve.deck.reading.overrides import place_given
from crashsolve.deck.source import locate
from crashsolve.foundation.errors import DeckError


def placed(item: Item, mistake: Mistake) -> DeckError:
    """A mistake of a card with its place in the deck."""
    path = mistake.path
    place: tuple[str, int | None, int | None] = locate(item.where, item.value, path, mistake.key)
    given = place_given(item, path, mistake.key)
    if given:
        place = given, None, None
    below = path[:-1] if mistake.key or path[-1:] == ("type",) else path
    field = ".".join(step for step in below if isinstance(step, str))
    message = f"{field}: {mistake.message}" if field else mistake.message
    return DeckError(*place, item.title, message, mistake.advice)
