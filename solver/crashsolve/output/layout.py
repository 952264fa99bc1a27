"""The HDF5 layout of a history, with rows reserved ahead so that appending touches no metadata.

Every dataset is contiguous with `capacity` rows. A row exists once its time is not NaN, and rows
are written values first, times last, with plain file writes at fixed offsets: whatever moment the
process is killed, the file is a valid HDF5 file and its rows are whole.
"""

import os
from collections.abc import Callable, Iterator
from io import FileIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.output.channels import FAMILIES, Column, Family
from crashsolve.output.errors import OutputError

if TYPE_CHECKING:
    import h5py

FORMAT = "crashsolve history"
FORMAT_VERSION = 2
SLAB_BYTES = 1 << 24

Offsets = dict[str, int]


def create(file: "h5py.File", families: tuple[Family, ...], capacity: int) -> Offsets:
    """Lay out an empty history; returns where each dataset begins in the file, "time" included."""
    import h5py

    offsets: Offsets = {}
    time = None
    for family in families:
        group = file.create_group(family.name)
        group.attrs["meaning"] = FAMILIES[family.word]
        group.create_dataset("ids", data=family.ids, dtype=h5py.string_dtype())
        # all families share one time axis: one dataset under several names
        if time is None:
            time = reserve(group, "time", (capacity,), fill_time="ifset", fillvalue=np.nan)
            time.attrs["unit"] = "s"
            time.attrs["meaning"] = "sample times, the same in every family"
            offsets["time"] = time.id.get_offset() or 0
        else:
            group["time"] = time
        make = _column_maker(group, (capacity, len(family.ids)))
        offsets |= {f"{family.name}/{column.path}": make(column) for column in family.columns}
    return offsets


def _column_maker(group: "h5py.Group", shape: tuple[int, int]) -> Callable[[Column], int]:
    """Function that lays out a column with its unit and meaning, and returns where it begins.

    It calls HDF5 itself: a run has hundreds of columns, and h5py takes four times as long for each.
    """
    from h5py import h5a, h5d, h5p, h5s, h5t, string_dtype

    values, links = h5p.create(h5p.DATASET_CREATE), h5p.create(h5p.LINK_CREATE)
    values.set_alloc_time(h5d.ALLOC_TIME_EARLY)
    values.set_fill_time(h5d.FILL_TIME_NEVER)
    values.set_obj_track_times(False)
    links.set_create_intermediate_group(True)
    links.set_char_encoding(h5t.CSET_UTF8)
    rows, one = h5s.create_simple(shape), h5s.create(h5s.SCALAR)
    text = h5t.py_create(string_dtype(), logical=True)

    def make(column: Column) -> int:
        data = h5d.create(group.id, column.path.encode(), h5t.IEEE_F64LE, rows, values, links)
        for name, words in ((b"unit", column.unit), (b"meaning", column.meaning)):
            h5a.create(data, name, text, one).write(np.array(words, string_dtype()))
        # of a dataset without rows, which is never written, there is no place
        return data.get_offset() or 0

    return make


def copy_rows(
    old: Path, offsets: Offsets, new: Path, target: Offsets, families: tuple[Family, ...], rows: int
) -> None:
    """Copy the first `rows` rows of every dataset of an older history, within the system."""
    widths = {"time": 1}
    for family in families:
        names = (f"{family.name}/{column.path}" for column in family.columns)
        widths |= dict.fromkeys(names, len(family.ids))
    with FileIO(old) as source, FileIO(new, "r+") as copy:
        for name, width in widths.items():
            _copy_at(source, offsets[name], copy, target[name], 8 * width * rows)


def offsets_of(path: Path, families: tuple[Family, ...]) -> Offsets:
    """Where each dataset of a history begins in its file, "time" included.

    Raises OutputError for a file that another program has laid out anew.
    """
    import h5py

    names = {f"{f.name}/{c.path}": f"{f.name}/{c.path}" for f in families for c in f.columns}
    names |= {"time": f"{families[0].name}/time"}
    with h5py.File(path, "r") as file:
        datasets = {name: file[at] for name, at in names.items()}
        for data in datasets.values():
            if data.chunks or data.dtype != "<f8" or data.nbytes and data.id.get_offset() is None:
                raise OutputError(path, f"{data.name[1:]} is not contiguous, as a run writes it")
        return {name: data.id.get_offset() or 0 for name, data in datasets.items()}


