"""What limits and friction of a named joint share: the joint and its stops."""

from typing import Any

from pydantic import model_validator

from crashsolve.deck.building import Columns, JointOfScene, Scene
from crashsolve.deck.card import Card, CurveName, JointName, word
from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.springs._range import AT_LIMIT, check_pushes_back
from crashsolve.springs._resistance import steepest

STOPS = Record("""
    lower      m or rad            lower stop; minus infinity for none
    upper      m or rad            upper stop; infinity for none
    stiffness  N/m or N m/rad      k; not used with a curve
    curve      index               force over the travel beyond the stop; 0 for none
    damping    N s/m or N m s/rad  c
    largest_slope  N/m or N m/rad      largest slope of the force
""")
STOPPED = Record("at  flag  1: beyond the upper stop, -1: beyond the lower, 0: between")


class StopCard(Card):
    """A joint with stops; the file of the law adds lower, upper, stiffness and damping."""

    joint: JointName = word("joint with the stops")
    curve: CurveName | None = word(
        "force beyond the stop over the travel beyond it, from 0; instead of stiffness",
        default=None,
    )

    @model_validator(mode="after")
    def _consistent(self) -> "StopCard":
        lower, upper = getattr(self, "lower", None), getattr(self, "upper", None)
        if lower is None and upper is None:
            raise ValueError("needs lower, upper or both")
        if lower is not None and upper is not None and lower > upper:
            raise ValueError("lower: must not exceed upper")
        if (self.curve is None) == (getattr(self, "stiffness", None) is None):
            raise ValueError("needs one of stiffness and curve")
        return self


def named_joint(scene: Scene, name: str, *motions: str) -> JointOfScene:
    """The joint a card names, which must have one of some motions."""
    scene.refuse_joint(name, motions, "joint")
    return scene.joints[name]


def stops(card: Any, scene: Scene) -> Columns:
    """Columns of STOPS from the words of a card."""
    curve = scene.curve(card.curve) if card.curve else 0
    if curve and scene.curve_points[curve]["x"] != 0.0:
        raise scene.fail("must begin at 0, where the joint meets the stop", "curve")
    if curve:
        check_pushes_back(scene, curve)
    return {
        "lower": float("-inf") if card.lower is None else card.lower,
        "upper": float("inf") if card.upper is None else card.upper,
        "stiffness": card.stiffness or 0.0,
        "curve": curve,
        "damping": card.damping,
        "largest_slope": steepest(scene.curve_points, curve) if curve else card.stiffness,
    }


def check_start(
    card: Any, scene: Scene, p: Columns, start: float, unit: str, *, placed: bool = False
) -> None:
    """A joint past its range at the start is moved back at once.

    A posture that has `placed` it there is refused; elsewhere a preload may be meant: a warning.
    """
    past = max(start - p["upper"], p["lower"] - start)
    if past <= AT_LIMIT:
        return
    size = f"{past:.3g} {unit} past the range from {p['lower']:.4g} to {p['upper']:.4g} {unit}"
    if placed:
        message = f"the posture rotates '{card.joint}' to {start:.4g} {unit}, {size}"
        raise scene.fail(message, "joint")
    scene.warn(f"joint '{card.joint}' begins {size}: its stop moves it back from the start")


@kernel
def stop(p, new, x, rate, out, curves):
    """Force against x beyond a stop [N or N m]; it never pulls back. Writes: new, out."""
    new.at = 1 if x > p.upper else (-1 if x < p.lower else 0)
    out.stored = out.power = out.loss = 0.0
    over = max(x - p.upper, p.lower - x)
    if over <= 0.0:
        return 0.0
    side = 1.0 if x > p.upper else -1.0
    if p.curve > 0:
        elastic = curve_value(curves, p.curve, over)[0]
        out.stored = curve_area(curves, p.curve, over)
    else:
        elastic = p.stiffness * over
        out.stored = 0.5 * elastic * over
    total = max(elastic + p.damping * side * rate, 0.0)
    out.power = (total - elastic) * side * rate
    return side * total


@kernel
def stop_tangent(p, x, rate, curves):
    """Rise of the force of a stop over x [N/m or N m/rad] and over its rate."""
    over = max(x - p.upper, p.lower - x)
    if over <= 0.0:
        return 0.0, 0.0
    elastic, slope = p.stiffness * over, p.stiffness
    if p.curve > 0:
        elastic, slope, _ = curve_value(curves, p.curve, over)
    side = 1.0 if x > p.upper else -1.0
    if elastic + p.damping * side * rate <= 0.0:
        return 0.0, 0.0
    return slope, p.damping


@kernel
def stop_event(p, old, x):
    """Distance of x from the range in which it began the step, between the stops or beyond one
    [m or rad].
    """
    if old.at == 0:
        return max(x - p.upper, p.lower - x)
    return p.upper - x if old.at > 0 else x - p.lower
