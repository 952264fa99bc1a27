"""Forces or velocities that arrows show at a state, and their points of application."""

from fnmatch import fnmatchcase
from typing import Protocol

import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.renders.appearance import Appearance
from crashpost.results.states import States

# contact forces this far from the shown parts, of their size, act on them
BESIDE = 0.02


class Shown(Protocol):
    """Attributes of a scene that arrows need: states, appearance, numbers of the bodies shown."""

    states: States
    appearance: Appearance
    bodies: set[int]

    def positions(self, number: float, name: str) -> np.ndarray: ...
    def extent(self, number: float) -> np.ndarray: ...


def contacts_with_arrows(states: States, appearance: Appearance) -> set[int]:
    """Numbers of the contacts whose forces are shown; raises PostError for an unknown word."""
    word = appearance.arrows
    if not word or word == "velocity":
        return set()
    names = states.names["contacts"]
    family, _, card = word.partition(".")
    matching = {k for k, name in enumerate(names) if not card or fnmatchcase(name, card)}
    if family != "rcforc" or (card and not matching):
        known = ["velocity", "rcforc", *(f"rcforc.{name}" for name in names)]
        raise unknown("arrows", word, known)
    if appearance.magnify != 1.0:
        raise PostError(f"arrows {word}: forces do not act where magnified displacements lead")
    return matching


def forces_of(scene: Shown, number: float, contacts: set[int]) -> tuple[np.ndarray, np.ndarray]:
    """Starting points of arrows (n, 3), and the vectors they show (n, 3) [N or m/s]."""
    states, empty = scene.states, np.empty((0, 3))
    if scene.appearance.arrows == "velocity":
        if "mass_centres" not in states.blocks:
            return empty, empty
        rows = np.array(sorted(scene.bodies), int) - 1
        speed = states.read_one(int(number), "mass_centres", "velocity")
        return scene.positions(number, "mass_centres")[rows], speed[rows].astype(float)
    if "contacts" not in states.blocks:
        return empty, empty
    forces = states.read_one(int(number), "contacts", "force").astype(float)
    fields = states.read(int(number), "contacts", "contact")
    cards = fields.get("contact", np.zeros(len(forces))).astype(int)
    starts = states.positions(int(number), "contacts")
    chosen = np.isin(cards, list(contacts)) & np.any(forces, axis=1)
    if scene.appearance.show:
        chosen &= _near(scene, starts, number)
    return starts[chosen], forces[chosen]


def _near(scene: Shown, points: np.ndarray, number: float) -> np.ndarray:
    """Mask of the points (n,) in the box around the parts shown at a state."""
    shown = scene.extent(number)
    if not len(shown):
        return np.zeros(len(points), bool)
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = BESIDE * float(np.max(high - low))
    inside: np.ndarray = np.all((low - margin <= points) & (points <= high + margin), axis=1)
    return inside
