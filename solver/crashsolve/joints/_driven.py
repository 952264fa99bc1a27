"""Words and build of prescribed motions: a coordinate of the model follows a curve of time."""

from typing import Any

import numpy as np

from crashsolve.deck.card import Card, CurveName, word


class DrivenCard(Card):
    """A curve of time that a coordinate follows."""

    curve: CurveName = word("motion over time; smooth, as a corner is an impact")
    relative: bool = word(
        "true: only changes of the curve count, so that the motion begins where the model stands; "
        "false: the curve gives the coordinate itself and must agree with the model at the start",
        default=True,
    )


def motion(card: DrivenCard, scene: Any, coordinate: float, tolerance: float) -> dict[str, Any]:
    """Columns `curve` and `offset`, so that coordinate = curve(t) - offset at the start."""
    value = start_value(card, scene)
    if not card.relative and abs(value - coordinate) > tolerance:
        raise scene.fail(
            f"is {value:.9g} at the start, where the coordinate is {coordinate:.9g}; "
            "make them agree, or write relative: true",
            "curve",
        )
    return {"curve": scene.curve(card.curve), "offset": value - coordinate}


def start_value(card: DrivenCard, scene: Any) -> float:
    """Value of the curve at the start of the run [m or rad]."""
    first = scene.curve(card.curve)
    points = scene.curve_points[first : scene.curve_points[first]["last"] + 1]
    x, t = points["x"], scene.deck.control.start_time
    if not x[0] <= t <= x[-1]:
        raise scene.fail(
            f"'{card.curve}' reaches from {x[0]:g} to {x[-1]:g} s; the run starts at {t:g} s",
            "curve",
        )
    i = min(int(np.searchsorted(x, t, side="right")) - 1, len(x) - 2)
    return float(np.polyval(points["c"][i][::-1], t - x[i]))
