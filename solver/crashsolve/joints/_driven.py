"""Words, build and kernel of prescribed motions: a coordinate follows a curve of time.

    x = f(t) - offset                                   of a travel
    x = int f dt - offset,    x' = f                    of a velocity
    x = int int f dt dt + (t - start) rate - offset,    x'' = f     of an acceleration

Integrals of the cubics are exact. Consequence to test: a measured pulse gives the velocity that is
the area below it, and the stroke that is the integral of that, to the last digits.
"""

from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, word
from crashsolve.foundation.curve import REFUSE, curve_area, curve_moment, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import as_rows

FIELDS = ("curve", "velocity", "acceleration")
# those of every driver beside its frame
MOTION = Record("""
    curve      index         f
    integrals  count         of f that the coordinate is: 0 to 2
    start      s             time at which the run begins
    rate       m/s or rad/s  velocity at the first point of an acceleration
    offset     m or rad      of f, or of its integral, over the coordinate
""")


class DrivenCard(Card):
    """A curve of time that a coordinate, its velocity or its acceleration follows."""

    curve: CurveName | None = word("motion over time; smooth, as a corner is an impact", None)
    velocity: CurveName | None = word("velocity over time, in place of `curve`", None)
    acceleration: CurveName | None = word(
        "acceleration over time, in place of `curve`, such as a measured pulse; it is "
        "integrated exactly, from the velocity that the bodies begin with",
        None,
    )
    relative: bool = word(
        "true: only changes of the curve count, so that the motion begins "
        "at the initial position; false: the curve gives the coordinate itself and must agree with "
        "the model at the start",
        default=True,
    )

    @model_validator(mode="after")
    def _one_curve(self) -> "DrivenCard":
        given = [field for field in FIELDS if getattr(self, field) is not None]
        if not given:
            raise ValueError("curve: is missing; give one of curve, velocity, acceleration")
        if len(given) > 1:
            raise ValueError(f"{given[1]}: give one of curve, velocity, acceleration")
        if given != ["curve"] and not self.relative:
            raise ValueError("relative: false needs a curve of the coordinate itself")
        return self

    @property
    def field(self) -> str:
        """The field that names the curve."""
        return next(field for field in FIELDS if getattr(self, field) is not None)


def motion(
    card: DrivenCard, scene: Scene, coordinate: float, rate: float, tolerance: float
) -> Columns:
    """Columns of MOTION, so that the coordinate begins as the model stands, and a velocity too.

    `coordinate` and `rate` are those of the bodies at the start.
    """
    t, integrals = scene.deck.control.start_time, FIELDS.index(card.field)
    if integrals and scene.deck.control.solution == "quasi_static":
        raise scene.fail("an equilibrium has no velocity; name a curve of the travel", card.field)
    first, values = start_values(card, scene)
    value = values[integrals]
    if not card.relative and abs(value - coordinate) > tolerance:
        raise scene.fail(
            f"is {value:.9g} at the start, where the coordinate is {coordinate:.9g}; "
            "make them agree, or write relative: true",
            "curve",
        )
    return {
        "curve": first,
        "integrals": integrals,
        "start": t,
        "rate": rate - values[1] if integrals == 2 else 0.0,
        "offset": value - coordinate,
    }


def start_values(card: DrivenCard, scene: Scene) -> tuple[int, tuple[float, float, float]]:
    """First point of the curve; its value, integral and integral of that when the run starts."""
    name = getattr(card, card.field)
    first, points, t = scene.curve(name), scene.curve_points, scene.deck.control.start_time
    x = points["x"][first : points[first]["last"] + 1]
    if not x[0] <= t <= x[-1] and points[first]["beyond"] == REFUSE:
        message = f"'{name}' reaches from {x[0]:g} to {x[-1]:g} s; the run starts at {t:g} s"
        raise scene.fail(f"{message}: give it points for that, or extrapolate: hold", card.field)
    rows = as_rows(points)
    value, _, _ = curve_value(rows, first, t)
    area, moment = curve_area(rows, first, t), curve_moment(rows, first, t)
    return first, (float(value), float(area), float(moment))


@kernel
def driven(p, curves, t):
    """Coordinate [m or rad] at time t, its velocity and its acceleration."""
    y, y1, y2 = curve_value(curves, p.curve, t)
    if p.integrals == 0:
        return y - p.offset, y1, y2
    area = curve_area(curves, p.curve, t)
    if p.integrals == 1:
        return area - p.offset, y, y1
    x = curve_moment(curves, p.curve, t) + p.rate * (t - p.start) - p.offset
    return x, area + p.rate, y
