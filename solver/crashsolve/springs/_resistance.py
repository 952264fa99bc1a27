"""Force over deformation by a curve, with unloading, free play, damping and rate hardening.

    e = |x| - gap (0 within the gap),  f(e) on the curve,  in one of three ways:
    same     f = y(e)                                  stored = int y de
    set      f = min(y(e), k (e - s)), not below 0     s grows, the permanent set; stored = f^2 / 2k
    between  u(e) <= f = k (e - s) <= y(e)             s grows and falls; stored = f^2 / 2k + P(s)

The last two are an elastic line of slope k on a slider s, which slides at y upwards and at u
downwards. Work on the slider is exact: with G_c(e) = int c de - c^2 / 2k it is the change of G_y on
loading, of which P, the change of G_u, returns in unloading. Each direction of x has its own
slider. A factor phi(|rate|) acts while the deformation grows, and the energy that it adds is
dissipated.

Consequence to test: energy absorbed = stored + lost over any path, for any step.

References: the shape of the hysteresis is that of seat-belt and foam models of crash codes;
phi = 1 + a |rate|^b is Ambrosio (2003), Eq. 7; Cowper and Symonds (1957), Brown University TR 28.
"""

from typing import Any

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.foundation.curve import curve_area, curve_value, segment
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.slider import line_meets, work

SAME, SET, BETWEEN = 0, 1, 2
# branches of the law: no force, on the elastic line, on y, on u
SLACK, LINE, LOADING, LOWER = range(4)

RESISTANCE = Record("""
    curve                index               y
    unloading            flag                SAME, SET or BETWEEN
    unloading_curve      index               u
    unloading_stiffness  N/m or N m/rad      k
    direction            flag                1 or -1: no force in the other direction; 0: both
    loose                flag                the ends may part: never a force that holds them
                                             together
    gap                  m or rad            free play in each direction
    damping              N s/m or N m s/rad  c
    rate_curve           index               phi over |rate|; 0 for the power law
    rate_coefficient     1                   a
    rate_exponent        1                   b
    rate_floor           m/s or rad/s        rate at which phi = 1.1
    largest_slope        N/m or N m/rad      largest slope of the curves and k
""")
SLIDER = Record("""
    set             m or rad  2  s in tension, in compression
    unloading_work  J         2  P of both
    side            flag         1 or -1: direction of the deformation
    branch          flag         SLACK, LINE, LOADING or LOWER
    segment         index        of the curve that is read
""")


def resistance(card: Any, scene: Scene) -> Columns:
    """Parameters of the law from the words of a card."""
    a, b = _power_law(card)
    curves = [name for name in (card.curve, card.unloading_curve) if name]
    k = card.unloading_stiffness or 0.0
    slopes = [steepest(scene.curve_points, scene.curve(name)) for name in curves]
    direction = {"both": 0, "tension": 1, "positive": 1, "compression": -1, "negative": -1}[
        card.acts
    ]
    if k:
        _check_hysteresis(card, scene, direction, k, max(slopes))
    return {
        "curve": scene.curve(card.curve),
        "unloading": BETWEEN if card.unloading_curve else SET if k else SAME,
        "unloading_curve": scene.curve(card.unloading_curve) if card.unloading_curve else 0,
        "unloading_stiffness": k,
        "direction": direction,
        "loose": direction != 0 or card.gap > 0.0 or k > 0.0,
        "gap": card.gap,
        "damping": card.damping,
        "rate_curve": scene.curve(card.rate_curve) if card.rate_curve else 0,
        "rate_coefficient": a,
        "rate_exponent": b,
        "rate_floor": (0.1 / a) ** (1.0 / b) if a else 0.0,
        "largest_slope": max([k, *slopes]),
    }


def _power_law(card: Any) -> tuple[float, float]:
    """a and b of phi = 1 + a |rate|^b."""
    if card.cowper_symonds is not None:
        b = 1.0 / card.cowper_symonds.exponent
        return card.cowper_symonds.reference_rate**-b, b
    if card.power_law is not None:
        return card.power_law.coefficient, card.power_law.exponent
    return 0.0, 1.0


def steepest(points: np.ndarray, start: int) -> float:
    """Largest |slope| [N/m or N m/rad] of the curve that starts at a point."""
    part = points[start : points[start]["last"] + 1]
    width, c = np.diff(part["x"]), part["c"][:-1]
    # the slope is a parabola on each segment: check its ends and its vertex
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = np.clip(np.nan_to_num(-c[:, 2] / (3.0 * c[:, 3])), 0.0, width)
    slopes = [c[:, 1] + s * (2.0 * c[:, 2] + 3.0 * c[:, 3] * s) for s in (0.0, vertex, width)]
    return float(np.abs(slopes).max())


