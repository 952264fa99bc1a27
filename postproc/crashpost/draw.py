"""Figures drawn with matplotlib: SVG for the report, PNG, SVG or PDF for the command line."""

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from crashpost.errors import PostError

try:
    import matplotlib as mpl
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas
except ModuleNotFoundError as missing:
    raise PostError(
        f"figures need {missing.name}, which is missing: pip install 'crashsolve[plot]'"
    ) from None

from crashpost.figure import Curve, Figure, Pair, Reference, axis_unit
from crashpost.result import Result
from crashsolve.channels.display import factor

INK, MUTED, RULE = "#1c2126", "#66707a", "#e4e7ea"
COLOURS = ("#1f5a99", "#c4472b", "#2e8b63", "#c98a12", "#74509e", "#3f9fc4", "#7d5a44", "#8a9199")
REFERENCE_COLOURS = ("#93804f", "#a0527d", "#3c7d78")
DASHES: tuple[str, ...] = ("-", "--", ":")
MOST_POINTS = 3000
MINUS = "\N{MINUS SIGN}"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "crashpost",
    "font.size": 10,
    "axes.edgecolor": "#b9c0c6",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.labelcolor": MUTED,
    "grid.color": RULE,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": "#b9c0c6",
    "ytick.color": "#b9c0c6",
    "xtick.labelcolor": MUTED,
    "ytick.labelcolor": MUTED,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "lines.linewidth": 1.6,
    "lines.solid_joinstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 9,
    "path.simplify": True,
}


@dataclass(frozen=True)
class Key:
    """One entry of a legend: mark is line, dash, dots, band or point."""

    label: str
    colour: str
    mark: str


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


def svg(result: Result, figure: Figure, name: str) -> tuple[str, list[Key]]:
    """The figure as an <svg> element without size, and its legend; raises PostError."""
    with mpl.rc_context(STYLE):
        canvas = Canvas(figsize=(5.4, 3.3), layout="constrained")
        keys = _draw(canvas.subplots(), result, figure)
        stream = io.StringIO()
        canvas.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    return _embeddable(stream.getvalue(), figure.title, name), keys


def save(result: Result, figures: Sequence[Figure], path: Path) -> None:
    """The figures one below the other in a file; its ending chooses the format."""
    with mpl.rc_context(STYLE):
        canvas = Canvas(figsize=(7.2, 0.4 + 3.4 * len(figures)), layout="constrained", dpi=160)
        panels = canvas.subplots(len(figures), squeeze=False)[:, 0]
        for panel, figure in zip(panels, figures, strict=True):
            _draw(panel, result, figure)
            panel.legend(loc="lower left", bbox_to_anchor=(0, 1.08), ncols=2, borderaxespad=0)
        try:
            canvas.savefig(path)
        except (OSError, ValueError) as error:
            raise PostError(f"{path}: {error}") from error


def labels(channels: Sequence[str]) -> list[str]:
    """Short names that tell the channels apart: the words in which they differ."""
    words = [channel.split(".") for channel in channels]
    if len(words) < 2 or len({len(w) for w in words}) > 1 or not all(map(_is_name, channels)):
        return list(channels)
    differing = [len(set(column)) > 1 for column in zip(*words, strict=True)]
    short = [[w for w, differs in zip(row, differing, strict=True) if differs] for row in words]
    return [
        " ".join(row).replace("_", " ") or name for row, name in zip(short, channels, strict=True)
    ]


def tick(value: float) -> str:
    """A tick label that carries its own power of ten: 0.25, 1200, 3·10⁻¹⁴."""
    digits, _, power = f"{value:.10g}".partition("e")
    raised = f"·10{str(int(power)).translate(SUPERSCRIPTS)}" if power else ""
    return digits.replace("-", MINUS) + raised


