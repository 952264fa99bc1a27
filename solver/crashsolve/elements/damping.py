"""Damping of elements and scaling of their mass: fields that the cards of parts share.

    f = -alpha m v,   m = -alpha J w                        drag, against the air of the world
    q = rho l (b_1 c + b_2^2 l |rate| [rate < 0]) rate      viscosity, c = sqrt(E / rho)

`damping` beta, over the stiffness, is the law of each element. Drag and beta together are
Rayleigh's damping, of the ratio (alpha / omega + beta omega) / 2 at the frequency omega. Viscosity
resists the rate of stretch, so that a front of pressure spreads over a few elements and does not
ring; a rigid motion it does not see. Scaled mass is that of an element whose own stable step is
shorter than wanted. Consequence to test: a free body under drag keeps exp(-alpha t) of its speed;
behind a front in a bar the force is smooth.

References: von Neumann and Richtmyer (1950), Journal of Applied Physics 21, 232-237. Landshoff
(1955), Los Alamos report LA-1930.
"""

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, quantity, word
from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_external
from crashsolve.foundation.vec3 import dot, scale, vec

IMPLICIT = ("generalized_alpha", "radau_iia_5")


class Viscosity(Card):
    """Viscosity that smooths the fronts of waves in explicit runs."""

    linear: float = quantity("1", "b_1, damping ratio of the shortest waves", 0.06, ge=0)
    quadratic: float = quantity("1", "b_2, against fast compression", 1.2, ge=0)


class MassScaling(Card):
    """Mass added to elements whose stable step is too short."""

    step: float = quantity(
        "s", "time step at which every element alone is stable, at control.safety", gt=0
    )
    limit: float = quantity("1", "largest added mass over that of the part", default=0.05, gt=0)


class Damped(Card):
    """Fields of damping and added mass of the cards of all parts; none by default."""

    damping: float = quantity("s", "beta, damping over stiffness", default=0.0, ge=0)
    drag: float = quantity("1/s", "alpha, damping force over momentum", default=0.0, ge=0)
    viscosity: Viscosity | None = word(
        "resists fast stretching; only for explicit integrators", default=None
    )
    mass_scaling: MassScaling | None = word("added mass, reported in the log", default=None)


def coefficients(card: Damped, scene: Scene) -> tuple[float, float]:
    """b_1 and b_2^2 [1] of the bulk viscosity; 0 without."""
    if card.viscosity is None:
        return 0.0, 0.0
    method = scene.deck.control.integrator
    if method in IMPLICIT:
        message = f"smooths fronts in explicit steps, and integrator {method} has no such steps"
        raise scene.fail(f"{message}; use damping, or integrator: rattle", "viscosity")
    return card.viscosity.linear, card.viscosity.quadratic**2


def mass_factors(card: Damped, squares: np.ndarray, scene: Scene) -> np.ndarray:
    """Factors of the mass of elements with these squares of their highest frequency [1/s^2]."""
    if card.mass_scaling is None:
        return 0.0 * squares + 1.0
    wanted = 4.0 * (scene.deck.control.safety / card.mass_scaling.step) ** 2
    return (squares / wanted).clip(min=1.0)


def report_added_mass(card: Damped, mass: np.ndarray, factor: np.ndarray, scene: Scene) -> None:
    """Report to the user how much mass has been added, or refuse it. `mass` is that of the
    elements.
    """
    added, count = float((mass * (factor - 1.0)).sum()), int((factor > 1.0).sum())
    share = added / float(mass.sum())
    if card.mass_scaling is None or not count:
        return
    message = (
        f"{added:.4g} kg, {100.0 * share:.3g} % of its mass, to {count} of {len(mass)} elements"
    )
    if share > card.mass_scaling.limit:
        limit = f"limit is {100.0 * card.mass_scaling.limit:g} %"
        advice = "give a shorter step, or a larger limit"
        raise scene.fail(f"adds {message}, but {limit}; {advice}", "mass_scaling")
    parts = scene.deck.entries["parts"].values()
    name = next(entry.name for entry in parts if entry.card is card)
    scene.warn(f"part '{name}': mass scaling adds {message}")


@kernel
def apply_drag(nodes, node, rate):
    """Drag on a node; returns the power lost. Writes: nodes."""
    b, zero = nodes[node], (0.0, 0.0, 0.0)
    f = scale(-rate / b.mass_inv, vec(b.v))
    rotation = scale(-rate, matvec(b.A, matvec(b.J, matvec_t(b.A, vec(b.w)))))
    apply_external(nodes, node, f, zero, rotation)
    b.damping += rate
    return -dot(f, vec(b.v)) - dot(rotation, vec(b.w))
