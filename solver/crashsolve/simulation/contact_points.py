"""Contact points as they are drawn: where forces act, and how large they are.

Contacts with few pairs show all of them. Of pairs that come and go, and of nodes of shells, the
largest forces are shown, so that a block of points keeps its size.
"""

from itertools import groupby

import numpy as np

from crashsolve.model.model import ContactGroup, NodalGroup
from crashsolve.system.engine import Engine

# contact points drawn per element where pairs come and go; balls in a heap have three each
TOUCHES = 3
# of the nodes of a group: more arrows hide each other
MAX_NODES = 200

Points = tuple[np.ndarray, np.ndarray, np.ndarray]  # position (k, 3), force (k, 3), card (k,)


class ContactPoints:
    """The points of all contacts of a scene, as many at all times."""

    def __init__(self, engine: Engine) -> None:
        self.engine, model = engine, engine.model
        pairs = [(g, n) for g in model.contact_groups if (n := _pair_slots(g))]
        # groups that follow each other, all of whose pairs are shown, are taken together
        self._pairs = [
            (list(groups), is_whole)
            for is_whole, groups in groupby(pairs, key=lambda one: one[0].search is None)
        ]
        # bodies and cards of all of their pairs
        self._constant = {
            i: (
                np.concatenate([_homes(g, g.parameters) for g, _ in groups]),
                np.concatenate([g.parameters["card"] for g, _ in groups]).astype(float),
            )
            for i, (groups, is_whole) in enumerate(self._pairs)
            if is_whole
        }
        self._nodal = [(g, min(g.slot_in_use.size, MAX_NODES)) for g in model.nodal_groups]
        self.count = sum(positions for _, positions in [*pairs, *self._nodal])

    def points(self) -> Points:
        """Points at which contacts act in the present sample, with forces on side a and cards."""
        points = []
        for i, (groups, is_whole) in enumerate(self._pairs):
            if is_whole:
                points.append(self._of_all([g for g, _ in groups], *self._constant[i]))
            else:
                points += [self._of_pairs(g, positions) for g, positions in groups]
        points += [self._of_nodes(g, positions) for g, positions in self._nodal]
        position, force, card = map(np.concatenate, zip(*points, strict=True))
        return position, force, card

    def _of_all(self, groups: list[ContactGroup], homes: np.ndarray, card: np.ndarray) -> Points:
        """Points of all pairs of groups, with their cards (n,); that of a pair that is apart lies
        on its body (n,), without force.
        """
        force = np.concatenate([g.output["force"] for g in groups])
        position = self.engine.nodes["r"].take(homes, axis=0)
        touching = np.flatnonzero(acts(force))
        if len(touching):
            point = np.concatenate([g.output["point"] for g in groups])
            position[touching] = point[touching]
        return position, force, card

    def _of_pairs(self, g: ContactGroup, positions: int) -> Points:
        """Points of the pairs of a group with the largest forces."""
        force, pairs = g.output["force"], g.parameters
        strength = np.linalg.norm(force, axis=1)
        shown = _largest(strength, positions)
        home = self.engine.nodes["r"][_homes(g, pairs[shown])]
        position = np.where(strength[shown, None] > 0.0, g.output["point"][shown], home)
        return self._filled(position, force[shown], pairs["card"][shown], positions)

    def _of_nodes(self, g: NodalGroup, positions: int) -> Points:
        """Points of shell nodes, or of balls on the faces of shells."""
        p, states, slot_in_use = g.p[0], g.probe_states, g.slot_in_use
        slots = np.arange(len(slot_in_use))
        # two records take turns (system/contact/node_contact.py): the last step's, accepted, and
        # the results of the force pass of the sample, which do not change for separated pairs
        accepted = np.where(slot_in_use > 1, 3 - slot_in_use, slot_in_use)
        was, now = states["active"][accepted, slots], states["active"][1 - accepted, slots]
        touching = np.flatnonzero(now & (was | (self.engine.clock["cycle"] == 0)))
        rows, owner = _walls(states, touching, 1 - accepted)
        record = states[1 - accepted[owner], rows]
        force = record["force"][:, None] * record["normal"]
        if "friction_force" in (record.dtype.names or ()):
            force = force + record["friction_force"]
        largest = _largest(np.linalg.norm(force, axis=1), positions)
        slots_per_probe = len(slot_in_use) // len(g.probes)
        centre = self._centres(g, owner[largest] // slots_per_probe)
        position = centre - p["gap"] * p["share"] * record["normal"][largest]
        card = np.full(len(largest), p["card"])
        return self._filled(position, p["order"] * force[largest], card, positions)

    def _centres(self, g: NodalGroup, chosen: np.ndarray) -> np.ndarray:
        """Positions (k, 3) of probes: points of shells, or points of bodies."""
        probes = (g.balls if g.is_round else g.probes)[chosen]
        if not len(probes) or probes["point"][0] >= 0:
            centres: np.ndarray = self.engine.state.points["r"][probes["point"]]
            return centres
        body = self.engine.nodes[probes["node"]]
        rotated = np.einsum("nij,nj->ni", body["A"].reshape(-1, 3, 3), probes["at"])
        return np.asarray(body["r"] + rotated)

    def _filled(
        self, position: np.ndarray, force: np.ndarray, card: np.ndarray, positions: int
    ) -> Points:
        """Fill the points up to the size of the block: unused ones lie at the first body."""
        rest = positions - len(position)
        nodes = self.engine.nodes["r"]
        waiting = np.tile(nodes[min(1, len(nodes) - 1)], (rest, 1))
        return (
            np.concatenate([position, waiting]),
            np.concatenate([force, np.zeros((rest, 3))]),
            np.concatenate([card, np.zeros(rest)]),
        )


def acts(force: np.ndarray) -> np.ndarray:
    """Which of some forces (n, 3) are not zero: numpy takes five times as long to join columns."""
    x, y, z = force.T
    return (x != 0.0) | (y != 0.0) | (z != 0.0)


def _homes(g: ContactGroup, pairs: np.ndarray) -> np.ndarray:
    """Bodies (n,) of side a of some pairs."""
    homes: np.ndarray = g.elements_a["node"][pairs["a"]]
    return homes


def _walls(
    states: np.ndarray, touching: np.ndarray, in_use: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rows of all walls that touch, and the sides of probes that they belong to (n,)."""
    rows = owner = touching
    if "other_walls" in (states.dtype.names or ()):
        from crashsolve.contact.cells import WALLS

        others = states["other_walls"][in_use[touching], touching]
        for w in range(1, WALLS):
            chosen = touching[others >= w]
            rows = np.r_[rows, len(in_use) + (WALLS - 1) * chosen + w - 1]
            owner = np.r_[owner, chosen]
    return rows, owner


def _largest(strength: np.ndarray, positions: int) -> np.ndarray:
    """Numbers of the largest, in their order."""
    return np.sort(np.argsort(-strength, kind="stable")[:positions])


def _pair_slots(g: ContactGroup) -> int:
    """Contact points drawn for a group: all its pairs, or, where these come and go, enough."""
    if g.search is None:
        return len(g.parameters)
    return TOUCHES * (len(g.elements_a) + len(g.elements_b))
