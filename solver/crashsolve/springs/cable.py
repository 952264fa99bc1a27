"""Cable through guides of several bodies, without friction: it pulls only.

    T = max(0, k x + c x_dot)   for x = l - l_0 > 0,   else 0

l is the length of the whole line from the first point through all guides to the last one, so that
one tension acts in all of it. Consequence to test: a hoist of n falls lifts n times the pull; three
bodies on one cable keep their momentum, and vibrate with omega^2 = k sum_j s_j . s_j / m_j.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.springs._several import (
    POINTS,
    Guide,
    length_and_rate,
    points_of,
    pull_along,
    start_length,
    tangent_along,
)

if TYPE_CHECKING:
    from crashsolve.springs._rows.cable import History, Output, Parameters


class Cable(Card):
    """Cable through points of two to eight bodies, without friction."""

    through: tuple[Guide, ...] = word("first end of the cable, its guides in order, its last end")
    stiffness: float = quantity("N/m", "slope of tension over elongation", gt=0)
    damping: float = quantity("N s/m", "tension over rate, while it is taut", default=0.0, ge=0)
    length: float | None = quantity(
        "m", "length without tension; that at the start when absent", default=None, gt=0
    )


PARAMETERS = POINTS + Record("""
    stiffness  N/m    k
    damping    N s/m  c
    length     m      l_0
""")
HISTORY = Record("taut  flag  whether it is longer than without tension")
TANGENTS = 1
OUTPUT = Record("""
    force       N    tension
    length      m    present length
    elongation  m    present length less that without tension; negative: slack
    rate        m/s  of the length
""")


def build(card: Cable, scene: Scene) -> Columns:
    columns = points_of(card.through, "through", scene)
    length = start_length(columns, scene) if card.length is None else card.length
    own = {"stiffness": card.stiffness, "damping": card.damping, "length": length}
    return columns | own


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    length, rate = length_and_rate(p, nodes)
    x = length - p.length
    new.taut = 1 if x > 0.0 else 0
    taut = max(x, 0.0)
    tension = max(p.stiffness * x + p.damping * rate, 0.0) if x > 0.0 else 0.0
    out.force, out.length, out.elongation, out.rate = tension, length, x, rate
    out.stored = 0.5 * p.stiffness * taut * taut
    out.power = (tension - p.stiffness * taut) * rate
    out.loss = 0.0
    pull_along(p, nodes, tension, p.stiffness, p.damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    length, rate = length_and_rate(p, nodes)
    x = length - p.length
    acts = 1.0 if x > 0.0 and p.stiffness * x + p.damping * rate > 0.0 else 0.0
    tangent_along(p, nodes, rows, first, acts * p.stiffness, acts * p.damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the length at which it becomes taut or slack [m]."""
    length, _ = length_and_rate(p, nodes)
    x = length - p.length
    return -x if old.taut == 1 else x
