"""Nodes and joints that parts bring, beside those of the deck."""

from collections.abc import Mapping

from crashsolve.deck.card import law_class
from crashsolve.deck.diagnostics import Diagnostic
from crashsolve.deck.reading.items import Entry, Item
from crashsolve.deck.reading.locations import placed
from crashsolve.foundation.errors import DeckError


def part_nodes(
    parts: Mapping[str, Entry], bodies: Mapping[str, Item], diagnostics: list[DeckError]
) -> list[str]:
    """Names of the nodes of all parts; one that a body has as well goes to `errors`."""
    names: list[str] = []
    for part in parts.values():
        own = part.card.node_names(part.name)
        for name in sorted(set(own) & (set(bodies) | set(names))):
            owner = "a body" if name in bodies else "a node of another part"
            message = f"its node '{name}' has the name of {owner}"
            diagnostics.append(placed(part.item, Diagnostic((), message, "rename one of them")))
        names += own
    return names


def joints_of_parts(
    entries: Mapping[str, dict[str, Entry]], diagnostics: list[DeckError]
) -> dict[str, Entry]:
    """Joints that parts bring; one whose name a joint of the deck has goes to `errors`."""
    joints: dict[str, Entry] = {}
    for part in entries["parts"].values():
        own = part.card.joints(part.name) if hasattr(part.card, "joints") else {}
        for name, (word, fields) in own.items():
            if name in entries["joints"]:
                message = f"its joint '{name}' has a name that is already in use"
                diagnostics.append(placed(part.item, Diagnostic((), message, "rename one of them")))
            kind = law_class("joints", word)
            card = kind.model_validate(fields)
            joints[name] = Entry(name, word, kind.__module__, card, part.where, part.item)
    return joints
