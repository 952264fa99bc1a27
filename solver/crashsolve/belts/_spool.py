"""Retractor: the spool at the start of a belt; it pulls, locks, is wound in, and pays out.

    free      T_0 = the pull of its spring, in and out
    wound in  T_0 >= P(s) where webbing goes in, s the length wound in; never out
    locked    T_0 <= R(w) where webbing goes out, w the length paid out since; never in
    empty     the last of its webbing goes out in the step, or none is left

q_0 is an unknown of the step beside the flows through rings. From T_0 to T_1 of the first segment
the spool takes up (T_0 + T_1) / 2 q_0 + T_0 T_1 q_0 / 2k: heat of a limiter where webbing goes out,
work of spring and pretensioner where it goes in.
"""

from math import sqrt
from typing import ClassVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, CurveName, Vec3, quantity, word
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import put, sub, vec
from crashsolve.springs._resistance import read

NONE, FREE, PULLING, LOCKED, EMPTY = range(5)


class Pretensioner(Card):
    """Pretensioner: winds webbing in from a given time on."""

    curve_axes: ClassVar = {"curve": ("m", "N")}

    time: float = quantity("s", "time at which it fires", ge=0)
    curve: CurveName = word("force over the webbing wound in; it stops at the end of the curve")
    duration: float = quantity("s", "duration of winding", default=0.02, gt=0)


class Retractor(Card):
    """Spool that holds the beginning of the belt."""

    curve_axes: ClassVar = {"limiter": ("m", "N")}

    body: BodyName = word("body that it is fixed to", default="ground")
    at: Vec3 = quantity("m", "where the webbing leaves it, in its frame", default=(0.0, 0.0, 0.0))
    pull: float = quantity("N", "force of its spring while it is not locked", default=5.0, gt=0)
    lock_time: float | None = quantity("s", "time at which it locks", None, ge=0)
    lock_acceleration: float | None = quantity(
        "m/s^2", "acceleration of its body's mass centre at which it locks", None, gt=0
    )
    lock_rate: float | None = quantity(
        "m/s", "speed of the webbing drawn out at which it locks", None, gt=0
    )
    limiter: CurveName | None = word(
        "load limiter: force over the webbing drawn out after locking; when absent none is drawn",
        default=None,
    )
    pretensioner: Pretensioner | None = word("winds webbing in, then locks", default=None)
    reserve: float = quantity("m", "webbing on the spool at the start", default=1.0, ge=0)

    @model_validator(mode="after")
    def _locks(self) -> "Retractor":
        known = (self.lock_time, self.lock_acceleration, self.lock_rate, self.pretensioner)
        if all(x is None for x in known):
            raise ValueError(
                "needs one of lock_time, lock_acceleration, lock_rate and pretensioner, or it "
                "never locks"
            )
        return self


SPOOL = Record("""
    spool              flag   whether the belt begins on one
    pull               N      of its spring
    lock_time          s      infinite for none
    lock_acceleration  m/s^2  infinite for none
    lock_rate          m/s    infinite for none
    limiter            index  R; 0 for none
    fires              s      time of the pretensioner; infinite for none
    pretensioner       index  P
    winds              s      how long
    reserve            m      webbing on it at the start
""")
SPOOL_HISTORY = Record("""
    locked    flag     whether it is
    mode      flag     NONE, FREE, PULLING, LOCKED or EMPTY in the step
    wound_in  m        s
    paid_out  m        w, since it is locked
    absorbed  J        energy taken by the spool
    speed     m/s   3  of its body
    steps     count    of the run, up to 2: with the second there is an acceleration
    early     flag     it locked by the first acceleration, or by the webbing of the first steps
    emptied   flag     it has run out of webbing
""")


def spool_columns(card: Retractor | None, scene: Scene) -> Columns:
    """Columns of SPOOL; of none for a belt between anchors."""
    never = float("inf")
    own = card or Retractor(lock_time=0.0)
    fired = own.pretensioner
    return {
        "spool": card is not None,
        "pull": own.pull,
        "lock_time": never if own.lock_time is None else own.lock_time,
        "lock_acceleration": own.lock_acceleration or never,
        "lock_rate": own.lock_rate or never,
        "limiter": _force_curve(own.limiter, "limiter", scene) if own.limiter else 0,
        "fires": fired.time if fired else never,
        "pretensioner": _force_curve(fired.curve, "pretensioner.curve", scene) if fired else 0,
        "winds": fired.duration if fired else 0.0,
        "reserve": own.reserve,
    }


