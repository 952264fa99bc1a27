"""Arrays that restore the State, of a restart dump or of the last sample."""

import numpy as np

from crashsolve.model.contact.groups import ContactGroup, NodalGroup
from crashsolve.model.contact.pairs import take_pairs
from crashsolve.system.engine import Engine

# [bytes] of a snapshot
MAX_BYTES = 1 << 26


def changing(engine: Engine) -> dict[str, np.ndarray]:
    """Everything that changes during a run, by name, as bytes where an array has columns."""
    fixed = {name: _plain(array) for name, array in _constant_arrays(engine).items()}
    lists = [
        {f"pairs/{g.word}": g.parameters, f"history/{g.word}": g.history} for g in _lists(engine)
    ]
    nodal = {
        f"{name}/{n.word}": _plain(a) for n in _nodal(engine) for name, a in n.changing().items()
    }
    return fixed | nodal | {name: _plain(array) for pair in lists for name, array in pair.items()}


def restore(engine: Engine, arrays: dict[str, np.ndarray]) -> None:
    """Restore the arrays of `changing`. Writes: the State, and the lists of near pairs.

    Raises KeyError, ValueError, TypeError or IndexError for arrays of another model.
    """
    for name, array in _constant_arrays(engine).items():
        columns = _columns(arrays[name], array.dtype)
        if columns.shape != array.shape:
            raise ValueError(f"{name} has the shape {columns.shape}, not {array.shape}")
        array[...] = columns
    for group in _lists(engine):
        rows = _columns(arrays[f"pairs/{group.word}"], group.parameters.dtype).copy()
        history = _columns(arrays[f"history/{group.word}"], group.history.dtype).copy()
        take_pairs(group, rows, history)
    for nodal in _nodal(engine):
        for name, array in nodal.changing().items():
            # the step goes on in it, and the restored state may be needed again
            nodal.arrays[name] = _columns(arrays[f"{name}/{nodal.word}"], array.dtype).copy()
    engine.bind()
    engine.after_restore()


def _constant_arrays(engine: Engine) -> dict[str, np.ndarray]:
    """Arrays whose size never changes."""
    state, model = engine.state, engine.model
    arrays = {name: getattr(state, name) for name in state.__dataclass_fields__}
    arrays |= {f"history/{g.word}": g.history for g in model.groups}
    # the work of a load in the first half of a step is that of the force with which it begins
    loads = [g for g in model.groups if hasattr(g.module, "present")]
    arrays |= {f"output/{g.word}": g.output for g in loads}
    arrays |= {f"history/{c.word}": c.history for c in model.contact_groups if c.search is None}
    for c in _lists(engine):
        tables = c.search.arrays() if c.search else {}
        arrays |= {f"{name}/{c.word}": array for name, array in tables.items()}
    for c in model.contact_groups:
        if c.body_pairs is not None:
            arrays[f"body_pairs/{c.word}"] = c.body_pairs
    arrays |= model.nodal_loads
    # a sample may lie within the last step
    arrays |= engine.stages
    arrays |= {f"powers/{g.word}": g.powers for g in model.groups if g.powers is not None}
    # an implicit method may use the factors of its last step in the next
    arrays |= engine.tableau | engine.aside
    return arrays | {"saddle/columns": model.saddle.columns, "saddle/blocks": model.saddle.blocks}


def _lists(engine: Engine) -> list[ContactGroup]:
    """Contact groups with lists of near pairs."""
    return [c for c in engine.model.contact_groups if c.search is not None]


def _nodal(engine: Engine) -> list[NodalGroup]:
    """Groups of nodal contact."""
    return engine.model.nodal_groups


def _plain(array: np.ndarray) -> np.ndarray:
    """Bytes in place of columns, for a file without their definitions."""
    if array.dtype.names is None:
        return array
    return array.view(np.uint8).reshape(*array.shape, array.dtype.itemsize)


def _columns(array: np.ndarray, dtype: np.dtype) -> np.ndarray:
    """Columns in place of bytes."""
    return array if dtype.names is None else array.view(dtype)[..., 0]


class Snapshot:
    """A copy of all that changes, in memory."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._arrays: dict[str, np.ndarray] = {}
        # where copies go: they become the snapshot when they have been made
        self._targets: dict[str, np.ndarray] = {}
        self._pieces: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        # number of the binding of arrays to which the copies belong
        self._bound = -1
        arrays = changing(engine).values()
        # lists of nodes and faces are renewed by the step itself
        self.is_copied = not _nodal(engine) and all(a.flags.c_contiguous for a in arrays)

    def pieces(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Copies to be made, from and to, in bytes, as numpy copies columns one by one.

        No pair of bodies is skipped in a new copy: none has a history there yet.

        Tables may be bound anew within an interval: what its begin has stored stays as it is.
        """
        if self._bound != self.engine.bindings:
            now = changing(self.engine)
            # a list that is empty now may have pairs when this copy is restored
            self._targets = {name: np.zeros_like(a) for name, a in now.items()}
            self._pieces = {
                n: (_bytes(a), _bytes(self._targets[n])) for n, a in now.items() if a.size
            }
            self._bound = self.engine.bindings
        return self._pieces

    def note_copies(self) -> None:
        """All of `pieces` have been copied."""
        self._arrays = self._targets

    def take(self) -> None:
        """Store the present arrays."""
        if not self.is_copied:
            kept = self._arrays
            self._arrays = {n: _copy(a, kept.get(n)) for n, a in changing(self.engine).items()}
            return
        for now, kept in self.pieces().values():
            kept[...] = now
        self.note_copies()

    def arrays(self) -> dict[str, np.ndarray]:
        """Copied arrays by name."""
        return self._arrays

    def recall(self, arrays: dict[str, np.ndarray]) -> None:
        """Restore the values of `arrays` of another snapshot."""
        self._arrays = dict(arrays)

    def restore_copy(self) -> None:
        """Restore the stored arrays."""
        # outputs of separated pairs, which samples skip
        for group in self.engine.model.contact_groups:
            for name in ("force", "stored", "friction_stored", "bound"):
                group.output[name] = 0.0
            if group.applied is not None:
                group.applied[...] = 0
        if self._arrays is self._targets and self._bound == self.engine.bindings:
            for now, kept in self._pieces.values():
                now[...] = kept
            self.engine.after_restore()
            return
        restore(self.engine, self._arrays)


def _copy(array: np.ndarray, earlier: np.ndarray | None) -> np.ndarray:
    """A copy of an array, in place of an earlier one where that has its size: new memory from the
    system costs three times as much as the copy.
    """
    if earlier is None or (earlier.shape, earlier.dtype) != (array.shape, array.dtype):
        return array.copy()
    earlier[...] = array
    return earlier


def _bytes(array: np.ndarray) -> np.ndarray:
    return array.reshape(-1).view(np.uint8)


def is_cheap(engine: Engine) -> bool:
    """Whether a model is small enough for a snapshot at every sample."""
    return sum(array.nbytes for array in changing(engine).values()) < MAX_BYTES
