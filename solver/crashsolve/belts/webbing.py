"""Webbing through rings: spans between points of bodies, and what flows from one to the next.

    T = max(0, min(f(e), k_u (e - e_p))),   e = d / L - 1
    ring:    T_1 <= T_2 exp(mu beta),   T_2 <= T_1 exp(mu beta)
    flow m:  L_1 + m, L_2 - m   until this holds

d is the length of a span, L that of the webbing in it, f the webbing's force over strain, e_p the
strain left without force when it unloads by k_u (without k_u it unloads as it came), beta the
angle by which the belt turns in the ring. What flows is found at the end of every step, not from
the one before, so that every state of a run satisfies the law of every ring. A span that is slack
has no tension, and takes what is pulled out of it. The energy in a span is L w(e); webbing that
flows in at the tension T brings G = T (1 + e) - w for its length, so that a ring loses
(G_1 - G_2) m. What a pretensioner does is a negative loss. Consequence to test: T_1 / T_2 =
exp(mu beta) while it slips; lengths of webbing less pay-out are what they were; a mass on a belt
swings as on a spring.

References: Euler (1769), Remarques sur l'effet du frottement dans l'equilibre, Memoires de
l'academie des sciences de Berlin 18, 265-278 (rope and drum).
"""

from math import acos, exp
from typing import Any, ClassVar

import numpy as np

from crashsolve.belts._card import MOST, Retractor, RoutePoint
from crashsolve.deck.card import Card, CurveName, quantity, word
from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_force,
    arm,
    mobility,
    relative,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, norm, scale
from crashsolve.springs._resistance import steepest

STEPWISE = True
SPANS = MOST - 1
# share of the largest tension to which rings are closed, and sweeps over them
CLOSED, SWEEPS, TRIES = 1e-10, 400, 60


class Webbing(Card):
    """Belt of webbing from anchor to anchor, through rings, out of a retractor or not."""

    curve_axes: ClassVar = {"force": ("1", "N")}

    force: CurveName = word("f, tension over strain, from 0")
    unloading_stiffness: float | None = quantity(
        "N", "k_u, tension over strain on unloading; as it came when absent", default=None, gt=0
    )
    slack: float = quantity("m", "webbing beyond the length of the route at the start", 0.0, ge=0)
    route: tuple[RoutePoint, ...] = word("points from one end to the other; both ends are fixed")
    retractor: Retractor | None = word("at the first point; none when absent", default=None)


PARAMETERS = Record(f"""
    points      count          of the route
    node        index  {MOST}  body of each
    point       m      {3 * MOST}  each from the mass centre of its body, body axes
    mu          1      {MOST}  friction of the rings
    length      m      {SPANS}  L at the start
    force       index          f
    unloading   N              k_u; 0 where it unloads as it came
    stiffest    N              largest slope of T
    pull        N              of a retractor; 0 for an anchor
    lock_time   s              infinite for none
    lock_speed  m/s            infinite for none
    limit       index          curve of the load limiter; 0 for none
    tightener   index          curve of the pretensioner; 0 for none
    fire_time   s              infinite for none
""")
HISTORY = Record(f"""
    begun      flag         whether the rest is known
    length     m   {SPANS}  L
    set        1   {SPANS}  e_p
    tension    N   {SPANS}  T
    drive      N   {SPANS}  G
    pay_out    m            webbing that has left the retractor
    pulled     m            what the pretensioner has pulled in
    locked     flag         whether the retractor is locked
    paid       m            pay-out since then
    spring     J            energy of the retractor's spring
""")
OUTPUT = Record(f"""
    force    N    {SPANS}  tension of each span
    length   m    {SPANS}  of each span
    webbing  m    {SPANS}  L of each span
    slip     m    {SPANS}  webbing that each span has gained since the start
    angle    rad  {SPANS}  by which the belt turns in the ring at the end of each span
    pay_out  m             webbing that has left the retractor
    locked   1             whether the retractor is locked
""")


