"""The table of a study: for people as text, for programs as study.csv."""

import csv
import io
from collections.abc import Sequence
from math import isfinite

from crashsolve.study.findings import Finding
from crashsolve.study.trials import Trial

COLUMNS_PER_TABLE = 4
LONGEST = 60


def text_table(trials: Sequence[Trial], findings: Sequence[Finding]) -> str:
    """A line per run; errors and orders by the number of the channel, a few channels abreast."""
    header = ["integrator", "setting", "step s", "cycles", "steps CPU s", "total CPU s"]
    tables = []
    for first in range(0, max(len(findings), 1), COLUMNS_PER_TABLE):
        some = findings[first : first + COLUMNS_PER_TABLE]
        # the numbers of a run stand in the first table only
        width = 2 if first else len(header)
        titles = [[f"error {first + i}", "order"] for i in range(1, len(some) + 1)]
        rows = [[*header[:width], *(word for pair in titles for word in pair)]]
        rows += [[*_run(trial)[:width], *_errors(trial, some)] for trial in trials]
        remarks = ["", *("" if first else _remark(trial) for trial in trials)]
        tables.append(_aligned(rows, remarks))
    return "\n\n".join(tables)


def _aligned(rows: list[list[str]], remarks: list[str]) -> str:
    """Two columns of words to the left, numbers to the right, a remark at the end."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row, remark in zip(rows, remarks, strict=True):
        pairs = enumerate(zip(row, widths, strict=True))
        cells = [cell.ljust(w) if i < 2 else cell.rjust(w) for i, (cell, w) in pairs]
        lines.append("  ".join([*cells, remark]).rstrip())
    return "\n".join(lines)


def _remark(trial: Trial) -> str:
    """The message of a run, cut: study.csv and its log have all of it."""
    text = trial.message if trial.has_finished else f"exit code {trial.code}: {trial.message}"
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def csv_text(trials: Sequence[Trial], findings: Sequence[Finding]) -> str:
    """The table as CSV with all digits; a value that does not exist is an empty cell."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    header = ["integrator", "mesh", "deformation", "setting"]
    header += ["step [s]", "steps CPU [s]", "total CPU [s]", "cycles"]
    for finding in findings:
        name, kind = finding.watch.name, f"error against {finding.kind or 'nothing'}"
        unit = f" [{finding.unit}]" if finding.is_absolute else ""
        header += [f"{name} [{finding.unit or '-'}]", f"{name}: {kind}{unit}", f"{name}: order"]
        header += [f"{name}: order of mesh"] if finding.mesh_orders else []
    writer.writerow([*header, "exit code", "message"])
    for trial in trials:
        numbers = [trial.step, trial.cpu_steps, trial.cpu, trial.cycles]
        for at, finding in enumerate(findings):
            numbers += [_value(trial, at), finding.error(trial), finding.order(trial)]
            numbers += [finding.mesh_order(trial)] if finding.mesh_orders else []
        cells = [repr(number) if isfinite(number) else "" for number in numbers]
        words = [*map(str, trial.setting.series), trial.setting.label]
        writer.writerow([*words, *cells, trial.code, trial.message])
    return stream.getvalue()


def legend(findings: Sequence[Finding]) -> str:
    """Reference of each channel, and the convergence of its runs."""
    lines = []
    for number, finding in enumerate(findings, 1):
        lines.append(f"{number}  {finding.watch.name}{_reference(finding)}")
        lines += [f"     {note}" for note in finding.notes]
    return "\n".join(lines)


def _run(trial: Trial) -> list[str]:
    numbers = [_short(trial.step, 4), str(trial.cycles or "-")]
    numbers += [_short(trial.cpu_steps, 3), _short(trial.cpu, 3)]
    return [trial.setting.series.name, trial.setting.label, *numbers]


def _errors(trial: Trial, findings: Sequence[Finding]) -> list[str]:
    cells = []
    for finding in findings:
        order = finding.order(trial)
        cells += [_short(finding.error(trial), 2), f"{order:.2f}" if isfinite(order) else "-"]
    return cells


def _short(value: float, digits: int) -> str:
    return f"{value:.{digits}g}" if isfinite(value) else "-"


def _value(trial: Trial, at: int) -> float:
    """The value of a channel; of a history the last one."""
    value = trial.answers[at].get("value", float("nan")) if trial.answers else float("nan")
    return float(value[-1] if isinstance(value, list) else value)


def _reference(finding: Finding) -> str:
    if not len(finding.reference):
        return ": no run has it"
    if len(finding.reference) > 1:
        return f" against the {finding.kind}, over its largest value"
    kind = f"{finding.kind}; errors are absolute" if finding.is_absolute else finding.kind
    return f" = {float(finding.reference[0]):.9g} {finding.unit} ({kind})"
