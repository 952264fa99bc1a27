"""Pictures of a sweep: every measure over every parameter, main effects, Sobol indices."""

from collections.abc import Callable, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.ticker import LogLocator, NullFormatter

from crashpost.errors import PostError
from crashpost.figures.draw import tick
from crashpost.figures.style import COLOURS, MATPLOTLIB, MUTED
from crashpost.sweeps.effects import Indices, indices, main_effect
from crashpost.sweeps.table import Row, Sweep

# panels of one picture that can still be read
MAX_PANELS = 64
# letters of a heading that fit beside a panel
LONGEST = 34
FAILED = "#b3261e"
Panel = Callable[[Axes, int, int], None]


def draw(sweep: Sweep, folder: Path) -> tuple[list[Path], list[str]]:
    """Write the pictures; returns them, and those that could not be drawn. Raises PostError."""
    if not any(isfinite(y) for row in sweep.finished for y in row.measured):
        raise PostError(f"{sweep.folder}: no finished run has anything to draw")
    if len(sweep.axes) * len(sweep.measures) > MAX_PANELS:
        raise PostError(f"more than {MAX_PANELS} panels: measure less, or draw from {sweep.folder}")
    finished = len(sweep.finished)
    about = f"{finished} of {len(sweep.rows)} runs"
    paths = [folder / "scatter.png", folder / "effects.png"]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with mpl.rc_context(MATPLOTLIB):
            _panels(sweep, lambda axes, i, j: _scatter(axes, sweep, i, j), about, paths[0])
            note = f"means of {about} with their standard errors"
            _panels(sweep, lambda axes, i, j: _effect(axes, sweep, i, j), note, paths[1])
            # one of another design must not be taken for one of this
            (folder / "indices.png").unlink(missing_ok=True)
            if sweep.design != "saltelli":
                return paths, []
            analyses = [indices(sweep, at) for at in range(len(sweep.measures))]
            if any(isinstance(one, Indices) for one in analyses):
                paths.append(_draw_indices(sweep, analyses, folder / "indices.png"))
    except OSError as error:
        raise PostError(f"{folder}: {error.strerror}") from error
    pairs = zip(sweep.measures, analyses, strict=True)
    return paths, [f"{m.name}: {reason}" for m, reason in pairs if isinstance(reason, str)]


def _panels(sweep: Sweep, panel: Panel, note: str, path: Path) -> None:
    """One row of panels per measure, one column per parameter."""
    rows, columns = len(sweep.measures), len(sweep.axes)
    size = (max(1.2 + 2.7 * columns, 4.6), 0.9 + 2.3 * rows)
    canvas = Canvas(figsize=size, layout="constrained", dpi=160)
    every = canvas.subplots(rows, columns, squeeze=False, sharex="col", sharey="row")
    for i in range(rows):
        for j in range(columns):
            panel(every[i, j], i, j)
        every[i, 0].set_ylabel(_cut(sweep.measures[i].heading), fontsize=9)
        every[i, 0].yaxis.set_major_formatter(lambda value, _: tick(value))
    for j, axis in enumerate(sweep.axes):
        last = every[-1, j]
        last.set_xlabel(_cut(axis.heading), fontsize=9)
        if axis.is_of_numbers and axis.scale == "log":
            last.set_xscale("log")
            last.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=6))
            last.xaxis.set_minor_formatter(NullFormatter())
        if axis.is_of_numbers:
            last.xaxis.set_major_formatter(lambda value, _: tick(value))
        if axis.is_of_numbers and axis.scale != "log":
            last.locator_params(axis="x", nbins=5)
    canvas.suptitle(f"{sweep.title}\n{note}", x=0.01, ha="left", fontsize=10)
    canvas.savefig(path)


def _scatter(axes: Axes, sweep: Sweep, i: int, j: int) -> None:
    """Every finished run, with its estimated error; the others as marks on the lower edge."""
    good = [row for row in sweep.finished if isfinite(row.measured[i])]
    x = _coordinates(sweep, j, good)
    y = [row.measured[i] for row in good]
    bars = [row.errors[i] for row in good] if sweep.has_errors(i) else None
    axes.errorbar(
        *(x, y),
        yerr=[bar if isfinite(bar) else 0.0 for bar in bars] if bars else None,
        fmt="o",
        ms=3.5,
        lw=0,
        elinewidth=0.9,
        color=COLOURS[0],
        alpha=0.75,
        mec="none",
        zorder=3,
    )
    bad = [row for row in sweep.rows if row.state not in ("finished", "new")]
    if bad:
        under = axes.get_xaxis_transform()
        at = _coordinates(sweep, j, bad)
        axes.plot(at, [0.02] * len(bad), "x", color=FAILED, ms=5, transform=under, zorder=4)
        if (i, j) == (0, 0):
            message = f"x  {len(bad)} without a result"
            axes.text(
                0.02, 0.98, message, transform=axes.transAxes, va="top", fontsize=8, color=FAILED
            )
    _name_words(axes, sweep, j)


