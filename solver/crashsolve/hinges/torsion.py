"""Torsion hinge: b turns against a about the axis of the beam against an elastic-plastic torque.

    M(theta) by _law.py,   theta by _turn.py      (Ambrosio (2003), Fig. 3c)

The axis is that of the beam. Consequence to test: a
rotor J at w_0 in a rigid-plastic hinge M_0 stops after J w_0^2 / 2 M_0.

References: Ambrosio (2003), Eq. 6-7, Fig. 3 and 4.
"""

from crashsolve.hinges._card import TurningCard
from crashsolve.hinges._joint import LEDGER
from crashsolve.hinges._turn import (
    ANGULAR,
    COUNTS_TURNS,
    FREE,
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

__all__ = [
    "ANGULAR",
    "COUNTS_TURNS",
    "FREE",
    "HISTORY",
    "LEDGER",
    "OUTPUT",
    "PARAMETERS",
    "ROWS",
    "TANGENTS",
    "beyond",
]
__all__ += ["build", "convective", "curves", "force", "initial_history", "jacobian", "residual"]
__all__ += ["tangent"]


class Torsion(TurningCard):
    """Torsion hinge: b turns about the axis of the beam against an elastic-plastic torque."""
