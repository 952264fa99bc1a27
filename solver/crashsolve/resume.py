"""From the State to the arrays of a restart dump, and back."""

from typing import Any

import numpy as np

from crashsolve.model.model import ContactGroup
from crashsolve.system.engine import Engine


def changing(engine: Engine) -> dict[str, np.ndarray]:
    """Everything that changes during a run, by name, as bytes where an array has columns."""
    fixed = {name: _plain(array) for name, array in _kept_in_place(engine).items()}
    lists = [
        {f"pairs/{g.word}": g.parameters, f"history/{g.word}": g.history} for g in _lists(engine)
    ]
    nodal = {
        f"{name}/{n.word}": _plain(a) for n in _nodal(engine) for name, a in n.changing().items()
    }
    return fixed | nodal | {name: _plain(array) for pair in lists for name, array in pair.items()}


def restore(engine: Engine, arrays: dict[str, np.ndarray]) -> None:
    """Take up what `changing` gave away. Writes: the State, and the lists of near pairs."""
    for name, array in _kept_in_place(engine).items():
        array[...] = _columns(arrays[name], array.dtype)
    for group in _lists(engine):
        group.parameters = _columns(arrays[f"pairs/{group.word}"], group.parameters.dtype)
        group.history = _columns(arrays[f"history/{group.word}"], group.history.dtype)
        group.output = np.zeros(len(group.parameters), group.output.dtype)
    for nodal in _nodal(engine):
        for name, array in nodal.changing().items():
            nodal.arrays[name] = _columns(arrays[f"{name}/{nodal.word}"], array.dtype)
    engine.bind()


def _kept_in_place(engine: Engine) -> dict[str, np.ndarray]:
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
    # an implicit method may use the factors of its last step in the next
    arrays |= engine.tableau
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
