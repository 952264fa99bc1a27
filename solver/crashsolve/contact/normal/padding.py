"""Padding: force over penetration by a curve, unloading on a lower one, recovers as it unloads.

    u(delta) <= f = k (delta - s) <= y(delta)     s slides at y in loading, at u in unloading
    stored = f^2 / 2k + P(s),   loss = change of G_y - change of P    (G, P: foundation/slider.py)

No force is kept and no set: the next touch meets the padding as new. A dashpot may act beside it;
the sum is never tensile. Beyond the last point of its curve the run stops, unless the curve sets
its continuation: there the padding bottoms out. Consequence to test: a stroke there and back loses
the area between both curves, less the triangles under the lines between them, in any number of
steps.

Reference: the shape of the hysteresis is that of seat and foam models of crash codes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from crashsolve.contact.normal._pressed import check_below, check_pressed
from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import Card, CurveName, quantity, word
from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.slider import line_meets, work

if TYPE_CHECKING:
    from crashsolve.contact.normal._rows.padding import History, Parameters


class Padding(Card):
    """Padding that loads on a curve, unloads on a lower one and recovers."""

    curve_axes: ClassVar = {"curve": ("m", "N"), "unloading_curve": ("m", "N")}

    curve: CurveName = word("y, force [N] over penetration [m], starting at (0, 0)")
    unloading_curve: CurveName = word("u, lower bound of the force as it falls; from (0, 0)")
    unloading_stiffness: float = quantity("N/m", "k, above every slope of both curves", gt=0)
    damping: float = quantity("N s/m", "c of the dashpot, while loaded", 0.0, ge=0)


# the loss is the work of the force in a step less the change of stored energy
LOSS_IS_WORK = True
PARAMETERS = Record("""
    curve                index  y
    unloading_curve      index  u
    unloading_stiffness  N/m    k
    damping              N s/m  c
""")
HISTORY = Record("""
    slider          m  s
    unloading_work  J  P
    recoverable     J  recoverable energy of the padding
    branch          index  LOADING, UNLOADING or BETWEEN at the end of the step
""")
# on the upper curve, on the lower one, and on the line between them
LOADING, UNLOADING, BETWEEN = 1, 2, 0


def build(card: Padding, scene: Scene, pair: Pair) -> Columns:
    upper, lower = scene.curve(card.curve), scene.curve(card.unloading_curve)
    check_pressed(upper, card.curve, card.unloading_stiffness, scene)
    check_pressed(lower, card.unloading_curve, card.unloading_stiffness, scene)
    check_below(lower, upper, card.unloading_curve, scene)
    return {
        "curve": upper,
        "unloading_curve": lower,
        "unloading_stiffness": card.unloading_stiffness,
        "damping": card.damping,
    }


@kernel
def normal_force(p: Parameters, old: History, new: History, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping. Writes: new."""
    k, s, unloading_work, loss = p.unloading_stiffness, old.slider, old.unloading_work, 0.0
    new.branch = BETWEEN
    upper, _, _ = curve_value(curves, p.curve, depth)
    lower, _, _ = curve_value(curves, p.unloading_curve, depth)
    spring = k * (depth - s)
    if spring > upper:
        new.branch = LOADING if rate > 0.0 else BETWEEN
        start = line_meets(curves, p.curve, 1.0, k, s, depth)
        begun = k * (start - s)
        spring, s = upper, depth - upper / k
        area = curve_area(curves, p.curve, depth) - curve_area(curves, p.curve, start)
        loss = area - 0.5 * (spring * spring - begun * begun) / k + unloading_work
        meets = line_meets(curves, p.unloading_curve, 1.0, k, s, depth)
        unloading_work = work(curves, p.unloading_curve, 1.0, k, meets)
        loss -= unloading_work
    elif spring < lower:
        new.branch = UNLOADING if rate < 0.0 else BETWEEN
        spring, s = lower, depth - lower / k
        unloading_work = work(curves, p.unloading_curve, 1.0, k, depth)
    new.slider, new.unloading_work = s, unloading_work
    new.recoverable = 0.5 * spring * spring / k + unloading_work
    f = max(0.0, spring + p.damping * rate) if spring > 0.0 else 0.0
    lost = max(loss, 0.0) if h > 0.0 else 0.0
    return f, new.recoverable, (f - spring) * rate, lost, k, p.damping


@kernel
def release(p: Parameters, old: History, new: History):
    """Nothing is left of the touch. Writes: new."""
    new.slider = 0.0
    new.unloading_work = 0.0
    new.recoverable = 0.0
    new.branch = BETWEEN


@kernel
def branch_left(p: Parameters, old: History, h, depth, rate, curves):
    """Distance beyond the branch on which the step began [m]: on a curve that of the reversal, by
    the displacement in h, between them that beyond either.
    """
    if old.branch == LOADING:
        return -rate * h
    if old.branch == UNLOADING:
        return rate * h
    upper, _, _ = curve_value(curves, p.curve, depth)
    lower, _, _ = curve_value(curves, p.unloading_curve, depth)
    along = depth - old.slider
    return max(along - upper / p.unloading_stiffness, lower / p.unloading_stiffness - along)


@kernel
def normal_tangent(p: Parameters, state: History, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate."""
    k = p.unloading_stiffness
    upper, rises, _ = curve_value(curves, p.curve, depth)
    lower, falls, _ = curve_value(curves, p.unloading_curve, depth)
    spring = k * (depth - state.slider)
    slope = k
    if spring >= upper * (1.0 - 1e-12) and rate > 0.0:
        spring, slope = upper, rises
    elif spring <= lower * (1.0 + 1e-12) and rate < 0.0:
        spring, slope = lower, falls
    if spring <= 0.0 or spring + p.damping * rate <= 0.0:
        return 0.0, 0.0
    return slope, p.damping
