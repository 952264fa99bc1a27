"""From the State to the arrays of a restart dump, and back; what may change on going on."""

from typing import Any

import numpy as np
import yaml

from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.contact.pairs import take_pairs
from crashsolve.system.engine import Engine

# fields of control that say how to go on, and nothing of what has been
FREE_CONTROL = (
    "end_time",
    "step",
    "step_max",
    "step_min",
    "safety",
    "tolerance",
    "onset_tolerance",
    "constraint_tolerance",
    "energy_limit",
    "check_every",
    "estimate",
    "threads",
)
# of them those on which the errors of a run depend
OF_ERRORS = tuple(
    f"control.{name}"
    for name in FREE_CONTROL
    if name not in ("end_time", "energy_limit", "check_every", "estimate", "step_min", "threads")
)
FREE_CARDS = ("title", "output", "watch", "expect")
FREE = f"{', '.join(FREE_CARDS)} and of control {', '.join(FREE_CONTROL)}"


def differing(old: str, new: str) -> list[tuple[str, bool]]:
    """Where two decks (Deck.text) differ: name of a field, and whether the State is bound to it."""
    if old == new:
        return []
    decks = [yaml.load(text, yaml.CSafeLoader) for text in (old, new)]
    found = {".".join(path[:3]): _is_bound(path) for path in _paths(*decks)}
    return list(found.items())


def _is_bound(path: tuple[str, ...]) -> bool:
    if path[0] == "control":
        return path[1:2] == () or path[1] not in FREE_CONTROL
    return path[0] not in FREE_CARDS


def _paths(old: Any, new: Any, at: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Paths to values that differ; parameters count by what they are used for."""
    if not (isinstance(old, dict) and isinstance(new, dict)):
        return [] if old == new else [at]
    words = [word for word in {**old, **new} if at or word != "parameters"]
    return [p for word in words for p in _paths(old.get(word), new.get(word), (*at, str(word)))]


def changing(engine: Engine) -> dict[str, np.ndarray]:
    """Everything that changes during a run, by name, as bytes where an array has columns."""
    fixed = {name: _plain(array) for name, array in _kept_aside(engine).items()}
    lists = [
        {f"pairs/{g.word}": g.parameters, f"history/{g.word}": g.history} for g in _lists(engine)
    ]
    nodal = {
        f"{name}/{n.word}": _plain(a) for n in _nodal(engine) for name, a in n.changing().items()
    }
    return fixed | nodal | {name: _plain(array) for pair in lists for name, array in pair.items()}


def restore(engine: Engine, arrays: dict[str, np.ndarray]) -> None:
    """Take up what `changing` gave away. Writes: the State, and the lists of near pairs.

    Raises KeyError, ValueError, TypeError or IndexError for arrays of another model.
    """
    for name, array in _kept_aside(engine).items():
        found = _columns(arrays[name], array.dtype)
        if found.shape != array.shape:
            raise ValueError(f"{name} has the shape {found.shape}, not {array.shape}")
        array[...] = found
    for group in _lists(engine):
        rows = _columns(arrays[f"pairs/{group.word}"], group.parameters.dtype)
        take_pairs(group, rows, _columns(arrays[f"history/{group.word}"], group.history.dtype))
    for nodal in _nodal(engine):
        for name, array in nodal.changing().items():
            nodal.arrays[name] = _columns(arrays[f"{name}/{nodal.word}"], array.dtype)
    engine.bind()


def _kept_aside(engine: Engine) -> dict[str, np.ndarray]:
    """Arrays whose size never changes."""
    state, model = engine.state, engine.model
    arrays = {name: getattr(state, name) for name in state.__dataclass_fields__}
    arrays |= {f"history/{g.word}": g.history for g in model.groups}
    arrays |= {f"history/{c.word}": c.history for c in model.contact_groups if c.search is None}
    for c in _lists(engine):
        seen = c.search.arrays() if c.search else {}
        arrays |= {f"{name}/{c.word}": array for name, array in seen.items()}
    arrays |= model.nodal_loads
    # a sample may lie within the last step
    arrays |= engine.stages
    arrays |= {f"powers/{g.word}": g.powers for g in model.groups if g.powers is not None}
    # an implicit method may use the factors of its last step in the next
    arrays |= engine.tableau | engine.aside
    return arrays | {"saddle/columns": model.saddle.columns, "saddle/blocks": model.saddle.blocks}


def _lists(engine: Engine) -> list[ContactGroup]:
    """Contact groups whose pairs come and go."""
    return [c for c in engine.model.contact_groups if c.search is not None]


def _nodal(engine: Engine) -> list[Any]:
    """Groups of nodal contact."""
    return engine.model.nodal_groups


def _plain(array: np.ndarray) -> np.ndarray:
    """Bytes in place of columns, for a file that need not know them."""
    if array.dtype.names is None:
        return array
    return array.view(np.uint8).reshape(*array.shape, array.dtype.itemsize)


def _columns(array: np.ndarray, dtype: Any) -> np.ndarray:
    """Columns in place of bytes."""
    return array if dtype.names is None else array.view(dtype)[..., 0]
