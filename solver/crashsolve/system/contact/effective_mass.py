"""Effective masses of touches whose damping is to return a restitution.

Positions in which two bodies strike each other at once push each other, and so does what joints
hold together with them: a box on its corners, a ball welded to another. Each is damped as a lone
one with

    m_i = k_i u_i / a_i,   a_i = sum_j W_ij s_j k_j u_j

over the touches j between the same two sides; k is the stiffness of the law, s the share of its
force that acts, u the closing speed (the depth, where nothing closes), and W_ij the acceleration of
place i along its normal by a unit force at place j, reactions of joints included. Touches of two
bodies that push to opposite sides do not count for each other, and no mass is more than both sides
have altogether, or than that of the place alone. They are found when a touch begins, and one that
began before keeps the larger of both: it may have begun alone. Consequence to test: a box on any
number of corners, and a body within joints, return the restitution of a lone ball.
"""

from collections import defaultdict

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.rows import as_rows
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.model import Model, State
from crashsolve.system.contact.initial_penetration import Touch, touches_of

# singular values below this share of the largest are those of redundant constraints: S loses
# twice the digits of D
REDUNDANT = 1e-11


def weighed_groups(model: Model) -> tuple[ContactGroup, ...]:
    """Groups whose law asks for the mass of the whole touch, and have more than lone bodies."""
    asking = [g for g in model.contact_groups if "mass_ratio" in (g.history.dtype.names or ())]
    if not asking:
        return ()
    joined = {node for joint in model.joints for node in joint.nodes} - {0}
    positions = defaultdict(set)
    for group in model.contact_groups:
        for elements in (group.elements_a, group.elements_b):
            for i, element in enumerate(elements):
                # shares of one surface may have one point in common
                where = (group.word, i) if group.has_shares else tuple(element["point"])
                positions[int(element["node"])].add(where)
    many = joined | {node for node, some in positions.items() if len(some) > 1}
    return tuple(g for g in asking if many & (_bodies(g.elements_a) | _bodies(g.elements_b)))


def _bodies(elements: np.ndarray) -> set[int]:
    return set(elements["node"].tolist())


@kernel
def has_unweighed(history, current):
    """Whether a touch has begun whose effective mass is not known yet."""
    for i in range(history.shape[1]):
        if history[current, i].active == 1 and history[current, i].mass_ratio == 0.0:
            return True
    return False


def find_masses(model: Model, state: State) -> bool:
    """Of touches that have begun; returns whether there were any. Writes: their histories."""
    clusters, current = _clusters(model), int(state.clock[0]["current"])
    found: dict[tuple[int, int], list[Touch]] = defaultdict(list)
    groups = weighed_groups(model)
    for group in groups:
        for touch in touches_of(group, as_rows(state.nodes)):
            a, b = (int(clusters[node]) for node in touch.bodies)
            found[min(a, b), max(a, b)].append(touch)
    is_any = False
    for sides, touches in found.items():
        known = np.array(
            [touch.group.history["mass_ratio"][current, touch.pair] for touch in touches]
        )
        if not known.all():
            within = np.flatnonzero(np.isin(clusters, [side for side in sides if side]))
            ratios = _ratios(touches, known == 0.0, within, model, state)
            for touch, ratio in zip(touches, np.maximum(known, ratios), strict=True):
                touch.group.history["mass_ratio"][:, touch.pair] = ratio
            is_any = True
    for group in groups:
        # one that has parted again when it is looked at was as if alone
        ratio = group.history["mass_ratio"]
        ratio[current, (group.history["active"][current] == 1) & (ratio[current] == 0.0)] = 1.0
    return is_any


def _clusters(model: Model) -> np.ndarray:
    """Number of what each node is joined to; the ground joins nothing."""
    number = np.arange(len(model.mass))
    for joint in model.joints:
        ends = number[[node for node in joint.nodes if node]]
        number[np.isin(number, ends)] = ends.min(initial=len(number))
    return number


def _ratios(
    touches: list[Touch], is_new: np.ndarray, within: np.ndarray, model: Model, state: State
) -> np.ndarray:
    """Effective masses of the touches between two sides over those of two bodies alone [1]."""
    speeds = np.array([max(touch.rate, 0.0) for touch in touches])
    if not speeds[is_new].any():
        speeds = np.array([touch.depth for touch in touches])
    free, mobility = _mobility(touches, within, model, state)
    shares = np.array([touch.share for touch in touches])
    springs = speeds * [float(t.group.parameters["stiffness"][t.pair]) for t in touches]
    own, alone = np.diag(mobility), np.diag(free)
    least = np.minimum(own, _least_mobility(within, model)) * shares * springs
    response = np.maximum(_one_sided(touches, mobility) @ (shares * springs), least)
    ratios = np.ones(len(touches))
    # what joints hold fast along the normal does not close
    moves = own > REDUNDANT * alone
    ratios[moves] = alone[moves] / (own * shares)[moves]
    pressed = moves & (response > 0.0)
    ratios[pressed] = (alone * springs)[pressed] / response[pressed]
    return ratios


def _least_mobility(within: np.ndarray, model: Model) -> float:
    """Of both sides, if they do not turn [1/kg]: each a cluster of its own."""
    clusters = _clusters(model)[within]
    masses = [
        float(model.mass[within[clusters == number]].sum()) for number in set(clusters.tolist())
    ]
    return sum(1.0 / mass for mass in masses if mass > 0.0)


def _one_sided(touches: list[Touch], mobility: np.ndarray) -> np.ndarray:
    """Mobilities without those of touches that push the same two bodies to opposite sides."""
    normals = np.array([touch.normal for touch in touches])
    same = np.array([[one.bodies == other.bodies for other in touches] for one in touches])
    return np.where(same & (normals @ normals.T <= 0.0), 0.0, mobility)


def _mobility(
    touches: list[Touch], within: np.ndarray, model: Model, state: State
) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations along the normals by unit forces there [1/kg]: bodies alone, and in joints."""
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
    found = []
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
        found.append(D)
    return np.concatenate(found) if found else np.zeros((0, 0))
