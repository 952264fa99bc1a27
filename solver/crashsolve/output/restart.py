"""Restart dumps: two files in turn, so that a whole one exists at every moment.

Each dump carries a serial number and a checksum over all it holds. The newest valid dump is the
one to continue from; a broken one is skipped and the reason reported.
"""

import hashlib
import json
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from crashsolve.output.errors import OutputError
from crashsolve.output.files import Json, replacing_hdf5, write_metadata

FORMAT = "crashsolve restart"
FORMAT_VERSION = 2
SLOTS = ("restart_0.h5", "restart_1.h5")

Dump = tuple[dict[str, np.ndarray], Json]


def write_restart(folder: Path | str, arrays: dict[str, np.ndarray], info: Json) -> Path:
    """Write a dump over the older slot and return its path; `info` must be JSON values.

    Flush the history first: rows before the dump that were not flushed are lost to a kill.
    """
    serials = {Path(folder) / slot: _serial(Path(folder) / slot, -1) for slot in SLOTS}
    path = min(serials, key=lambda slot: serials[slot])
    text = json.dumps(info)
    with replacing_hdf5(path) as file:
        attributes = {
            "serial": max(serials.values()) + 1,
            "info": text,
            "checksum": _checksum(arrays, text),
        }
        write_metadata(file, FORMAT, FORMAT_VERSION, attributes)
        group = file.create_group("arrays")
        for name, array in arrays.items():
            group[name] = array
    return path


def newest_restart(folder: Path | str, warn: Callable[[str], None] = warnings.warn) -> Dump | None:
    """Return arrays and info of the newest valid dump, None when no slot was ever written.

    Reports `warn` why a dump is passed over; raises OutputError when all of them are broken.
    """
    slots = [Path(folder) / slot for slot in SLOTS if (Path(folder) / slot).exists()]
    # an unreadable dump is tried first, so that it is reported
    for path in sorted(slots, key=lambda slot: _serial(slot, sys.maxsize), reverse=True):
        try:
            return _read(path)
        # whatever HDF5, h5py and numpy raise over a damaged file
        except Exception as reason:
            warn(f"{path}: dump skipped: {reason}")
    if slots:
        raise OutputError(folder, "no valid restart dump: all of them are broken")
    return None


def _read(path: Path) -> Dump:
    """Read and verify one dump; raises ValueError for another format or a wrong checksum."""
    import h5py

    with h5py.File(path, "r") as file:
        if file.attrs["format"] != FORMAT or file.attrs["format_version"] != FORMAT_VERSION:
            raise ValueError(f"not a {FORMAT} of version {FORMAT_VERSION}")
        arrays: dict[str, np.ndarray] = {}

        def keep(name: str, item: object) -> None:
            if isinstance(item, h5py.Dataset):
                arrays[name] = np.asarray(item[()])

        file["arrays"].visititems(keep)
        text = file.attrs["info"]
        if file.attrs["checksum"] != _checksum(arrays, text):
            raise ValueError("wrong checksum")
    info = json.loads(text)
    if not isinstance(info, dict):
        raise ValueError("it reports no deck")
    return arrays, info


def _serial(path: Path, unreadable: int) -> int:
    """Serial number of a dump, or the given number for one that is absent or unreadable."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            return int(file.attrs["serial"])
    except Exception:
        return unreadable


def _checksum(arrays: dict[str, np.ndarray], text: str) -> str:
    """Digest of names, types, shapes and bytes of the arrays, and of the info text."""
    digest = hashlib.blake2b(text.encode(), digest_size=16)
    for name in sorted(arrays):
        array = arrays[name]
        digest.update(repr((name, array.dtype.descr, array.shape)).encode())
        digest.update(array.tobytes())
    return digest.hexdigest()
