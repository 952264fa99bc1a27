"""Closing speed below which a contact counts as resting, where the deck gives none."""

from math import sqrt

import numpy as np

from crashsolve.deck.card import Card
from crashsolve.model.scene import Scene

# the default [m/s], and its share of the speeds of a slow or small model
USUAL, SHARE = 1e-3, 1e-3


def speed_floor(card: Card, scene: Scene) -> float:
    """Speed floor [m/s] of a contact card; 0 where its law has none.

    A share of the fastest initial speed and of a fall through the model's size, at most USUAL:
    so slow touches that are deeper than lone ones, as of bodies within joints, are impacts still.
    Springs, drivers, parts and other loads than gravity bring speeds that are not known yet, and
    then it is USUAL.
    """
    if not hasattr(card, "speed_floor"):
        return 0.0
    if card.speed_floor is not None:
        return float(card.speed_floor)
    entries = scene.deck.entries
    loads = list(entries["loads"].values())
    is_unknown = any(entries[word] for word in ("springs", "belts", "tyres", "parts"))
    is_unknown |= any(joint.type.endswith("_driver") for joint in entries["joints"].values())
    if is_unknown or any(load.type != "gravity" for load in loads):
        return USUAL
    g = float(np.linalg.norm(np.sum([load.card.acceleration for load in loads], axis=0)))
    swing = np.linalg.norm(scene.w, axis=1).max() * scene.size
    fastest = np.linalg.norm(scene.v, axis=1).max() + swing + sqrt(2.0 * g * scene.size)
    return min(USUAL, SHARE * float(fastest)) if fastest > 0.0 else USUAL