def _effect(axes: Axes, sweep: Sweep, i: int, j: int) -> None:
    """Means by value or class of values, over the runs in a faint colour."""
    good = [row for row in sweep.finished if isfinite(row.measured[i])]
    x, y = _coordinates(sweep, j, good), [row.measured[i] for row in good]
    axes.plot(x, y, "o", ms=2.5, color=MUTED, alpha=0.35, mec="none", zorder=2)
    effect = main_effect([row.values[j] for row in good], y)
    at = _positions(sweep, j, effect.at)
    line = "-" if sweep.axes[j].is_of_numbers else ""
    bars = [error if isfinite(error) else 0.0 for error in effect.errors]
    style: dict[str, Any] = {
        "ms": 4.5,
        "capsize": 2.5,
        "elinewidth": 1.2,
        "color": COLOURS[1],
        "zorder": 3,
    }
    axes.errorbar(at, effect.means, yerr=bars, fmt=f"o{line}", **style)
    _name_words(axes, sweep, j)


def _coordinates(sweep: Sweep, j: int, rows: Sequence[Row]) -> list[float]:
    return _positions(sweep, j, [row.values[j] for row in rows])


def _positions(sweep: Sweep, j: int, values: Sequence[Any]) -> list[float]:
    """Numbers as they are, words by their positions in the order of the plan."""
    if sweep.axes[j].is_of_numbers:
        return [float(value) for value in values]
    words = _words(sweep, j)
    return [float(words.index(value)) for value in values]


def _words(sweep: Sweep, j: int) -> list[str]:
    return list(dict.fromkeys(str(row.values[j]) for row in sweep.rows))


def _name_words(axes: Axes, sweep: Sweep, j: int) -> None:
    if not sweep.axes[j].is_of_numbers:
        words = [_cut(word, 20) for word in _words(sweep, j)]
        axes.set_xticks(range(len(words)), words, rotation=20, ha="right", fontsize=8)
        axes.set_xlim(-0.5, len(words) - 0.5)


def _draw_indices(sweep: Sweep, indices_of: Sequence[Indices | str], path: Path) -> Path:
    """Bars of first and total indices with their 95 % intervals, a panel per measure."""
    known = [
        (m, f) for m, f in zip(sweep.measures, indices_of, strict=True) if isinstance(f, Indices)
    ]
    height = 0.9 + len(known) * (0.7 + 0.42 * len(sweep.axes))
    canvas = Canvas(figsize=(6.4, height), layout="constrained", dpi=160)
    every = canvas.subplots(len(known), squeeze=False, sharex=True)[:, 0]
    names = [_cut(axis.name) for axis in sweep.axes]
    for axes, (measure, one) in zip(every, known, strict=True):
        for shift, label, share, errors, colour in (
            (-0.19, "alone (first order)", one.first, one.first_errors, COLOURS[0]),
            (0.19, "with all others (total)", one.total, one.total_errors, COLOURS[3]),
        ):
            at = [k + shift for k in range(len(names))]
            bars = {"ecolor": MUTED, "capsize": 2.5, "elinewidth": 1.0}
            axes.barh(at, share, 0.36, xerr=errors, color=colour, label=label, error_kw=bars)
        axes.set_yticks(range(len(names)), names)
        axes.invert_yaxis()
        axes.grid(False, axis="y")
        axes.set_title(_cut(measure.name, 60), loc="left", fontsize=9, color=MUTED)
        axes.axvline(0.0, color="#b9c0c6", lw=0.8)
    every[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    every[-1].set_xlabel("share of the variance, with 95 % interval", fontsize=9)
    blocks, lost = known[0][1].blocks, known[0][1].lost
    note = f"{blocks} blocks of {len(names) + 2} runs" + (f", {lost} incomplete" if lost else "")
    canvas.suptitle(f"{sweep.title}\n{note}", x=0.01, ha="left", fontsize=10)
    canvas.savefig(path)
    return path


def _cut(text: str, longest: int = LONGEST) -> str:
    return text if len(text) <= longest else text[: longest - 3] + "..."
