"""Energy balance of each contact card: the work done by both sides is stored, or dissipated.

    missing = stored + dissipated + work of the forces on both sides

once for the normal force and once for friction. The balance of the scene may hide it: a contact
stores little of the energy of a crash.
"""

from typing import NamedTuple

import numpy as np

from crashsolve.model.ledger import LARGEST
from crashsolve.model.model import Model, State
from crashsolve.system.contact.advice import advice_on_depth, advice_on_gain

# of the largest energy that the normal force or the friction of a card has stored and dissipated
UNBALANCED = 0.02
# of the largest energy of the scene: less is ignored
NEGLIGIBLE = 1e-5
FRICTION = "friction"


def contact_warnings(model: Model, state: State, ledger: np.ndarray) -> list[str]:
    """Warnings of contacts whose forces did other work than they have stored and dissipated."""
    current, warnings = int(state.clock["current"][0]), []
    least = NEGLIGIBLE * float(ledger[LARGEST])
    unknown = _of_unknown_friction(model)
    for card in sorted(_measured(model)):
        for what, missing, largest_energy in missing_energies(
            state.card_history[current, card], state.cards[card]
        ):
            is_known = what != FRICTION or card not in unknown
            if is_known and abs(missing) > max(UNBALANCED * largest_energy, least):
                warnings.append(_warning(model, card, what, missing, largest_energy))
    return warnings


class Missing(NamedTuple):
    """Work of a contact card that nothing accounts for."""

    card: int
    what: str  # normal force or friction
    missing: float  # [J]

    def text(self, model: Model) -> str:
        verb = "made" if self.missing > 0.0 else "lost"
        return (
            f"the {self.what} of contact '{model.contacts[self.card]}' has {verb} "
            f"{abs(self.missing):.3g} J of it"
        )


def largest_missing(model: Model, state: State, current: int) -> Missing | None:
    """The card whose work is least accounted for; None without contacts."""
    unknown = _of_unknown_friction(model)
    every = [
        Missing(card, what, missing)
        for card in sorted(_measured(model))
        for what, missing, _ in missing_energies(
            state.card_history[current, card], state.cards[card]
        )
        if what != FRICTION or card not in unknown
    ]
    return max(every, key=lambda one: abs(one.missing), default=None)


def missing_energies(now: np.void, out: np.void) -> list[tuple[str, float, float]]:
    """For normal force and friction of a card: its name, missing energy [J] and largest energy
    exchanged [J].
    """
    pushed = now["stored"] + out["dissipated"] + now["work"] - now["initially_stored"]
    friction_loss = now["bristle_energy"] + out["friction_dissipated"] + now["friction_work"]
    return [
        ("normal force", float(pushed), float(now["largest_energy"])),
        (FRICTION, float(friction_loss), float(now["largest_friction_energy"])),
    ]


def _measured(model: Model) -> set[int]:
    """Cards whose work is known: those with laws of force."""
    pairs = [g for g in model.contact_groups if not g.is_unilateral]
    cards = {int(card) for g in pairs for card in g.parameters["card"]}
    return cards | {int(n.arrays["p"]["card"][0]) for n in model.nodal_groups}


def _of_unknown_friction(model: Model) -> set[int]:
    """Cards whose friction resists spins, the work of which methods of stages do not sum."""
    if model.integrator == "rattle":
        return set()
    spun = [g for g in model.contact_groups if not g.is_unilateral and g.resists_spin]
    return {int(card) for g in spun for card in g.parameters["card"]}


def _warning(model: Model, card: int, what: str, missing: float, largest_energy: float) -> str:
    share = 100.0 * abs(missing) / largest_energy if largest_energy > 0.0 else 100.0
    is_by_safety = model.integrator == "rattle"
    shorter = (
        "control.safety or control.step" if is_by_safety else "control.tolerance or control.step"
    )
    deep = advice_on_depth(model, card)
    helps = advice_on_gain(model, card) or f"{deep}; or halve {shorter}".removeprefix("; or ")
    verb = "made" if missing > 0.0 else "lost"
    return (
        f"contact '{model.contacts[card]}': its {what} has {verb} {abs(missing):.3g} J that "
        f"nothing accounts for, {share:.2g} % of the {largest_energy:.3g} J it stored and "
        f"dissipated; {helps}, and compare the results"
    )
