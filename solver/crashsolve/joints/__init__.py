"""Joints: kinematic constraints between two bodies."""

from typing import Any, Protocol

from crashsolve.deck.family import ANY, Family


class JointLaw(Protocol):
    """What the file of a joint provides beside its card."""

    def build(self, card: Any, scene: Any) -> Any:
        """Words into symbols: one row of PARAMETERS."""

    def residual(self, p, old, new, t, nodes, rows, curves):
        """Phi(q, t). Writes: rows.phi, new."""

    def jacobian(self, p, old, t, nodes, rows, curves):
        """D and nu = -Phi_t. Writes: rows.D, nu."""

    def convective(self, p, old, t, nodes, rows, curves):
        """gamma = -D_dot v - Phi_tt. Writes: rows.gamma."""


FAMILY = Family(
    entry="joint",
    follows="bodies",
    law=JointLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