def build(card: Webbing, scene: Any) -> dict[str, Any]:
    count = len(card.route)
    if not 2 <= count <= MOST:
        raise scene.fail(f"needs 2 to {MOST} points, not {count}", "route")
    for k, point in enumerate(card.route):
        is_end = k in (0, count - 1)
        if is_end and point.ring is not None:
            message = "there is no webbing beyond it; an end is fixed, without `ring`"
            raise scene.fail(message, f"route.{k}.ring")
        if not is_end and point.ring is None:
            message = "is fixed within the route: end the belt here, or give `ring`"
            raise scene.fail(message, f"route.{k}")
    nodes = [scene.node(point.body) for point in card.route]
    points = [scene.from_mass_centre(n, p.at) for n, p in zip(nodes, card.route, strict=True)]
    if len(set(nodes)) == 1:
        raise scene.fail("all points are on one body, which such a belt does not move", "route")
    x = [scene.r[n] + scene.matrix(n) @ p for n, p in zip(nodes, points, strict=True)]
    spans = np.linalg.norm(np.diff(x, axis=0), axis=1)
    for k, span in enumerate(spans):
        if span <= 1e-6 * spans.sum():
            message = "lies where the point before it does: a span has a length"
            raise scene.fail(message, f"route.{k + 1}")
    force = _from_zero(card.force, "force", scene)
    slope = steepest(scene.curve_points, force)
    unloading = card.unloading_stiffness or 0.0
    if unloading and unloading < slope * (1.0 - 1e-9):
        raise scene.fail(
            f"is below the largest slope of its force, {slope:.6g} N: it would unload with more "
            "than it was given",
            "unloading_stiffness",
        )
    padded = (*card.route, *[card.route[-1]] * (MOST - count))
    return {
        "points": count,
        "node": [*nodes, *[0] * (MOST - count)],
        "point": np.concatenate([*points, *[np.zeros(3)] * (MOST - count)]),
        "mu": [point.ring or 0.0 for point in padded],
        "length": np.append(spans * (1.0 + card.slack / spans.sum()), np.ones(MOST - count)),
        "force": force,
        "unloading": unloading,
        "stiffest": max(slope, unloading),
        **_of_retractor(card.retractor, scene),
    }


def _of_retractor(card: Retractor | None, scene: Any) -> dict[str, Any]:
    never = float("inf")
    if card is None:
        names = ("lock_time", "lock_speed", "fire_time")
        return dict.fromkeys(names, never) | {"pull": 0.0, "limit": 0, "tightener": 0}
    return {
        "pull": card.pull,
        "lock_time": never if card.lock_time is None else card.lock_time,
        "lock_speed": card.lock_speed or never,
        "limit": _from_zero(card.limit, "retractor.limit", scene),
        "tightener": _from_zero(card.pretensioner, "retractor.pretensioner", scene),
        "fire_time": never if card.fire_time is None else card.fire_time,
    }


def _from_zero(name: str | None, field: str, scene: Any) -> int:
    """The number of a curve that begins at 0; 0 for none."""
    if name is None:
        return 0
    curve = scene.curve(name)
    if scene.curve_points[curve]["x"] != 0.0:
        raise scene.fail("must begin at 0", field)
    if field == "force" and scene.curve_points[curve]["c"][0] != 0.0:
        raise scene.fail("must be 0 at 0: webbing without strain has no tension", field)
    return int(curve)


@kernel
def tension_of(p, curves, d, L, e_p):
    """T of a span [N], and its slope over the strain."""
    e = d / L - 1.0
    if e <= e_p:
        return 0.0, 0.0
    T, slope, _ = curve_value(curves, p.force, e)
    if p.unloading > 0.0 and p.unloading * (e - e_p) < T:
        return p.unloading * (e - e_p), p.unloading
    return T, slope


@kernel
def density(p, curves, T, e):
    """Energy per length of webbing w [N]."""
    if T <= 0.0:
        return 0.0
    if p.unloading > 0.0:
        return 0.5 * T * T / p.unloading
    return curve_area(curves, p.force, e)


@kernel
def energy_of(p, curves, new, out, i):
    """L w of span i [J]."""
    d, L = out.length[i], new.length[i]
    T, _ = tension_of(p, curves, d, L, new.set[i])
    return L * density(p, curves, T, d / L - 1.0)


