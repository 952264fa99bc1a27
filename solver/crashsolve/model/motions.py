"""Curves of time that drive joints, and how many derivatives of them the kernels read."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crashsolve.deck.reading.deck import Deck

# by the field of a driver that names a curve (joints/_driven.py): accelerations are the second
# derivative of a travel, and the first of a velocity
DERIVATIVES = {"curve": 2, "velocity": 1, "acceleration": 0}


def derivatives_read(deck: "Deck") -> dict[str, int]:
    """Names of the curves that drive joints, each with the highest derivative that is read."""
    orders: dict[str, int] = {}
    for entry in deck.entries["joints"].values():
        for field, order in DERIVATIVES.items():
            name = getattr(entry.card, field, None)
            if isinstance(name, str):
                orders[name] = max(order, orders.get(name, 0))
    return orders
