"""Effective masses of contacts whose damping realises a coefficient of restitution.

Simultaneous points of contact of two bodies interact, also through joints: a box on its corners, a
ball welded to another. Each is damped as a single contact with the mass

    m_i = k_i u_i / a_i,   a_i = sum_j W_ij s_j k_j u_j

over the contacts j between the same two sides; k is the stiffness of the law, s the share of its
force that acts, u the closing speed (the depth, where nothing closes), and W_ij the acceleration of
position i along its normal by a unit force at position j, reactions of joints included. Contacts of
two bodies that push to opposite sides do not count for each other, and no mass exceeds that of
both sides together, or that of the point alone. They are computed at an onset; contacts that began
earlier keep the larger of both values, and those that have hardly begun take the new one: positions
that strike one soon after the other strike at once, in whichever order, and the less so the deeper
the first is. Consequence to test: a box on any number of corners, and a body within joints, have
the restitution of a single ball, and so has a box that is tilted by next to nothing.
"""

from collections import defaultdict

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import welded_response
from crashsolve.foundation.rows import as_rows
from crashsolve.foundation.vec3 import ZERO
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.model import Model, State
from crashsolve.system.contact.initial_penetration import Touch, initial_touches

# singular values below this share of the largest are those of redundant constraints: S loses
# twice the digits of D
REDUNDANT = 1e-11
# of the depth u sqrt(m / k) that a free impact reaches: as deep, a contact has an impact of its own
EARLY = 0.1


def groups_with_effective_mass(model: Model) -> tuple[ContactGroup, ...]:
    """Groups with a restitution whose contacts may interact: of bodies with several elements, or
    with joints.
    """
    asking = [group for group in model.contact_groups if _has_restitution(group)]
    if not asking:
        return ()
    positions = defaultdict(set)
    for group in model.contact_groups:
        for elements in (group.elements_a, group.elements_b):
            for i, element in enumerate(elements):
                # shares of one surface may have one point in common
                where = (group.word, i) if group.has_shares else tuple(element["point"])
                positions[int(element["node"])].add(where)
    many = _joined(model) | {node for node, some in positions.items() if len(some) > 1}
    return tuple(g for g in asking if many & (_bodies(g.elements_a) | _bodies(g.elements_b)))


def _joined(model: Model) -> set[int]:
    """Nodes that joints hold, but for the ground."""
    return {node for joint in model.joints for node in joint.nodes} - {0}


def _has_restitution(group: ContactGroup) -> bool:
    """Whether some pair of a group is damped by its mass."""
    if "mass_ratio" not in (group.history.dtype.names or ()):
        return False
    rows = group.parameters if group.search is None else group.search.laws
    return bool((np.asarray(rows["damping_ratio"]) > 0.0).any())


def _bodies(elements: np.ndarray) -> set[int]:
    return set(elements["node"].tolist())


@kernel
def needs_effective_mass(params, history, current):
    """Whether a contact has begun whose effective mass is needed and not known yet."""
    for i in range(history.shape[1]):
        now = history[current, i]
        if now.active == 1 and now.mass_ratio == 0.0 and params[i].damping_ratio > 0.0:
            return True
    return False


