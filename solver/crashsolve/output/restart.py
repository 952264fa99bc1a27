"""Restart dumps: two files in turn, so that a whole one exists at every moment.

Each dump carries a serial number and a checksum over all it holds. The newest valid dump is the
one to go on from; a broken one is passed over with a warning that says why.
"""

import hashlib
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from crashsolve.output.errors import OutputError
from crashsolve.output.files import HDF5_OPTIONS, replacing, write_metadata

FORMAT = "crashsolve restart"
FORMAT_VERSION = 1
SLOTS = ("restart_0.h5", "restart_1.h5")

Dump = tuple[dict[str, np.ndarray], dict[str, Any]]


def write_restart(folder: Path | str, arrays: dict[str, np.ndarray], info: dict[str, Any]) -> Path:
    """Write a dump over the older slot and return its path; `info` must be JSON values."""
    import h5py

    serials = {Path(folder) / slot: _serial(Path(folder) / slot) for slot in SLOTS}
    path = min(serials, key=lambda slot: serials[slot])
    text = json.dumps(info)
    with replacing(path) as partial, h5py.File(partial, "w", **HDF5_OPTIONS) as file:
        attributes = {
            "serial": max(serials.values()) + 1,
            "info": text,
            "checksum": _checksum(arrays, text),
        }
        write_metadata(file, FORMAT, FORMAT_VERSION, attributes)
        for name, array in arrays.items():
            file["arrays/" + name] = array
    return path


def newest_restart(folder: Path | str) -> Dump | None:
    """Return arrays and info of the newest valid dump, None when no slot was ever written.

    Raises OutputError when there are dumps but all are broken.
    """
    slots = [Path(folder) / slot for slot in SLOTS if (Path(folder) / slot).exists()]
    for path in sorted(slots, key=_serial, reverse=True):
        try:
            return _read(path)
        except (OSError, RuntimeError, KeyError, ValueError) as reason:
            warnings.warn(f"{path}: dump passed over: {reason}", stacklevel=2)
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

        def keep(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset):
                arrays[name] = item[()]

        file.get("arrays", {}).visititems(keep)
        text = file.attrs["info"]
        if file.attrs["checksum"] != _checksum(arrays, text):
            raise ValueError("wrong checksum")
    return arrays, json.loads(text)


def _serial(path: Path) -> int:
    """Serial number of a dump; -1 for one that is absent or unreadable."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            return int(file.attrs["serial"])
    except (OSError, RuntimeError, KeyError, ValueError):
        return -1


def _checksum(arrays: dict[str, np.ndarray], text: str) -> str:
    """Digest of names, types, shapes and bytes of the arrays, and of the info text."""
    digest = hashlib.blake2b(text.encode(), digest_size=16)
    for name in sorted(arrays):
        array = arrays[name]
        digest.update(repr((name, array.dtype.descr, array.shape)).encode())
        digest.update(array.tobytes())
    return digest.hexdigest()
