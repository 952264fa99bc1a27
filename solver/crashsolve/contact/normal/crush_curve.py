"""Crushable end: force over penetration by a curve, elastic unloading, permanent set.

    f = F(delta)                              while delta is the deepest so far, delta = d
    f = max(0, F(d) - k (d - delta))          below d, unloading and reloading
    stored = f^2 / (2 k),   lost so far = area of F to d - F(d)^2 / (2 k)

The loss is a function of d alone, so it does not depend on the step. Where a method knows the work
that its forces do over a step (LOSS_IS_WORK), the loss is the work done on them less the stored
energy: a step that passes a corner of the curve takes another area than that under it. A dashpot
may act beside it while the end is loaded; the sum is never tensile. Consequence to test: pushed to
d and after release the end keeps the set d - F(d)/k and has taken the area under the curve less the
triangle F(d)^2/(2 k).

References: Ambrosio (2003), 5.1, crushable ends of trains; how they unload is left open there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from crashsolve.contact.normal._pressed import check_pressed
from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import Card, CurveName, quantity, word
from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.contact.normal._rows.crush_curve import History, Parameters


class CrushCurve(Card):
    """Crushable end: force over penetration by a curve, elastic unloading, permanent set."""

    curve_axes: ClassVar = {"curve": ("m", "N")}

    curve: CurveName = word("force [N] over penetration [m], starting at (0, 0)")
    unloading_stiffness: float = quantity("N/m", "k, not below any slope of the curve", gt=0)
    damping: float = quantity("N s/m", "c of the dashpot, while loaded", 0.0, ge=0)


# the loss is the work of the force in a step less the change of stored energy
LOSS_IS_WORK = True
PARAMETERS = Record("""
    curve                index  force over penetration
    unloading_stiffness  N/m    k
    damping              N s/m  c
""")
HISTORY = Record("""
    crush        m  deepest loading so far, d
    recoverable  J  recoverable energy of the end
    is_loading   flag  whether it was being crushed at the end of the step
""")


def build(card: CrushCurve, scene: Scene, pair: Pair) -> Columns:
    curve = scene.curve(card.curve)
    check_pressed(curve, card.curve, card.unloading_stiffness, scene)
    return {
        "curve": curve,
        "unloading_stiffness": card.unloading_stiffness,
        "damping": card.damping,
    }


@kernel
def normal_force(p: Parameters, old: History, new: History, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping. Writes: new."""
    k = p.unloading_stiffness
    new.crush = max(old.crush, depth)
    peak, _, _ = curve_value(curves, p.curve, new.crush)
    spring = max(0.0, peak - k * (new.crush - depth))
    loss = 0.0
    # an end that is crushed when the run begins has lost nothing in it
    if h > 0.0 and new.crush > old.crush:
        loss = lost(p, new.crush, curves) - lost(p, old.crush, curves)
    f = max(0.0, spring + p.damping * rate) if spring > 0.0 else 0.0
    new.recoverable = 0.5 * spring * spring / k
    new.is_loading = 1 if depth >= new.crush and rate > 0.0 else 0
    return f, new.recoverable, (f - spring) * rate, loss, k, p.damping


@kernel
def lost(p: Parameters, crush, curves):
    """Energy that an end crushed to this depth will not give back [J]."""
    peak, _, _ = curve_value(curves, p.curve, crush)
    return curve_area(curves, p.curve, crush) - 0.5 * peak * peak / p.unloading_stiffness


@kernel
def release(p: Parameters, old: History, new: History):
    """The end stays crushed. Writes: new."""
    new.crush = old.crush
    new.recoverable = 0.0
    new.is_loading = 0


@kernel
def branch_left(p: Parameters, old: History, h, depth, rate, curves):
    """Distance beyond the branch on which the step began [m]: of crush the reversal, by the
    displacement in h, else the deepest loading so far or the end of the force.
    """
    if old.is_loading == 1:
        return -rate * h
    peak, _, _ = curve_value(curves, p.curve, old.crush)
    free = old.crush - peak / p.unloading_stiffness
    if old.recoverable > 0.0:
        return max(depth - old.crush, free - depth)
    return depth - free


@kernel
def normal_tangent(p: Parameters, state: History, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate."""
    k = p.unloading_stiffness
    peak, slope, _ = curve_value(curves, p.curve, state.crush)
    spring = peak - k * (state.crush - depth)
    if spring <= 0.0 or spring + p.damping * rate <= 0.0:
        return 0.0, 0.0
    grows = depth >= state.crush and rate > 0.0
    return slope if grows else k, p.damping
