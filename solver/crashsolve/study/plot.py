"""The work-precision plot: error against CPU time, a curve per method and channel."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from crashsolve.output.files import reported
from crashsolve.study.findings import Finding
from crashsolve.study.trials import Trial

COLOURS = ("#1f5a99", "#c4472b", "#2e8b63", "#c98a12", "#74509e", "#3f9fc4", "#7d5a44", "#8a9199")
MARKERS = "os^Dv<>p"
ROUND_OFF = 1e-12
# letters of a title or label that fit
LONGEST = 72
INK, MUTED, RULE = "#1c2126", "#66707a", "#e4e7ea"


def draw(path: Path, title: str, trials: Sequence[Trial], findings: Sequence[Finding]) -> str:
    """Write the picture; returns why it cannot be drawn, if so. Raises OutputError."""
    curves = [(f, m, *_points(f, m, trials)) for f in findings for m in _methods(trials)]
    # a curve of round-off alone would only press the others together
    curves = [curve for curve in curves if curve[2] and max(curve[3]) > ROUND_OFF]
    if not curves:
        return "no plot: no run has an error to show"
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return "no plot: matplotlib is missing; pip install 'crashsolve[post]'"
    canvas = Figure(figsize=(7.6, 4.6 + 0.24 * len(curves)), layout="constrained", dpi=150)
    axes, methods = canvas.subplots(), _methods(trials)
    for finding, method, work, error in curves:
        # colour tells methods apart; channels, where there is but one method
        marker, colour = findings.index(finding), methods.index(method)
        if len(methods) == 1:
            # where the colours have run out they begin again with the next marker
            marker, colour = findings.index(finding) // len(COLOURS), findings.index(finding)
        axes.loglog(
            *(work, error, MARKERS[marker % len(MARKERS)] + "-"),
            color=COLOURS[colour % len(COLOURS)],
            label=_label(finding, method if len(methods) > 1 else ""),
            lw=1.6,
            ms=5,
            zorder=3,
        )
    _dress(axes, title)
    canvas.legend(loc="outside lower left", frameon=False, fontsize=9, labelcolor=INK)
    with reported(path):
        canvas.savefig(path)
    return ""


def _label(finding: Finding, method: str) -> str:
    absolute = f" (absolute, {finding.unit})" if finding.is_absolute else ""
    return f"{method}{': ' if method else ''}{_cut(finding.watch.name)}{absolute}"


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def _methods(trials: Sequence[Trial]) -> list[str]:
    return list(dict.fromkeys(trial.setting.method for trial in trials))


def _points(
    finding: Finding, method: str, trials: Sequence[Trial]
) -> tuple[list[float], list[float]]:
    """CPU times [s] and errors of one method, from the longest step to the shortest."""
    mine = [t for t in trials if t.setting.method == method and not t.is_same]
    mine = [t for t in mine if isfinite(finding.error(t)) and finding.error(t) > 0.0]
    mine = sorted((t for t in mine if t.cpu_steps > 0.0), key=lambda trial: -trial.step)
    return [trial.cpu_steps for trial in mine], [finding.error(trial) for trial in mine]


def _dress(axes: Any, title: str) -> None:
    axes.set_title(_cut(title), loc="left", fontsize=11, color=INK)
    axes.set_xlabel("CPU time of the steps, s", color=MUTED)
    axes.set_ylabel("relative error", color=MUTED)
    axes.grid(True, which="major", color=RULE, lw=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(which="both", colors="#b9c0c6", labelcolor=MUTED, labelsize=9)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#b9c0c6")
