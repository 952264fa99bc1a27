"""Elastoplastic spring between two points, with linear hardening.

    F = k (x - x_p),   |F - beta| <= F_y + H_i alpha,   alpha_dot = |x_p_dot|,   beta = H_k x_p

x is the elongation. With the tangent k_t after yield, H = k k_t / (k - k_t) is either isotropic
(H_i) or kinematic (H_k). The return to the yield limit is exact for any step, and so is the energy:
stored (k (x - x_p)^2 + H_k x_p^2) / 2, lost F_y alpha + H_i alpha^2 / 2.

Consequence to test: with k_t = 0 a mass m at v_0 stops after m v_0^2 / 2 F_y + F_y / 2k.

Reference: Simo and Hughes (1998), Computational Inelasticity, 1.2 to 1.6.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import line_tangent, pull
from crashsolve.foundation.record import Record
from crashsolve.springs._between import POINTS, line_of_action, rest_length
from crashsolve.springs._card import PointSpringCard
from crashsolve.springs._geometric_stiffness import add_geometric_stiffness

if TYPE_CHECKING:
    from crashsolve.springs._rows.elastoplastic import History, Output, Parameters


class Elastoplastic(PointSpringCard):
    """Spring between two points that yields in tension and compression, with linear hardening."""

    stiffness: float = quantity("N/m", "slope of force over elongation before yield", gt=0)
    yield_force: float = quantity("N", "force at first yield", gt=0)
    tangent: float = quantity("N/m", "slope after yield; below stiffness", default=0.0, ge=0)
    hardening: Literal["isotropic", "kinematic"] = word(
        "isotropic: the yield force grows in both directions; kinematic: the elastic range moves",
        default="isotropic",
    )
    length: float | None = quantity(
        "m", "length without force; that at the start when absent", default=None, ge=0
    )


PARAMETERS = POINTS + Record("""
    stiffness    N/m  k
    yield_force  N    F_y
    isotropic    N/m  H_i
    kinematic    N/m  H_k
    length       m    l_0
""")
HISTORY = Record("""
    plastic       m     x_p
    flow          m     alpha
    plastic_flow  flag  1 or -1: x_p grows or falls; 0: it rests
""")
TANGENTS = 1
OUTPUT = Record("""
    force       N    tension positive
    length      m    present length
    elongation  m    present length less that without force at the start
    rate        m/s  of the length
    set         m    plastic elongation
    flow        m    sum of plastic elongations in both directions
""")


def build(card: Elastoplastic, scene: Scene) -> Columns:
    k, tangent = card.stiffness, card.tangent
    if tangent >= k:
        raise scene.fail(f"must be below stiffness, {k:g} N/m", "tangent")
    modulus = k * tangent / (k - tangent)
    ends = scene.attachments(card)
    return ends | {
        "stiffness": k,
        "yield_force": card.yield_force,
        "isotropic": modulus if card.hardening == "isotropic" else 0.0,
        "kinematic": modulus if card.hardening == "kinematic" else 0.0,
        "length": rest_length(card, scene, ends),
    }


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    u, length, rate, d_a, d_b = line_of_action(p, nodes)
    x = length - p.length
    trial = p.stiffness * (x - old.plastic) - p.kinematic * old.plastic
    excess = abs(trial) - p.yield_force - p.isotropic * old.flow
    flow = max(excess, 0.0) / (p.stiffness + p.isotropic + p.kinematic)
    new.plastic = old.plastic + (flow if trial > 0.0 else -flow)
    new.flow = old.flow + flow
    new.plastic_flow = 0
    if flow > 0.0 and trial * rate > 0.0:
        new.plastic_flow = 1 if trial > 0.0 else -1
    out.force = p.stiffness * (x - new.plastic)
    out.length = length
    out.elongation = x
    out.rate = rate
    out.set = new.plastic
    out.flow = new.flow
    recoverable = p.stiffness * (x - new.plastic) ** 2 + p.kinematic * new.plastic**2
    out.stored = 0.5 * recoverable
    out.power = 0.0
    lost = flow * (p.yield_force + p.isotropic * (old.flow + 0.5 * flow))
    # a state without a step has no history to lose energy in
    out.loss = lost if h > 0.0 else 0.0
    pull(p, nodes, out.force, u, d_a, d_b, p.stiffness, 0.0)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    line = line_of_action(p, nodes)
    x, hardening = line.length - p.length, p.isotropic + p.kinematic
    trial = p.stiffness * (x - state.plastic) - p.kinematic * state.plastic
    stiffness = p.stiffness
    # at yield but for round-off, and not in unloading
    at_yield = p.yield_force + p.isotropic * state.flow
    if abs(trial) >= (1.0 - 1e-12) * at_yield and trial * line.rate > 0.0:
        stiffness *= hardening / (p.stiffness + hardening)
    line_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], line, stiffness, 0.0)


geometric_stiffness = add_geometric_stiffness


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond yield, or beyond the reversal of the motion while it flows [m]."""
    _, length, rate, _, _ = line_of_action(p, nodes)
    if old.plastic_flow != 0:
        return -old.plastic_flow * rate * h
    trial = p.stiffness * (length - p.length - old.plastic) - p.kinematic * old.plastic
    return (abs(trial) - p.yield_force - p.isotropic * old.flow) / p.stiffness
