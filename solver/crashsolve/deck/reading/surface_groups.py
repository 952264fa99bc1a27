"""Contacts that name an entry which stands for many surfaces, such as a structure.

The module of its type has `surfaces`, see deck/expansion.py; in the contact its name is replaced by
the names of these surfaces.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

from crashsolve.deck.diagnostics import Diagnostic
from crashsolve.deck.expansion import Made, Problem, add, known
from crashsolve.deck.reading.items import Entry, Item, Items
from crashsolve.deck.source import Rows

# surfaces so small that they could pass between the nodes of a mesh
BALLS = {"sphere", "ellipsoid", "nodes", "point_set"}


class SurfaceGroups:
    """Entries whose names stand for surfaces, and the surfaces made of them."""

    def __init__(
        self,
        entries: list[Entry],
        laws: Mapping[str, Mapping[str, Entry]],
        control: object,
        items: Items,
        refuse: Callable[[Item, Diagnostic], None],
    ) -> None:
        self.entries = {
            e.name: e for e in entries if hasattr(import_module(e.module_name), "surfaces")
        }
        self.laws, self.items, self.refuse = known(laws), items, refuse
        self.control = control if isinstance(control, Mapping) else {}
        self._made: dict[tuple[str, bool], list[Made]] = {}
        self._added: set[str] = set()

    def substitute(self, contact: Item) -> None:
        """Put surfaces in place of the names of entries. Writes: items, the contact's value."""
        value = contact.value
        sides: list[Any] = [
            value.get(side) if isinstance(value, Mapping) else None for side in "ab"
        ]
        if not all(isinstance(names, Rows) for names in sides):
            return
        on_both = [name for name in sides[0] if self._is_group(name) and name in sides[1]]
        if on_both:
            message = (
                f"'{on_both[0]}' is on both sides: its name does not define contact with itself"
            )
            self.refuse(contact, Diagnostic(("b",), message, "see self_contact on its card"))
            return
        substitutes = [self._side(contact, k, sides) for k in (0, 1)]
        for side, names in zip("ab", substitutes, strict=True):
            value[side] = names
        added = ([name for name in names if self._is_added(name)] for names in substitutes)
        if all("nodes" in map(self._type, names) for names in added):
            message = "both of its structures have shells, and nodes cannot press on nodes"
            advice = "name the nodes of one and the faces of the other, as separate surfaces"
            self.refuse(contact, Diagnostic((), message, advice))

    def _is_group(self, name: object) -> bool:
        """Whether a name in a contact is that of an entry, and of no surface."""
        return isinstance(name, str) and name in self.entries and name not in self.items["surfaces"]

    def _is_added(self, name: object) -> bool:
        return isinstance(name, str) and name in self._added

    def _side(self, contact: Item, k: int, sides: list[Rows]) -> Rows:
        """The names of a side with those of surfaces in place of entries."""
        names, others = sides[k], sides[1 - k]
        rows = Rows(names.file)
        for i, name in enumerate(names):
            path = ("ab"[k], i)
            one = self._surfaces(contact, path, name, others) if self._is_group(name) else [name]
            rows.extend(one)
            rows.values_at.extend([names.values_at[i]] * len(one))
        return rows

    def _surfaces(self, contact: Item, path: tuple[str, int], name: str, others: Rows) -> list[str]:
        """Names of the surfaces of an entry that others face. Writes: items."""
        types, entry = set(map(self._type, others)), self.entries[name]
        try:
            at_nodes, at_faces = (self._of(entry, faces_balls) for faces_balls in (False, True))
        except Problem as problem:
            self.refuse(entry.item, Diagnostic(problem.path, problem.message, problem.advice))
            return []
        if at_nodes != at_faces and types & BALLS and types - BALLS:
            message = (
                f"the shells of '{name}' touch balls with their faces, and other shapes with their "
                "nodes"
            )
            self.refuse(
                contact, Diagnostic(path, message, "define a separate contact for the balls")
            )
        substitutes = at_faces if types <= BALLS else at_nodes
        add(
            entry,
            [card for card in substitutes if card.name not in self._added],
            self.items,
            self.refuse,
        )
        self._added |= {card.name for card in substitutes}
        return [card.name for card in substitutes]

    def _of(self, entry: Entry, faces_balls: bool) -> list[Made]:
        """The cards that replace an entry, made once. Raises Problem."""
        key = (entry.name, faces_balls)
        if key not in self._made:
            make = import_module(entry.module_name).surfaces
            self._made[key] = make(entry.name, entry.card, self.laws, self.control, faces_balls)
        return self._made[key]

    def _type(self, name: object) -> str:
        """Type of the surface of a name; nothing if it is no surface."""
        item = self.items["surfaces"].get(name) if isinstance(name, str) else None
        value = item.value if item else None
        return str(value.get("type", "")) if isinstance(value, Mapping) else ""
