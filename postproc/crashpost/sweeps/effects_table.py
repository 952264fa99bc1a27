"""Main effects and Sobol indices as tables: `effects.csv`, `indices.csv`, and as text."""

import csv
import io
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from crashpost.errors import PostError
from crashpost.results.table import number, text_table
from crashpost.sweeps.effects import Indices, indices, main_effect
from crashpost.sweeps.table import Sweep

EFFECTS, INDICES = "effects.csv", "indices.csv"
# rows that a terminal is shown; the files have all
MAX_ROWS = 40
EFFECTS_HEADER = ("measure", "parameter", "value or mean of class", "mean", "+-", "runs")
INDICES_HEADER = (
    *("measure", "parameter"),
    *("first order", "first order +-", "total", "total +-", "blocks"),
)

Rows = list[list[str]]


def effects_rows(sweep: Sweep) -> Rows:
    """A row for each value, or class of values, of each parameter, for each measure."""
    rows = []
    for i, measure in enumerate(sweep.measures):
        good = [row for row in sweep.finished if isfinite(row.measured[i])]
        for j, axis in enumerate(sweep.axes):
            effect = main_effect([row.values[j] for row in good], [row.measured[i] for row in good])
            for at, mean, error, count in zip(
                effect.at, effect.means, effect.errors, effect.counts, strict=True
            ):
                value = at if isinstance(at, str) else number(at)
                numbers = [value, number(mean), _error(error), str(count)]
                rows.append([measure.heading, axis.heading, *numbers])
    return rows


def indices_rows(sweep: Sweep) -> Rows:
    """A row for each parameter and measure that has indices, with halves of 95 % intervals."""
    if sweep.design != "saltelli":
        return []
    rows = []
    for i, measure in enumerate(sweep.measures):
        analysis = indices(sweep, i)
        if isinstance(analysis, Indices):
            columns = (analysis.first, analysis.first_errors, analysis.total, analysis.total_errors)
            rows += [
                [measure.name, axis.name, *(f"{column[j]:.4f}" for column in columns)]
                + [str(analysis.blocks)]
                for j, axis in enumerate(sweep.axes)
            ]
    return rows


def write_tables(sweep: Sweep, folder: Path) -> list[str]:
    """Write both tables; returns their paths and, where they are short, their text.

    Raises PostError.
    """
    texts = []
    tables = (
        (EFFECTS, EFFECTS_HEADER, effects_rows(sweep)),
        (INDICES, INDICES_HEADER, indices_rows(sweep)),
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, header, rows in tables:
            path = folder / name
            # one of another design must not be taken for one of this
            path.unlink(missing_ok=True)
            if rows:
                path.write_text(_csv(header, rows), encoding="utf-8")
                texts.append(str(path))
                texts += [text_table(header, rows)] if len(rows) <= MAX_ROWS else []
    except OSError as error:
        raise PostError(f"{folder}: {error.strerror}") from error
    return texts


def _error(error: float) -> str:
    """A standard error; - of a single run, which has none."""
    return number(error) if isfinite(error) else "-"


def _csv(header: Sequence[str], rows: Rows) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([header, *rows])
    return stream.getvalue()