def _draw(axes: Axes, result: Result, figure: Figure) -> list[Key]:
    """Draw references, then curves, then the axes; returns the legend."""
    scaled = _scaled(result, figure)
    keys = []
    for number, line in enumerate(scaled.lines):
        colour, dash = COLOURS[number % len(COLOURS)], DASHES[number // 4 % len(DASHES)]
        axes.plot(line.x, line.y, dash, color=colour, label=line.label, zorder=3)
        keys.append(Key(line.label, colour, {"-": "line", "--": "dash", ":": "dots"}[dash]))
    for number, reference in enumerate(figure.reference):
        colour = REFERENCE_COLOURS[number % len(REFERENCE_COLOURS)]
        keys.append(_draw_reference(axes, reference, colour, figure))
    _finish_axes(axes, figure, scaled)
    return keys


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
        axes.plot(xs, (level, level), "--", transform=where, **style)
        return Key(reference.label, colour, "dash")
    x, y = np.array(reference.points).T
    if reference.kind == "curve":
        axes.plot(x, y, ":", linewidth=2, **style)
        return Key(reference.label, colour, "dots")
    # a point on the border of the figure is drawn whole, one beyond it not at all
    seen = _between(x, figure.x_range) & _between(y, figure.y_range)
    axes.plot(x[seen], y[seen], "o", markersize=6, markerfacecolor="white", clip_on=False, **style)
    return Key(reference.label, colour, "point")


def _between(values: np.ndarray, ends: Pair | None) -> np.ndarray:
    """Which values lie between the ends of an axis; all when it has none."""
    low, high = (min(ends), max(ends)) if ends else (-np.inf, np.inf)
    return (values >= low) & (values <= high)


def _finish_axes(axes: Axes, figure: Figure, scaled: _Scaled) -> None:
    axes.set_xscale(figure.x_scale)
    axes.set_yscale(figure.y_scale)
    for axis, scale in ((axes.xaxis, figure.x_scale), (axes.yaxis, figure.y_scale)):
        if scale == "linear":
            axis.set_major_formatter(lambda value, _: tick(value))
    axes.margins(x=0 if figure.x == "time" and figure.x_scale == "linear" else 0.03)
    if figure.x_range:
        axes.set_xlim(figure.x_range)
    if figure.y_range:
        axes.set_ylim(figure.y_range)
    x_words = figure.x_label or ("time" if figure.x == "time" else _quantity([figure.x]))
    y_words = figure.y_label or _quantity([curve.channel for curve in figure.y])
    axes.set_xlabel(_with_unit(x_words, scaled.x_unit), loc="right", fontsize=9)
    # the ordinate's title lies flat above its axis, where it is read without turning the head
    axes.text(
        0,
        1.03,
        _with_unit(y_words, scaled.y_unit),
        transform=axes.transAxes,
        ha="left",
        va="bottom",
        fontsize=9,
        color=MUTED,
    )
    if figure.y_scale == "linear" and _changes_sign(scaled.lines):
        axes.axhline(0, color="#b9c0c6", linewidth=0.8, zorder=1)


def _changes_sign(lines: Sequence[_Line]) -> bool:
    """Whether zero lies among the ordinates and deserves a line of its own."""
    values = np.concatenate([line.y for line in lines])
    return bool(np.any(values < 0) and np.any(values > 0))


def _scaled(result: Result, figure: Figure) -> _Scaled:
    """Every curve in the units of the axes."""
    abscissas = [result.series(curve.x or figure.x) for curve in figure.y]
    ordinates = [result.series(curve.channel) for curve in figure.y]
    x_unit = axis_unit(abscissas, figure.x_unit)
    y_unit = axis_unit(ordinates, figure.y_unit)
    lines = []
    for label, x, y in zip(_line_labels(figure.y), abscissas, ordinates, strict=True):
        along = x.values * factor(x.unit, x_unit) + figure.x_offset
        up = y.values * factor(y.unit, y_unit) + figure.y_offset
        if figure.y_scale == "log" and not np.any(up > 0):
            raise PostError(f"'{label}' has no positive value to show on a logarithmic axis")
        lines.append(_Line(label, *_thinned(along, up)))
    return _Scaled(lines, x_unit, y_unit)


def _line_labels(curves: Sequence[Curve]) -> list[str]:
    short = labels([curve.channel for curve in curves])
    return [curve.label or name for curve, name in zip(curves, short, strict=True)]


def _thinned(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest value of each bucket of a long history; peaks survive."""
    if len(x) <= MOST_POINTS or np.any(np.diff(x) < 0):
        return x, y
    starts = np.linspace(0, len(y), MOST_POINTS // 2 + 1).astype(int)
    kept = {0, len(y) - 1}
    for start, stop in pairwise(starts):
        kept |= {start + int(np.argmin(y[start:stop])), start + int(np.argmax(y[start:stop]))}
    chosen = sorted(kept)
    return x[chosen], y[chosen]


def _quantity(channels: Sequence[str]) -> str:
    """The quantity all channels share, in words; nothing for expressions."""
    quantities = {channel.split(".")[2] for channel in channels if channel.count(".") >= 2}
    plain = all(map(_is_name, channels)) and len(quantities) == 1
    return quantities.pop().replace("_", " ") if plain else ""


def _is_name(channel: str) -> bool:
    """Whether the text is a channel name rather than arithmetic."""
    return re.fullmatch(r"[a-z]+\.[^.\s()*/+]+\.\w+(\.\w+)?", channel) is not None


def _with_unit(words: str, unit: str) -> str:
    shown = {"deg": "°", "g0": "g"}.get(unit, unit.replace("^2", "²").replace("^3", "³"))
    return ", ".join(part for part in (words, shown) if part)


def _embeddable(text: str, title: str, name: str) -> str:
    """Only the <svg> element, its ids made unique by `name`, its size left to the page."""
    body = text[text.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, count=1, flags=re.DOTALL)
    body = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", body, count=1)
    body = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", body, count=1)
    body = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{name}-", body)
    words = title.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return body.replace("<svg", f'<svg role="img" aria-label="{words}"', 1)
