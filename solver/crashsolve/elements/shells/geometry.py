"""Mesh of a shell part as elements have it: order, shapes, points through the thickness."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.elements.shells.cards import NamedNode, SectionCut, ShellCard, Trace
from crashsolve.elements.shells.forces.quadrilateral import rate_bound
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES

if TYPE_CHECKING:
    from crashsolve.deck.building import MeshOfScene


def rule(card: ShellCard, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Positions -1 to 1 and weights, sum 2, of the layers, (layers,) each."""
    if card.rule == "gauss":
        return np.polynomial.legendre.leggauss(card.layers)
    if card.layers < 2:
        raise scene.fail("lobatto needs 2 layers at least: one at each face", "layers")
    # ends, and roots of the derivative of the Legendre polynomial of one degree less
    polynomial = np.polynomial.legendre.Legendre.basis(card.layers - 1)
    zeta = np.concatenate([[-1.0], np.sort(polynomial.deriv().roots().real), [1.0]])
    return zeta, 2.0 / (card.layers * (card.layers - 1) * polynomial(zeta) ** 2)


def nearest(positions: np.ndarray, card: NamedNode | Trace) -> int:
    """Number of the position nearest to that of a card."""
    return int(np.argmin(np.linalg.norm(positions - np.asarray(card.at), axis=1)))


def sides(x: np.ndarray, card: SectionCut, scene: Scene) -> np.ndarray:
    """Corners (n, 4), of elements at x (n, 4, 3), in front of a cut.

    Rows of elements that are not cut are empty.
    """
    normal = scene.unit(card.normal, "section_cuts")
    is_front = (x - np.asarray(card.at)) @ normal > 0.0
    is_front &= ~is_front.all(axis=1, keepdims=True)
    if not is_front.any():
        raise scene.fail(f"the plane of '{card.name}' cuts no element", "section_cuts")
    return is_front


def sorted_mesh(mesh: Any, cut: bool) -> MeshOfScene:
    """The mesh with its triangles last, a corner named twice at their end; or cut into triangles.

    A quadrilateral is cut along the shorter diagonal.
    """
    quads = mesh.quads.copy()
    for k in range(3):
        same = quads[:, k] == quads[:, (k + 1) % 4]
        quads[same] = np.roll(quads[same], 2 - k, axis=1)
    same = (quads[:, 3] == quads[:, 0]) & (quads[:, 2] != quads[:, 3])
    quads[same] = np.roll(quads[same], -1, axis=1)
    whole, thirds = quads[quads[:, 2] != quads[:, 3]], quads[quads[:, 2] == quads[:, 3]]
    if cut:
        x = mesh.points[whole]
        diagonals = np.linalg.norm([x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]], axis=2)
        rotated = np.where((diagonals[1] < diagonals[0])[:, None], np.roll(whole, -1, 1), whole)
        halves = rotated[:, [[0, 1, 2, 2], [0, 2, 3, 3]]].reshape(-1, 4)
        whole, thirds = whole[:0], np.concatenate([halves, thirds])
    return replace(mesh, quads=np.concatenate([whole, thirds]).astype(np.int32))


def blocks_of(own: slice) -> int:
    """Blocks that hold these elements."""
    return -(-(own.stop - own.start) // LANES)


def in_lanes(values: np.ndarray) -> np.ndarray:
    """(blocks, lanes); the last element stands for those that are missing."""
    missing = -len(values) % LANES
    filled = np.append(values, np.repeat(values[-1:], missing, axis=0))
    return filled.reshape(-1, LANES)


def diagonals(x: np.ndarray) -> np.ndarray:
    """Diagonals of quadrilaterals (m, 4, 3) in axes between them, as columns (m, 2, 2)."""
    d, e = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
    d_length, e_length = np.linalg.norm(d, axis=1), np.linalg.norm(e, axis=1)
    # both axes are as far from one diagonal as from the other
    half = 0.5 * np.arccos(np.clip((d * e).sum(1) / (d_length * e_length), -1.0, 1.0))
    s, c = np.sin(half), np.cos(half)
    return np.array([[d_length * s, -e_length * s], [d_length * c, e_length * c]]).transpose(
        2, 0, 1
    )


@kernel
def quad_bound(flat, hourglass, z, area, thickness, radius_2, light, nu):
    """Bound of the largest squared frequency of a quadrilateral [1/s^2], for Python to call."""
    return rate_bound(flat, hourglass, z, area, thickness, radius_2, light, nu)