@kernel
def flow_between(p, curves, new, out, i, j, ratio):
    """Webbing from span j into span i, until T_i is T_j times the ratio [m]; T_i was above."""
    d_i, d_j, L_i, L_j = out.length[i], out.length[j], new.length[i], new.length[j]
    # at most what leaves span i without tension
    low, high = 0.0, max(d_i / (1.0 + new.set[i]) - L_i, 0.0)
    high = min(high, L_j * (1.0 - 1e-9))
    m = 0.0
    for _ in range(TRIES):
        T_i, k_i = tension_of(p, curves, d_i, L_i + m, new.set[i])
        T_j, k_j = tension_of(p, curves, d_j, L_j - m, new.set[j])
        rest = T_i - ratio * T_j
        if rest > 0.0:
            low = m
        else:
            high = m
        slope = k_i * d_i / (L_i + m) ** 2 + ratio * k_j * d_j / (L_j - m) ** 2
        step = rest / slope if slope > 0.0 else 0.0
        m += step
        if slope <= 0.0 or m <= low or m >= high:
            m = 0.5 * (low + high)
        if high - low <= 1e-15 * L_i or abs(step) <= 1e-16 * L_i:
            break
    return m


@kernel
def flow_out(p, curves, new, out, curve, done, sign):
    """Webbing out of the retractor into span 0, until T_0 is that of a curve [m].

    The curve is read at done + sign m; without one the force is the retractor's pull.
    """
    d, L = out.length[0], new.length[0]
    at_rest = d / (1.0 + new.set[0]) - L
    low, high = min(0.0, at_rest), max(0.0, at_rest)
    if sign < 0.0:
        # it may be drawn taut: down to a strain of 1/2 beyond its set
        low, high = d / (1.5 + new.set[0]) - L, 0.0
    elif curve == 0:
        low = d / (1.5 + new.set[0]) - L
    m = 0.0
    for _ in range(TRIES):
        T, k = tension_of(p, curves, d, L + m, new.set[0])
        wanted, rise = p.pull, 0.0
        if curve > 0:
            wanted, rise, _ = curve_value(curves, curve, max(done + sign * m, 0.0))
        rest = T - wanted
        if rest > 0.0:
            low = m
        else:
            high = m
        slope = k * d / (L + m) ** 2 + sign * rise
        step = rest / slope if slope > 0.0 else 0.0
        m += step
        if slope <= 0.0 or m <= low or m >= high:
            m = 0.5 * (low + high)
        if high - low <= 1e-15 * L or abs(step) <= 1e-16 * L:
            break
    return m


@kernel
def wind(p, old, new, out, t, curves):
    """Let the retractor act; returns what it lets out [m]. Writes: new."""
    T, _ = tension_of(p, curves, out.length[0], new.length[0], new.set[0])
    m = 0.0
    if t >= p.fire_time and p.tightener > 0:
        force, _, _ = curve_value(curves, p.tightener, new.pulled)
        if force > T:
            m = flow_out(p, curves, new, out, p.tightener, new.pulled, -1.0)
            # in no time, and most of it may be slack: its work is the energy that the span gains
            before = energy_of(p, curves, new, out, 0)
            new.pulled -= m
            new.length[0] += m
            out.loss += before - energy_of(p, curves, new, out, 0)
            return m
    if old.locked == 0 and t < p.lock_time and t < p.fire_time:
        m = flow_out(p, curves, new, out, 0, 0.0, 1.0)
        new.spring += p.pull * m
    elif p.limit > 0:
        force, _, _ = curve_value(curves, p.limit, new.paid)
        if force < T:
            m = flow_out(p, curves, new, out, p.limit, new.paid, 1.0)
            new.paid += m
    new.length[0] += m
    return m


@kernel
def slip_through(p, new, out, k, curves):
    """Let webbing slip through ring k, between spans k - 1 and k; returns how much. Writes: new."""
    i, j = k - 1, k
    T_i, _ = tension_of(p, curves, out.length[i], new.length[i], new.set[i])
    T_j, _ = tension_of(p, curves, out.length[j], new.length[j], new.set[j])
    ratio = exp(p.mu[k] * out.angle[i])
    if T_i > ratio * T_j * (1.0 + CLOSED):
        m = flow_between(p, curves, new, out, i, j, ratio)
        new.length[i] += m
        new.length[j] -= m
        return m
    if T_j > ratio * T_i * (1.0 + CLOSED):
        m = flow_between(p, curves, new, out, j, i, ratio)
        new.length[i] -= m
        new.length[j] += m
        return m
    return 0.0


