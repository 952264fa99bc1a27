"""Moment of a stop that sets in smoothly, common to cone and twist stops.

    m(e) = k e^2 / (2 d)  for 0 < e < d,   k (e - d / 2) beyond,   or m(e) on a curve
    M = max(m + c w(e / d) e_dot, 0),   w(x) = x^2 (3 - 2 x), 1 beyond

e is the angle past the limit and d the transition over which stiffness and damping grow from
nothing. m and its slope are continuous, and c acts past the limit alone.
"""

from typing import ClassVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, JointName, quantity, word
from crashsolve.foundation.curve import LINEAR
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.springs._resistance import (
    RESISTANCE,
    SLACK,
    SLIDER,
    branch_event,
    resistance,
    resistance_force,
    resistance_tangent,
)

# without a curve: on the parabola, and on the straight line
TRANSITION, STRAIGHT = 1, 2
# a limit that is passed by less at the start is met exactly, but for round-off [rad]
AT_LIMIT = 1e-9
# of the largest value of a curve, next to its zeros
ROUND_OFF = 1e-12
# beyond this angle neither an azimuth nor a twist is defined well [rad]
LARGEST = 2.9

MOMENT = RESISTANCE + Record("""
    stop_stiffness  N m/rad    k; not used with a curve
    transition      rad        d
    stop_damping    N m s/rad  c
""")
REACHED = SLIDER


class RangeCard(Card):
    """A joint, and the moment past the end of its range."""

    # features of a spring's curve that a stop does not have
    gap: ClassVar[float] = 0.0
    rate_curve: ClassVar[None] = None
    cowper_symonds: ClassVar[None] = None
    power_law: ClassVar[None] = None
    curve_axes: ClassVar = {"curve": ("rad", "N m"), "unloading_curve": ("rad", "N m")}

    joint: JointName = word("joint whose range this is")
    stiffness: float | None = quantity(
        "N m/rad", "k, reached at the end of the transition", default=None, gt=0
    )
    transition: float = quantity(
        "rad", "d, angle past the limit over which stiffness and damping grow", default=0.2, gt=0
    )
    curve: CurveName | None = word(
        "moment over the angle past the limit, from 0; instead of stiffness", default=None
    )
    unloading_stiffness: float | None = quantity(
        "N m/rad", "slope of the moment when the angle falls; with a curve", default=None, gt=0
    )
    unloading_curve: CurveName | None = word(
        "lower bound of the moment when the angle falls; needs unloading_stiffness", default=None
    )
    damping: float = quantity("N m s/rad", "c, past the limit", default=0.0, ge=0)

    @model_validator(mode="after")
    def _check_moment(self) -> "RangeCard":
        if (self.curve is None) == (self.stiffness is None):
            raise ValueError("needs one of stiffness and curve")
        if self.curve is None and (self.unloading_stiffness or self.unloading_curve):
            raise ValueError("unloading needs a curve")
        if self.unloading_curve and self.unloading_stiffness is None:
            raise ValueError("unloading_curve: needs unloading_stiffness, the slope down to it")
        return self


class _Curve:
    """A card as the law of resistance reads it: without damping of its own."""

    damping = 0.0

    def __init__(self, card: RangeCard, acts: str) -> None:
        self._card, self.acts = card, acts

    def __getattr__(self, name: str) -> object:
        return getattr(self._card, name)


def moment_columns(card: RangeCard, scene: Scene, acts: str) -> Columns:
    """Columns of MOMENT; `acts` is positive where the angle past the limit has one sign."""
    if card.curve:
        start = scene.curve_points[scene.curve(card.curve)]["x"]
        if acts == "positive" and start != 0.0:
            raise scene.fail("must begin at 0, where the limit is met", "curve")
        if acts == "both" and start >= 0.0:
            message = "must begin below 0: past the lower end the angle and the moment are negative"
            raise scene.fail(message, "curve")
        check_pushes_back(scene, scene.curve(card.curve))
        columns = resistance(_Curve(card, acts), scene)
    else:
        columns = {column.name: 0 for column in RESISTANCE.columns} | {
            "largest_slope": card.stiffness
        }
    return columns | {
        "stop_stiffness": card.stiffness or 0.0,
        "transition": card.transition,
        "stop_damping": card.damping,
    }


