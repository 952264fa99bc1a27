"""Linear spring as stiff as the shells that touch, without damping.

    f = k delta,   k = s E t

t and E are thickness and modulus of the softer shell of both sides. With the mass rho t A / 4 of a
node beside four elements of area A it adds 2 s E / (rho A) to the squared frequency of the mesh,
whose own is 4 E / (rho A) and more: for any mesh, contact shortens the step only a little.
Consequence to test: a ball on a rigid wall bounces back after pi sqrt(m / k) with all its energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import model_validator

from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.contact.normal._rows.penalty import History, Parameters

SHARE = 0.5
LEFT_OUT = "the stiffness of penalty contacts"


class Penalty(Card):
    """Linear spring as stiff as the shells that touch."""

    stiffness: float | None = quantity("N/m", "k; from the shells when absent", None, gt=0)
    share: float | None = quantity("1", "s, k over E t of the shells; 0.5 if absent", None, gt=0)

    @model_validator(mode="after")
    def _one_stiffness(self) -> Penalty:
        if self.stiffness is not None and self.share is not None:
            raise ValueError("share: stiffness is given already; leave one of them out")
        return self


PARAMETERS = Record("stiffness  N/m  k")
HISTORY = Record()


def build(card: Penalty, scene: Scene, pair: Pair) -> Columns:
    if card.stiffness is not None:
        return {"stiffness": card.stiffness}
    shell = getattr(pair, "membrane", None)
    if shell is None:
        raise scene.fail(
            "no shell is in this contact, from whose stiffness it could follow; give stiffness",
            "normal",
        )
    return {"stiffness": (SHARE if card.share is None else card.share) * shell}


@kernel
def normal_force(p: Parameters, old: History, new: History, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping."""
    f = p.stiffness * depth
    return f, 0.5 * f * depth, 0.0, 0.0, p.stiffness, 0.0


@kernel
def release(p: Parameters, old: History, new: History):
    """Nothing is remembered after separation."""


@kernel
def normal_tangent(p: Parameters, state: History, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate."""
    return p.stiffness, 0.0
