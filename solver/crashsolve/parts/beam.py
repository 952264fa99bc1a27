"""Beam: a chain of nodes joined by two-node elements with shear and finite rotations.

    y = R^T (r_b - r_a),   theta = log(A_a^T A_b),   u = (e, y_y, y_z),   e = l_bent - l
    U = (u . K u + theta . K_r theta) / 2,   K = diag(E A / l, k_y, k_z)
    1 / k_y = l^3 / (12 E I_z) + l / (kappa_y G A),   1 / k_z = l^3 / (12 E I_y) + l / (kappa_z G A)
    K_r = diag(G J, E I_y, E I_z) / l

R is half-way between both triads. K and K_r are the exact stiffness of a straight Timoshenko
beam; e is the stretch of the line between the ends with the bending it has (`beams/bowing.py`), so
that tension resists bending. Forces on the nodes are f = K u and m = K_r theta through the
derivatives of u and theta, so they are the gradient of U. Damping adds beta times the rates of u
and theta. A node is a rigid body with half the mass and rotary inertia of each element beside it.
Consequence to test: a cantilever under a small load bends by P L^3 / (3 E I) + P L / (kappa G A)
with one element; under a moment of 2 pi E I / L it closes to a ring with any number; a taut string
of any thinness has its lateral stiffness.

References: Crisfield (1990), A consistent co-rotational formulation for non-linear,
three-dimensional beam-elements, Computer Methods in Applied Mechanics and Engineering 81, 131-150.
Simo and Vu-Quoc (1986), A three-dimensional finite-strain rod model. Part II: Computational
aspects, the same 58, 79-116.
"""

from __future__ import annotations

from math import dist
from typing import TYPE_CHECKING, Literal

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, MaterialName, SectionName, Vec3, quantity, word
from crashsolve.elements.beams import element, static_tangent
from crashsolve.elements.beams.corotational import mean_frame
from crashsolve.elements.beams.element import add_drag, damping_rows, deformation, element_forces
from crashsolve.elements.beams.properties import (
    axes_of,
    damping_row,
    ends_row,
    halves,
    laws,
    scaled,
    stiffness_row,
)
from crashsolve.elements.beams.tangent import add_tangent_blocks
from crashsolve.elements.damping import Damped, report_added_mass
from crashsolve.foundation.angles import check_rotation_limit
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.orientation import quaternion_of
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import Table
from crashsolve.foundation.vec3 import ZERO

if TYPE_CHECKING:
    from crashsolve.parts._rows.beam import History, Output, Parameters

DESCRIPTIONS = ("co-rotational",)
"""How deformation may be described; a study runs over them."""
ORDER = 2
"""Power of the length of elements with which errors fall."""


class Mesh(Card):
    """Nodes on a straight line, at equal distances."""

    shape: Literal["line"] = word("line: from one point to another")
    from_: Vec3 = quantity("m", "first node")
    to: Vec3 = quantity("m", "last node")
    elements: int = word("number of elements", ge=1)
    division: int = word(
        "number of elements into which each is divided, as by crashsolve study; new nodes follow "
        "P_k as P_k_1, P_k_2, ..., new elements likewise, and old names stay where they begin",
        default=1,
        ge=1,
    )

    @property
    def count(self) -> int:
        """Number of elements after division."""
        return self.elements * self.division


class Beam(Damped):
    """Beam with shear and finite rotations; its nodes are bodies."""

    mesh: Mesh = word("nodes: P_start, P_1, P_2, ..., P_end of a part P; elements: P_1, P_2, ...")
    section: SectionName = word("cross section")
    material: MaterialName = word("material of the beam")
    side: Vec3 | None = word(
        "direction near the section's y axis; needed where I_y and I_z differ", default=None
    )
    offset: tuple[float, float] = quantity(
        "m",
        "offset of the section's centre from the line of nodes, along y and z",
        default=(0.0, 0.0),
    )
    velocity: Vec3 = quantity("m/s", "initial velocity of the first node", default=ZERO)
    angular_velocity: Vec3 = quantity(
        "rad/s", "initial angular velocity of the whole part, world axes", default=ZERO
    )
    buckling_load: float | None = quantity(
        "N", "compression along the beam above which the run warns at its end", default=None, gt=0
    )

    @property
    def beams(self) -> int:
        """Number of elements."""
        return self.mesh.count

    def node_names(self, part: str) -> list[str]:
        """Names of the nodes of a part of this name."""
        words = ["start", *map(str, range(1, self.mesh.elements))]
        return [*self._divided(part, words), f"{part}_end"]

    def element_names(self, part: str) -> list[str]:
        """Names of its elements."""
        return self._divided(part, [str(k + 1) for k in range(self.mesh.elements)])

    def _divided(self, part: str, words: list[str]) -> list[str]:
        ends = ["", *(f"_{j}" for j in range(1, self.mesh.division))]
        return [f"{part}_{word}{end}" for word in words for end in ends]