def check_pushes_back(scene: Scene, curve: int) -> None:
    """Refuse a curve over the angle or travel past a limit that leads away from the limit.

    A stop cannot: its moment would be cut to 0 and the energy of the curve would not be its work.
    """
    points = scene.curve_points[curve : scene.curve_points[curve]["last"] + 1]
    s = np.diff(points["x"])[:, None] * np.linspace(0.0, 1.0, 33)
    c0, c1, c2, c3 = points["c"][:-1].T[:, :, None]
    x, y = points["x"][:-1, None] + s, c0 + s * (c1 + s * (c2 + s * c3))
    if (np.sign(x) * y).min() < -ROUND_OFF * np.abs(y).max():
        raise scene.fail("must not change sign: past a limit it can only push back", "curve")
    slopes = (c1 + s * (2.0 * c2 + 3.0 * s * c3))[[0, -1], [0, -1]]
    ends = [(x[0, 0], slopes[0]), (x[-1, -1], slopes[1])]
    if points["beyond"][0] == LINEAR and any(at != 0.0 and slope < 0.0 for at, slope in ends):
        message = "falls beyond its end, where it would change sign; set extrapolate: hold"
        raise scene.fail(message, "curve")


@kernel
def range_moment(p, old, new, out, h, past, rate, curves):
    """Moment [N m] against an angle past the limit, of its sign; 0 for 0. Writes: new, out."""
    side = 1.0 if past >= 0.0 else -1.0
    e = side * past
    if p.curve > 0:
        elastic = side * resistance_force(p, old, new, out, h, past, rate, curves)[0]
    else:
        elastic = smooth_stop(p, new, out, e)
    share = damping_share(e / p.transition)
    total = max(elastic + p.stop_damping * share * side * rate, 0.0) if e > 0.0 else 0.0
    out.power = (total - elastic) * side * rate
    return side * total


@kernel
def smooth_stop(p, new, out, e):
    """m(e) [N m], e >= 0. Writes: new, out.stored, loss."""
    for j in range(2):
        new.set[j] = new.unloading_work[j] = 0.0
    new.side, new.segment = 1, 0
    new.branch = SLACK if e == 0.0 else (TRANSITION if e < p.transition else STRAIGHT)
    out.loss = 0.0
    k, d = p.stop_stiffness, p.transition
    if e < d:
        out.stored = k * e * e * e / (6.0 * d)
        return 0.5 * k * e * e / d
    out.stored = k * (0.5 * e * (e - d) + d * d / 6.0)
    return k * (e - 0.5 * d)


@kernel
def damping_share(x):
    """w(x)."""
    return x * x * (3.0 - 2.0 * x) if x < 1.0 else 1.0


@kernel
def range_tangent(p, state, past, rate, curves):
    """Rise of the moment over the angle [N m/rad] and over its rate."""
    side = 1.0 if past >= 0.0 else -1.0
    e, x = side * past, side * past / p.transition
    if e <= 0.0:
        return 0.0, 0.0
    if p.curve > 0:
        slope = resistance_tangent(p, state, past, rate, curves)[0]
    else:
        slope = p.stop_stiffness * min(x, 1.0)
    steeper = 6.0 * x * (1.0 - x) / p.transition if x < 1.0 else 0.0
    return slope + p.stop_damping * steeper * side * rate, p.stop_damping * damping_share(x)


@kernel
def range_event(p, old, h, past, rate, curves):
    """Angle beyond the branch of the moment on which the step began [rad].

    `past` is below zero within the range.
    """
    if old.branch == SLACK:
        return past
    if p.curve > 0:
        return branch_event(p, old, h, past * old.side, rate * old.side, curves)
    if old.branch == TRANSITION:
        return max(-past, past - p.transition)
    return p.transition - past
