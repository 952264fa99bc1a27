"""The work-precision plot: error against CPU time, a curve per method and channel."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from crashsolve.foundation.errors import DeckError
from crashsolve.study.findings import Finding
from crashsolve.study.trials import Trial

COLOURS = ("#1f5a99", "#c4472b", "#2e8b63", "#c98a12", "#74509e", "#3f9fc4", "#7d5a44", "#8a9199")
MARKERS = "os^Dv<>p"
INK, MUTED, RULE = "#1c2126", "#66707a", "#e4e7ea"


def draw(path: Path, title: str, trials: Sequence[Trial], findings: Sequence[Finding]) -> str:
    """Write the picture; returns what is missing when it cannot be drawn, else nothing."""
    curves = [(f, m, *_points(f, m, trials)) for f in findings for m in _methods(trials)]
    curves = [curve for curve in curves if len(curve[2]) > 0]
    if not curves:
        return "no plot: no run has an error to show"
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return "no plot: matplotlib is missing; pip install 'crashsolve[post]'"
    canvas = Figure(figsize=(7.6, 4.6 + 0.24 * len(curves)), layout="constrained", dpi=150)
    axes = canvas.subplots()
    for finding, method, work, error in curves:
        colour = COLOURS[findings.index(finding) % len(COLOURS)]
        marker = MARKERS[_methods(trials).index(method) % len(MARKERS)]
        label = (
            finding.watch.name if len(_methods(trials)) == 1 else f"{method}: {finding.watch.name}"
        )
        axes.loglog(work, error, marker + "-", color=colour, label=label, lw=1.6, ms=5, zorder=3)
    _dress(axes, title)
    canvas.legend(loc="outside lower left", frameon=False, fontsize=9, labelcolor=INK)
    try:
        canvas.savefig(path)
    except OSError as error:
        raise DeckError(str(path), None, None, "", f"cannot be written: {error}") from error
    return ""


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
    axes.set_title(title, loc="left", fontsize=11, color=INK)
    axes.set_xlabel("CPU time of the steps, s", color=MUTED)
    axes.set_ylabel("relative error", color=MUTED)
    axes.grid(True, which="major", color=RULE, lw=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(which="both", colors="#b9c0c6", labelcolor=MUTED, labelsize=9)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#b9c0c6")
