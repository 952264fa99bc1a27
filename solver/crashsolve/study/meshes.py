"""Meshes of a deck, finer and coarser: fields that divide elements, and limits of a division.

    beam                        mesh.division, so that the names of nodes stay where they are
    frame                       elements of each bar
    shell, generated mesh       mesh.elements, in all directions; of a shared mesh, under meshes
    structure                   divisions of segments and beams, across of shells

Hinges and rigid members have no mesh. Meshes that are listed or of a file are not divided; to make
them coarser their elements are joined by mesh.joined, where they lie in rows. Of other numbers of
elements n the coarser mesh has n / 2; where n is even and n / 2 is odd one more, so that a node in
the middle stays one; where n is odd (n + 1) / 2; and where n is 1 or 2 as many. On
another mesh the inner nodes of a frame, a beam made coarser and a structure have other names: a
deck that names one is not divided. Consequence to test: a deck divided by 2 and made coarser by 2
has its own numbers of elements.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.reading.items import Entry
from crashsolve.deck.run_cards.expect import Expect
from crashsolve.deck.run_cards.watch import Watch

# deformations of a structure's members, the word that divides them, and the order in its length
STRUCTURE = {"segments": "divisions", "beams": "divisions", "shells": "across"}
# segments yield in the middle of their length
SEGMENTS_ORDER = 1.0
# shells that are smooth, elastic and free of contact (benchmarks/shell_convergence.md)
SHELLS_ORDER = 2.0
Numbers = tuple[int, ...]
# elements that may become one along a side of a given mesh
MAX_JOINED = 8


@dataclass(frozen=True)
class Divisible:
    """A field whose numbers divide elements: its path, and names of nodes that move if it changes.

    `coarser` replaces it where the elements become longer.
    """

    part: str
    path: str
    numbers: Numbers
    is_list: bool = False
    names: frozenset[str] = frozenset()
    coarser: "Divisible | None" = None

    def overrides(self, numbers: Numbers) -> dict[str, str]:
        """Numbers as values for --set."""
        if not self.is_list:
            return {self.path: str(numbers[0])}
        return {f"{self.path}.{k}": str(n) for k, n in enumerate(numbers, 1)}


def divisible(deck: Deck) -> list[Divisible]:
    """Every field that divides elements of a part or structure."""
    own = [part for part in deck.entries["parts"].values() if not part.item.owner]
    fields = [d for part in own for d in _of_part(deck, part)]
    return fields + [d for entry in deck.written_out for d in _of_structure(deck, entry)]


def finer(deck: Deck, factor: int) -> dict[str, str]:
    """Overrides that divide all elements into `factor`. Raises ValueError for why it cannot be."""
    changes: dict[str, str] = {}
    for field in divisible(deck) if factor > 1 else ():
        _check_names(deck, field)
        changes |= field.overrides(tuple(n * factor for n in field.numbers))
    return changes


@dataclass(frozen=True)
class Coarser:
    """Overrides that make elements longer, by the factor `ratio` at most; what stays as it is.

    `kept` are the numbers of elements that are too small to be divided, by their path.
    """

    overrides: dict[str, str]
    ratio: float
    kept: dict[str, int]


def coarser(deck: Deck, factor: int) -> Coarser:
    """Elements about `factor` times as long, a power of 2. Raises ValueError likewise."""
    changes = _joined(deck, factor)
    ratios, kept = [float(factor)] * bool(changes), dict[str, int]()
    for field in divisible(deck):
        own = field
        if field.coarser and any(n % factor for n in field.numbers):
            own = field.coarser
        is_exact = own is not field or field.coarser is None
        numbers = tuple(_coarse(n, factor) if is_exact else n // factor for n in own.numbers)
        new, old = own.overrides(numbers), own.overrides(own.numbers)
        if numbers != own.numbers:
            _check_names(deck, own)
            changes |= new
        ratios += [a / b for a, b in zip(own.numbers, numbers, strict=True) if a != b]
        kept |= {path: int(n) for path, n in old.items() if new[path] == n}
    if not changes:
        path, number = next(iter(kept.items()))
        raise ValueError(f"{path} has {number}, which cannot be divided by 2 and stay above 1")
    return Coarser(changes, max(ratios), kept)


def _coarse(n: int, factor: int) -> int:
    """Number of elements about `factor` times as long, of n along a side."""
    while factor > 1:
        half = (n + 1) // 2
        n, factor = n if n <= 2 else half + half % 2 * (1 - n % 2), factor // 2
    return n


def _joined(deck: Deck, factor: int) -> dict[str, str]:
    """Overrides that join elements of listed meshes and of files. Raises ValueError likewise."""
    changes = {}
    for name in undivided(deck):
        path, mesh = _mesh_of(deck, deck.entries["parts"][name])
        if not hasattr(mesh, "joined"):
            raise ValueError(f"{name} has a mesh that cannot be made coarser")
        if mesh.joined * factor > MAX_JOINED:
            raise ValueError(f"elements of {name} are joined by {mesh.joined} already")
        changes[f"{path}.joined"] = str(mesh.joined * factor)
    return changes


def undivided(deck: Deck) -> list[str]:
    """Names of the parts that have elements and cannot be divided."""
    divided = {field.part for field in divisible(deck)}
    parts = deck.entries["parts"].values()
    return [part.name for part in parts if not part.item.owner and part.name not in divided]


def has_mesh(deck: Deck) -> bool:
    """Whether errors of elements, or of segments, are among those of a deck."""
    return bool(deck.entries["parts"] or divisible(deck))


def has_segments(deck: Deck) -> bool:
    """Whether a structure has members of segments."""
    return any("segments" in _deformations(entry.card) for entry in _structures(deck))


def _of_part(deck: Deck, part: Entry) -> Iterator[Divisible]:
    card = part.card
    name, (path, mesh) = part.name, _mesh_of(deck, part)
    if hasattr(mesh, "division"):
        inner = frozenset(card.node_names(name)[1:-1]) | frozenset(card.element_names(name))
        plain = Divisible(name, f"parts.{name}.mesh.elements", (mesh.elements,), names=inner)
        path = f"parts.{name}.mesh.division"
        yield Divisible(name, path, (mesh.division,), coarser=plain)
    elif mesh is not None and _is_count(getattr(mesh, "elements", None)):
        given = mesh.elements
        numbers = tuple(given) if isinstance(given, tuple) else (given,)
        yield Divisible(name, f"{path}.elements", numbers, isinstance(given, tuple))
    elif hasattr(card, "bars"):
        points = {f"{name}_{k}" for k in range(1, len(card.points) + 1)}
        inner = frozenset(card.node_names(name)) - points
        inner |= frozenset(card.element_names(name)) - points
        yield Divisible(name, f"parts.{name}.elements", (card.elements,), names=inner)


def _mesh_of(deck: Deck, part: Entry) -> tuple[str, Any]:
    """The path of a part's mesh and its card: of a shared one, those of the whole."""
    mesh: Any = getattr(part.card, "mesh", None)
    shared = getattr(mesh, "mesh", "")
    if shared:
        return f"meshes.{shared}", deck.entries["meshes"][shared].card
    return f"parts.{part.name}.mesh", mesh


