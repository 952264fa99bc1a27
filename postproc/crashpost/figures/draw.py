"""Figures drawn with matplotlib: SVG for the report, PNG, SVG or PDF for the command line."""

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from crashpost.errors import PostError
from crashpost.results.status import Json
from crashpost.results.whole_file import whole_file
from crashpost.values import words

try:
    import matplotlib as mpl
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.ticker import LogFormatter
except ModuleNotFoundError as missing:
    raise PostError(
        f"figures need {missing.name}, which is missing: pip install 'crashsolve[plot]'"
    ) from None

from crashpost.figures.style import (
    FRAME,
    MATPLOTLIB,
    MAX_LINES,
    MUTED,
    REFERENCE_COLOURS,
    line_style,
)
from crashpost.results.result import Result
from crashpost.values.figure import Curve, Figure, Pair, Reference, axis_unit
from crashpost.values.summary import MOMENTS
from crashpost.values.units import unit_text
from crashsolve.channels.display import factor
from crashsolve.channels.series import Series

MAX_POINTS = 3000
# of the largest ordinate: an axis that begins below it begins at zero
NEAR_ZERO = 0.25
MINUS = "\N{MINUS SIGN}"
# dashes of levels and of curves known from elsewhere
LEVEL, MEASURED = (4.0, 2.0), (1.0, 1.2)
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# a panel of a saved figure [inches], letters of an entry of its legend in two columns and in one
WIDTH, HEIGHT = 7.2, 3.4
HALF_LINE, LINE = 48, 92

Runs = Result | Sequence[Result]


@dataclass(frozen=True)
class Key:
    """One entry of a legend: mark is line, dash, dots, band or point; dashes in line widths."""

    label: str
    colour: str
    mark: str = "line"
    dashes: tuple[float, ...] = ()


@dataclass(frozen=True)
class _Line:
    """A curve in display units."""

    label: str
    x: np.ndarray
    y: np.ndarray


@dataclass(frozen=True)
class _Scaled:
    """A figure's curves in display units, with the units chosen."""

    lines: list[_Line]
    x_unit: str
    y_unit: str


def svg(results: Runs, figure: Figure, name: str) -> tuple[str, list[Key]]:
    """The figure as an <svg> element without size, and its legend; raises PostError."""
    with mpl.rc_context(MATPLOTLIB):
        canvas = Canvas(figsize=(5.4, 3.3), layout="constrained")
        keys = _draw(canvas.subplots(), results, figure)
        stream = io.StringIO()
        canvas.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    return _embeddable(stream.getvalue(), figure.title, name), keys


def save(results: Runs, figures: Sequence[Figure], path: Path) -> None:
    """The figures one below the other in a file; its ending chooses the format."""
    with mpl.rc_context(MATPLOTLIB):
        heights = [HEIGHT + 0.16 * _legend_lines(figure) for figure in figures]
        layout = ConstrainedLayoutEngine(hspace=0.06)
        canvas = Canvas(figsize=(WIDTH, 0.2 + sum(heights)), layout=layout, dpi=160)
        grid = canvas.subplots(len(figures), squeeze=False, height_ratios=heights)
        for panel, figure in zip(grid[:, 0], figures, strict=True):
            _draw(panel, results, figure)
            _add_legend(panel, figure.title)
        with whole_file(path) as partial:
            try:
                canvas.savefig(partial, metadata=_metadata(path))
            except ValueError as error:
                raise PostError(f"{path}: {error}") from error


def _metadata(path: Path) -> Json:
    """Nothing that differs between two files of one figure."""
    return {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix.lower(), {})


def _legend_lines(figure: Figure) -> int:
    """Lines of title and legend above a panel."""
    entries = len(figure.y) + len(figure.reference)
    return 1 + (entries + 1) // 2 + figure.title.count("\n") + len(figure.title) // LINE


def repeats_title(labels: Sequence[str], title: str) -> bool:
    """Whether a legend would only repeat words of the title."""
    return len(labels) == 1 and labels[0].lower() in title.lower()


def _add_legend(panel: Axes, title: str) -> None:
    """The title with the legend below it, above a panel; no legend of a single line."""
    handles, names = panel.get_legend_handles_labels()
    if repeats_title(names, title):
        handles, names = [], []
    columns = 2 if all(len(name) <= HALF_LINE for name in names) else 1
    legend = panel.legend(
        handles,
        [fill(name, LINE if columns == 1 else HALF_LINE) for name in names],
        title=fill(title, LINE),
        title_fontproperties={"weight": "bold", "size": 10},
        alignment="left",
        loc="lower left",
        bbox_to_anchor=(0, 1.08),
        ncols=columns,
        borderaxespad=0,
        borderpad=0.1,
    )
    legend.set_zorder(5)


def tick(value: float) -> str:
    """A tick label that carries its own power of ten: 0.25, 1200, 3·10⁻¹⁴."""
    digits, _, power = f"{value:.10g}".partition("e")
    raised = f"·10{str(int(power)).translate(SUPERSCRIPTS)}" if power else ""
    return digits.replace("-", MINUS) + raised


