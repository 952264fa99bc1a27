"""The chain of bodies of a deck with its landmarks, as defined by a request."""

from importlib import import_module
from pathlib import Path

import numpy as np

from crashsolve.deck.family import families
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.model.scene import Scene
from crashsolve.photogrammetry.chain_fit import Chain
from crashsolve.photogrammetry.request import Requested
from crashsolve.photogrammetry.tables import LANDMARKS, read_table
from crashsolve.postures._chain import Link, Motion, in_order, link

OCCUPANT = "<who>"


def chain_of(requested: Requested) -> tuple[Chain, Scene]:
    """The chain, and the scene that it is taken from. Raises DeckErrors."""
    deck = read_deck(Path(requested.card.deck))
    # cards of bodies have the zero posture, in any posture of the deck
    deck.entries["postures"].clear()
    scene = Scene(deck)
    scene.raise_errors()
    if requested.card.root not in deck.entries["bodies"]:
        advice = choices(requested.card.root, list(deck.entries["bodies"]), "bodies")
        raise DeckErrors(
            [requested.error(("root",), f"unknown body '{requested.card.root}'", advice)]
        )
    root = scene.node(requested.card.root)
    links = _links(requested, deck, scene, root)
    reached = {root} | {node for one in links for node in (one.a, one.b)}
    _check_spread(requested, links)
    at_rest = np.zeros(3)
    zero = Motion(scene.matrix(root), scene.r[root], at_rest, at_rest)
    chain = Chain(
        root,
        requested.card.root,
        tuple(links),
        _landmarks(requested, scene, reached, _extent(scene, links, reached)),
        zero,
        _stops(deck, links),
        requested.card.spread,
    )
    return chain, scene


def _links(requested: Requested, deck: Deck, scene: Scene, root: int) -> list[Link]:
    """Joints that hang on the root, without those of the ground."""
    links, entries = [], {}
    for keyword, family in families().items():
        for name, entry in deck.entries[keyword].items() if family.has_rows else ():
            card = entry.card
            if not hasattr(card, "at") or "ground" in (card.a, card.b):
                continue
            links.append(link(scene, name, card))
            entries[name] = entry
    order, rest = in_order(root, links)
    known = {root} | {node for one in order for node in (one.a, one.b)}
    errors = []
    for one in order:
        free = set(getattr(import_module(entries[one.joint].module_name), "FREE", ()))
        if free not in ({"ball", "swing"}, {"angle"}) or entries[one.joint].type == "planar":
            message = "a posture is fitted through spherical and revolute joints alone"
            errors.append(deck.error(entries[one.joint], "type", message))
    for one in rest:
        if {one.a, one.b} <= known:
            message = f"'{one.joint}' closes a loop of the chain of '{requested.card.root}'"
            errors.append(deck.error(entries[one.joint], None, message))
    if errors:
        raise DeckErrors(errors)
    return order


def _extent(scene: Scene, links: list[Link], reached: set[int]) -> float:
    """Diagonal of a box about all mass centres and joints of the zero posture [m]."""
    points = [scene.r[node] for node in reached]
    points += [scene.r[one.a] + scene.matrix(one.a) @ one.s_a for one in links]
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _landmarks(
    requested: Requested, scene: Scene, reached: set[int], extent: float
) -> dict[str, tuple[int, np.ndarray]]:
    """Node and arm of every landmark; one farther from its body than the chain is long is refused:
    the unit of the table is another one.
    """
    path, landmarks, errors = requested.card.landmarks, {}, []
    for row in read_table(path, LANDMARKS):
        name = row.names["body"].replace(OCCUPANT, requested.card.occupant)
        problem = ""
        if name not in scene.names:
            problem = f"unknown body '{name}'"
        elif scene.names.index(name) not in reached:
            problem = f"'{name}' is not connected to '{requested.card.root}'"
        if problem:
            errors.append(DeckError(path, row.line, None, row.names["point"], problem))
            continue
        node = scene.names.index(name)
        arm = scene.from_mass_centre(node, [row.numbers[axis] for axis in "xyz"])
        far = float(np.linalg.norm(arm))
        if far > extent > 0.0:
            problem = f"lies {far:.3g} m from the mass centre of '{name}', and all bodies within "
            problem += f"{extent:.3g} m"
            advice = "look for a wrong unit of the table, or coordinates of another frame"
            errors.append(DeckError(path, row.line, None, row.names["point"], problem, advice))
            continue
        landmarks[row.names["point"]] = node, arm
    if errors:
        raise DeckErrors(errors)
    return landmarks


def _stops(deck: Deck, links: list[Link]) -> dict[str, tuple[float, float]]:
    """Ranges of joints with an axis."""
    stops = {}
    joints = {one.joint for one in links if one.axis is not None}
    for entry in deck.entries["springs"].values():
        if entry.type == "rotation_stop" and entry.card.joint in joints:
            low, high = entry.card.lower, entry.card.upper
            stops[str(entry.card.joint)] = (
                -np.inf if low is None else low,
                np.inf if high is None else high,
            )
    return stops


def _check_spread(requested: Requested, links: list[Link]) -> None:
    known = [one.joint for one in links]
    for name in requested.card.spread:
        if name not in known:
            advice = choices(name, known, "joints")
            raise DeckErrors([requested.error(("spread", name), f"unknown joint '{name}'", advice)])
