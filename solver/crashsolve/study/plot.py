"""The work-precision plot: error against CPU time, a curve per method, mesh and channel.

Of many channels the largest error, to which a target refers.
"""

import warnings
from collections.abc import Callable, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from crashsolve.output.files import reported
from crashsolve.study.findings import Finding, worst
from crashsolve.study.settings import Series
from crashsolve.study.trials import Trial

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# those of crashpost, which a solver does not import
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#332288", "#cc79a7", "#882255", "#1c2126")
MARKERS = "os^Dv<>p"
ROUND_OFF = 1e-12
# more lines than these cannot be distinguished
MAX_LINES = 10
# letters of a title or label that fit
LONGEST = 72
INK, MUTED, RULE = "#1c2126", "#5b6570", "#e4e7ea"


class Line(NamedTuple):
    """A curve of the picture: CPU times [s] and errors, and how it looks."""

    label: str
    work: list[float]
    error: list[float]
    colour: int
    marker: int


def draw(path: Path, title: str, trials: Sequence[Trial], findings: Sequence[Finding]) -> str:
    """Write the picture; returns why it cannot be drawn, if so. Raises OutputError."""
    lines, what = _of_channels(trials, findings), "relative error"
    if len(lines) > MAX_LINES and len(_series(trials)) > 1:
        lines, what = _of_all(trials, findings), "largest relative error of all channels"
    if not lines:
        return "no plot: no run has an error to show"
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return "no plot: matplotlib is missing; pip install 'crashsolve[plot]'"
    canvas = Figure(figsize=(7.6, 4.6 + 0.24 * len(lines)), layout="constrained", dpi=150)
    axes = canvas.subplots()
    for line in lines:
        axes.loglog(
            *(line.work, line.error, MARKERS[line.marker % len(MARKERS)] + "-"),
            color=COLOURS[line.colour % len(COLOURS)],
            label=line.label,
            lw=1.6,
            ms=5,
            zorder=3,
        )
    _format_axes(axes, title, what)
    legend = canvas.legend(loc="outside lower left", frameon=False, fontsize=9, labelcolor=INK)
    for text in legend.get_texts():
        text.set_parse_math(False)
    with reported(path), warnings.catch_warnings():
        # a character that the fonts lack, as an emoji in a title, is drawn as a box
        warnings.filterwarnings("ignore", message=r"Glyph \d+ .*missing from")
        canvas.savefig(path)
    return ""


def _of_channels(trials: Sequence[Trial], findings: Sequence[Finding]) -> list[Line]:
    """A line for each channel and series; colour distinguishes series, or channels of one."""
    every, lines = _series(trials), []
    for i, finding in enumerate(findings):
        for j, series in enumerate(every):
            work, error = _points(finding.error, series, trials)
            # a curve of round-off alone would only press the others together
            if work and max(error) > ROUND_OFF:
                # where the colours have run out they begin again with the next marker
                look = (j, i) if len(every) > 1 else (i, i // len(COLOURS))
                label = _label(finding, series.name if len(every) > 1 else "")
                lines.append(Line(label, work, error, *look))
    return lines


def _of_all(trials: Sequence[Trial], findings: Sequence[Finding]) -> list[Line]:
    """A line for each series: colour distinguishes methods, markers the meshes."""
    every, lines = _series(trials), []
    methods = list(dict.fromkeys(series.method for series in every))
    kinds = list(dict.fromkeys((series.mesh, series.description) for series in every))
    for series in every:
        work, error = _points(lambda trial: worst(findings, trial), series, trials)
        if work:
            look = methods.index(series.method), kinds.index((series.mesh, series.description))
            lines.append(Line(series.name, work, error, *look))
    return lines


def _label(finding: Finding, series: str) -> str:
    absolute = f" (absolute, {finding.unit})" if finding.is_absolute else ""
    return f"{series}{': ' if series else ''}{_cut(finding.watch.name)}{absolute}"


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def _series(trials: Sequence[Trial]) -> list[Series]:
    return list(dict.fromkeys(trial.setting.series for trial in trials))


def _points(
    error: Callable[[Trial], float], series: Series, trials: Sequence[Trial]
) -> tuple[list[float], list[float]]:
    """CPU times [s] and errors of one series, from the longest step to the shortest."""
    own = [t for t in trials if t.setting.series == series and not t.is_same]
    own = [t for t in own if isfinite(error(t)) and error(t) > 0.0]
    own = sorted((t for t in own if t.cpu_steps > 0.0), key=lambda trial: -trial.step)
    return [trial.cpu_steps for trial in own], [error(trial) for trial in own]


def _format_axes(axes: "Axes", title: str, what: str) -> None:
    # a title is text: a dollar begins no formula
    axes.set_title(_cut(title), loc="left", fontsize=11, color=INK, parse_math=False)
    axes.set_xlabel("CPU time of the steps, s", color=MUTED)
    axes.set_ylabel(what, color=MUTED)
    axes.grid(True, which="major", color=RULE, lw=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(which="both", colors="#b9c0c6", labelcolor=MUTED, labelsize=9)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#b9c0c6")
