"""Bending hinge: b turns against a about one axis, and an elastic-plastic moment resists.

    M(theta) by _law.py,   theta by _turn.py      (Ambrosio (2003), Fig. 3a)

The axis is at right angles to the beam and to the plane in which it bends. Consequence to test: a
rotor J at w_0 in a rigid-plastic hinge M_0 stops after J w_0^2 / 2 M_0.

References: Ambrosio (2003), Eq. 6-7, Fig. 3 and 4.
"""

from crashsolve.deck.card import quantity, word
from crashsolve.hinges._card import HingeCard, TurnCurve
from crashsolve.hinges._joint import LEDGER
from crashsolve.hinges._turn import (
    ANGULAR,
    HISTORY,
    OUTPUT,
    PARAMETERS,
    ROWS,
    TANGENTS,
    beyond,
    build,
    convective,
    curves,
    force,
    initial_history,
    jacobian,
    residual,
    tangent,
)

__all__ = ["ANGULAR", "HISTORY", "LEDGER", "OUTPUT", "PARAMETERS", "ROWS", "TANGENTS", "beyond"]
__all__ += ["build", "convective", "curves", "force", "initial_history", "jacobian", "residual"]
__all__ += ["tangent"]


class Bending(HingeCard):
    """Bending hinge: b turns about one axis of a against an elastic-plastic moment."""

    curve: TurnCurve = word("moment over angle as it grows, from [0, 0]")
    curve_negative: TurnCurve | None = word(
        "the same for negative angles, both counted positive; as curve when absent", default=None
    )
    stiffness: float | None = quantity(
        "N m/rad", "elastic, also of unloading; the first slope when absent", default=None, gt=0
    )
    initial_angle: float = quantity(
        "rad", "turn of b from the start in which the hinge has no moment", default=0.0
    )
    failure_angle: float | None = quantity(
        "rad", "angle in either direction at which the hinge fails", default=None, gt=0
    )
