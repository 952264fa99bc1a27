"""Joints that a posture tears apart: it moves one body of them and leaves the other behind.

A joint whose point is in the frame of one of its bodies finds its point of the other one where they
are at the start. A posture that omits the joint would join its bodies there, a metre apart or
turned; such a deck is refused. A point in the world, or in the frame of a third body, states where
bodies are joined, whatever a posture does to them.
"""

from collections.abc import Iterator

import numpy as np

from crashsolve.deck.building import Jointed, Scene
from crashsolve.deck.family import families

# round-off of positions and rotations of bodies that no posture moves; of some metres
ROUND_OFF = 1e-9


def torn_joints(scene: Scene, r: np.ndarray, A: np.ndarray) -> Iterator[tuple[str, str, str]]:
    """Section and name of every such joint, and what is wrong.

    r (n, 3) and A (n, 9) are those before the postures.
    """
    for keyword, family in families().items():
        for entry in scene.deck.entries[keyword].values() if family.has_rows else ():
            card = entry.card
            if not hasattr(card, "at"):
                continue
            ends = (card.a, card.b)
            if card.frame not in ends or "ground" in ends:
                continue
            a, b = scene.node(card.a), scene.node(card.b)
            if scene.posed.get(a) == scene.posed.get(b):
                continue
            apart, rotated = _torn(scene, card, (a, b), r, A)
            if max(apart, rotated) > ROUND_OFF:
                root = scene.posed.get(a) or scene.posed.get(b)
                yield keyword, entry.name, _message(entry.name, card, root, apart)


def _torn(
    scene: Scene, card: Jointed, nodes: tuple[int, int], r: np.ndarray, A: np.ndarray
) -> tuple[float, float]:
    """Distance [m] of the two points of a joint that were one, and the change of rotation [1]."""
    at = scene.node(card.frame)
    point = r[at] + A[at].reshape(3, 3) @ (np.asarray(card.at, float) - scene.offset[at])
    ends, changes = [], []
    for i in nodes:
        change = scene.A[i].reshape(3, 3) @ A[i].reshape(3, 3).T
        ends.append(scene.r[i] + change @ (point - r[i]))
        changes.append(change)
    return float(np.linalg.norm(ends[1] - ends[0])), float(np.abs(changes[1] - changes[0]).max())


def _message(name: str, card: Jointed, root: str | None, apart: float) -> str:
    return (
        f"the posture of '{root}' moves one of '{card.a}' and '{card.b}' and not the other, by "
        f"{apart:.3g} m at '{name}': name this joint in the posture; if it joins them as they are "
        "then, give its point in the world"
    )