ELEMENT = Record("""
    node_a                index         first node
    node_b                index         second node
    length                m             l
    stiffness             N/m        3  diagonal of K
    rotational_stiffness  N m/rad    3  diagonal of K_r
    bowing                1          2  c_y and c_z
    damping               s             beta
    drag_a                1/s           alpha, times the element's share in its first node
    drag_b                1/s           the same of the second
    viscosity             N s/m         rho A c b_1, of the stretch
    quadratic_viscosity   N s^2/m^2     rho A b_2^2, of its square in compression
    rate_a                1/s^2         largest k times mobility at the first node
    rate_b                1/s^2         the same at the second
    tension_rate_a        1/(kg m)      increase of that by a tension of 1 N, at the first node
    tension_rate_b        1/(kg m)      the same at the second
    bow_coupling          1/m^0.5       root of the rate of a bow of 1 m over the rate, both nodes
""")
PARAMETERS = ELEMENT + Record("buckling  N  compression to warn of; infinite if there is none")
HISTORY = Record("peak_compression  N  largest compression along the beam so far")
TANGENTS = element.TANGENTS
OUTPUT = Record("""
    force      N    3  tension, shear along y and z, axes of the element
    moment_a   N m  3  torsion, bending about y and z, at the first node
    moment_b   N m  3  torsion, bending about y and z, at the second node
    strain     1    3  stretch of the bent line, shear along y and z, u / l
    curvature  1/m  3  twist, bending about y and z, theta / l
""")


def build(card: Beam, scene: Scene) -> list[Columns]:
    """The nodes as bodies."""
    section, material, length = _numbers(card, scene)
    start, end, n = np.asarray(card.mesh.from_), np.asarray(card.mesh.to), card.mesh.count
    quaternion = quaternion_of(_triad(card, section, scene))
    mass, J = halves(card, section, material, length, scene)
    report_added_mass(card, *scaled(card, section, material, np.full(n, length), scene), scene)
    nodes = []
    for k in range(n + 1):
        offset, ends = (end - start) * (k / n), 1 if k in (0, n) else 2
        nodes.append(
            {
                "mass": mass * ends,
                "inertia": J * ends,
                "mass_centre": (0.0, *card.offset),
                "position": start + offset,
                "quaternion": quaternion,
                "velocity": np.asarray(card.velocity) + np.cross(card.angular_velocity, offset),
                "angular_velocity": card.angular_velocity,
            }
        )
    return nodes


def elements(card: Beam, nodes: list[int], scene: Scene) -> list[Columns]:
    """The elements between neighbours."""
    section, material, length = _numbers(card, scene)
    half, _ = halves(card, section, material, length, scene)
    row = stiffness_row(section, material, length) | damping_row(card, section, material, scene)
    row |= {"buckling": card.buckling_load or np.inf}
    return [
        row | ends_row(card, row, (a, b), scene, np.eye(3), half)
        for a, b in zip(nodes[:-1], nodes[1:], strict=True)
    ]


def _numbers(card: Beam, scene: Scene) -> tuple[Columns, Columns, float]:
    """Section, material and length of an element."""
    length = dist(card.mesh.from_, card.mesh.to) / card.mesh.count
    if not length > 0.0:
        raise scene.fail("begins and ends in one point; a beam needs a length", "mesh.to")
    return *laws(card, scene), length


def _triad(card: Beam, section: Columns, scene: Scene) -> np.ndarray:
    """Axes of the section at the start as columns: along the beam, y, z."""
    along = scene.unit(np.subtract(card.mesh.to, card.mesh.from_), "mesh.to")
    return axes_of(card, along, section, scene)


def forces_by_motions(p: Table, state: Table, nodes: Table, curves: np.ndarray) -> np.ndarray:
    """Derivatives (n, 12, 12) of the forces on both nodes of all elements at rest."""
    a, b = nodes[p["node_a"]], nodes[p["node_b"]]
    return static_tangent.forces_by_motions(p, a["q"], b["q"], b["r"] - a["r"])


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame(a, b)
    check_rotation_limit(curves, p.node_b, w)
    element_forces(p, out, a, b, R, v, w)
    add_drag(p, out, nodes)
    new.peak_compression = max(old.peak_compression, -out.force[0])


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Derivatives of the forces by velocities; for those by positions see tangent_blocks.

    Writes: rows.
    """
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame(a, b)
    damping_rows(p, a, b, R, v, w, rows, first)


@kernel
def tangent_blocks(p: Parameters, state: History, nodes, curves, slot, blocks):
    """Tangent by the positions. Writes: blocks."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame(a, b)
    strained = deformation(p, a, b, R, v, w)
    add_tangent_blocks(p, None, a, b, (R, v, w), strained, slot, blocks)
