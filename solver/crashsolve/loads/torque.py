"""Torque on a body, constant or by a curve of time.

    tau = T phi(t)  in world axes,  or  tau = A T phi(t)  in body axes;   power tau . w

Consequence to test: a disc of inertia J under constant T about its axis turns by T t^2 / 2J.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_external
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, put, vec
from crashsolve.loads._on_body import BODY_LOAD, BodyLoadCard, body_load, present_load

if TYPE_CHECKING:
    from crashsolve.loads._rows.torque import History, Output, Parameters


class Torque(BodyLoadCard):
    """Torque on a body, constant or by a curve of time."""

    torque: Vec3 = quantity("N m", "vector of the torque; times curve")


CURVES_OF_TIME = ("curve",)
PARAMETERS = BODY_LOAD
AMPLITUDE = "vector"
HISTORY = Record()
OUTPUT = Record("torque  N m  3  world axes")


def build(card: Torque, scene: Scene) -> Columns:
    return body_load(card, card.torque, scene)


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    torque = present_load(p, t, nodes, curves)
    zero = (0.0, 0.0, 0.0)
    apply_external(nodes, p.node, zero, zero, torque)
    put(out.torque, torque)
    out.stored = 0.0
    out.power = dot(torque, vec(nodes[p.node].w))
    out.loss = 0.0


@kernel
def present(p: Parameters, out: Output, A):
    """Present force, its arm in a body rotated by A, and torque; world axes."""
    return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), vec(out.torque)
