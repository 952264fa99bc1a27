"""Two surfaces that act on each other more than once: the forces add up, and the stiffness doubles.

They are named by two contact cards, or one of them stands twice on a side of one card.

Surfaces of equal shape in one position on one body are one surface, whatever their names.
"""

from collections import defaultdict
from collections.abc import Mapping
from itertools import combinations
from typing import Protocol

from crashsolve.deck.building import EntryOfScene
from crashsolve.model.scene import Scene


class TwoSided(Protocol):
    """A contact card, by the names of its surfaces."""

    @property
    def a(self) -> tuple[str, ...]: ...
    @property
    def b(self) -> tuple[str, ...]: ...


def warn_of_common_pairs(
    entries: Mapping[str, EntryOfScene], surfaces: Mapping[str, EntryOfScene], scene: Scene
) -> None:
    """Warn of every two contact cards that have a pair of surfaces in common, and of every card
    with a surface that stands twice on one side.
    """
    first_of: dict[tuple[str, object], str] = {}
    same = {name: first_of.setdefault((s.type, s.card), name) for name, s in surfaces.items()}
    named = defaultdict(list)
    for name, entry in entries.items():
        for side in (entry.card.a, entry.card.b):
            _warn_of_doubles(name, side, same, scene)
        for surface in {same[word] for word in (*entry.card.a, *entry.card.b)}:
            named[surface].append(name)
    together = {two for names in named.values() for two in combinations(names, 2)}
    for first, second in sorted(together):
        pair = _common(entries[first].card, entries[second].card, same)
        if pair is not None:
            scene.warn(
                f"contacts '{first}' and '{second}' both act between surfaces '{pair[0]}' and "
                f"'{pair[1]}': the forces add up; leave the pair to one of them"
            )


def _warn_of_doubles(
    contact: str, side: tuple[str, ...], same: Mapping[str, str], scene: Scene
) -> None:
    """Warn of surfaces of one side of a card that are the same but for their names."""
    first_of: dict[str, str] = {}
    for surface in side:
        first = first_of.setdefault(same[surface], surface)
        if first != surface:
            scene.warn(
                f"contact '{contact}': surfaces '{first}' and '{surface}' are the same: the forces "
                "add up; leave one of them out"
            )


def _common(first: TwoSided, second: TwoSided, same: Mapping[str, str]) -> tuple[str, str] | None:
    """Two surfaces of the first card that face each other, or their equals, in both cards."""
    for a, b in ((second.a, second.b), (second.b, second.a)):
        some_a = [name for name in first.a if same[name] in {same[word] for word in a}]
        some_b = [name for name in first.b if same[name] in {same[word] for word in b}]
        for one in some_a:
            for other in some_b:
                if one != other:
                    return one, other
    return None
