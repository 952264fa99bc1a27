"""The keywords of a deck: which folder of laws, or which single card, each one stands for."""

from typing import NamedTuple

from crashsolve.deck.card import Card
from crashsolve.deck.family import FamilyError, families
from crashsolve.deck.run_cards.control import Control
from crashsolve.deck.run_cards.expect import Expect
from crashsolve.deck.run_cards.output import Output
from crashsolve.deck.run_cards.units import Units
from crashsolve.deck.run_cards.watch import Watch


class Section(NamedTuple):
    """A keyword with named entries: the word for one, the folder of its types, the default type."""

    singular: str
    folder: str
    default: str = ""


SECTIONS: dict[str, Section] = {
    name: Section(family.entry, family.folder, family.default)
    for name, family in families().items()
    if family.entry is not None
}


def answering(keyword: str) -> tuple[str, ...]:
    """Sections whose entries a card may name as one of `keyword`: every entry with rows is a
    joint.
    """
    if keyword in SECTIONS and families()[keyword].has_rows:
        return tuple(name for name in SECTIONS if families()[name].has_rows)
    return (keyword,)


SINGLE: dict[str, type[Card]] = {"units": Units, "control": Control, "output": Output}
# keywords whose entries stand in a list, without names
LISTS: dict[str, type[Card]] = {"watch": Watch, "expect": Expect}
_OWN = ("title", "parameters", "include", *SINGLE, *LISTS)
for _name in SECTIONS:
    if _name in _OWN:
        raise FamilyError(f"section '{_name}' of a family is a keyword of decks already")
KEYWORDS = ("title", "units", "parameters", "include", "control", *SECTIONS, "output", *LISTS)