def _force_curve(name: str, field: str, scene: Scene) -> int:
    """A curve of a force over a length from 0."""
    first = int(scene.curve(name))
    part = scene.curve_points[first : scene.curve_points[first]["last"] + 1]
    force = read(scene.curve_points, first, np.linspace(0.0, part["x"][-1], 1001))
    if part["x"][0] != 0.0 or (force < 0.0).any():
        raise scene.fail(
            "must begin at 0 and be a force, not below zero", f"route.0.retractor.{field}"
        )
    return first


@kernel
def choose_mode(p, old, new, t):
    """Choose the mode of the spool for this step. Writes: new."""
    new.mode, new.locked = NONE, old.locked
    if p.spool == 0:
        return
    if t >= p.lock_time or t > p.fires + p.winds:
        new.locked = 1
    if t >= p.fires and t <= p.fires + p.winds:
        new.mode = PULLING
    else:
        new.mode = LOCKED if new.locked == 1 else FREE


@kernel
def clamped(curves, k, x):
    """Value and slope of a curve, held beyond its ends; nothing is noted."""
    at = min(max(x, 0.0), curves[curves[k].last].x)
    y, slope, _ = curve_value(curves, k, at)
    return y, (slope if at == x else 0.0)


@kernel
def spool_force(p, old, mode, q, curves):
    """Force [N] on whose edge webbing q leaves the spool, and its slope over q; below 0: none."""
    if mode == FREE:
        return p.pull, 0.0
    if mode == PULLING:
        s = old.wound_in - q
        if s > curves[curves[p.pretensioner].last].x:
            return 0.0, 0.0
        P, slope = clamped(curves, p.pretensioner, s)
        return P, -slope
    if p.limiter == 0:
        return 1e300, 0.0
    return clamped(curves, p.limiter, old.paid_out + q)


@kernel
def spool_direction(new, out, F):
    """Direction of the flow at the spool, whose locking edge bears the force F."""
    T, q = out.force[0], new.flow[0]
    if new.mode == FREE:
        return 2
    if new.mode == EMPTY:
        return 0
    if new.mode == PULLING:
        return -1 if q < 0.0 or T < F else 0
    return 1 if q > 0.0 or (new.mode == LOCKED and T > F) else 0


@kernel
def stroke_left(p, old, curves):
    """Webbing that the pretensioner may yet wind in: to the end of its curve [m]."""
    return max(0.0, curves[curves[p.pretensioner].last].x - old.wound_in)


@kernel
def webbing_left(p, old):
    """Webbing that is left on the spool [m]."""
    return max(0.0, p.reserve - old.slip[0])


@kernel
def update_spool(p, old, new, nodes, q, h, curves):
    """Update the history of the spool by a step with the flow q. Writes: new, curves."""
    new.wound_in = old.wound_in + max(-q, 0.0) if new.mode == PULLING else old.wound_in
    pays_out = new.mode == LOCKED or (new.mode == EMPTY and old.locked == 1)
    new.paid_out = old.paid_out + max(q, 0.0) if pays_out else old.paid_out
    if pays_out and p.limiter > 0:
        last = curves[curves[p.limiter].last].x
        if new.paid_out > last:
            curve_value(curves, p.limiter, new.paid_out)
    body, new.steps, new.emptied = nodes[p.node[0]], old.steps, old.emptied
    new.early = old.early
    put(new.speed, vec(old.speed))
    if p.spool == 0:
        return
    put(new.speed, vec(body.v))
    if h > 0.0:
        new.steps = min(old.steps + 1, 2)
        a = sub(vec(body.v), vec(old.speed))
        size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
        if q > p.lock_rate * h or (old.steps > 0 and size > p.lock_acceleration * h):
            new.early = 1 if old.steps < 2 and new.locked == 0 else old.early
            new.locked = 1
        if new.mode == EMPTY:
            new.emptied = new.locked = 1
