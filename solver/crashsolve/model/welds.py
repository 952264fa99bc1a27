"""Nodes welded to a rigid body: its slaves, with no motion of their own.

    m = m_0 + sum m_k,   J = J_0 + m_0 [s_0] + sum (J_k + m_k [s_k]),   [s] = s . s I - s s^T

s_k are the places of the nodes, s_0 that of the body's own mass centre, from the common one. It is
the mass matrix of Ambrosio (2003), Eq. 8, about the common mass centre, where it falls apart into
that of a rigid body. Consequence to test: a free body with a beam welded on keeps its momentum and
its angular momentum, as it would with the joint `weld`.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.record import Record

SLAVE = Record(
    node=("index", "the slave"),
    body=("index", "what it is welded to"),
    arm=("m", 3, "place of the node from the mass centre, body axes"),
    turn=("1", 4, "unit quaternion, node to body"),
)
# mass of a slave's row of the node table: what it has belongs to the body
NOTHING = 1e-300


def lump(body: int, slaves: list[int], scene: Any) -> None:
    """Add mass and inertia of welded nodes to their body. Writes: scene.mass, J, r, v, offset."""
    A = scene.matrix(body)
    turns = [A.T @ scene.matrix(i) for i in slaves]
    own = [B @ scene.J[i].reshape(3, 3) @ B.T for i, B in zip(slaves, turns, strict=True)]
    add_masses(body, scene.mass[slaves], scene.r[slaves], np.array(own), scene)


def add_masses(
    body: int, mass: np.ndarray, places: np.ndarray, inertia: np.ndarray, scene: Any
) -> None:
    """Add masses (n,) at places (n, 3) with inertia (n, 3, 3), body axes, to a body.

    Writes: scene.mass, J, r, v, offset.
    """
    mass = np.append(scene.mass[body], mass)
    places = np.concatenate([scene.r[body][None], places])
    A = scene.matrix(body)
    centre = mass @ places / mass.sum()
    s = (places - centre) @ A
    J = scene.J[body].reshape(3, 3) + inertia.sum(axis=0)
    J = J + (mass * (s * s).sum(axis=1)).sum() * np.eye(3) - np.einsum("n,ni,nj->ij", mass, s, s)
    way = centre - scene.r[body]
    scene.v[body] += np.cross(scene.w[body], way)
    scene.offset[body] += A.T @ way
    scene.r[body], scene.mass[body], scene.J[body] = centre, mass.sum(), J.ravel()


def misfit(body: int, slave: int, scene: Any) -> float:
    """Difference of the velocities of a node and of its place on the body [m/s]."""
    way = scene.r[slave] - scene.r[body]
    apart = scene.v[slave] - scene.v[body] - np.cross(scene.w[body], way)
    return float(np.linalg.norm(apart))


def table(scene: Any) -> np.ndarray:
    """The slaves as kernels read them."""
    rows = np.zeros(len(scene.welded), SLAVE.dtype)
    for row, (node, body) in zip(rows, scene.welded.items(), strict=True):
        row["node"], row["body"] = node, body
        row["arm"] = scene.to_body(body, scene.r[node])
        row["turn"] = _between(scene.q[body], scene.q[node])
    return rows


def unload(nodes: np.ndarray, slaves: np.ndarray) -> None:
    """Take their inertia from the rows of slaves. Writes: nodes."""
    at = slaves["node"]
    nodes["mass_inv"][at] = 1.0 / NOTHING
    for name in ("J", "J_inv", "L"):
        nodes[name][at] = 0.0


def _between(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternion p^-1 q."""
    w, v = p[0], -p[1:]
    return np.array([w * q[0] - v @ q[1:], *(w * q[1:] + q[0] * v + np.cross(v, q[1:]))])
