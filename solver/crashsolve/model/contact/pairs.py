"""Pairs of contact elements: which may touch at all, and, among many, which are near.

A group with few possible pairs keeps them all. One with many keeps those whose bounding spheres
come within a margin, of each other or of a plane at rest, and renews the list when an element has
moved by half the margin. A pair that stays in the list keeps its history; the losses of a pair that
leaves are added to its contact card.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.record import Record
from crashsolve.model.contact.groups import ContactGroup, NearPairs
from crashsolve.model.contact.pieces import cut
from crashsolve.model.model import State

if TYPE_CHECKING:
    from collections.abc import Mapping

# a group with more possible pairs than this keeps lists of the near ones; implicit methods, whose
# tangents need fixed pairs, from many more on, and groups whose pairs are skipped while separated
# (system/contact/resting.py), which costs less than new lists
SEARCH_ABOVE, SEARCH_ABOVE_IMPLICIT, SEARCH_ABOVE_RESTING = 180, 500, 1000
# margin of the list of near pairs, in shares of the mean radius of the bounding spheres; planes
# have few near pairs
MARGIN, MARGIN_OF_PLANES = 0.5, 4.0
# share of the slack by which every pair outside the list is separated when the list is renewed: of
# a margin of two, each of both elements has moved by 0.7, and in a step by 0.2, at most
# (system/contact/touches.py)
SEPARATION_OF_OTHERS = 0.2
# extent of infinite elements [m]: finite, so that its product with no rotation is 0
INFINITE_EXTENT = 1e300
CENTRE_AT_SEARCH = Record("r  m  3  centre of an element when the list was made")


@dataclass(eq=False)
class Elements:
    """Elements of one side as pairing needs them; arrays over the elements."""

    node: np.ndarray
    rank: np.ndarray  # index of the surface in the deck
    round: np.ndarray  # class of equal radii of curvature
    centre: np.ndarray  # of the bounding sphere, body axes from the mass centre
    radius: np.ndarray  # of the bounding sphere; infinite for a plane
    thick: np.ndarray  # half thickness; infinite for a plane
    normal: np.ndarray  # of a plane, body axes; 0 for others
    reach: np.ndarray  # how far it reaches from the mass centre; ENDLESS for a plane

    def spread(self) -> np.ndarray:
        """Extent of each element beyond its thickness [m]; 0 of infinite ones."""
        is_infinite = np.isinf(self.radius)
        return np.where(is_infinite, 0.0, self.radius - np.where(is_infinite, 0.0, self.thick))


@dataclass(eq=False)
class Block:
    """Pairs under one contact card: elements of side a against elements of side b."""

    card: int
    speed_floor: float
    order: int  # +1 when the gap's first shape is side a of the card, else -1
    member: tuple[np.ndarray, np.ndarray]  # which elements, by side of the gap
    on_both: tuple[np.ndarray, np.ndarray]  # which of them the card names on both its sides
    law: np.ndarray  # row of the table of laws, by the classes of the two elements


class Pairing:
    """All possible pairs of a contact group."""

    def __init__(
        self, sides: tuple[Elements, Elements], blocks: list[Block], laws: np.ndarray
    ) -> None:
        self.sides, self.blocks, self.laws = sides, blocks, laws

    def should_search(self, is_implicit: bool) -> bool:
        """Whether there are many possible pairs, of elements with an end or with planes at rest."""
        has_reach = "reach_a" in (self.laws.dtype.names or ())
        above = SEARCH_ABOVE_RESTING if has_reach else SEARCH_ABOVE
        above = SEARCH_ABOVE_IMPLICIT if is_implicit else above
        count = sum(int(b.member[0].sum()) * int(b.member[1].sum()) for b in self.blocks)
        first, second = self.sides
        planes = np.isinf(second.radius)
        at_rest = planes.all() and not second.node.any()
        has_size = np.isfinite(first.radius).all() and first.radius.any()
        return bool(count > above and has_size and (at_rest or not planes.any()))

    def everything(self) -> np.ndarray:
        """Parameters of all possible pairs."""
        allowed = []
        for block in self.blocks:
            a, b = (np.flatnonzero(member) for member in block.member)
            allowed.append(self._allowed(block, np.repeat(a, len(b)), np.tile(b, len(a))))
        return np.concatenate(allowed)

    def chosen(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Parameters of the allowed ones among the given pairs, sorted by card, a, b."""
        allowed = []
        for block in self.blocks:
            keep = block.member[0][a] & block.member[1][b]
            allowed.append(self._allowed(block, a[keep], b[keep]))
        if len(allowed) == 1:
            # they are in this order
            return allowed[0]
        rows = np.concatenate(allowed)
        return rows[np.lexsort((rows["b"], rows["a"], rows["card"]))]

    def _allowed(self, block: Block, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Pairs on two bodies; of two surfaces named on both sides of a card, only one order."""
        first, second = self.sides
        twice = block.on_both[0][a] & block.on_both[1][b]
        in_order = block.order * (second.rank[b] - first.rank[a]) > 0
        keep = (first.node[a] != second.node[b]) & (in_order | ~twice)
        a, b = a[keep], b[keep]
        rows = self.laws[block.law[first.round[a], second.round[b]]]
        rows["a"], rows["b"], rows["card"] = a, b, block.card
        rows["speed_floor"], rows["order"] = block.speed_floor, block.order
        rows["thick"] = first.thick[a] + second.thick[b]
        rows["spread_a"], rows["spread_b"] = first.spread()[a], second.spread()[b]
        if "reach_a" in rows.dtype.names:
            rows["reach_a"], rows["reach_b"] = first.reach[a], second.reach[b]
        return rows


class Search:
    """The list of near pairs of a group, and the centres of its elements when it was made."""

    def __init__(self, pairing: Pairing) -> None:
        self.pairing = pairing
        radii = np.concatenate([side.radius for side in pairing.sides])
        share = MARGIN_OF_PLANES if np.isinf(pairing.sides[1].radius).all() else MARGIN
        self.margin = share * float(radii[np.isfinite(radii)].mean())
        self.slack = np.array([0.5 * self.margin])
        self.references = tuple(
            np.zeros(len(side.centre), CENTRE_AT_SEARCH.dtype) for side in pairing.sides
        )

    @property
    def laws(self) -> np.ndarray:
        """Parameters of the laws, by kind of pair."""
        return self.pairing.laws

    def cards(self) -> list[int]:
        """Contact cards whose pairs are in the list."""
        return sorted({block.card for block in self.pairing.blocks})

    def arrays(self) -> dict[str, np.ndarray]:
        """Arrays from which the step determines when pairs must be searched again."""
        return {
            "reference_a": self.references[0],
            "reference_b": self.references[1],
            "slack": self.slack,
        }

    def update(self, nodes: np.ndarray | Mapping[str, np.ndarray]) -> np.ndarray:
        """Parameters of the near pairs now. Writes: references."""
        for side, reference in zip(self.pairing.sides, self.references, strict=True):
            A = nodes["A"][side.node].reshape(-1, 3, 3)
            reference["r"] = nodes["r"][side.node] + np.einsum("nij,nj->ni", A, side.centre)
        first, second = self.pairing.sides
        if np.isinf(second.radius).all():
            near = self._near_planes()
        else:
            from crashsolve.contact.broad import near_pairs

            near = near_pairs(
                self.references[0]["r"],
                first.radius,
                self.margin,
                self.references[1]["r"],
                second.radius,
            )
        return self.pairing.chosen(near[:, 0], near[:, 1])

    def _near_planes(self) -> np.ndarray:
        """Pairs (m, 2) of spheres and planes at rest whose gap is below the margin."""
        first, second = self.pairing.sides
        height = self.references[0]["r"] @ second.normal.T - (
            self.references[1]["r"] * second.normal
        ).sum(axis=1)
        return np.argwhere(height - first.radius[:, None] < self.margin)


def resting(count: int, dtype: np.dtype, search: NearPairs | None) -> np.ndarray:
    """Both sides of the history of separated pairs with at least this gap."""
    history = np.zeros((2, count), dtype)
    history["depth"] = -SEPARATION_OF_OTHERS * search.slack[0] if search else 0.0
    return history


def renew(groups: list[ContactGroup], state: State) -> None:
    """Renew the lists of near pairs.

    Writes: groups, and the losses of pairs that left to the cards.
    """
    current = int(state.clock[0]["current"])
    for group in groups:
        if group.search is not None:
            _renew(group, group.search, state, current)


def _renew(group: ContactGroup, search: NearPairs, state: State, current: int) -> None:
    rows = search.update(state.nodes)
    before, after = (_identity(group, p) for p in (group.parameters, rows))
    # both lists are in ascending order, and so are the pairs that stay
    at = np.searchsorted(after, before)
    kept = np.append(after, -1)[at] == before
    history = resting(len(rows), group.history.dtype, search)
    history[:, at[kept]] = group.history[current, kept]
    left = group.parameters["card"][~kept], group.history[current, ~kept]
    _add_losses_of_removed(*left, flags_of(group.normal), state.card_history)
    take_pairs(group, rows, history)


def take_pairs(group: ContactGroup, rows: np.ndarray, history: np.ndarray) -> None:
    """Replace the list of pairs, with their histories. Writes: group."""
    group.parameters, group.history = rows, history
    group.output = np.zeros(len(rows), group.output.dtype)
    if group.in_pieces:
        cut(group)


def _identity(group: ContactGroup, rows: np.ndarray) -> np.ndarray:
    """One number per pair, ascending along a list."""
    width = len(group.elements_b)
    return (rows["card"] * len(group.elements_a) + rows["a"]) * width + rows["b"]


def flags_of(law: object) -> list[str]:
    """Columns of HISTORY of a normal law that are flags, in the order of their bits."""
    return [*getattr(law, "WARNINGS", {}), *getattr(law, "REMARKS", {})]


def _add_losses_of_removed(
    card: np.ndarray, history: np.ndarray, warnings: list[str], cards: np.ndarray
) -> None:
    """Add losses and flags of pairs that leave the list to their cards. Writes: cards."""
    for side in cards:
        for name in ("dissipated", "friction_dissipated"):
            np.add.at(side[f"left_{name}"], card, history[name])
        for bit, name in enumerate(warnings):
            np.bitwise_or.at(side["left_warnings"], card[history[name] != 0], 1 << bit)
