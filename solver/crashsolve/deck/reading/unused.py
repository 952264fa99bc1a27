"""Settings from outside the deck without effect: the run would be the same without them.

A parameter must be read by a card, other than the title, or by a parameter that is read. A word of
a card must be one that the deck's choices use: `across` of a structure is not where it has no
shells, and a parameter that stands only there is read by nothing. A deck may declare parameters
that nothing reads, as files that it includes may bring more than it needs; to set them is an
error.
"""

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from crashsolve.deck.reading.items import Item, Items, Step
from crashsolve.deck.reading.overrides import PARAMETERS
from crashsolve.deck.reading.parameters import Parameters, Reader
from crashsolve.deck.source import Position, Rows, Table, locate
from crashsolve.foundation.errors import DeckError

ADVICE = "leave it out"
# laws that act only where a card names them
ONLY_NAMED = ("curves", "materials", "meshes", "sections")


class Unused(NamedTuple):
    """A path of a card that the deck's choices have no use for, and why."""

    item: Item
    path: tuple[Step, ...]
    reason: str

    def holds(self, path: tuple[Step, ...]) -> bool:
        """Whether a path lies within."""
        return path[: len(self.path)] == self.path

    def readers(self) -> Iterator[Reader]:
        """All positions within, as parameters know who reads them."""
        value: Any = self.item.value
        for step in self.path:
            inside = isinstance(value, Table) and step in value
            inside |= isinstance(value, Rows) and isinstance(step, int) and step < len(value)
            if not inside:
                return
            value = value[step]
        at = locate(self.item.at, self.item.value, self.path, False)
        for location in _locations(value, at):
            yield self.item.title, location


def unused(
    items: Items, control: Mapping[str, str], named: Collection[tuple[str, str]]
) -> Iterator[Unused]:
    """Words of the control that are without use, and laws whose keyword and name no card names."""
    for item in items["control"].values():
        for word, why in control.items():
            yield Unused(item, (word,), why)
    for keyword in ONLY_NAMED:
        for item in items[keyword].values():
            if (keyword, item.name) not in named:
                yield Unused(item, (), "no card names it")


def ineffective(
    items: Items, parameters: Parameters, spots: Collection[Unused], overrides: Mapping[str, str]
) -> dict[str, DeckError]:
    """Reasons why values set from outside change nothing, by their names in `overrides`."""
    words = {
        f"--set {word}={text}": name
        for name, text in overrides.items()
        for word in (name.removeprefix(PARAMETERS), name)
    }
    refusals = {}
    for spot in spots:
        for path, given in spot.item.given.items():
            if spot.holds(path):
                refusals[words[given]] = _refusal(given, spot.item.title, spot.reason, ADVICE)
    unread = {reader: spot for spot in spots for reader in spot.readers()}
    read = parameters.read(unread)
    for name, given in parameters.given.items():
        if name not in read:
            reason = _why_unread(items["parameters"][name], parameters, unread)
            known = ", ".join(other for other in items["parameters"] if other in read)
            advice = f"{ADVICE} (parameters that are read: {known or 'none'})"
            refusals[words[given]] = _refusal(given, "", reason, advice)
    return refusals


def unread(parameters: Parameters, spots: Collection[Unused], main: Path) -> list[str]:
    """Warnings of parameters of the deck's own file that no card reads."""
    read = parameters.read({reader for spot in spots for reader in spot.readers()})
    return [
        f"parameter '{name}' ({item.where.file}:{item.where.line}) is read by no card"
        for name, item in parameters.items.items()
        if item.file == main and name not in read
    ]


def _why_unread(item: Item, parameters: Parameters, unread: Mapping[Reader, Unused]) -> str:
    location = f"parameter '{item.name}' ({item.where.file}:{item.where.line})"
    spots = [unread[reader] for reader in parameters.readers[item.name] if reader in unread]
    if spots:
        return (
            f"{location} is read only by {spots[0].item.title}, where it has no effect: "
            f"{spots[0].reason}"
        )
    return f"{location} is read by no card, so that the run would be the same without it"


def _refusal(given: str, card: str, message: str, advice: str) -> DeckError:
    return DeckError(given, None, None, card, message, advice)


def _locations(value: object, at: Position) -> Iterator[Position]:
    """The locations of a value and of all values within it."""
    yield at
    if isinstance(value, Table):
        for key, part in value.items():
            yield from _locations(part, value.value_location(key))
    elif isinstance(value, Rows):
        for i, part in enumerate(value):
            yield from _locations(part, value.location(i))
