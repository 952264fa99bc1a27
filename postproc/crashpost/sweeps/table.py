"""The runs of a sweep as one table: their values, their outcome, and their measures.

A measure counts only of a run that has finished and was made as sweep.json states: the cell of
any other run is empty, and its message states the cause. The table is the same whether the sweep
was interrupted or not.
"""

import csv
import hashlib
import io
import json
import os
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isfinite, nan
from pathlib import Path

from crashpost.errors import PostError
from crashpost.results.answer import answer
from crashpost.results.result import Result
from crashpost.results.status import Json, read_status
from crashpost.results.text import plain_text
from crashpost.values.accuracy import error_of
from crashsolve.channels.display import factor

FORMAT, FORMAT_VERSION = "crashsolve sweep", 1
CSV, PARQUET = "sweep.csv", "sweep.parquet"
AUTO = "auto-"
_METHOD = re.compile(r"(?m)^  integrator: .*\n")


@dataclass(frozen=True)
class Axis:
    """A varied parameter; `is_of_numbers` where its values can stand on an axis."""

    name: str
    unit: str
    is_of_numbers: bool
    scale: str

    @property
    def heading(self) -> str:
        """Name with the unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@dataclass
class Measure:
    """A number computed for every run; a unit that the plan does not name is known from an
    answer.
    """

    name: str
    question: Json
    unit: str = ""

    @property
    def heading(self) -> str:
        """Name with the unit."""
        return f"{self.name} [{self.unit}]" if self.unit not in ("", "1") else self.name


@dataclass
class Row:
    """One run; NaN stands for a number that there is not."""

    number: int
    values: list[float | str]
    state: str
    message: str = ""
    measured: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)


@dataclass
class Sweep:
    """All runs of a sweep in order; `design` states how their values were chosen."""

    folder: Path
    title: str
    design: str
    axes: list[Axis]
    measures: list[Measure]
    rows: list[Row]

    @property
    def finished(self) -> list[Row]:
        """The runs whose measures count."""
        return [row for row in self.rows if row.state == "finished"]

    def has_errors(self, at: int) -> bool:
        """Whether any run estimated the error of measure number `at`."""
        return any(isfinite(row.errors[at]) for row in self.rows)


def read(folder: Path) -> Sweep:
    """The sweep in a folder. Raises PostError where there is none."""
    path = folder / "sweep.json"
    data = _table(path)
    if data.get("format") != FORMAT:
        raise PostError(f"{path}: no sweep; name the folder that crashsolve sweep has made")
    if data.get("format_version") != FORMAT_VERSION:
        raise PostError(f"{path}: version {data.get('format_version')} is not known here")
    try:
        axes = [Axis(**entry) for entry in data["axes"]]
        measures = [
            Measure(str(entry["name"]), entry, str(entry.get("unit") or ""))
            for entry in data["measures"]
        ]
        rows = [_row(folder, entry, axes, measures) for entry in data["runs"]]
        return Sweep(folder, str(data["title"]), str(data["design"]), axes, measures, rows)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise PostError(f"{path}: not as FILE_FORMAT.md has it ({error!r})") from error


def _row(sweep: Path, entry: Json, axes: list[Axis], measures: list[Measure]) -> Row:
    folder = sweep / str(entry["folder"])
    texts = [str(entry["values"][axis.name]) for axis in axes]
    values = [_number(t) if a.is_of_numbers else t for t, a in zip(texts, axes, strict=True)]
    state, message = _state(folder, entry["mark"])
    row = Row(int(entry["number"]), values, state, message)
    row.measured, row.errors = [nan] * len(measures), [nan] * len(measures)
    if state == "finished":
        _measure(row, folder, measures)
    return row


def _number(text: str) -> float:
    """The number of a value such as "12.5 km/h"."""
    match = re.match(r"\s*[-+0-9.eE]+", text)
    if match is None:
        raise ValueError(f"'{text}' is no number")
    return float(match[0])


def _state(folder: Path, mark: dict[str, str]) -> tuple[str, str]:
    """State of a run, and why."""
    note, status = _table(folder / "run.json"), read_status(folder / "status.json")
    state, message = str(status["state"]), str(status.get("message", ""))
    if not note:
        return ("stale", "unknown results") if state != "unknown" else ("new", "")
    if note.get("mark") != mark:
        return "stale", "of another deck, other values or another version"
    if state == "finished":
        code = status.get("exit_code")
        return ("finished", "") if code == 0 else ("failed", f"exit code {code}: {message}")
    if state == "unknown":
        is_known = note.get("state") in ("failed", "stopped", "killed")
        return (str(note["state"]) if is_known else "new"), str(note.get("message", ""))
    if state == "killed" and note.get("state") in ("stopped", "killed"):
        # the process that ran the sweep has the reason
        return str(note["state"]), str(note.get("message", ""))
    return state, message


def _measure(row: Row, folder: Path, measures: list[Measure]) -> None:
    """Fill in the results of a finished run. Writes: row, units of measures."""
    try:
        result = Result(folder)
        text = str(result.attributes.get("deck_text", ""))
    except PostError as error:
        row.state, row.message = "stale", f"damaged results: {error}"
        return
    mark = str(_table(folder / "run.json")["mark"]["deck"])
    if _text_mark(text, mark.startswith(AUTO)) != mark:
        row.state, row.message = "stale", "of another deck or other values"
        return
    remarks = []
    for at, measure in enumerate(measures):
        requested = measure.question
        channel, word = str(requested["channel"]), str(requested["statistic"])
        during = (
            (requested["during"][0], requested["during"][1]) if requested.get("during") else None
        )
        try:
            reply = answer(result, channel, word, during)
            size = factor(reply.unit, requested.get("unit") or reply.unit)
        except (PostError, ValueError, LookupError, OverflowError) as error:
            remarks.append(f"{measure.name}: {error}")
            continue
        remarks += [f"{measure.name}: {reply.remark}"] if reply.remark else []
        measure.unit = str(requested.get("unit") or reply.unit)
        row.measured[at] = reply.value * size
        estimate = error_of(result, channel, word, during)
        row.errors[at] = nan if estimate is None else estimate * size
    row.message = "; ".join(remarks)


def _text_mark(text: str, is_auto: bool) -> str:
    """Hash of the text of a deck, without the method where the run has chosen it."""
    selected = _METHOD.sub("", text) if is_auto else text
    return is_auto * AUTO + hashlib.sha256(selected.encode()).hexdigest()[:16]


def _table(path: Path) -> Json:
    """The table in a JSON file; empty without one."""
    try:
        content = json.loads(plain_text(path) or "")
    except (ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def columns(sweep: Sweep) -> Iterator[tuple[str, list[object]]]:
    """Headings and cells of the table; estimated errors stand beside their measures."""
    rows = sweep.rows
    yield "run", [row.number for row in rows]
    for at, axis in enumerate(sweep.axes):
        yield axis.heading, [row.values[at] for row in rows]
    for at, measure in enumerate(sweep.measures):
        yield measure.heading, [row.measured[at] for row in rows]
        if sweep.has_errors(at):
            yield f"{measure.name} +- [{measure.unit}]", [row.errors[at] for row in rows]
    yield "state", [row.state for row in rows]
    yield "message", [row.message for row in rows]


def write(sweep: Sweep) -> list[Path]:
    """Write the table as CSV, and as Parquet where pandas and pyarrow are. Raises PostError."""
    named = list(columns(sweep))
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([heading for heading, _ in named])
    for cells in zip(*(cells for _, cells in named), strict=True):
        writer.writerow([_cell(cell) for cell in cells])
    path, other = sweep.folder / CSV, sweep.folder / PARQUET
    try:
        # an older one must not be taken for this one
        other.unlink(missing_ok=True)
        partial = path.with_name(f"{CSV}.{os.getpid()}")
        partial.write_text(stream.getvalue(), encoding="utf-8")
        os.replace(partial, path)
        return [path, other] if _write_parquet(other, named) else [path]
    except OSError as error:
        raise PostError(f"{path}: {error.strerror}") from error


def _cell(value: object) -> str:
    if isinstance(value, float):
        return repr(value) if isfinite(value) else ""
    return str(value)


def _write_parquet(path: Path, named: list[tuple[str, list[object]]]) -> bool:
    try:
        import pandas
        import pyarrow  # noqa: F401
    except ImportError:
        return False
    partial = path.with_name(f"{PARQUET}.{os.getpid()}")
    pandas.DataFrame(dict(named)).to_parquet(partial)
    os.replace(partial, path)
    return True


def unanswered(sweep: Sweep) -> list[str]:
    """Measures that no finished run has a value of; none while no run has finished."""
    rows = sweep.finished
    measures = enumerate(sweep.measures) if rows else ()
    return [m.name for at, m in measures if not any(isfinite(row.measured[at]) for row in rows)]


def summary(sweep: Sweep, paths: list[Path]) -> str:
    """Summary of the table in a few lines: states, and each problem of a measure once."""
    counts = Counter(row.state for row in sweep.rows)
    states = ", ".join(f"{n} {state}" for state, n in sorted(counts.items()))
    lines = [f"{', '.join(map(str, paths))}: {len(sweep.rows)} runs, {states}"]
    problems = Counter(row.message for row in sweep.finished if row.message)
    lines += [f"  {n} runs: {text}" for text, n in problems.most_common(8)]
    return "\n".join(lines)
