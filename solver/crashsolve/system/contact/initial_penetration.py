"""Impact speeds of contacts that penetrate at the start of a run.

Several points of a body that penetrate another at the start push it out together: a box on its
corners, a mesh, balls on one body. Each has the impact speed of the free impact that reaches the
same depths: that of a single point with the effective mass

    m_i = f_i / a_i,   a_i = sum_j f_j n_i . (acceleration of point i by a unit force at point j)

with f the force without damping, over the contacts j of the same two bodies that push to the same
side, n_i . n_j > 0. No effective mass exceeds that of both bodies without rotation. A single
contact has its own effective mass. Consequence to test: a box that penetrates with a face leaves
with the speed of a ball at the same depth.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from crashsolve.foundation.rows import as_rows
from crashsolve.model.model import ContactGroup, Model, State
from crashsolve.system.contact.touches import closing_motion

# [N] that stands for none, of depths whose power is below the numbers of a machine
LEAST = 1e-200


@dataclass(eq=False)
class Touch:
    """A point of contact that penetrates at the start."""

    group: ContactGroup
    pair: int
    bodies: tuple[int, int]
    depth: float
    rate: float  # closing speed [m/s]
    share: float  # of the law's force that acts
    normal: np.ndarray
    arms: tuple[np.ndarray, np.ndarray]  # from both mass centres to the position

    @property
    def spring(self) -> float:
        """Force of the law without damping [N]."""
        row = np.zeros_like(as_rows(self.group.history)[0, [self.pair]])[0]
        p = as_rows(self.group.parameters)[self.pair]
        return float(
            self.group.normal.normal_force(p, row, row, 0.0, self.depth, 0.0, 1.0, None)[0]
        )

    def set_mass(self, mass: float) -> None:
        """Set the impact speed to that of a free impact with a mass [kg].

        Writes: history of the pair.
        """
        p = as_rows(self.group.parameters)[self.pair]
        history = as_rows(self.group.history)[:, self.pair]
        before = np.zeros_like(history)[0]
        for after in history:
            self.group.normal.normal_force(p, before, after, 0.0, self.depth, self.rate, mass, None)


def find_impact_speeds(model: Model, state: State) -> bool:
    """Find the impact speeds of contacts that penetrate at the start; returns whether there are
    any.

    Writes: their histories.
    """
    touches_of: dict[tuple[int, int], list[Touch]] = defaultdict(list)
    for group in model.contact_groups:
        if "damping_speed" in (group.history.dtype.names or ()):
            for touch in initial_touches(group, as_rows(state.nodes)):
                touches_of[touch.bodies].append(touch)
    for (a, b), touches in touches_of.items():
        for touch, mass in zip(touches, _masses(state.nodes[[a, b]], touches), strict=True):
            touch.set_mass(mass)
    return bool(touches_of)


def initial_touches(
    group: ContactGroup, nodes: np.ndarray, pairs: Sequence[int] | None = None
) -> Iterator[Touch]:
    """Touches of a group, or of some of its pairs; the body with the lower number first."""
    tables = (group.elements_a, group.elements_b, *group.data)
    elements_a, elements_b, *data = (as_rows(table) for table in tables)
    touching = np.asarray(group.history["active"].any(axis=0))
    for i in np.flatnonzero(touching) if pairs is None else pairs:
        if not touching[i]:
            continue
        p = group.parameters[i]
        a, b = elements_a[p["a"]], elements_b[p["b"]]
        depth, n, x = group.narrow.gap(a, b, nodes, tuple(data))
        if depth <= 0.0:
            continue
        rate, _, *arms = closing_motion(nodes[a.node], nodes[b.node], x, n)
        share = float(a.share) if group.has_shares else 1.0
        bodies, normal = (int(a.node), int(b.node)), np.array(n)
        if bodies[0] > bodies[1]:
            bodies, normal, arms = bodies[::-1], -normal, arms[::-1]
        positions = np.array(arms[0]), np.array(arms[1])
        yield Touch(group, int(i), bodies, float(depth), float(rate), share, normal, positions)


def _masses(nodes: np.ndarray, touches: list[Touch]) -> np.ndarray:
    """Effective masses of the contacts of two bodies [kg], over the shares of their force."""
    normals = np.array([touch.normal for touch in touches])
    cosines, free = normals @ normals.T, nodes["mass_inv"].sum()
    compliance = free * cosines
    for side, node in enumerate(nodes):
        levers = np.cross([touch.arms[side] for touch in touches], normals)
        compliance += levers @ node["W"].reshape(3, 3) @ levers.T
    compliance[cosines <= 0.0] = 0.0
    # the law computes the force of the full surface, the bodies receive their share
    springs = np.array([max(touch.spring, LEAST) for touch in touches])
    pushes = springs * [touch.share for touch in touches]
    return np.asarray(springs / np.maximum(compliance @ pushes, free * pushes))