class EffectiveMasses:
    """Finds the effective masses of the contacts of a model as they begin."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.groups, self.joined = groups_with_effective_mass(model), _joined(model)
        self.clusters = _clusters(model) if self.groups else np.zeros(0, int)

    def find(self, state: State) -> bool:
        """Find the effective masses of contacts that have begun; returns whether there were any.

        Writes: their histories.
        """
        current = int(state.clock[0]["current"])
        sides = [self._sides(group) for group in self.groups]
        new = [_new_touches(group, current) for group in self.groups]
        wanted = {tuple(row) for pairs, rows in zip(new, sides, strict=True) for row in rows[pairs]}
        if not wanted:
            return False
        touches_of: dict[tuple[int, int], list[Touch]] = defaultdict(list)
        for group, rows in zip(self.groups, sides, strict=True):
            chosen = [i for i, row in enumerate(rows.tolist()) if tuple(row) in wanted]
            for touch in initial_touches(group, as_rows(state.nodes), chosen):
                touches_of[tuple(rows[touch.pair].tolist())].append(touch)
        for key, touches in touches_of.items():
            self._set_ratios(key, touches, current, state)
        for group, pairs in zip(self.groups, new, strict=True):
            # one that has separated again counts as a single contact
            ratio = group.history["mass_ratio"]
            ratio[current, pairs[ratio[current, pairs] == 0.0]] = 1.0
        return True

    def _sides(self, group: ContactGroup) -> np.ndarray:
        """Clusters of both bodies of each pair (n, 2), the lower first."""
        ends = [
            self.clusters[elements["node"][group.parameters[side]]]
            for elements, side in ((group.elements_a, "a"), (group.elements_b, "b"))
        ]
        return np.sort(np.column_stack(ends), axis=1)

    def _set_ratios(
        self, key: tuple[int, int], touches: list[Touch], current: int, state: State
    ) -> None:
        """Set the masses of all contacts between two clusters, if one has begun.

        Writes: histories.
        """
        histories = [touch.group.history["mass_ratio"] for touch in touches]
        known = np.array(
            [row[current, touch.pair] for row, touch in zip(histories, touches, strict=True)]
        )
        if known.all():
            return
        within = np.flatnonzero(np.isin(self.clusters, [side for side in key if side]))
        is_free = not self.joined & set(within.tolist())
        if is_free and len(touches) == 1 and touches[0].share == 1.0:
            # a single contact of free bodies
            ratios = np.ones(1)
        else:
            ratios = _ratios(touches, known, within, self.model, state)
        for row, touch, ratio in zip(histories, touches, ratios, strict=True):
            row[:, touch.pair] = ratio


def _new_touches(group: ContactGroup, current: int) -> np.ndarray:
    """Pairs whose contact has begun and whose mass is needed."""
    history, wanted = group.history[current], group.parameters["damping_ratio"] > 0.0
    return np.flatnonzero((history["active"] == 1) & (history["mass_ratio"] == 0.0) & wanted)


def _clusters(model: Model) -> np.ndarray:
    """Cluster number of each node: nodes connected by joints, but not through the ground."""
    number = np.arange(len(model.mass))
    for joint in model.joints:
        ends = number[[node for node in joint.nodes if node]]
        number[np.isin(number, ends)] = ends.min(initial=len(number))
    return number


def _ratios(
    touches: list[Touch], known: np.ndarray, within: np.ndarray, model: Model, state: State
) -> np.ndarray:
    """Effective masses of the contacts between two sides over those of two free bodies [1]; of
    contacts that began earlier, whose ratio is known, the larger of both.
    """
    rates = np.array([max(touch.rate, 0.0) for touch in touches])
    depths = np.array([touch.depth for touch in touches])
    speeds = rates if rates[known == 0.0].any() else depths
    free, mobility = _mobility(touches, within, model, state)
    shares = np.array([touch.share for touch in touches])
    stiffness = np.array([float(t.group.parameters["stiffness"][t.pair]) for t in touches])
    springs = speeds * stiffness
    own, alone = np.diag(mobility), _alone(touches, free, state)
    least = np.minimum(own, _least_mobility(within, model)) * shares * springs
    response = np.maximum(_one_sided(touches, mobility) @ (shares * springs), least)
    ratios = np.ones(len(touches))
    # a point that joints hold along the normal does not close
    moves = own > REDUNDANT * alone
    ratios[moves] = alone[moves] / (own * shares)[moves]
    pressed = moves & (response > 0.0)
    ratios[pressed] = (alone * springs)[pressed] / response[pressed]
    # depths that free impacts with the known masses reach; one that no longer closes has reached it
    reached = EARLY * rates * np.sqrt(known / np.maximum(alone * stiffness, 1e-300))
    apart = np.where(reached > depths, depths / np.where(reached > 0.0, reached, 1.0), 1.0)
    return np.maximum(ratios, ratios + apart * (known - ratios))


def _alone(touches: list[Touch], free: np.ndarray, state: State) -> np.ndarray:
    """Mobilities along the normals of both bodies, or of the wholes that welds make of them, as in
    the step [1/kg].
    """
    if "welded_first" not in (state.nodes.dtype.names or ()):
        return np.diag(free)
    nodes = as_rows(state.nodes)
    return np.array(
        [
            sum(
                welded_response(nodes[node], tuple(arm), tuple(touch.normal), ZERO)
                for node, arm in zip(touch.bodies, touch.arms, strict=True)
            )
            for touch in touches
        ]
    )


def _least_mobility(within: np.ndarray, model: Model) -> float:
    """Mobility of both sides without rotation [1/kg], each a cluster of its own."""
    clusters = _clusters(model)[within]
    masses = [
        float(model.mass[within[clusters == number]].sum()) for number in set(clusters.tolist())
    ]
    return sum(1.0 / mass for mass in masses if mass > 0.0)


def _one_sided(touches: list[Touch], mobility: np.ndarray) -> np.ndarray:
    """Mobilities without those of contacts that push the same two bodies to opposite sides."""
    normals = np.array([touch.normal for touch in touches])
    bodies = np.array([touch.bodies for touch in touches])
    same = (bodies[:, None] == bodies[None, :]).all(axis=2)
    return np.where(same & (normals @ normals.T <= 0.0), 0.0, mobility)


def _mobility(
    touches: list[Touch], within: np.ndarray, model: Model, state: State
) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations along the normals by unit forces there [1/kg]: free bodies, and with joints."""
    first = {int(node): 6 * i for i, node in enumerate(within)}
    inverse = np.zeros((6 * len(within), 6 * len(within)))
    for node, i in first.items():
        inverse[i : i + 3, i : i + 3] = state.nodes["mass_inv"][node] * np.eye(3)
        inverse[i + 3 : i + 6, i + 3 : i + 6] = state.nodes["W"][node].reshape(3, 3)
    rows = np.zeros((len(touches), len(inverse)))
    for row, touch in zip(rows, touches, strict=True):
        for node, arm, sign in zip(touch.bodies, touch.arms, (1.0, -1.0), strict=True):
            if node in first:
                along = sign * touch.normal
                row[first[node] : first[node] + 6] = [*along, *np.cross(arm, along)]
    free = rows @ inverse @ rows.T
    D = _jacobian(first, model, state)
    if not len(D):
        return free, free
    pushed = D @ inverse @ rows.T
    reactions = np.linalg.lstsq(D @ inverse @ D.T, pushed, rcond=REDUNDANT)[0]
    return free, free - pushed.T @ reactions


def _jacobian(first: dict[int, int], model: Model, state: State) -> np.ndarray:
    """D of the joints of some nodes, whose columns begin at `first`."""
    blocks = []
    for column in model.saddle.columns:
        parts = state.rows[int(column["entry"]) : int(column["end"])]
        if not any(int(part[name]) in first for part in parts for name in ("node_a", "node_b")):
            continue
        size = int(column["rows"])
        D = np.zeros((size, 6 * len(first)))
        for k, part in enumerate(parts):
            for name, half in (("node_a", slice(0, 6)), ("node_b", slice(6, 12))):
                at = first.get(int(part[name]))
                if at is not None:
                    D[k % size, at : at + 6] += part["D"][half]
        blocks.append(D)
    return np.concatenate(blocks) if blocks else np.zeros((0, 0))
