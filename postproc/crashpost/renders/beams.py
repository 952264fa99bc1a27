"""Elements of beams as prisms with the outline of their section."""

from collections.abc import Iterator

import numpy as np

from crashpost.results.states import States

# numbers of elements (n,), corners of their section, its outlines at both ends (n, 2, corners, 3)
Outline = tuple[np.ndarray, int, np.ndarray]


def outlines(
    states: States, number: int, points: np.ndarray, shown: np.ndarray, magnify: float
) -> Iterator[Outline]:
    """For each section the elements with it that are shown (m,); points (2 m, 3) of their ends."""
    fixed, ends = states.blocks["beams"].fixed, points.reshape(-1, 2, 3)
    for kind, outline in enumerate(states.sections if "side" in fixed else []):
        own = np.flatnonzero((fixed["section"].astype(int) == kind) & shown)
        if len(own):
            yield own, len(outline), rings(states, number, own, kind, ends, magnify)


def rings(
    states: States,
    number: int,
    own: np.ndarray,
    kind: int,
    ends: np.ndarray,
    magnify: float = 1.0,
) -> np.ndarray:
    """Outlines (n, 2, k, 3) of a section at both ends of elements, each turned with its node.

    `own` are the numbers of the elements, `ends` (m, 2, 3) the positions of the ends of all;
    rotations are drawn `magnify` times as large.
    """
    block = states.blocks["beams"]
    vectors = states.read_one(number, "beams", "rotation").astype(float)
    rotated_corners = rotated(magnify * vectors).reshape(-1, 2, 3, 3)
    start = block.points.reshape(-1, 2, 3)
    axis = start[:, 1] - start[:, 0]
    y = block.fixed["side"].astype(float)
    z = np.cross(axis / np.linalg.norm(axis, axis=1)[:, None], y)
    outline = states.sections[kind]
    flat = y[own, None] * outline[:, :1] + z[own, None] * outline[:, 1:]
    both = [
        ends[own, end][:, None] + np.einsum("nij,nkj->nki", rotated_corners[own, end], flat)
        for end in (0, 1)
    ]
    circles: np.ndarray = np.stack(both, axis=1)
    return circles


def prisms(count: int, corners: int) -> tuple[np.ndarray, np.ndarray]:
    """Sides (quads) and ends (polygons) of prisms, each with two rings of corners."""
    base = np.arange(corners)
    after = np.roll(base, -1)
    one = np.column_stack([base, after, after + corners, base + corners])
    first = 2 * corners * np.arange(count)[:, None, None]
    ends = np.stack([base[::-1], base + corners])
    return (first + one).reshape(-1, 4), (first + ends).reshape(-1, corners)


def rotated(vectors: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3) (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)
    axis = vectors / np.where(angle > 0.0, angle, 1.0)[:, None]
    x, y, z = axis.T
    zero = np.zeros_like(x)
    K = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    sine, rest = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    R: np.ndarray = np.eye(3) + sine * K + rest * (K @ K)
    return R
