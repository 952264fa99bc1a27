"""Segments at rest: their whole tangent, also while they yield, and their flow over a correction.

    F_a = (f, m_a + d_a x f),   dF_a = (df, dm_a + d_a x df + (w_a x d_a) x f)
    dx_a = dr + w_a x d_a

with f, m_a and their derivatives as of beam elements (elements/beams/static_tangent.py) between the
points d_a and d_b of both bodies. By stretch and rotations N, M_y and M_z change while they flow
by `softened`. Consequence to test: central differences of the forces, elastic and flowing.
"""

import numpy as np

from crashsolve.elements.beams.static_tangent import by_motions, skew, slopes_of_strains, strains
from crashsolve.foundation.orientation import matrices, products
from crashsolve.foundation.rows import Row, Table, as_rows
from crashsolve.materials import elastoplastic
from crashsolve.springs._segment_yield import FROZEN, growth, scaled_back, softened

# components of u and theta that yield together
YIELDING_AXES = np.array([0, 4, 5])
# a load step leads so far beyond the first yield that it meets; square over that of yield of what
# has begun
OVER, YIELDING = 0.05, 1.0 - 1e-6


def forces_by_motions(p: Table, state: Table, nodes: Table, curves: np.ndarray) -> np.ndarray:
    """Derivatives (n, 12, 12) of the forces on both bodies of all segments at rest."""
    R, q, d_a, d_b = _deformations(p, nodes)
    k = np.hstack([p["stiffness"], p["rotational_stiffness"]])
    resultant, own = k * q, k[:, :, None] * np.eye(6)
    resultant[:, YIELDING_AXES] -= k[:, YIELDING_AXES] * state["plastic"]
    named, past = as_rows(p), as_rows(state)
    for i in np.flatnonzero((p["yields"] == 1) & (p["at_rest"] != FROZEN)):
        flow, share = _flow(named[i], past[i], resultant[i, YIELDING_AXES], curves)
        if flow > 0.0:
            args = (named[i], k[i, YIELDING_AXES], resultant[i, YIELDING_AXES])
            C = np.zeros((3, 3))
            C[np.triu_indices(3)] = softened(*args, flow, share, past[i].strain, 1.0, curves)
            own[i][np.ix_(YIELDING_AXES, YIELDING_AXES)] = C + np.triu(C, 1).T
            resultant[i, YIELDING_AXES] = scaled_back(*args, share)
    K = by_motions(R, q[:, :3], q[:, 3:], resultant[:, :3], resultant[:, 3:], own)
    to = _from_mass_centres(d_a, d_b)
    forces: np.ndarray = to.transpose(0, 2, 1) @ K @ to
    pull = np.einsum("nij,nj->ni", R, resultant[:, :3])
    for at, d, f in ((3, d_a, pull), (9, d_b, -pull)):
        # (w x d) x f
        forces[:, at : at + 3, at : at + 3] += skew(f) @ skew(d)
    return forces


def predict(
    p: Table, state: Table, new: Table, nodes: Table, displacement: np.ndarray, curves: np.ndarray
) -> None:
    """Predict the plastic flow of segments over motions `displacement` (n, 6) of all nodes, to
    first order. Writes: new.

    Rotations of bodies stretch the beam between them by their squares, which is no
    flow.
    """
    k, trial, change = _trials(p, state, nodes, displacement)
    trial += change
    new["plastic"] = state["plastic"]
    named, past = as_rows(p), as_rows(state)
    for i in np.flatnonzero(p["yields"]):
        _, share = _flow(named[i], past[i], trial[i], curves)
        new["plastic"][i] += (trial[i] - scaled_back(named[i], k[i], trial[i], share)) / k[i]


def load_factor_to_yield(
    p: Table, state: Table, nodes: Table, displacement: np.ndarray, curves: np.ndarray
) -> float:
    """Share of motions `displacement` (n, 6) at which the first segment begins to yield; at most 1.

    By OVER more than yield, as the path is not straight; of those that are elastic yet.
    """
    _, trial, change = _trials(p, state, nodes, displacement)
    named, past, least = as_rows(p), as_rows(state), 1.0
    for i in np.flatnonzero(p["yields"]):
        limit = elastoplastic.flow(named[i], past[i].strain, curves)[0] * named[i].moduli
        f, d = trial[i] / limit, change[i] / limit
        # |f + s d| = 1 + OVER
        a, b, c = d @ d, f @ d, f @ f
        if c < YIELDING and a + 2.0 * b + c > (1.0 + OVER) ** 2:
            least = min(least, float((np.sqrt(b * b + a * ((1.0 + OVER) ** 2 - c)) - b) / a))
    return least


def _trials(
    p: Table, state: Table, nodes: Table, displacement: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """k, elastic N, M_y, M_z (n, 3), and how these change over motions, to first order."""
    R, q, d_a, d_b = _deformations(p, nodes)
    ends = np.hstack([displacement[p["node_a"]], displacement[p["node_b"]]])
    by_ends = slopes_of_strains(R, q[:, :3], q[:, 3:]) @ _from_mass_centres(d_a, d_b)
    k = np.hstack([p["stiffness"], p["rotational_stiffness"]])[:, YIELDING_AXES]
    change = np.einsum("nij,nj->ni", by_ends, ends)[:, YIELDING_AXES]
    return k, k * (q[:, YIELDING_AXES] - state["plastic"]), k * change


def _deformations(p: Table, nodes: Table) -> tuple[np.ndarray, ...]:
    """R (n, 3, 3), u and theta (n, 6), and arms (n, 3) of both ends."""
    a, b = nodes[p["node_a"]], nodes[p["node_b"]]
    d_a = np.einsum("nij,nj->ni", matrices(a["q"]), p["point_a"])
    d_b = np.einsum("nij,nj->ni", matrices(b["q"]), p["point_b"])
    rotated = products(a["q"], p["rotation_a"]), products(b["q"], p["rotation_b"])
    R, u, theta = strains(*rotated, b["r"] + d_b - a["r"] - d_a)
    return R, np.hstack([u, theta]), d_a, d_b


def _flow(p: Row, state: Row, trial: np.ndarray, curves: np.ndarray) -> tuple[float, float]:
    """Plastic flow `growth` of the trial forces, and its factor."""
    k = (p.stiffness[0], p.rotational_stiffness[1], p.rotational_stiffness[2])
    flow, share = growth(p, k, trial, state.strain, 1.0, 0.0, curves)
    return float(flow), float(share)


def _from_mass_centres(d_a: np.ndarray, d_b: np.ndarray) -> np.ndarray:
    """Motions of both ends by those of their bodies (n, 12, 12)."""
    to = np.tile(np.eye(12), (len(d_a), 1, 1))
    for at, d in ((0, d_a), (6, d_b)):
        to[:, at : at + 3, at + 3 : at + 6] = -skew(d)
    return to