def write_at(file: FileIO, offset: int, data: memoryview) -> None:
    """Write bytes at an offset; the system may take long data in several bites."""
    while data:
        written = os.pwrite(file.fileno(), data, offset)
        data, offset = data[written:], offset + written


def _copy_at(source: FileIO, begin: int, copy: FileIO, at: int, count: int) -> None:
    """Copy `count` bytes. Raises OSError where the source ends before."""
    copy.seek(at)
    while count:
        done = os.sendfile(copy.fileno(), source.fileno(), begin, count)
        if not done:
            raise OSError("the file is shorter than its datasets")
        begin, count = begin + done, count - done


def read_blocks(
    path: Path, families: tuple[Family, ...], rows: int
) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Yield (family index, times (k,), values (n_column, k, n_id)) over the first rows."""
    import h5py

    with h5py.File(path, "r") as file:
        for number, family in enumerate(families):
            group = file[family.name]
            for part in _slabs(rows, len(family.ids) * len(family.columns)):
                values = np.stack([group[column.path][part] for column in family.columns])
                yield number, group["time"][part], values


def rows_until(path: Path, families: tuple[Family, ...], last_time: float) -> int:
    """Number of rows not later than `last_time`; refuses a file of another model."""
    import h5py

    with h5py.File(path, "r") as file:
        versions = str(file.attrs.get("format")), str(file.attrs.get("format_version"))
        if versions != (FORMAT, str(FORMAT_VERSION)):
            raise OutputError(path, f"not a {FORMAT} of version {FORMAT_VERSION}")
        if sorted(file) != sorted(family.name for family in families):
            raise OutputError(path, f"holds families {sorted(file)}, not those of this run")
        for family in families:
            group = file[family.name]
            names = group.get("ids") if isinstance(group, h5py.Group) else None
            if not isinstance(names, h5py.Dataset) or h5py.check_string_dtype(names.dtype) is None:
                raise OutputError(path, f"'{family.name}' does not hold names of entities")
            if _signature(group) != (
                list(family.ids),
                sorted(column.path for column in family.columns),
            ):
                raise OutputError(path, f"entities or columns of '{family.name}' have changed")
            _refuse_malformed(path, group, family)
        # a reserved row has time NaN, which is not <= anything
        return int(np.count_nonzero(file[families[0].name]["time"][:] <= last_time))


def _refuse_malformed(path: Path, group: "h5py.Group", family: Family) -> None:
    """Raises OutputError for anything but a table of numbers for each column, and its times."""
    time = group.get("time")
    rows = time.shape if getattr(time, "ndim", 0) == 1 else None
    wanted = [("time", rows)]
    if rows is not None:
        wanted += [(column.path, (*rows, len(family.ids))) for column in family.columns]
    for name, shape in wanted:
        data = group.get(name)
        kind = getattr(getattr(data, "dtype", None), "kind", "")
        if shape is None or kind != "f" or data.shape != shape:
            raise OutputError(path, f"{family.name}/{name} is no table of a number for each time")


def reserve(
    group: "h5py.Group", name: str, shape: tuple[int, ...], kind: str = "<f8", **fill: object
) -> "h5py.Dataset":
    """Create a contiguous dataset whose position in the file is fixed at once."""
    from h5py import h5d, h5p

    properties = h5p.create(h5p.DATASET_CREATE)
    properties.set_alloc_time(h5d.ALLOC_TIME_EARLY)
    return group.create_dataset(name, shape, kind, dcpl=properties, **fill)


def _slabs(rows: int, width: int) -> Iterator[slice]:
    """Cut rows of `width` doubles into pieces of bounded memory."""
    step = max(1, SLAB_BYTES // (8 * width))
    for start in range(0, rows, step):
        yield slice(start, min(start + step, rows))


def _signature(group: "h5py.Group") -> tuple[list[str], list[str]]:
    """Entity names, and the sorted paths of all columns, of a family as written."""
    import h5py

    paths: list[str] = []
    group.visititems(
        lambda name, item: paths.append(name) if isinstance(item, h5py.Dataset) else None
    )
    return list(np.ravel(group["ids"].asstr()[()])), sorted(set(paths) - {"time", "ids"})
