"""Many contact pairs in pieces, which one thread or several evaluate.

A pair writes its own rows alone: histories, output, and a load for either of its bodies. Sums over
the pairs of a contact card are taken piece by piece, those on a body pair by pair, in the order of
the list: one thread hands them on pair by pair, several when all pieces are done. So any number of
threads gives the bits of one. Groups of few pairs add to bodies and cards at once; the difference
is the order of the sums.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.distinct import distinct
from crashsolve.foundation.record import Record
from crashsolve.model.contact import records

if TYPE_CHECKING:
    from crashsolve.model.contact.groups import ContactGroup

# elements on both sides of a group from which on its pairs are many: its near pairs are about as
# many, and a job for several threads costs as much as some hundred of them
MANY = 1000
# pairs of a piece, and bodies, but for the last ones, as long as there are not too many pieces;
# their number has 16 bits (threads/worker.py), and each card begins with a piece of its own
PAIRS, BODIES = 128, 64
MAX_PIECES = 30_000

PIECE = Record("""
    first    index  first pair
    end      index  first pair after it
    card     index  contact card of all of them
    nearest  m      largest depth that begins in a step; negative is a gap
    before   m      the same at the start of the step
""")
BODY_OF_LOADS = Record("""
    node   index  body that pairs press on
    first  index  of its loads
    end    index  first load after them
""")
RANGE = Record("""
    first  index  first body
    end    index  first body after it
""")


def has_many(group: ContactGroup) -> bool:
    """Whether the pairs of a group are done in pieces."""
    elements = len(group.elements_a) + len(group.elements_b)
    return elements >= MANY and not group.is_unilateral and _cards(group) <= MAX_PIECES


def _cards(group: ContactGroup) -> int:
    """Contact cards of a group."""
    return len(group.search.cards() if group.search else distinct(group.parameters["card"]))


def cut(group: ContactGroup) -> None:
    """The present pairs of a group in pieces. Writes: group."""
    for name, table in tables_of(group, group.parameters).items():
        setattr(group, name, table)


def tables_of(group: ContactGroup, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Pieces of some pairs of a group, sorted by card, and the tables of their sums, by name."""
    pieces = _pieces(rows["card"])
    nodes = np.empty(2 * len(rows), np.int64)
    nodes[0::2] = group.elements_a["node"][rows["a"]]
    nodes[1::2] = group.elements_b["node"][rows["b"]]
    load_rows, loaded_bodies = _bodies(nodes)
    return {
        "pieces": pieces,
        "sums": np.zeros(len(pieces), records.CARD_OUTPUT.dtype),
        "counts": np.zeros(len(pieces), records.COUNTS.dtype),
        "loads": np.zeros(2 * len(rows), records.LOAD.dtype),
        "applied": np.zeros(2 * len(rows), np.int8),
        "load_rows": load_rows,
        "loaded_bodies": loaded_bodies,
        "ranges": _ranges(len(loaded_bodies)),
    }


def _pieces(cards: np.ndarray) -> np.ndarray:
    """Pieces of a list of pairs that is sorted by card, each of one card."""
    size = _size(len(cards), PAIRS)
    starts = np.flatnonzero(np.diff(cards, prepend=-1))
    ends = np.append(starts, len(cards))[1:]
    first = np.concatenate(
        [np.zeros(0, int), *(np.arange(*two, size) for two in zip(starts, ends, strict=True))]
    )
    pieces = np.zeros(len(first), PIECE.dtype)
    pieces["first"], pieces["card"] = first, cards[first]
    pieces["end"] = np.append(first, len(cards))[1:]
    return pieces


def _bodies(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of loads body by body, of one body in their order, and where each body's are."""
    order = np.argsort(nodes, kind="stable")
    load_rows = np.empty(len(nodes), np.int64)
    load_rows[order] = np.arange(len(nodes))
    first = np.flatnonzero(np.diff(nodes[order], prepend=-1))
    loaded_bodies = np.zeros(len(first), BODY_OF_LOADS.dtype)
    loaded_bodies["node"], loaded_bodies["first"] = nodes[order[first]], first
    loaded_bodies["end"] = np.append(first, len(nodes))[1:]
    return load_rows, loaded_bodies


def _ranges(bodies: int) -> np.ndarray:
    """Pieces of a list of bodies."""
    size = _size(bodies, BODIES)
    first = np.arange(0, bodies, size)
    ranges = np.zeros(len(first), RANGE.dtype)
    ranges["first"], ranges["end"] = first, np.minimum(first + size, bodies)
    return ranges


def _size(count: int, usual: int) -> int:
    """Number of pairs in a piece, of `count`."""
    return max(usual, -(-count // MAX_PIECES))
