"""Pieces: parts with points cut into ranges of blocks, which several threads do side by side.

A piece is a row of the part's parameters with fewer points and elements. No two pieces add to the
same entry: the forces on a corner at a point that an earlier piece has corners at go to a point of
its own, behind all others, that stands for it. It is added afterwards in the order of the elements,
so every sum has the order that it has without pieces.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.point import LANES, POINT
from crashsolve.foundation.record import Record
from crashsolve.model.model import Model, Pieces, State

if TYPE_CHECKING:
    from crashsolve.elements.shells.layout import DiscretisedShell

PIECE = Record("""
    first_replica  index  of those that it collects
    replica_count  count  of them
    rate           1/s^2  bound of the squared frequencies found in it
    element        index  that has it
    first_point    index  of its points
    speed          m/s    the largest of them
""")
ORIGINAL = Record("""
    point      index  whose forces a replica collects
    is_damped  flag   whether its element has damping
""")
SPAN = Record("""
    first            index  of the rows of an entry's pieces
    count            count  of them
    first_piece      index  which these are among all pieces
    first_collector  index  of the pieces that collect the forces of its replicas
    collector_count  count  of them
""")
QUADS = ("one_point", "four_points")
# of a thread: one that is held up leaves those to others that it has not begun
PIECES = 4


def cut(model: Model, state: State, threads: int) -> Pieces:
    """All parts with points in pieces.

    Writes: state.points and elements.corners, which become views of longer tables.
    """
    elements, count = model.elements, len(state.points)
    assert elements is not None
    begin = len(elements.corners)
    corners = np.concatenate([elements.corners, elements.corners])
    rows: dict[str, list[np.void]] = {g.word: [] for g in model.element_groups()}
    bounds_of: list[list[int]] = []
    of_part: dict[int, list[tuple[int, int, np.void]]] = {}
    parts = [
        (g, *pair)
        for g in model.element_groups()
        for pair in zip(g.names, g.parameters, strict=True)
    ]
    total, done = sum(_blocks_of(row) for _, _, row in parts), 0
    for g, name, row in parts:
        bounds = _bounds(_blocks_of(row), total, PIECES * threads)
        cuts = [_piece(row, elements.parts[name], *ends, bounds[-1]) for ends in pairwise(bounds)]
        of_part[int(row["first_corner"])] = [
            (done + k, bounds[k], one) for k, one in enumerate(cuts)
        ]
        bounds_of.append(bounds)
        done += len(cuts)
        for one in cuts:
            one["aside"] = begin
        rows[g.word] += cuts
    pieces = np.zeros(done, PIECE.dtype)
    of_groups = [one for g in model.element_groups() for one in rows[g.word]]
    pieces["first_point"] = [one["first_point"] for one in of_groups]
    firsts = [elements.parts[name].first for _, name, _ in parts]
    originals = _all_replicas(
        [row for *_, row in parts], firsts, bounds_of, corners[begin:], count, pieces
    )
    elements.corners = corners[:begin]
    spans = {}
    for g in model.element_loads():
        rows[g.word], spans[g.word] = _loads(g.parameters, of_part)
        if len(set(firsts)) < len(firsts):
            # replicas of other parts may have forces of a load
            spans[g.word]["first_collector"], spans[g.word]["collector_count"] = 0, len(pieces)
    table = np.zeros(count + len(originals), POINT.dtype)
    table[:count] = state.points
    state.points = table[:count]
    by_word = {word: np.array(indices) for word, indices in rows.items()}
    return Pieces(by_word, spans, pieces, table, originals)


def _bounds(blocks: int, total: int, pieces: int) -> list[int]:
    """Bounds of the pieces of a part, in blocks: its share of all pieces, one at least."""
    own = min(blocks, max(1, round(pieces * blocks / total)))
    return [blocks * k // own for k in range(own + 1)]


def _piece(row: np.void, meshed: DiscretisedShell, begin: int, end: int, blocks: int) -> np.void:
    """The row of a part with the blocks from `begin` to `end`, and a share of its points."""
    one, triangles = row.copy(), int(row["triangles"])
    quads = int(row["element_count"]) - triangles
    filled = _blocks(quads)
    (n, m), (n_end, m_end) = (
        (min(LANES * at, quads), min(LANES * max(at - filled, 0), triangles)) for at in (begin, end)
    )
    for kind in QUADS:
        one[kind] = n_end - n if row[kind] else 0
    one["triangles"] = m_end - m
    one["element_count"] = n_end - n + m_end - m
    one["first"] += min(begin, filled) * meshed.stride
    one["first"] += max(begin - filled, 0) * meshed.stride_of(1)
    one["first_corner"] += 4 * LANES * begin
    one["first_element"] += n + m
    points = int(row["point_count"])
    first, last = points * begin // blocks, points * end // blocks
    one["first_point"] += first
    one["point_count"] = last - first
    return one


def _all_replicas(
    rows: list[np.void],
    firsts: list[int],
    bounds: list[list[int]],
    corners: np.ndarray,
    count: int,
    pieces: np.ndarray,
) -> np.ndarray:
    """All rows of ORIGINAL; parts whose points begin at the same of `firsts` share a mesh.

    Writes: corners, pieces.
    """
    begun = np.cumsum([0, *(len(own) - 1 for own in bounds)])
    originals: list[np.ndarray] = []
    for first in dict.fromkeys(firsts):
        same = [k for k, own in enumerate(firsts) if own == first]
        replicas = sum(map(len, originals))
        own = _add_replicas(
            [rows[k] for k in same], [bounds[k] for k in same], corners, count, replicas
        )
        ends = replicas + np.cumsum([0, *map(len, own)])
        at = np.concatenate([np.arange(begun[k], begun[k + 1]) for k in same])
        pieces["first_replica"][at], pieces["replica_count"][at] = ends[:-1], np.diff(ends)
        originals += own
    return np.concatenate(originals)


def _add_replicas(
    rows: list[np.void], bounds: list[list[int]], corners: np.ndarray, count: int, replicas: int
) -> list[np.ndarray]:
    """Rows of ORIGINAL, point by point, in as many shares as the parts of a mesh have pieces.

    Replicas begin at `count`; `replicas` of them are in use already. Writes: corners of
    the parts.
    """
    own = [
        corners[int(row["first_corner"]) :][: 4 * LANES * b[-1]]
        for row, b in zip(rows, bounds, strict=True)
    ]
    table = np.concatenate(own).reshape(-1, 4, LANES)
    sizes = np.concatenate([np.diff(b) for b in bounds])
    of_block = np.repeat(np.arange(len(sizes)), sizes)
    piece = np.broadcast_to(of_block[:, None, None], table.shape)
    # the first piece with a corner at a point: the last that is written, backwards
    first = np.zeros(count, int)
    first[table.ravel()[::-1]] = piece.ravel()[::-1]
    shared = (piece > first[table]) & np.concatenate([*map(_live, rows)])[:, None, :]
    # of one point block by block and corner by corner, as forces are added
    points = table[shared]
    order = np.argsort(points, kind="stable")
    index = np.empty_like(points)
    index[order] = count + replicas + np.arange(len(points))
    table[shared] = index
    for some, part in zip(
        own, np.split(table.ravel(), np.cumsum([*map(len, own)])[:-1]), strict=True
    ):
        some[:] = part
    originals = np.zeros(len(points), ORIGINAL.dtype)
    originals["point"], originals["is_damped"] = points[order], rows[0]["is_damped"]
    cuts = len(originals) * np.arange(1, len(sizes)) // len(sizes)
    # all of one point to one piece
    return np.split(originals, np.searchsorted(originals["point"], originals["point"][cuts]))


def _loads(
    rows: np.ndarray, of_part: dict[int, list[tuple[int, int, np.void]]]
) -> tuple[list[np.void], np.ndarray]:
    """Loads on parts, each on the pieces of its own; and where these are."""
    loads: list[np.void] = []
    spans = np.zeros(len(rows), SPAN.dtype)
    for row, span in zip(rows, spans, strict=True):
        pieces = of_part[int(row["first_corner"])]
        span["first"], span["count"], span["first_piece"] = len(loads), len(pieces), pieces[0][0]
        span["first_collector"], span["collector_count"] = pieces[0][0], len(pieces)
        for _, first_block, one in pieces:
            own = row.copy()
            own["first_corner"], own["first_block"] = one["first_corner"], first_block
            own["aside"] = one["aside"]
            own["triangles"] = one["triangles"]
            own["quads"] = one["element_count"] - one["triangles"]
            loads.append(own)
    return loads, spans


def _blocks(elements: int) -> int:
    """Blocks that hold so many elements."""
    return -(-elements // LANES)


def _blocks_of(row: np.void) -> int:
    """Blocks of a part."""
    triangles = int(row["triangles"])
    return _blocks(int(row["element_count"]) - triangles) + _blocks(triangles)


def _live(row: np.void) -> np.ndarray:
    """Mask (blocks, lanes) of the lanes that hold an element of a part."""
    triangles = int(row["triangles"])
    counts = (int(row["element_count"]) - triangles, triangles)
    lanes = [np.arange(LANES * _blocks(n)) < n for n in counts]
    return np.concatenate(lanes).reshape(-1, LANES)
