"""Plastic hinges: joints whose free motions an elastic-plastic moment or force resists."""

from typing import Any, Protocol

from crashsolve.deck.family import ANY, Family


class HingeLaw(Protocol):
    """What the file of a hinge provides beside its card: a joint, and what resists its motion."""

    def build(self, card: Any, scene: Any) -> Any:
        """Words into symbols: one row of PARAMETERS."""

    def residual(self, p, old, new, t, nodes, rows, curves):
        """Phi(q, t). Writes: rows.phi, new."""

    def jacobian(self, p, old, t, nodes, rows, curves):
        """D and nu = -Phi_t. Writes: rows.D, nu."""

    def convective(self, p, old, t, nodes, rows, curves):
        """gamma = -D_dot v - Phi_tt. Writes: rows.gamma."""

    def force(self, p, old, new, out, t, h, nodes, rows, curves):
        """Moments and forces on both bodies, energy stored and lost. Writes: nodes, out, new."""


FAMILY = Family(
    entry="hinge",
    follows="springs",
    law=HingeLaw,
    energy=("hinge",),
    channels=("hinge", "moments, angles and energies of plastic hinges"),
    picture=None,
    uses=("joints",),
    integrators=ANY,
)
