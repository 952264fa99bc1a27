"""Histories for other programs: comma-separated values, Parquet, ISO-MME, by the file's ending."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from crashpost.errors import PostError
from crashpost.results.choice import channels
from crashpost.results.result import Result
from crashpost.results.whole_file import whole_file
from crashsolve.channels.series import Series


def export(result: Result, path: Path, words: Sequence[str]) -> int:
    """Write time and all channels that the words name, exactly; returns their number.

    Raises PostError for a word that names none, for an expression without a value somewhere, and
    for an ending that is none of FORMATS.
    """
    names = channels(result, words)
    series = {name: result.series(name) for name in names}
    for name, one in series.items():
        if not np.isfinite(one.values).all():
            raise PostError(f"division by zero at some samples of '{name}'")
    if not len(result.time):
        raise PostError(f"{result.folder} holds no samples")
    write = FORMATS.get(path.suffix.lower())
    if write is None:
        raise PostError(f"{path}: name a file that ends in {', '.join(FORMATS)}")
    write(result, path, series)
    return len(names)


def _write_csv(result: Result, path: Path, series: dict[str, Series]) -> None:
    """A row for each sample; units in brackets behind the names."""
    columns = [one.values.tolist() for one in series.values()]
    heads = [f"{name} [{one.unit or '-'}]" for name, one in series.items()]
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *heads])
        writer.writerows(zip(result.time.tolist(), *columns, strict=True))


def _write_parquet(result: Result, path: Path, series: dict[str, Series]) -> None:
    """A column for each channel over the index time; units in `attrs` and in the schema."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        text = "Parquet needs pandas and pyarrow: pip install 'crashsolve[frame]'"
        raise PostError(text) from None
    from crashpost.results.frame import frame

    table = pa.Table.from_pandas(frame(result, list(series)))
    # other readers than pandas find each unit at its column
    for at, field in enumerate(table.schema):
        unit = "s" if field.name == "time" else series[field.name].unit
        column = table.column(at)
        table = table.set_column(at, field.with_metadata({"unit": unit}), column)
    with whole_file(path) as partial:
        pq.write_table(table, partial)


def _write_mme(result: Result, path: Path, series: dict[str, Series]) -> None:
    from crashpost.exports.mme import write_mme

    try:
        write_mme(result, path, series)
    except OSError as error:
        raise PostError(f"{path}: {error.strerror or error}") from error


FORMATS: dict[str, Callable[[Result, Path, dict[str, Series]], None]] = {
    ".csv": _write_csv,
    ".parquet": _write_parquet,
    ".mme": _write_mme,
}
