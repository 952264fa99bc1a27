"""Elements joined by fours, where those of a given mesh lie in rows: the mesh twice as coarse.

Each element of a mesh whose elements were divided by 2 has one corner that was there before, the
opposite one in the middle of four elements, and two in the middle of sides. One corner of one
element determines all others, from neighbour to neighbour; of the four choices the one is taken
that holds all over. Consequence to test: a mesh that is divided by 2 and joined is itself again.
"""

from collections import defaultdict
from typing import Protocol

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.meshes._mesh import Mesh

# number of a node before its mesh was divided
CORNER, SIDE, MIDDLE = range(3)
ROWS = "its elements do not lie in rows of even numbers, that could be joined in pairs"


def joined(mesh: Mesh, factor: int) -> Mesh:
    """The mesh with elements `factor` times as long, 2, 4, ... . Raises ValueError for why not."""
    while factor > 1:
        mesh, factor = _half(mesh), factor // 2
    return mesh


class Joined(Protocol):
    """A card of a mesh whose elements may be joined."""

    @property
    def joined(self) -> int: ...


def coarsened(mesh: Mesh, card: Joined, scene: Scene) -> Mesh:
    """The mesh of a card with elements joined by `joined`; an error of the deck where that is
    impossible.
    """
    try:
        return joined(mesh, card.joined)
    except ValueError as why:
        raise scene.fail(f"the mesh cannot be joined: {why}", "mesh.joined") from None


def _half(mesh: Mesh) -> Mesh:
    quads = mesh.quads
    if (np.sort(quads, axis=1)[:, 1:] == np.sort(quads, axis=1)[:, :-1]).any():
        raise ValueError("it has triangles, which are not joined")
    kinds = _kinds(quads)
    blocks = _blocks(quads, kinds)
    coarse = np.array([_around(quads[own], kinds) for own in blocks])
    remaining = np.unique(coarse)
    index = np.full(len(mesh.points), -1)
    index[remaining] = np.arange(len(remaining))
    sets = {}
    for name, own in mesh.sets.items():
        sets[name] = index[own][index[own] >= 0]
        if len(own) and not len(sets[name]):
            raise ValueError(f"no node of set '{name}' is a corner of joined elements")
    return Mesh(mesh.points[remaining], index[coarse], sets, _sets_of(blocks, mesh.element_sets))


def _sets_of(blocks: list[np.ndarray], fine: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Element sets of joined elements. Raises ValueError where one would be partly in a set."""
    sets = {}
    for name, own in fine.items():
        count = np.array([np.isin(four, own).sum() for four in blocks])
        if not np.isin(count, (0, 4)).all():
            raise ValueError(f"the border of element set '{name}' runs through joined elements")
        sets[name] = np.flatnonzero(count)
    return sets


def _kinds(quads: np.ndarray) -> np.ndarray:
    """Kind of every node before the division, of all connected patches of elements."""
    beside = defaultdict(list)
    for element, quad in enumerate(quads.tolist()):
        for k in range(4):
            beside[frozenset((quad[k], quad[(k + 1) % 4]))].append(element)
    kinds = np.full(quads.max() + 1, -1)
    for first in range(len(quads)):
        if (kinds[quads[first]] < 0).any():
            kinds = _of_patch(quads, beside, kinds, first)
    return kinds


def _of_patch(
    quads: np.ndarray, beside: dict[frozenset[int], list[int]], kinds: np.ndarray, first: int
) -> np.ndarray:
    """The kinds with those of one patch. Raises ValueError where no choice holds all over."""
    for corner in range(4):
        tried = kinds.copy()
        own = _spread(quads, beside, tried, first, corner)
        if own is not None and _holds(quads[own], tried):
            return tried
    raise ValueError(ROWS)


def _spread(
    quads: np.ndarray,
    beside: dict[frozenset[int], list[int]],
    kinds: np.ndarray,
    first: int,
    corner: int,
) -> list[int] | None:
    """Elements of the patch of `first`; None where kinds contradict each other. Writes: kinds."""
    left, visited = [(first, corner)], {first}
    while left:
        element, k = left.pop()
        quad = quads[element].tolist()
        for j, kind in enumerate((CORNER, SIDE, MIDDLE, SIDE)):
            node = quad[(k + j) % 4]
            if kinds[node] not in (-1, kind):
                return None
            kinds[node] = kind
        for j in range(4):
            pair = quad[j], quad[(j + 1) % 4]
            for other in set(beside[frozenset(pair)]) - visited:
                visited.add(other)
                left.append((other, _corner_of(quads[other].tolist(), kinds, pair)))
    return sorted(visited)


def _corner_of(quad: list[int], kinds: np.ndarray, pair: tuple[int, int]) -> int:
    """Node of an element that was a corner, from the kinds of two that it shares."""
    at = {int(kinds[node]): quad.index(node) for node in pair}
    return at[CORNER] if CORNER in at else (at[MIDDLE] + 2) % 4


def _holds(quads: np.ndarray, kinds: np.ndarray) -> bool:
    """Whether four elements lie around every middle, and none of its sides is open."""
    middles = quads[kinds[quads] == MIDDLE]
    return bool((np.unique(middles, return_counts=True)[1] == 4).all())


def _blocks(quads: np.ndarray, kinds: np.ndarray) -> list[np.ndarray]:
    """The four elements around each middle."""
    middles = quads[np.arange(len(quads)), np.argmax(kinds[quads] == MIDDLE, axis=1)]
    order = np.argsort(middles, kind="stable")
    return list(order.reshape(-1, 4))


def _around(quads: np.ndarray, kinds: np.ndarray) -> list[int]:
    """Corners of four elements around a middle, in their order."""
    follows, corners = {}, {}
    for quad in quads.tolist():
        k = int(np.argmax(kinds[quad] == CORNER))
        before, after = quad[(k + 3) % 4], quad[(k + 1) % 4]
        follows[before], corners[before] = after, quad[k]
    at, ring = next(iter(follows)), []
    for _ in range(4):
        if at not in follows:
            raise ValueError(ROWS)
        ring.append(corners[at])
        at = follows.pop(at)
    return ring
