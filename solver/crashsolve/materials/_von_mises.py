"""What metals that yield by von Mises' stress share: columns, and what a point remembers.

    sqrt(3/2) |dev(sigma - alpha)| <= Y(e) f(rate) g(T),   alpha_dot = 2/3 H_k eps_p_dot
    T_dot = heating w_p_dot

e is the equivalent plastic strain, w_p the plastic work per volume. A law says Y, f and g; elements
return stresses to the yield surface (elements/shells/plasticity.py, elements/beams/fibres.py).
"""

from typing import Any

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.record import Record, rows_of
from crashsolve.materials import elastic

PARAMETERS = elastic.PARAMETERS + Record("""
    softness         1/Pa   nu / E
    falls_1          Pa     c_1 of the plastic return
    falls_2          Pa     c_2
    kinematic        Pa     H_k, of what moves the yield surface
    rated            flag   whether the rate of strain has a factor
    heating          m^3/J  temperature, 1 at melting, over plastic work per volume; 0 for none
    temperature_row  index  of a layer
    failure          1      plastic strain at which a layer fails; 0 for none
""")
# then, where there are any: the temperature, and the line of a curve
LAYER = rows_of(
    Record("""
        stress          Pa  3  xx, yy, xy
        plastic_strain  1      e
        alpha           Pa  3  middle of the yield surface, where it moves
    """)
)
FIBRE = Record("""
    plastic    1  plastic strain
    hardening  1  e, sum of the sizes of its steps
""")
HEATED_FIBRE = FIBRE + Record("temperature  1  from 0 at the start to 1 at melting")


def build(
    card: Any, scene: Scene, kinematic: float, rated: bool, heating: float = 0.0
) -> dict[str, Any]:
    """Columns of PARAMETERS; an equilibrium has no rate."""
    rated = rated and scene.deck.control.solution != "quasi_static"
    words = elastic.build(card, scene)
    E, nu, moves = words["young"], words["poisson"], 2.0 / 3.0 * kinematic
    return words | {
        "softness": nu / E,
        "falls_1": E / (3.0 - 3.0 * nu) + moves,
        "falls_2": 2.0 * words["shear"] + moves,
        "kinematic": kinematic,
        "rated": rated,
        "heating": heating,
        "temperature_row": LAYER.SIZE if kinematic else LAYER.alpha,
        "failure": card.failure_strain or 0.0,
    }


def plastic_strain(card: Any, layer: np.ndarray) -> np.ndarray:
    """Equivalent plastic strain [1] of layers (..., rows)."""
    found: np.ndarray = layer[..., LAYER.plastic_strain]
    return found


@inlined
def factor_of(m, rate, temperature, material):
    """Factor [1] on the yield stress: it is higher at a rate of strain, lower at a temperature."""
    factor = material.rate_factor(m, rate) if m.rated == 1 else 1.0
    return factor * material.heat_factor(m, temperature) if m.heating > 0.0 else factor


@inlined
def has_factor(m):
    """Whether there is a factor on the yield stress."""
    return m.rated == 1 or m.heating > 0.0