@kernel
def settle(p, old, new, out, t, h, curves):
    """Webbing of all spans at the end of the step. Writes: new."""
    for _ in range(SWEEPS):
        moved = 0.0
        if p.pull > 0.0:
            moved = abs(wind(p, old, new, out, t, curves))
        for k in range(1, p.points - 1):
            moved = max(moved, abs(slip_through(p, new, out, k, curves)))
        if moved <= 1e-14 * new.length[0]:
            break
    if p.pull > 0.0:
        new.pay_out = old.pay_out
        for i in range(p.points - 1):
            new.pay_out += new.length[i] - length_before(p, old, i)
        if t >= p.lock_time or t >= p.fire_time:
            new.locked = 1
        if h > 0.0 and new.pay_out - old.pay_out > p.lock_speed * h:
            new.locked = 1


@kernel
def length_before(p, old, i):
    """L of span i at the beginning of the step [m]."""
    return old.length[i] if old.begun == 1 else p.length[i]


@kernel
def open_step(p, old, new, out, nodes):
    """State of before, lengths of the spans and angles in the rings. Writes: new, out."""
    new.begun = 1
    new.pay_out, new.pulled, new.paid = old.pay_out, old.pulled, old.paid
    new.locked, new.spring = old.locked, old.spring
    last = (0.0, 0.0, 0.0)
    for i in range(SPANS):
        new.length[i] = new.set[i] = new.tension[i] = new.drive[i] = 0.0
        out.force[i] = out.length[i] = out.webbing[i] = out.slip[i] = out.angle[i] = 0.0
    for i in range(p.points - 1):
        new.length[i] = length_before(p, old, i)
        new.set[i] = old.set[i]
        u, length, _, _ = span_of(p, nodes, i)
        out.length[i] = length
        if i > 0:
            out.angle[i - 1] = acos(min(max(dot(last, u), -1.0), 1.0))
        last = u


@kernel
def span_of(p, nodes, i):
    """Unit vector from point i to the next, the distance, and both arms [m]."""
    a, b = nodes[p.node[i]], nodes[p.node[i + 1]]
    d_a = arm(a, (p.point[3 * i], p.point[3 * i + 1], p.point[3 * i + 2]))
    d_b = arm(b, (p.point[3 * i + 3], p.point[3 * i + 4], p.point[3 * i + 5]))
    x, _ = relative(a, d_a, b, d_b)
    length = norm(x)
    if length < 1e-12:
        return (1.0, 0.0, 0.0), 1e-12, d_a, d_b
    return scale(1.0 / length, x), length, d_a, d_b


@kernel
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    open_step(p, old, new, out, nodes)
    out.loss = 0.0
    settle(p, old, new, out, t, h, curves)
    out.stored, out.power = new.spring, 0.0
    out.pay_out, out.locked = new.pay_out, float(new.locked)
    for i in range(p.points - 1):
        d, L = out.length[i], new.length[i]
        e = d / L - 1.0
        T, _ = tension_of(p, curves, d, L, new.set[i])
        if p.unloading > 0.0:
            new.set[i] = max(old.set[i], e - T / p.unloading) if T > 0.0 else old.set[i]
        w = density(p, curves, T, e)
        new.tension[i], new.drive[i] = T, T * (1.0 + e) - w
        out.force[i], out.webbing[i], out.slip[i] = T, L, L - p.length[i]
        out.stored += L * w
        if h > 0.0 and old.begun == 1:
            flow = L - old.length[i]
            if i == 0:
                flow += new.pulled - old.pulled
            out.loss += 0.5 * (old.drive[i] + new.drive[i]) * flow
            out.loss += 0.5 * (old.tension[i] + T) * (new.set[i] - old.set[i]) * L
        u, _, d_a, d_b = span_of(p, nodes, i)
        pull_span(p, nodes, i, T, u, d_a, d_b, p.stiffest / L)
    out.loss -= new.spring - old.spring
    if h == 0.0 or old.begun == 0:
        out.loss = 0.0


@kernel
def pull_span(p, nodes, i, T, u, d_a, d_b, stiffness):
    """Tension on both ends of span i. Writes: nodes."""
    a, b = nodes[p.node[i]], nodes[p.node[i + 1]]
    apply_force(a, scale(T, u), d_a)
    apply_force(b, scale(-T, u), d_b)
    add_stiffness_bound(a, mobility(a, d_a, u), stiffness, 0.0)
    add_stiffness_bound(b, mobility(b, d_b, u), stiffness, 0.0)
