"""Bending hinge: b rotates against a about one axis, and an elastic-plastic moment resists.

    M(theta) by _law.py,   theta by _one_axis.py      (Ambrosio (2003), Fig. 3a)

The axis is at right angles to the beam and to the plane in which it bends. Consequence to test: a
rotor J at w_0 in a rigid-plastic hinge M_0 stops after J w_0^2 / 2 M_0.

References: Ambrosio (2003), Eq. 6-7, Fig. 3 and 4.
"""

from crashsolve.hinges._card import RotationalCard

# all else is that of every hinge that rotates about one axis
from crashsolve.hinges._one_axis import *  # noqa: F403


class Bending(RotationalCard):
    """Bending hinge: b rotates about one axis of a against an elastic-plastic moment."""
