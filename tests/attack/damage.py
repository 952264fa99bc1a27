"""Damages HDF5 files by their structure: what is left is valid HDF5 of wrong shapes and types."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

Damage = Callable[[h5py.File], None]


def damages(path: Path) -> Iterator[tuple[str, Damage]]:
    """Every damage of every dataset, group and attribute of a file, in words and as a deed."""
    items: list[tuple[str, bool]] = []
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: items.append((name, isinstance(item, h5py.Dataset))))
        attributes = list(file.attrs)
    for name, is_dataset in items:
        for word, values in WRONG.items() if is_dataset else ():
            yield f"{name}: {word}", _replaced(name, values)
        yield f"{name}: deleted", lambda file, name=name: file.__delitem__(name)
        if is_dataset:
            yield f"{name}: a group", _as_group(name)
        else:
            yield f"{name}: a number", _replaced(name, lambda _: 3.0)
    for name in attributes:
        yield f"@{name}: deleted", lambda file, name=name: file.attrs.__delitem__(name)
        for value in ("[]", "{}", '{"bodies": 3}', "[[1, 2], 3]", "[0, 0, 0]", 7, np.arange(3.0)):
            yield f"@{name}: {value!r}", _attribute(name, value)


# another content for a dataset that was an array
WRONG: dict[str, Callable[[Any], Any]] = {
    "a number": lambda _: 1.0,
    "text": lambda _: np.array([b"abc", b"d"]),
    "empty": lambda old: np.zeros((0, *old.shape[1:]), old.dtype),
    "shorter": lambda old: old[: len(old) // 2],
    "longer": lambda old: np.concatenate([old, old, old[:1]]),
    "one axis more": lambda old: old[..., None],
    "flat": lambda old: np.ravel(old),
    "complex": lambda old: np.full(old.shape, 1j),
    "negative": lambda old: np.full(old.shape, -5.0),
    "huge": lambda old: np.full(old.shape, 1e300),
    "not numbers": lambda old: np.full(old.shape, np.nan),
    "large whole numbers": lambda old: np.full(old.shape, 2**40),
}


def _replaced(name: str, values: Callable[[Any], Any]) -> Damage:
    def change(file: h5py.File) -> None:
        old = file[name]
        was = old[...] if isinstance(old, h5py.Dataset) else np.zeros((2, 3))
        if was.dtype.kind not in "fiu" or not was.ndim:
            was = np.zeros((2, 3))
        del file[name]
        file[name] = values(was)

    return change


def _as_group(name: str) -> Damage:
    def change(file: h5py.File) -> None:
        del file[name]
        file.create_group(name)

    return change


def _attribute(name: str, value: object) -> Damage:
    def change(file: h5py.File) -> None:
        file.attrs[name] = value

    return change
