"""Curves of time that drive joints: how many derivatives of them the kernels read, and the speed to
which errors of steps are compared at least.

A body that begins to move from rest, under a load or with a driver, is slower at first than any
speed that matters: against its own speed a step would resolve the last digits of the curve.
Consequence to test: a pulse that begins with a kink, or from 1e-40 of its peak, stops no method.
"""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crashsolve.deck.reading.deck import Deck
    from crashsolve.model.model import Model

# by the field of a driver that names a curve (joints/_driven.py): accelerations are the second
# derivative of a travel, and the first of a velocity
DERIVATIVES = {"curve": 2, "velocity": 1, "acceleration": 0}
# of the model's size: with the default tolerance a step then errs by 1e-15 of it, its last digit
SLOW = 1e-9


def derivatives_read(deck: "Deck") -> dict[str, int]:
    """Names of the curves that drive joints, each with the highest derivative that is read."""
    orders: dict[str, int] = {}
    for entry in deck.entries["joints"].values():
        for field, order in DERIVATIVES.items():
            name = getattr(entry.card, field, None)
            if isinstance(name, str):
                orders[name] = max(order, orders.get(name, 0))
    return orders


def least_speed(model: "Model") -> float:
    """Largest speed [m/s] of the prescribed motions of a run, at the points of their curves and
    half-way between them, a rotation at the model's size; or one that moves SLOW of that in all.
    """
    control = model.control[0]
    span = float(control["end"] - control["start"])
    speeds = [SLOW * model.size / span if span > 0.0 else 0.0]
    for group in model.groups:
        if "integrals" not in (group.parameters.dtype.names or ()):
            continue
        arm = model.size if group.module.ANGULAR[0] else 1.0
        speeds += [arm * _largest_rate(model, p) for p in group.parameters]
    return max(speeds)


def _largest_rate(model: "Model", p: np.void) -> float:
    """Largest rate [m/s or rad/s] of the coordinate that one driver prescribes."""
    control, first = model.control[0], int(p["curve"])
    points = model.curves[first : model.curves[first]["last"] + 1]
    x, c = points["x"], points["c"][:-1]
    overlaps = (x[:-1] <= control["end"]) & (x[1:] >= control["start"])
    if p["integrals"] == 2:
        rates = p["rate"] + points["area"][1:][overlaps]
    else:
        s = np.diff(x) * np.array([[0.0], [0.5], [1.0]])
        slope = c[:, 1] + s * (2.0 * c[:, 2] + 3.0 * s * c[:, 3])
        value = c[:, 0] + s * (c[:, 1] + s * (c[:, 2] + s * c[:, 3]))
        rates = (value if p["integrals"] == 1 else slope)[:, overlaps]
    return float(np.abs(rates).max(initial=0.0))
