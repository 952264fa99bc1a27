"""A small history whose every number is known, shared by the tests of this folder."""

from pathlib import Path

import h5py
import numpy as np

from crashsolve.output.channels import Column, Family
from crashsolve.output.history import HistoryWriter

FAMILIES = (
    Family(
        "glstat",
        ("model",),
        (
            Column("energy", "kinetic", "J", "kinetic energy"),
            Column("energy", "total", "J", "total energy"),
            Column("step", "", "s", "time step"),
        ),
    ),
    Family(
        "rbdout",
        ("wagon_a", "wagon_b", "wagon_c"),
        (Column("position", "x", "m", "mass centre"), Column("velocity", "x", "m/s", "")),
    ),
)


def sample_row(row: int) -> dict[str, np.ndarray]:
    """Values of one row, every number different from all others of its column."""
    return {
        "glstat": np.array([[row, -row, 1 / (row + 1)]]),
        "rbdout": np.array([[row + 0.1, row], [row + 0.2, 2 * row], [row + 0.3, 3 * row]]),
    }


def appended(writer: HistoryWriter, time: float, values: dict[str, np.ndarray]) -> None:
    """Append one row, whose arrays are (n_id, n_column)."""
    writer.append(np.array([time]), {name: block[None] for name, block in values.items()})


def sample_time(row: int) -> float:
    """Time of one row."""
    return 1e-3 * row


def read_rows(path: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Read a history as FILE_FORMAT.md says: times, and (n_time, n_id) by dataset name."""
    with h5py.File(path, "r") as file:
        times = file["glstat/time"][:]
        rows = np.count_nonzero(times == times)
        names = [f"{family.name}/{c.path}" for family in FAMILIES for c in family.columns]
        return times[:rows], {name: file[name][:rows] for name in names}


def assert_is_sample(path: Path, at_least: int) -> int:
    """Check that a file holds the first rows of the sample, each whole; returns their number."""
    times, data = read_rows(path)
    rows = len(times)
    assert rows >= at_least
    np.testing.assert_array_equal(times, [sample_time(row) for row in range(rows)])
    for family in FAMILIES:
        for position, column in enumerate(family.columns):
            wanted = [sample_row(row)[family.name][:, position] for row in range(rows)]
            shape = (rows, len(family.ids))
            np.testing.assert_array_equal(
                data[f"{family.name}/{column.path}"], np.reshape(wanted, shape)
            )
    return rows