def _is_count(elements: object) -> bool:
    return isinstance(elements, int | tuple) and elements != ()


def _structures(deck: Deck) -> list[Entry]:
    return [entry for entry in deck.written_out if hasattr(entry.card, "deformation")]


def _deformations(card: Any) -> list[str]:
    return [member.deformation or card.deformation for member in card.members]


def _of_structure(deck: Deck, entry: Entry) -> Iterator[Divisible]:
    card = entry.card
    if not hasattr(card, "deformation"):
        return
    base, inner = f"parts.{entry.name}", _inner_names(deck, entry)
    words, own = set(), {}
    for k, (member, deformation) in enumerate(zip(card.members, _deformations(card), strict=True)):
        word = STRUCTURE.get(deformation)
        if word == "divisions" and member.divisions is not None:
            own[f"{base}.members.{k + 1}.divisions"] = member.divisions
        elif word is not None:
            words.add(word)
    own |= {f"{base}.{word}": getattr(card, word) for word in sorted(words)}
    for path, number in own.items():
        yield Divisible(entry.name, path, (number,), names=inner)


def _inner_names(deck: Deck, entry: Entry) -> frozenset[str]:
    """Names of bodies and nodes within members, which stand elsewhere on another mesh."""
    points = {f"{entry.name}_{point.name}" for point in entry.card.points}
    names = set()
    for keyword in ("bodies", "springs", "parts"):
        for entry_of_structure in deck.entries[keyword].values():
            if entry_of_structure.item.owner != entry.item.title:
                continue
            if keyword == "parts":
                for word in ("node_names", "element_names"):
                    names |= set(
                        getattr(entry_of_structure.card, word, lambda _: ())(
                            entry_of_structure.name
                        )
                    )
            else:
                names.add(entry_of_structure.name)
    return frozenset(names - points)


def _check_names(deck: Deck, field: Divisible) -> None:
    """Raise ValueError where the deck names a node that would stand elsewhere."""
    for name in sorted(_words(deck) & field.names):
        raise ValueError(f"the deck names {name}, which is elsewhere if {field.path} changes")


def _words(deck: Deck) -> set[str]:
    texts = [path.read_text("utf-8", "replace") for path in deck.files]
    # a run in memory may watch channels that no file names
    cards: list[Watch | Expect] = [*deck.watch, *deck.expect]
    texts += [str(card.channel) for card in cards] + list(deck.given.values())
    return {word for text in texts for word in re.findall(r"\w+", text)}
