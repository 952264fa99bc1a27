"""Spring between two points whose force follows a curve, with separate loading and unloading.

    F = f(l - l_0),   tension positive, with f and its unloading as in springs._resistance

Consequence to test: with `unloading_stiffness` k the length after a stroke x keeps the set
x - f(x) / k, and the spring has absorbed int f dx, of which f^2 / 2k returns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import line_tangent, pull
from crashsolve.foundation.record import Record
from crashsolve.springs import _resistance
from crashsolve.springs._between import POINTS, line_of_action, rest_length
from crashsolve.springs._card import PointSpringCard, ResistanceCard
from crashsolve.springs._geometric_stiffness import add_geometric_stiffness

if TYPE_CHECKING:
    from crashsolve.springs._rows.curve import History, Output, Parameters


class Curve(PointSpringCard, ResistanceCard):
    """Spring between two points whose force follows a curve, unloading on it or on another path."""

    curve_axes: ClassVar = {
        "curve": ("m", "N"),
        "unloading_curve": ("m", "N"),
        "rate_curve": ("m/s", "1"),
    }

    length: float | None = quantity(
        "m", "length without deformation; that at the start when absent", default=None, ge=0
    )
    unloading_stiffness: float | None = quantity(
        "N/m",
        "slope on which the force falls and grows again; leaves a permanent set",
        default=None,
        gt=0,
    )
    acts: Literal["both", "tension", "compression"] = word(
        "directions of deformation that are resisted", default="both"
    )
    gap: float = quantity("m", "free play in each direction", default=0.0, ge=0)
    damping: float = quantity("N s/m", "force over rate", default=0.0, ge=0)


PARAMETERS = POINTS + _resistance.RESISTANCE + Record("length  m  l_0")
HISTORY = _resistance.SLIDER
TANGENTS = 1
OUTPUT = Record("""
    force       N    tension positive
    length      m    present length
    elongation  m    present length less that without deformation
    rate        m/s  of the length
    set         m    permanent elongation, the larger of both directions
""")


def build(card: Curve, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    return ends | _resistance.resistance(card, scene) | {"length": rest_length(card, scene, ends)}


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    u, length, rate, d_a, d_b = line_of_action(p, nodes)
    x = length - p.length
    tension, stiffness, damping = _resistance.resistance_force(p, old, new, out, h, x, rate, curves)
    out.force = tension
    out.length = length
    out.elongation = x
    out.rate = rate
    out.set = new.set[0] if new.set[0] >= new.set[1] else -new.set[1]
    pull(p, nodes, tension, u, d_a, d_b, stiffness, damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    line = line_of_action(p, nodes)
    x, rate = line.length - p.length, line.rate
    stiffness, damping = _resistance.resistance_tangent(p, state, x, rate, curves)
    line_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], line, stiffness, damping)


geometric_stiffness = add_geometric_stiffness


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the branch of the law on which the step began [m]."""
    _, length, rate, _, _ = line_of_action(p, nodes)
    return _resistance.branch_event(p, old, h, length - p.length, rate, curves)
