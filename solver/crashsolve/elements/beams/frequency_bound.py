"""Largest frequency of a node of a straight beam element: it bounds the step of explicit methods.

The diagonal block of the element's stiffness K of one node, over its mass, has a largest
eigenvalue; the largest of M^-1 K of a chain is not above twice the largest sum of these at a node.
In a slender element it is 8 E / (rho l^2), from bending against rotary inertia, and a tension N
adds 4 N / (15 rho I). Consequence to test: the bound holds in any orientation, at any tension.
"""

from functools import lru_cache

import numpy as np

from crashsolve.deck.building import Columns


def fastest_rate(row: Columns, mass: float, J: np.ndarray) -> float:
    """Largest eigenvalue of M^-1 sum k D^T D of one node of a straight element [1/s^2].

    The node has this mass and inertia (3, 3), axes of the element.
    """
    stiffness = (*row["stiffness"], *row["rotational_stiffness"])
    return _fastest_rate(float(row["length"]), stiffness, 0.0, float(mass), J.tobytes())


def rate_of_tension(row: Columns, mass: float, J: np.ndarray) -> float:
    """The same of what a tension of 1 N adds [1/(kg m)].

    Of the stretch e by lateral displacement: of the chord, 1 / l, and of the bow where it is
    positive.
    """
    length = float(row["length"])
    by_displacement = (2.0 * max(c, 0.0) / length for c in row["bowing"])
    stiffness = (0.0, *by_displacement, 0.0, length / 12.0, length / 12.0)
    return _fastest_rate(length, stiffness, 1.0 / length, float(mass), J.tobytes())


@lru_cache(maxsize=64)
def _fastest_rate(
    length: float, stiffness: tuple[float, ...], across: float, mass: float, J: bytes
) -> float:
    """The same of plain values: elements of a beam have mostly the same.

    `stiffness` resists displacement and rotation of the node in the frame, `across` displacement
    alone.
    """
    half, D = 0.5 * length, np.eye(6)
    # shear along y rotates about z, along z about y in the opposite sense
    D[1, 5], D[2, 4] = half, -half
    K = D.T @ np.diag(stiffness) @ D + np.diag((0.0, across, across, 0.0, 0.0, 0.0))
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = mass * np.eye(3), np.frombuffer(J).reshape(3, 3)
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    return float(np.linalg.eigvalsh(inverse @ K @ inverse.T)[-1])
