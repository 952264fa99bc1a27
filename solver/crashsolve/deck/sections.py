"""The keywords of a deck: which folder of laws, or which single card, each one stands for."""

from dataclasses import dataclass

from crashsolve.deck.card import Card
from crashsolve.deck.control import Control
from crashsolve.deck.expect import Expect
from crashsolve.deck.family import families, with_families
from crashsolve.deck.output import Output
from crashsolve.deck.units import Units
from crashsolve.deck.watch import Watch


@dataclass(frozen=True)
class Section:
    """A keyword with named entries: the word for one, the folder of its types, the default type."""

    singular: str
    folder: str
    default: str = ""


# those that are more than a family of laws; the others state themselves, see deck/family.py
OWN = {
    "materials": Section("material", "materials"),
    "sections": Section("section", "sections"),
    "curves": Section("curve", "curves", "table"),
    "bodies": Section("body", "bodies", "rigid"),
    "parts": Section("part", "parts"),
    "surfaces": Section("surface", "contact/shape"),
    "contacts": Section("contact", "contact", "force"),
}
SECTIONS: dict[str, Section] = with_families(
    OWN | {name: Section(f.entry, name, f.default) for name, f in families().items()}
)
SINGLE: dict[str, type[Card]] = {"units": Units, "control": Control, "output": Output}
# keywords whose entries stand in a list, without names
LISTS: dict[str, type[Card]] = {"watch": Watch, "expect": Expect}
KEYWORDS = ("title", "units", "parameters", "include", "control", *SECTIONS, "output", *LISTS)
