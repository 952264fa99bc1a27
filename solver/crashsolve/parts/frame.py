"""Frame: bars between listed points, each a chain of the beam's elements, stiff where they meet.

    u = R^T (r_b - r_a) - l e_x,   theta = log((A_a Q)^T A_b Q),   R = A_a Q exp(theta / 2)

Q turns the axes of an element to those of the nodes, which at the start are the world's: what is
kinked at the start is free of stress. Energy, forces and stiffness are those of the beam. A node
has half the mass and rotary inertia of each element that meets in it. Consequence to test: a
straight bar in any direction is the beam; an arm across another twists it.

References: those of the beam.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import MaterialName, SectionName, Vec3, quantity, word
from crashsolve.elements.beams import element, properties, releases, static_tangent
from crashsolve.elements.beams.corotational import mean_frame_of
from crashsolve.elements.beams.tangent import add_tangent_blocks
from crashsolve.elements.damping import Damped, report_added_mass
from crashsolve.foundation.angles import axes_at, check_rotation_limit
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.orientation import products, quaternion_of
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import Table
from crashsolve.foundation.vec3 import ZERO
from crashsolve.parts import beam

if TYPE_CHECKING:
    from crashsolve.parts._rows.frame import History, Output, Parameters

HISTORY, OUTPUT, TANGENTS = Record(), beam.OUTPUT, element.TANGENTS
ORDER, DESCRIPTIONS = beam.ORDER, beam.DESCRIPTIONS
PARAMETERS = beam.ELEMENT + Record("rotation  1  4  unit quaternion Q, element to nodes")


class Frame(Damped):
    """Bars with shear and finite rotations between listed points; their nodes are bodies."""

    points: tuple[Vec3, ...] = quantity(
        "m", "points where bars meet: nodes P_1, P_2, ... of a part P"
    )
    bars: tuple[tuple[int, int], ...] = word(
        "pairs of points by their number from 1; nodes within bar k: P_bark_1, P_bark_2, ..."
    )
    elements: int = word("number of elements of each bar", ge=1)
    ends: tuple[releases.End, ...] = word(
        "ends of bars that are hinged to their point, or offset from it", ()
    )
    section: SectionName = word("cross section")
    material: MaterialName = word("material of the bars")
    side: Vec3 | None = word(
        "direction near the section's y axis; needed where I_y and I_z differ", default=None
    )
    velocity: Vec3 = quantity("m/s", "initial velocity of the first point", default=ZERO)
    angular_velocity: Vec3 = quantity(
        "rad/s", "initial angular velocity of the whole part, world axes", default=ZERO
    )

    def node_names(self, part: str) -> list[str]:
        """Names of the nodes of a part of this name."""
        inner = [f"bar{k + 1}_{j}" for k in range(len(self.bars)) for j in range(1, self.elements)]
        own = [f"{part}_{word}" for word in (*range(1, len(self.points) + 1), *inner)]
        return own + releases.names(self, part)

    @property
    def beams(self) -> int:
        """Number of elements."""
        return self.elements * len(self.bars)

    def joints(self, part: str) -> dict[str, tuple[str, Columns]]:
        """Joints that its ends bring: type and words by name."""
        return releases.joints(self, part)

    def element_names(self, part: str) -> list[str]:
        """Names of its elements, bar after bar."""
        return [f"{part}_{k + 1}" for k in range(self.elements * len(self.bars))]


def build(card: Frame, scene: Scene) -> list[Columns]:
    """The nodes as bodies."""
    _check(card, scene)
    section, material = properties.laws(card, scene)
    positions, chains = _mesh(card)
    mass, J, lengths = np.zeros(len(positions)), np.zeros((len(positions), 3, 3)), []
    for a, b in chains:
        length = float(np.linalg.norm(positions[b] - positions[a]))
        T = properties.axes_of(card, (positions[b] - positions[a]) / length, section, scene)
        half, inertia = properties.halves(card, section, material, length, scene)
        lengths.append(length)
        for node in (a, b):
            mass[node] += half
            J[node] += T @ inertia @ T.T
    scaled_mass = properties.scaled(card, section, material, np.array(lengths), scene)
    report_added_mass(card, *scaled_mass, scene)
    return [
        {
            "mass": mass[i],
            "inertia": J[i],
            "mass_centre": ZERO,
            "position": position,
            "quaternion": (1.0, 0.0, 0.0, 0.0),
            "velocity": card.velocity + np.cross(card.angular_velocity, position - positions[0]),
            "angular_velocity": card.angular_velocity,
        }
        for i, position in enumerate(positions)
    ]


def elements(card: Frame, nodes: list[int], scene: Scene) -> list[Columns]:
    """The elements, bar after bar."""
    section, material = properties.laws(card, scene)
    positions, chains = _mesh(card)
    damped, rows = properties.damping_row(card, section, material, scene), []
    for a, b in chains:
        length = float(np.linalg.norm(positions[b] - positions[a]))
        T = properties.axes_of(card, (positions[b] - positions[a]) / length, section, scene)
        row = properties.stiffness_row(section, material, length) | damped
        half, _ = properties.halves(card, section, material, length, scene)
        ends = properties.ends_row(card, row, (nodes[a], nodes[b]), scene, T, half)
        rows.append(row | ends | {"rotation": quaternion_of(T)})
    return rows


def _mesh(card: Frame) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Positions (n, 3) of all nodes, and the two nodes of each element."""
    positions, chains = [np.asarray(point) for point in card.points], []
    first_end = len(positions) + len(card.bars) * (card.elements - 1)
    own = {(end.bar, end.point): first_end + k for k, end in enumerate(card.ends)}
    for k, (first, last) in enumerate(card.bars, start=1):
        offset = releases.along(card, k)
        chain = [own.get((k, first), first - 1)]
        start = releases.start(card, k)
        for j in range(1, card.elements):
            chain.append(len(positions))
            positions.append(start + offset * (j / card.elements))
        chain.append(own.get((k, last), last - 1))
        chains += list(zip(chain[:-1], chain[1:], strict=True))
    positions += [releases.position(card, end) for end in card.ends]
    return np.array(positions), chains


