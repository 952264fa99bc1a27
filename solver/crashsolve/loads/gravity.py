"""Uniform gravity on every body and on every node of shells.

f_i = m_i g,   potential energy -m_i g . r_i
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, Vec3, quantity
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import act_from_outside, apply_external
from crashsolve.foundation.point import ATTACHED
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, cross, dot, put, scale, vec

if TYPE_CHECKING:
    from crashsolve.loads._rows.gravity import History, Output, Parameters

LEDGER = "potential"
AMPLITUDE = "acceleration"


class Gravity(Card):
    """Uniform gravity on every body and node."""

    acceleration: Vec3 = quantity("m/s^2", "acceleration of free fall", default=(0.0, 0.0, -9.81))


PARAMETERS = Record("acceleration  m/s^2  3  acceleration of free fall")
HISTORY = Record()
OUTPUT = Record("force  N  3  total weight")


def build(card: Gravity, scene: Scene) -> Columns:
    fields = [
        name for name, entry in scene.deck.entries["loads"].items() if entry.type == "gravity"
    ]
    if len(fields) > 1:
        named = " and ".join(f"'{name}'" for name in fields)
        scene.warn(f"loads {named} are all gravity on every body: their accelerations add up")
    return {"acceleration": card.acceleration}


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    zero = (0.0, 0.0, 0.0)
    g = vec(p.acceleration)
    potential, mass = 0.0, 0.0
    for i in range(1, nodes.shape[0]):
        m = 1.0 / nodes[i].mass_inv
        mass += m
        potential -= m * dot(g, vec(nodes[i].r))
        apply_external(nodes, i, scale(m, g), zero, zero)
    put(out.force, scale(mass, g))
    out.stored = potential
    out.power = 0.0
    out.loss = 0.0


@kernel
def force_on_points(
    p: Parameters, old: History, new: History, out: Output, t, h, nodes, curves, scene
):
    """Apply the weight of points that are not attached to a body.

    Writes: scene.points, nodes, out.
    """
    g, points = vec(p.acceleration), scene.points
    mass, position = 0.0, (0.0, 0.0, 0.0)
    for i in range(points.shape[0]):
        b = points[i]
        if b.fixed < ATTACHED:
            m = 1.0 / b.mass_inv
            mass, position = mass + m, add_scaled(position, m, vec(b.r))
            add_to(b.force, scale(m, g))
    out.stored -= dot(g, position)
    add_to(out.force, scale(mass, g))
    act_from_outside(nodes[0], scale(mass, g), cross(position, g))