def read(points: np.ndarray, start: int, x: np.ndarray) -> np.ndarray:
    """Values (n,) of a curve within its range."""
    part = points[start : points[start]["last"] + 1]
    i = np.clip(np.searchsorted(part["x"], x, "right") - 1, 0, len(part) - 2)
    s = np.clip(x, part["x"][0], part["x"][-1]) - part["x"][i]
    c = part["c"][i].T
    return np.asarray(c[0] + s * (c[1] + s * (c[2] + s * c[3])))


def _check_hysteresis(
    card: Any, scene: Scene, direction: int, k: float, steepest_slope: float
) -> None:
    """Refuse curves that would create energy: 0 <= u <= y and slopes below k is required
    everywhere.
    """
    if steepest_slope >= k:
        raise scene.fail(
            f"must exceed every slope of the curves; the largest is {steepest_slope:g}",
            "unloading_stiffness",
        )
    points, upper = scene.curve_points, scene.curve(card.curve)
    lower = scene.curve(card.unloading_curve) if card.unloading_curve else None
    x = np.concatenate([points[c : points[c]["last"] + 1]["x"] for c in (upper, lower) if c])
    for side in (1.0, -1.0):
        if direction == -side:
            continue
        e = np.append(x[side * x > 0.0], 0.0)
        y = side * read(points, upper, e)
        if y.min() < 0.0:
            raise scene.fail("must not change sign where it is used with unloading", "curve")
        if lower is None:
            continue
        u = side * read(points, lower, e)
        if abs(u[-1]) > 1e-12 * np.abs(u).max() or u.min() < 0.0 or (u > y).any():
            raise scene.fail("must start at 0 and stay between 0 and the curve", "unloading_curve")


@kernel
def resistance_force(p, old, new, out, h, x, rate, curves):
    """Force [N or N m] that opposes the deformation x [m or rad], stiffness and damping.

    Writes: new sliders, out.stored, power, loss.
    """
    side = 1.0 if x >= 0.0 else -1.0
    e = max(side * x - p.gap, 0.0)
    speed = side * rate
    for j in range(2):
        # between two curves the direction that is left goes back to its origin
        new.set[j] = old.set[j] if p.unloading == SET else 0.0
        new.unloading_work[j] = 0.0
    if p.direction * side < 0.0:
        e, upper = 0.0, 0.0
        f, out.stored, loss = 0.0, 0.0, 0.0
    else:
        upper = side * curve_value(curves, p.curve, side * e)[0]
        if p.unloading == SAME:
            f, out.stored, loss = along_curve(p, side, e, upper, curves)
        else:
            f, out.stored, loss = on_slider(p, old, new, side, e, upper, curves)
    note_branch(p, new, side, e, f, upper, speed, curves)
    # a state without a step has no history to lose energy in
    out.loss = loss if h > 0.0 else 0.0
    factor, viscosity = growth(p, abs(rate), curves)
    total = f * factor if speed > 0.0 else f
    if p.loose == 0:
        total += p.damping * speed
    elif f > 0.0:
        total = max(total + p.damping * speed, 0.0)
    out.power = (total - f) * speed
    return side * total, factor * p.largest_slope, p.damping + viscosity * f


@kernel
def note_branch(p, new, side, e, f, upper, speed, curves):
    """On which branch of the law this is: its corners are where branches meet. Writes: new.

    `upper` is y(e).
    """
    new.side, new.branch, new.segment = side, LOADING, 0
    if p.loose == 1 and f == 0.0:
        new.branch = SLACK
    elif p.unloading != SAME:
        j = 0 if side > 0.0 else 1
        # at rest on a curve unloading is along the elastic line
        if f < upper or speed <= 0.0:
            new.branch = LINE
        if p.unloading == BETWEEN and f > 0.0 and speed < 0.0:
            lower = side * curve_value(curves, p.unloading_curve, side * e)[0]
            if f <= lower and new.set[j] < e:
                new.branch = LOWER
    if new.branch == LOADING:
        new.segment = segment(curves, p.curve, curves[p.curve].last, side * e)


@kernel
def branch_event(p, old, h, x, rate, curves):
    """Distance of x beyond the branch of the law on which the step began [m or rad]; below 0: on
    it.

    On y and u the branch ends where the motion reverses, by the displacement in h.
    """
    if old.branch == SLACK:
        past = -1e300
        for j in range(2):
            side = 1.0 - 2.0 * j
            if p.direction * side >= 0.0:
                past = max(past, side * x - p.gap - (old.set[j] if p.unloading == SET else 0.0))
        return past
    side = 1.0 * old.side
    e, k = side * x - p.gap, p.unloading_stiffness
    if old.branch == LOADING:
        first, last = old.segment, curves[p.curve].last
        low = curves[first].x if first > p.curve else -1e300
        high = curves[first + 1].x if first + 1 < last else 1e300
        past = max(low - side * e, side * e - high)
        if p.unloading != SAME:
            past = max(past, -side * rate * h)
        return max(past, -e) if p.loose == 1 else past
    if old.branch == LOWER:
        return max(side * rate * h, -e)
    s = old.set[0 if side > 0.0 else 1]
    upper = side * curve_value(curves, p.curve, side * max(e, 0.0))[0]
    past = max(e - s - upper / k, s - e)
    if p.unloading == BETWEEN:
        lower = side * curve_value(curves, p.unloading_curve, side * max(e, 0.0))[0]
        past = max(past, lower / k - (e - s))
    return past


