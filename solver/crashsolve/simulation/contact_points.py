"""Contact points as they are drawn: where forces act, and how large they are.

Contacts with few pairs show all of them. Of pairs that come and go, and of nodes of shells, the
largest forces are shown, so that a block of points keeps its size.
"""

import numpy as np

from crashsolve.contact.cells import WALLS
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
        self._pairs = [(g, n) for g in model.contact_groups if (n := _pair_slots(g))]
        self._nodal = [(g, min(g.slot_in_use.size, MAX_NODES)) for g in model.nodal_groups]
        self.count = sum(positions for _, positions in [*self._pairs, *self._nodal])

    def points(self) -> Points:
        """Points at which contacts act in the present sample, with forces on side a and cards."""
        points = [self._of_pairs(g, positions) for g, positions in self._pairs]
        points += [self._of_nodes(g, positions) for g, positions in self._nodal]
        position, force, card = map(np.concatenate, zip(*points, strict=True))
        return position, force, card

    def _of_pairs(self, g: ContactGroup, positions: int) -> Points:
        """Points of a group of pairs; the point of a pair that is apart lies on its body, without
        force.
        """
        force, pairs = g.output["force"], g.parameters
        strength = np.linalg.norm(force, axis=1)
        if g.search is None:
            position = self._homes(g, pairs)
            touching = np.flatnonzero(strength > 0.0)
            position[touching] = g.output["point"][touching]
            return position, force, pairs["card"].astype(float)
        shown = _largest(strength, positions)
        home = self._homes(g, pairs[shown])
        position = np.where(strength[shown, None] > 0.0, g.output["point"][shown], home)
        return self._filled(position, force[shown], pairs["card"][shown], positions)

    def _homes(self, g: ContactGroup, pairs: np.ndarray) -> np.ndarray:
        """Mass centres (n, 3) of the bodies of side a of some pairs [m]."""
        homes: np.ndarray = self.engine.nodes["r"][g.elements_a["node"][pairs["a"]]]
        return homes

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


def _walls(
    states: np.ndarray, touching: np.ndarray, in_use: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rows of all walls that touch, and the sides of probes that they belong to (n,)."""
    rows = owner = touching
    if "other_walls" in (states.dtype.names or ()):
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
