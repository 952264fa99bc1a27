"""Numbers of a built model that are none: products and quotients beyond those of a machine.

A stiffness of 1e200 squared, or an inertia of 1e-300 inverted, would only show in the first step,
and as a fault of that step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from pydantic import BaseModel

from crashsolve.deck.fields import declared
from crashsolve.foundation.errors import DeckError, DeckErrors

if TYPE_CHECKING:
    from collections.abc import Callable

    from crashsolve.deck.reading.deck import Deck
    from crashsolve.deck.reading.items import Entry
    from crashsolve.model.model import Model, State

BEYOND = ("its numbers are too large or too small to compute with", "check powers and units")
# of a model: the fourth power of more is beyond a machine, and that of a stiffness with it [m]
LONGEST = 1e40
# the square of more in a sum with such powers is beyond a machine [kg]; the universe has 1e53 kg
HEAVIEST = 1e60
# of velocities that a deck starts with [m/s, rad/s]: light has 3e8 m/s
FASTEST = 1e12
# exceptions of Python and its libraries for them
BEYOND_NUMBERS = (ArithmeticError, np.linalg.LinAlgError)


def refuse_beyond(deck: Deck, model: Model, state: State) -> None:
    """Raise DeckErrors naming the cards whose numbers came out as none."""
    errors = [*_too_large(deck), *_too_fast(deck)]
    for group in model.groups:
        entries = deck.entries[group.keyword]
        for i in _rows_without_numbers(group.parameters):
            # an element has the name of its part
            owner = next((e for n, e in entries.items() if _is_of(group.names[i], n)), None)
            errors.append(deck.error(owner, None, *BEYOND) if owner else of_model(deck))
    for i in _rows_without_numbers(state.nodes, np.isfinite):
        name = model.bodies[i]
        entry = deck.entries["bodies"].get(name)
        errors.append(deck.error(entry, None, *BEYOND) if entry else of_model(deck, f"'{name}'"))
    is_wrong = (
        len(_rows_without_numbers(state.points, np.isfinite)) or not np.isfinite(state.blocks).all()
    )
    if not errors and is_wrong:
        errors.append(of_model(deck, "the shells"))
    if errors:
        raise DeckErrors({str(error): error for error in errors}.values())


def _sizes(value: object) -> Iterator[float]:
    """Magnitudes of the numbers of a field; infinity may be meant."""
    if isinstance(value, float | int) and math.isfinite(value):
        yield abs(value)
    elif isinstance(value, tuple | list):
        for one in value:
            yield from _sizes(one)


def _larger(deck: Deck, units: tuple[str, ...], most: float) -> Iterator[tuple[Entry, str, str]]:
    """Cards, fields and units of numbers in these units that are larger than `most`."""
    for entries in deck.entries.values():
        for entry in entries.values():
            kind: type[BaseModel] = type(entry.card)
            for name in kind.model_fields:
                unit = declared(kind, name).unit
                if unit in units and max(_sizes(getattr(entry.card, name)), default=0.0) > most:
                    yield entry, name, unit


def _too_large(deck: Deck) -> Iterator[DeckError]:
    """Cards with lengths or masses whose powers overflow."""
    for unit, most, what in (("m", LONGEST, "length"), ("kg", HEAVIEST, "mass")):
        for entry, name, _ in _larger(deck, (unit,), most):
            advice = f"give a {what} that a run can compute with; check powers and units"
            yield deck.error(entry, name, f"is a {what} of more than {most:g} {unit}", advice)


def _too_fast(deck: Deck) -> Iterator[DeckError]:
    """Cards with velocities so large that a run would stop in its first step.

    Rates that laws refer to may be as large as they like.
    """
    for entry, name, unit in _larger(deck, ("m/s", "rad/s"), FASTEST):
        if name.endswith("velocity"):
            message = f"is more than {FASTEST:g} {unit}"
            yield deck.error(
                entry, name, message, "give a smaller velocity; check powers and units"
            )


def of_model(deck: Deck, what: str = "the model") -> DeckError:
    """The error without a card of its own."""
    return DeckError(str(deck.path), None, None, what, *BEYOND)


def _is_of(name: str, owner: str) -> bool:
    return name == owner or name.startswith(f"{owner}_")


def _is_number(column: np.ndarray) -> np.ndarray:
    """Of parameters of laws, infinity may be meant."""
    return ~np.isnan(column)


def _rows_without_numbers(
    table: np.ndarray, is_sound: Callable[[np.ndarray], np.ndarray] = _is_number
) -> np.ndarray:
    """Rows with a column that is no number."""
    wrong = np.zeros(len(table), bool)
    for name in table.dtype.names or ():
        column = table[name]
        if column.dtype.kind == "f":
            wrong |= (~is_sound(column)).any(axis=tuple(range(1, column.ndim)))
    return np.flatnonzero(wrong)
