"""Linear spring and damper between two points.

    F = k (l - l_0) + c l_dot,   tension positive

Consequence to test: a mass on it swings with omega^2 = k / m; stored energy k (l - l_0)^2 / 2,
dissipated power c l_dot^2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import line_tangent, pull
from crashsolve.foundation.record import Record
from crashsolve.springs._between import POINTS, line_of_action, rest_length, spring_and_damper
from crashsolve.springs._card import PointSpringCard
from crashsolve.springs._geometric_stiffness import add_geometric_stiffness

if TYPE_CHECKING:
    from crashsolve.springs._rows.linear import History, Output, Parameters


class Linear(PointSpringCard):
    """Linear spring and damper between two points."""

    stiffness: float = quantity("N/m", "slope of force over elongation", ge=0)
    damping: float = quantity("N s/m", "force over rate of elongation", default=0.0, ge=0)
    length: float | None = quantity(
        "m", "length without force; that at the start when absent", default=None, ge=0
    )


PARAMETERS = POINTS + Record("""
    stiffness  N/m    k
    damping    N s/m  c
    length     m      l_0
""")
HISTORY = Record()
TANGENTS = 1
OUTPUT = Record("""
    force   N    tension positive
    length  m    present length
    rate    m/s  of the length
""")


def build(card: Linear, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    length = rest_length(card, scene, ends)
    return ends | {"stiffness": card.stiffness, "damping": card.damping, "length": length}


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    u, length, rate, d_a, d_b = line_of_action(p, nodes)
    out.force = spring_and_damper(p, out, length - p.length, rate)
    out.length = length
    pull(p, nodes, out.force, u, d_a, d_b, p.stiffness, p.damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    a, b, line = nodes[p.node_a], nodes[p.node_b], line_of_action(p, nodes)
    line_tangent(rows[first], a, b, line, p.stiffness, p.damping)


geometric_stiffness = add_geometric_stiffness
