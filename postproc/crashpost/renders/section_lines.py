"""Sections of shells whose forces are written (secforc), as lines that move with their elements."""

from typing import NamedTuple

import numpy as np

from crashpost.results.result import Result
from crashpost.results.states import Block
from crashpost.values.injury import sensor_cards


class Section(NamedTuple):
    """A section cut of a deck: part, name, point and normal of its plane at the start."""

    part: str
    name: str
    at: tuple[float, ...]
    normal: tuple[float, ...]


def sections(result: Result) -> tuple[Section, ...]:
    """All section cuts of the stored deck."""
    section_cuts = []
    for part, card in sensor_cards(result, "parts").items():
        for entry in card.get("section_cuts") or ():
            at, normal = (tuple(map(float, entry[word])) for word in ("at", "normal"))
            section_cuts.append(Section(part, str(entry["name"]), at, normal))
    return tuple(section_cuts)


def weights(block: Block, section: Section) -> tuple[np.ndarray, np.ndarray]:
    """Points at which a section crosses edges of shells at the start.

    For both ends of each segment (n, 2): the edge's nodes (n, 2, 2), and the share of the way.
    """
    above = (block.points - np.array(section.at)) @ np.array(section.normal)
    edges, shares = [np.empty((0, 2, 2), int)], [np.empty((0, 2))]
    for _, corners in block.cells:
        if corners.shape[1] not in (3, 4):
            continue
        after = np.roll(corners, -1, axis=1)
        crosses = (above[corners] > 0) != (above[after] > 0)
        rows = np.flatnonzero(crosses.sum(axis=1) == 2)
        ends = np.stack([corners, after], axis=2)[rows][crosses[rows]].reshape(-1, 2, 2)
        edges.append(ends)
        shares.append(above[ends[..., 0]] / (above[ends[..., 0]] - above[ends[..., 1]]))
    return np.concatenate(edges), np.concatenate(shares)


def lines(points: np.ndarray, edges: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """The segments (n, 2, 3) of a section whose nodes are at points (m, 3) now."""
    ends: np.ndarray = points[edges[..., 0]] + shares[..., None] * (
        points[edges[..., 1]] - points[edges[..., 0]]
    )
    return ends
