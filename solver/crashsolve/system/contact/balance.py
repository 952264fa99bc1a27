"""The balance of each contact card: what its forces have taken from both sides is held, or lost.

    lack = stored + dissipated + work of the forces on both sides

once for the normal force and once for friction. That of the whole scene may hide it: a contact
holds little of the energy of a crash.
"""

from typing import Any

import numpy as np

from crashsolve.model.ledger import LARGEST
from crashsolve.model.model import Model, State

# of the most that the normal force or the friction of a card has held and lost
UNBALANCED = 0.02
# of the largest energy of the scene: less alters nothing that is reported it
NEGLIGIBLE = 1e-5


def contact_warnings(model: Model, state: State, ledger: np.ndarray) -> list[str]:
    """Cards whose forces have done other work than what they are reported to have held and lost."""
    current, found = int(state.clock["current"][0]), []
    least = NEGLIGIBLE * float(ledger[LARGEST])
    for card in sorted(_measured(model)):
        for what, lack, handled in lacks(state.card_history[current, card], state.cards[card]):
            if abs(lack) > max(UNBALANCED * handled, least):
                found.append(_warning(model.contacts[card], what, lack, handled))
    return found


def lacks(now: Any, out: Any) -> list[tuple[str, float, float]]:
    """Of normal force and friction of a card: what it is, its lack [J], the most it handled [J]."""
    pushed = now["held"] + out["dissipated"] + now["work"] - now["held_first"]
    friction_loss = now["bristled"] + out["friction_dissipated"] + now["friction_work"]
    return [
        ("normal force", float(pushed), float(now["handled"])),
        ("friction", float(friction_loss), float(now["friction_handled"])),
    ]


def _measured(model: Model) -> set[int]:
    """Cards whose work is known: with laws of force, in steps of one force pass."""
    if model.integrator != "rattle":
        return set()
    pairs = [g for g in model.contact_groups if not g.is_unilateral]
    cards = {int(card) for g in pairs for card in g.parameters["card"]}
    return cards | {int(n.arrays["p"]["card"][0]) for n in model.nodal_groups}


def _warning(card: str, what: str, lack: float, handled: float) -> str:
    share = 100.0 * abs(lack) / handled if handled > 0.0 else 100.0
    verb = "made" if lack > 0.0 else "lost"
    return (
        f"contact '{card}': its {what} has {verb} {abs(lack):.3g} J that nothing accounts for, "
        f"{share:.2g} % of the {handled:.3g} J it held and lost; halve control.safety or "
        "control.step, and compare"
    )
