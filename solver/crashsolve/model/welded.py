"""Bodies that joints of type weld fix to each other, and that therefore move as one.

    m = sum m_k,   J = sum (J_k + m_k [s_k]),   [s] = s . s I - s s^T

s_k are the mass centres from the common one. A contact on any of these bodies meets the inertia of
all of them: a light bumper on a heavy car is no light body. Consequence to test: a ball strikes as
one body whether or not it is cut into two that a weld joins.
"""

import numpy as np

from crashsolve.model.model import Model
from crashsolve.model.nodes import NODE, WELDED


def wholes(model: Model) -> np.ndarray:
    """Of each node the first node of its rigid whole; itself where no weld holds it.

    Bodies welded to the ground and attached nodes count by themselves.
    """
    number = np.arange(len(model.mass))
    may_separate = {name for g in model.joint_groups() if g.can_separate for name in g.names}
    attached = set(model.attached_nodes["node"].tolist())
    for joint in model.joints:
        is_rigid = joint.type == "weld" and joint.name not in may_separate
        if is_rigid and not attached & set(joint.nodes):
            ends = number[list(joint.nodes)]
            number[np.isin(number, ends)] = ends.min()
    return np.where(number == 0, np.arange(len(number)), number)


def touches_welded(model: Model) -> bool:
    """Whether contacts touch bodies that are welded."""
    sides = [e["node"] for g in model.contact_groups for e in (g.elements_a, g.elements_b)]
    if not sides or not any(joint.type == "weld" for joint in model.joints):
        return False
    first = wholes(model)
    counts = np.bincount(first, minlength=len(first))
    return bool((counts[first[np.concatenate(sides)]] > 1).any())


def with_wholes(nodes: np.ndarray, model: Model) -> np.ndarray:
    """The node table with the columns of WELDED."""
    first = wholes(model)
    counts = np.bincount(first, minlength=len(first))
    wider = np.zeros(len(nodes), (NODE + WELDED).dtype)
    for name in nodes.dtype.names or ():
        wider[name] = nodes[name]
    wider["welded_first"] = first
    wider["welded_mass_inv"], wider["welded_J_inv"] = nodes["mass_inv"], nodes["J_inv"]
    for number in np.flatnonzero(counts > 1):
        _join(np.flatnonzero(first == number), wider)
    return wider


def _join(some: np.ndarray, nodes: np.ndarray) -> None:
    """Columns of the bodies of one whole. Writes: nodes."""
    mass = 1.0 / nodes["mass_inv"][some]
    r, A = nodes["r"][some], nodes["A"][some].reshape(-1, 3, 3)
    centre = mass @ r / mass.sum()
    s = r - centre
    J = np.einsum("nij,njk,nlk->il", A, nodes["J"][some].reshape(-1, 3, 3), A)
    J += np.einsum("n,nk,nk->", mass, s, s) * np.eye(3) - np.einsum("n,ni,nj->ij", mass, s, s)
    inverse = np.linalg.inv(J)
    for k, node in enumerate(some):
        nodes["welded_mass_inv"][node] = 1.0 / mass.sum()
        nodes["welded_at"][node] = A[k].T @ (centre - r[k])
        nodes["welded_J_inv"][node] = (A[k].T @ inverse @ A[k]).ravel()
