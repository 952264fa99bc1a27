"""Section given by its numbers.

    A,   I_y = int z^2 dA,   I_z = int y^2 dA,   J,   kappa_y and kappa_z

Mass that lies elsewhere than the stiffness has second moments of its own: rotary inertia per
length is rho diag(R_y + R_z, R_y, R_z). Consequence to test: with the numbers of a circle it is
that circle.
"""

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.record import Record


class General(Card):
    """Section given by its numbers."""

    area: float = quantity("m^2", "A, area", gt=0)
    I_y: float = quantity("m^4", "second moment for bending about y", gt=0)
    I_z: float = quantity("m^4", "second moment for bending about z", gt=0)
    torsion: float = quantity("m^4", "J, torsion constant", gt=0)
    shear_y: float = quantity("1", "kappa_y, share of A that carries shear along y", gt=0)
    shear_z: float = quantity("1", "kappa_z, share of A that carries shear along z", gt=0)
    rotary_y: float | None = quantity(
        "m^4", "R_y, second moment of the mass over its density; I_y when absent", None, gt=0
    )
    rotary_z: float | None = quantity(
        "m^4", "R_z, second moment of the mass over its density; I_z when absent", None, gt=0
    )


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: General, poisson: float) -> Columns:
    numbers = {
        "area": card.area,
        "second": (card.I_y, card.I_z),
        "torsion": card.torsion,
        "shear": (card.shear_y, card.shear_z),
    }
    if card.rotary_y or card.rotary_z:
        numbers["rotary"] = (card.rotary_y or card.I_y, card.rotary_z or card.I_z)
    return numbers
