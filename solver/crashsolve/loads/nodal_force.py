"""Force on the nodes of a set of a shell, held or not, constant or by a curve of time.

    f_i = s_i F phi(t),   s_i = m_i / sum m  or  1 / n

Its work is that of the mean force of a step. What holds a node in one direction takes its share
there, and the node moves in the others. A line of nodes under an even load has s_i = m_i / sum m on
a mesh of equal elements: half at its ends.
Consequence to test: F turns nothing if all nodes of a shell share it by their masses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, PartName, SetName, Vec3, quantity, word
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import act_from_outside
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, cross, dot, put, scale, vec

if TYPE_CHECKING:
    from crashsolve.loads._rows.nodal_force import History, Output, Parameters


class NodalForce(Card):
    """Force on a set of nodes of a shell, which may have supports in other directions."""

    curve_axes: ClassVar = {"curve": ("s", "1")}

    part: PartName = word("shell part")
    nodes: SetName = word("set of nodes of its mesh")
    force: Vec3 = quantity("N", "F, on all of them together; world axes; times curve")
    share: Literal["mass", "equal"] = word("division among the nodes", default="mass")
    curve: CurveName | None = word("factor over time; 1 when absent", default=None)


CURVES_OF_TIME = ("curve",)
PARAMETERS = Record("""
    vector        N      3  F
    curve         index     factor over time; 0 for none
    mass          kg        of the nodes together; 0 if they share alike
    first_member  index     of the nodes among those of all entries
    member_count  count     nodes
""")
AMPLITUDE = "vector"
HISTORY = Record("factor  1  phi at the last step")
OUTPUT = Record("force  N  3  total, world axes")


def build(card: NodalForce, scene: Scene) -> Columns:
    meshed, _, _ = scene.skin(card.part, "part")
    own = meshed.set_of(card.nodes, "nodes", scene)
    return {
        "vector": card.force,
        "curve": scene.curve(card.curve) if card.curve else 0,
        "mass": meshed.mass[own].sum() if card.share == "mass" else 0.0,
    }


def members(card: NodalForce, scene: Scene) -> np.ndarray:
    """The points (n,) it acts on."""
    meshed, _, first = scene.skin(card.part, "part")
    points: np.ndarray = first + meshed.set_of(card.nodes, "nodes", scene)
    return points


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: out, new."""
    factor = 1.0
    if p.curve > 0:
        factor, _, _ = curve_value(curves, p.curve, t)
    put(out.force, scale(factor, vec(p.vector)))
    out.stored = out.power = out.loss = 0.0
    new.factor = factor


@kernel
def force_on_points(
    p: Parameters, old: History, new: History, out: Output, t, h, nodes, curves, scene, members
):
    """The share of every node. Writes: scene.points, nodes, out."""
    f, points = vec(out.force), scene.points
    position = velocity = (0.0, 0.0, 0.0)
    for k in range(p.first_member, p.first_member + p.member_count):
        b = points[members[k]]
        share = 1.0 / p.member_count
        if p.mass > 0.0:
            share = 1.0 / (b.mass_inv * p.mass)
        add_to(b.force, scale(share, f))
        position, velocity = (
            add_scaled(position, share, vec(b.r)),
            add_scaled(velocity, share, vec(b.v)),
        )
    # velocities are those of the step
    mean = scale(0.5 * (old.factor + new.factor), vec(p.vector))
    out.loss += h * dot(mean, velocity)
    act_from_outside(nodes[0], f, cross(position, f))


@kernel
def kick_rate(p: Parameters, out: Output, scene, members):
    """f . M^-1 F of the load f on its nodes and all forces F on them [W/s]."""
    f, points, total = vec(out.force), scene.points, 0.0
    for k in range(p.first_member, p.first_member + p.member_count):
        b = points[members[k]]
        # of a share by mass, s_i / m_i is the same for all
        rate = b.mass_inv / p.member_count if p.mass == 0.0 else 1.0 / p.mass
        total += rate * dot(f, vec(b.force))
    return total