@kernel
def along_curve(p, side, e, upper, curves):
    """Force, stored energy and loss [J] on the curve itself, y(e) = `upper`."""
    f = 0.0 if e == 0.0 and p.loose == 1 else upper
    return f, curve_area(curves, p.curve, side * e) - curve_area(curves, p.curve, 0.0), 0.0


@kernel
def on_slider(p, old, new, side, e, upper, curves):
    """Force, stored energy and loss [J] of the elastic line on its slider, y(e) = `upper`.

    Writes: new.
    """
    k = p.unloading_stiffness
    j = 0 if side > 0.0 else 1
    s, unloading_work, loss = old.set[j], old.unloading_work[j], 0.0
    f = k * (e - s)
    lower = 0.0
    if p.unloading == BETWEEN:
        lower = side * curve_value(curves, p.unloading_curve, side * e)[0]
    if f > upper:
        # the slider begins to move where its line meets the curve: y = k (e - s) there
        start = line_meets(curves, p.curve, side, k, s, e)
        begun = k * (start - s)
        f, s = upper, e - upper / k
        area = curve_area(curves, p.curve, side * e) - curve_area(curves, p.curve, side * start)
        loss = area - 0.5 * (f * f - begun * begun) / k + unloading_work
        if p.unloading == BETWEEN:
            unloading_work = work(
                curves,
                p.unloading_curve,
                side,
                k,
                line_meets(curves, p.unloading_curve, side, k, s, e),
            )
        loss -= unloading_work
    elif f < lower and p.unloading == BETWEEN:
        f, s = lower, e - lower / k
        unloading_work = work(curves, p.unloading_curve, side, k, e)
    elif f < 0.0:
        f = 0.0
    new.set[j] = s
    new.unloading_work[j] = unloading_work
    return f, 0.5 * f * f / k + unloading_work, loss


@kernel
def growth(p, speed, curves):
    """phi [1] at a rate, and an upper bound of its slope: the secant, from where phi is 1.1 on.

    At lower rates phi adds less than a tenth of the force, however steep.
    """
    if p.rate_curve > 0:
        phi, slope, _ = curve_value(curves, p.rate_curve, speed)
        return phi, abs(slope)
    if p.rate_coefficient == 0.0:
        return 1.0, 0.0
    b = p.rate_exponent
    at = max(speed, p.rate_floor)
    secant = p.rate_coefficient * at ** (b - 1.0)
    return 1.0 + p.rate_coefficient * speed**b, max(b, 1.0) * secant


@kernel
def resistance_tangent(p, state, x, rate, curves):
    """Rise of the force over the deformation x [N/m or N m/rad] and over its rate, from a state."""
    side = 1.0 if x >= 0.0 else -1.0
    e = max(side * x - p.gap, 0.0)
    speed = side * rate
    if p.direction * side < 0.0 or (e == 0.0 and p.loose == 1):
        return 0.0, 0.0
    f, slope, _ = curve_value(curves, p.curve, side * e)
    f *= side
    if p.unloading != SAME:
        f, slope = slider_tangent(p, state, side, e, speed, f, slope, curves)
    factor, factor_slope = 1.0, 0.0
    if speed > 0.0:
        factor, factor_slope = growth_tangent(p, speed, curves)
    if p.loose == 1 and (f <= 0.0 or f * factor + p.damping * speed <= 0.0):
        return 0.0, 0.0
    return factor * slope, p.damping + f * factor_slope


@kernel
def slider_tangent(p, state, side, e, speed, upper, upper_slope, curves):
    """Force and slope [N/m or N m/rad] of the elastic line, or of the curve of a moving slider."""
    k = p.unloading_stiffness
    f = k * (e - state.set[0 if side > 0.0 else 1])
    # a slider that moves keeps the force on the curve to round-off
    near = 1e-12 * k * e
    if f >= upper - near and speed > 0.0:
        return upper, upper_slope
    if p.unloading == BETWEEN:
        lower, slope, _ = curve_value(curves, p.unloading_curve, side * e)
        if f <= side * lower + near and speed < 0.0:
            return side * lower, slope
    if f <= 0.0:
        return 0.0, 0.0
    return f, k


@kernel
def growth_tangent(p, speed, curves):
    """phi [1] at a rate and its slope; near rest, where a power law is vertical, that close by."""
    if p.rate_curve > 0:
        phi, slope, _ = curve_value(curves, p.rate_curve, speed)
        return phi, slope
    if p.rate_coefficient == 0.0:
        return 1.0, 0.0
    a, b = p.rate_coefficient, p.rate_exponent
    at = max(speed, 1e-3 * p.rate_floor) if b < 1.0 else speed
    return 1.0 + a * speed**b, a * b * at ** (b - 1.0)