class Powers(LogFormatter):
    """Labels of a logarithmic axis, in letters rather than as a formula."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return tick(x) if super().__call__(x, pos) else ""


def _draw(axes: Axes, results: Runs, figure: Figure) -> list[Key]:
    """Draw references, then curves, then the axes; returns the legend."""
    if len(figure.y) > MAX_LINES:
        raise PostError(f"{len(figure.y)} curves in one figure; {MAX_LINES} can be distinguished")
    scaled = _scaled(_runs(results), figure)
    keys = []
    for number, line in enumerate(scaled.lines):
        colour, dashes = line_style(number)
        style = (0, dashes) if dashes else "-"
        # a single sample has no line
        mark = "o" if len(line.x) == 1 else ""
        look: Json = {
            "linestyle": style,
            "marker": mark,
            "color": colour,
            "label": line.label,
        }
        axes.plot(line.x, line.y, zorder=3, **look)
        keys.append(Key(line.label, colour, "line", dashes))
    for number, reference in enumerate(figure.reference):
        colour = REFERENCE_COLOURS[number % len(REFERENCE_COLOURS)]
        keys.append(_draw_reference(axes, reference, colour, figure))
    _finish_axes(axes, figure, scaled)
    return keys


def _runs(results: Runs) -> Sequence[Result]:
    return [results] if isinstance(results, Result) else results


def _draw_reference(axes: Axes, reference: Reference, colour: str, figure: Figure) -> Key:
    """Draw one reference behind the curves."""
    style: dict[str, Any] = {"color": colour, "label": reference.label, "zorder": 2}
    # a level or band without limits spans the whole figure
    xs = reference.over or (0.0, 1.0)
    where = axes.transData if reference.over else axes.get_yaxis_transform()
    if reference.kind == "band":
        low, high = reference.from_ or 0.0, reference.to or 0.0
        style |= {"alpha": 0.22, "linewidth": 0, "transform": where, "zorder": 1}
        axes.fill_between(xs, low, high, **style)
        return Key(reference.label, colour, "band")
    if reference.kind == "level":
        level = reference.value or 0.0
        axes.plot(xs, (level, level), linestyle=(0, LEVEL), transform=where, **style)
        return Key(reference.label, colour, "dash", LEVEL)
    x, y = np.array(reference.points).T
    if reference.kind == "corridor":
        border = np.vstack([reference.points, reference.upper[::-1]])
        axes.fill(*border.T, alpha=0.22, linewidth=0, color=colour, label=reference.label, zorder=1)
        return Key(reference.label, colour, "band")
    if reference.kind == "curve":
        axes.plot(x, y, linestyle=(0, MEASURED), linewidth=2, **style)
        return Key(reference.label, colour, "dots", MEASURED)
    # a point on the border of the figure is drawn whole, one beyond it not at all
    is_visible = _between(x, figure.x_range) & _between(y, figure.y_range)
    axes.plot(
        x[is_visible],
        y[is_visible],
        "o",
        markersize=6,
        markerfacecolor="white",
        clip_on=False,
        **style,
    )
    return Key(reference.label, colour, "point")


def _between(values: np.ndarray, ends: Pair | None) -> np.ndarray:
    """Mask of the values between the ends of an axis; all when it has none."""
    low, high = (min(ends), max(ends)) if ends else (-np.inf, np.inf)
    return (values >= low) & (values <= high)


def _finish_axes(axes: Axes, figure: Figure, scaled: _Scaled) -> None:
    for set_scale, scale in ((axes.set_xscale, figure.x_scale), (axes.set_yscale, figure.y_scale)):
        # values without a logarithm are left out, not drawn at the edge as if they were small
        set_scale(scale, **({"nonpositive": "mask"} if scale == "log" else {}))
    for axis, scale in ((axes.xaxis, figure.x_scale), (axes.yaxis, figure.y_scale)):
        if scale == "linear":
            axis.set_major_formatter(lambda value, _: tick(value))
        else:
            axis.set_major_formatter(Powers(labelOnlyBase=False))
            axis.set_minor_formatter(Powers(labelOnlyBase=False, minor_thresholds=(1.2, 0.5)))
    axes.margins(x=0 if figure.x == "time" and figure.x_scale == "linear" else 0.03)
    if figure.x_range:
        axes.set_xlim(figure.x_range)
    if figure.y_range:
        axes.set_ylim(figure.y_range)
    elif figure.x_range and figure.y_scale == "linear" and not figure.reference:
        _fit_y(axes, figure.x_range, scaled.lines)
    x_words = figure.x_label or _axis_words([curve.x or figure.x for curve in figure.y])
    y_words = figure.y_label or _axis_words([curve.channel for curve in figure.y])
    axes.set_xlabel(_with_unit(fitted_words(x_words), scaled.x_unit), loc="right", fontsize=9)
    # the ordinate's title lies flat above its axis, where it is read without turning the head
    axes.text(
        0,
        1.03,
        _with_unit(fitted_words(y_words), scaled.y_unit),
        transform=axes.transAxes,
        ha="left",
        va="bottom",
        fontsize=9,
        color=MUTED,
    )
    if figure.y_scale == "linear" and _changes_sign(scaled.lines):
        axes.axhline(0, color=FRAME, linewidth=0.8, zorder=1)


def _fit_y(axes: Axes, x_range: Pair, lines: Sequence[_Line]) -> None:
    """Set the range of the ordinate to that of the lines within the abscissa shown."""
    visible = [line.y[_between(line.x, x_range)] for line in lines]
    values = np.concatenate([part[np.isfinite(part)] for part in visible])
    if not len(values):
        low, high = x_range
        raise PostError(f"no sample lies from {low:g} to {high:g} on the abscissa")
    low, high = float(values.min()), float(values.max())
    # what begins beside the abscissa, as a force between two samples, is seen to come from zero
    low = 0.0 if 0.0 < low < NEAR_ZERO * high else low
    margin = 0.05 * (high - low) or 0.5 * abs(high) or 1.0
    axes.set_ylim(low - margin, high + margin)


def _changes_sign(lines: Sequence[_Line]) -> bool:
    """Whether zero lies among the ordinates and deserves a line of its own."""
    values = np.concatenate([line.y for line in lines])
    return bool(np.any(values < 0) and np.any(values > 0))


def _scaled(results: Sequence[Result], figure: Figure) -> _Scaled:
    """Every curve in the units of the axes."""
    if all(curve.points for curve in figure.y):
        literal = [_Line(curve.label, *np.array(curve.points).T) for curve in figure.y]
        return _Scaled(literal, figure.x_unit, figure.y_unit)
    abscissas = [results[curve.run].series(curve.x or figure.x) for curve in figure.y]
    ordinates = [_reported(results[curve.run], curve.channel) for curve in figure.y]
    x_unit = axis_unit(abscissas, figure.x_unit)
    y_unit = axis_unit(ordinates, figure.y_unit)
    lines = []
    for label, x, y in zip(_line_labels(figure.y), abscissas, ordinates, strict=True):
        along = x.values * factor(x.unit, x_unit) + figure.x_offset
        up = y.values * factor(y.unit, y_unit) + figure.y_offset
        for values, scale in ((along, figure.x_scale), (up, figure.y_scale)):
            if scale == "log" and not np.any(values > 0):
                raise PostError(f"'{label}' has no positive value to show on a logarithmic axis")
        lines.append(_Line(label, *_thinned(along, up)))
    return _Scaled(lines, x_unit, y_unit)


def _reported(result: Result, channel: str) -> Series:
    """A channel, without the times of contacts that have not been: these lie before the run."""
    series = result.series(channel)
    is_moment = channel.startswith("rcforc.") and channel.rsplit(".", 1)[-1] in MOMENTS
    if not is_moment or not len(series.time):
        return series
    return series._replace(values=np.where(series.values < series.time[0], np.nan, series.values))


def _line_labels(curves: Sequence[Curve]) -> list[str]:
    short = words.legend([curve.channel for curve in curves])
    return [curve.label or name for curve, name in zip(curves, short, strict=True)]


def _thinned(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Extreme samples of each bucket of a long history, of y and where x turns of x; ends too."""
    if len(x) <= MAX_POINTS:
        return x, y
    curves = [y] if np.all(np.diff(x) >= 0) else [x, y]
    starts = np.linspace(0, len(y), MAX_POINTS // (2 * len(curves)) + 1).astype(int)
    selected = {0, len(y) - 1}
    for start, stop in pairwise(starts):
        for curve in curves:
            part = curve[start:stop]
            selected |= {start + int(np.argmin(part)), start + int(np.argmax(part))}
    chosen = sorted(selected)
    return x[chosen], y[chosen]


def _axis_words(channels: Sequence[str]) -> str:
    """Label of an axis."""
    distinct = list(dict.fromkeys(channels))
    if distinct == ["time"]:
        return "time"
    shared = words.quantity_of_all(distinct)
    return shared if shared or len(distinct) > 1 else words.title(distinct)


def fitted_words(text: str) -> str:
    """The title of an axis, cut where it is longer than a diagram is wide."""
    return text if len(text) <= LINE else f"{text[: LINE - 1]}\N{HORIZONTAL ELLIPSIS}"


def _with_unit(text: str, unit: str) -> str:
    return ", ".join(part for part in (text, unit_text(unit)) if part)


def _embeddable(text: str, title: str, name: str) -> str:
    """Only the <svg> element, its ids made unique by `name`, its size left to the page."""
    body = text[text.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, count=1, flags=re.DOTALL)
    body = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", body, count=1)
    body = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", body, count=1)
    body = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{name}-", body)
    label = title.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return body.replace("<svg", f'<svg role="img" aria-label="{label}"', 1)