def _check(card: Frame, scene: Scene) -> None:
    """Refuses bars to points that do not exist, without length, twice; points without a bar."""
    count, pairs = len(card.points), set()
    for k, bar in enumerate(card.bars, start=1):
        if not all(1 <= end <= count for end in bar):
            raise scene.fail(f"bar {k} joins {list(bar)}, but points are 1 to {count}", "bars")
        if not np.linalg.norm(releases.along(card, k)) > 0.0:
            raise scene.fail(f"bar {k} begins and ends in one point", "bars")
        if frozenset(bar) in pairs:
            raise scene.fail(f"bar {k} is given twice", "bars")
        pairs.add(frozenset(bar))
    wrong = releases.fault(card)
    if wrong:
        raise scene.fail(wrong, "ends")
    loose = sorted(set(range(1, count + 1)) - {end for bar in card.bars for end in bar})
    if loose:
        raise scene.fail(f"point {loose[0]} has no bar; take it out or join it", "points")


def forces_by_motions(p: Table, state: Table, nodes: Table, curves: np.ndarray) -> np.ndarray:
    """Derivatives (n, 12, 12) of the forces on both nodes of all elements at rest."""
    a, b = nodes[p["node_a"]], nodes[p["node_b"]]
    q_a, q_b = products(a["q"], p["rotation"]), products(b["q"], p["rotation"])
    return static_tangent.forces_by_motions(p, q_a, q_b, b["r"] - a["r"])


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame_of(axes_at(a, p.rotation), axes_at(b, p.rotation))
    check_rotation_limit(curves, p.node_b, w)
    element.element_forces(p, out, a, b, R, v, w)
    element.add_drag(p, out, nodes)


@kernel
def tangent_blocks(p: Parameters, state: History, nodes, curves, position, blocks):
    """Tangent by the positions. Writes: blocks."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame_of(axes_at(a, p.rotation), axes_at(b, p.rotation))
    strained = element.deformation(p, a, b, R, v, w)
    add_tangent_blocks(p, None, a, b, (R, v, w), strained, position, blocks)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Derivatives of the forces by velocities. Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame_of(axes_at(a, p.rotation), axes_at(b, p.rotation))
    element.damping_rows(p, a, b, R, v, w, rows, first)
