"""Largest frequency of a node of a beam element: it bounds the step of explicit methods.

The diagonal block K_a of a straight element's stiffness K of node a, over its mass M_a, has a
largest eigenvalue r_a. The energy of any motion is at most twice the sum of those of both nodes
alone; in a beam it is less, since shear rotates both ends in one sense and bending in opposite
ones:

    K <= s diag(r_a M_a, r_b M_b),   1 <= s <= 2

so that the largest eigenvalue of M^-1 K of a chain is not above twice the largest sum of s r / 2 at
a node. In a slender element that is 12 E / (rho l^2), from bending against rotary inertia, and a
tension N adds 8 N / (15 rho I l). An end attached to a body has the inertia that the body shares
out to it (model/attachments.py) and no other element: with the larger of both r in its place s
goes down to 1 as the body gets heavy.

A bent element has larger gradients, and its modes are coupled (element.growth_of_rates).
Consequence to test: the bound holds in any orientation, at any tension, bend and twist, and is the
highest frequency of a straight element by itself.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from crashsolve.deck.building import Columns


class End(NamedTuple):
    """A node of an element: what moves there."""

    mass: float  # [kg]
    J: bytes  # (3, 3) axes of the element [kg m^2]
    is_attached: bool  # to a body, and has no other element


def end_of(mass: float, J: np.ndarray, is_attached: bool = False) -> End:
    """A node with this inertia (3, 3) in axes of the element."""
    return End(float(mass), J.tobytes(), is_attached)


def fastest_rates(row: Columns, ends: tuple[End, End]) -> tuple[float, float]:
    """s w r / 2 of both nodes of a straight element [1/s^2]."""
    stiffness = (*row["stiffness"], *row["rotational_stiffness"])
    return _fastest_rates(float(row["length"]), stiffness, ends)


@lru_cache(maxsize=64)
def _fastest_rates(
    length: float, stiffness: tuple[float, ...], ends: tuple[End, End]
) -> tuple[float, float]:
    """s w r / 2 of both nodes [1/s^2] from plain values, which most elements of a beam share."""
    rates = [_fastest_rate(length, stiffness, 0.0, end.mass, end.J) for end in ends]
    # an attached end bears no other element: it may take as much as its neighbour
    for k, end in enumerate(ends):
        if end.is_attached:
            rates[k] = max(rates)
    rows = np.hstack([_motion(length, -1.0), _motion(length, 1.0)])
    M = np.zeros((12, 12))
    for k, (rate, end) in enumerate(zip(rates, ends, strict=True)):
        M[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = rate * _inertia(end.mass, end.J)
    coupled = _largest(M, rows.T @ np.diag(stiffness) @ rows)
    return 0.5 * coupled * rates[0], 0.5 * coupled * rates[1]


def rate_of_tension(row: Columns, end: End) -> float:
    """Increase of both rates by a tension of 1 N [1/(kg m)].

    Of the stretch e by lateral displacement: of the chord, 1 / l, and of the bow where it is
    positive.
    """
    length = float(row["length"])
    by_displacement = (2.0 * max(c, 0.0) / length for c in row["bowing"])
    stiffness = (0.0, *by_displacement, 0.0, length / 12.0, length / 12.0)
    return _fastest_rate(length, stiffness, 1.0 / length, end.mass, end.J)


@lru_cache(maxsize=64)
def _fastest_rate(
    length: float, stiffness: tuple[float, ...], across: float, mass: float, J: bytes
) -> float:
    """Largest eigenvalue of M^-1 K of one node of a straight element.

    `stiffness` resists displacement and rotation of the node in the frame, `across` displacement
    alone.
    """
    D = _motion(length, 1.0)
    K = D.T @ np.diag(stiffness) @ D + np.diag((0.0, across, across, 0.0, 0.0, 0.0))
    return _largest(_inertia(mass, J), K)


def _motion(length: float, side: float) -> np.ndarray:
    """Derivatives of u and theta by displacement and rotation of node b (side 1) or a (side -1).

    (6, 6)
    """
    D = side * np.eye(6)
    # shear along y rotates about z, along z about y in the opposite sense
    D[1, 5], D[2, 4] = -0.5 * length, 0.5 * length
    return D


def _inertia(mass: float, J: bytes) -> np.ndarray:
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = mass * np.eye(3), np.frombuffer(J).reshape(3, 3)
    return M


def _largest(M: np.ndarray, K: np.ndarray) -> float:
    """Largest eigenvalue of M^-1 K."""
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    return float(np.linalg.eigvalsh(inverse @ K @ inverse.T)[-1])
