"""Puts painted pictures on a sheet: captions, scale bar, colours with their unit, length of arrows.

A strip is one sheet with a picture for each moment; a film has one sheet, on which picture and time
change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from crashpost.figures.draw import tick
from crashpost.figures.style import INK, MATPLOTLIB, MUTED
from crashpost.renders.camera import Camera, round_length
from crashpost.renders.colour_scale import ColourScale
from crashpost.renders.shapes import ARROW
from crashpost.renders.title import lines_of
from crashsolve.channels.display import factor, readable

if TYPE_CHECKING:
    from PIL import ImageFont

# inches
WIDTH, LEAST_WIDTH, GAP, CAPTION, TITLE, LINE, FOOTER = 7.2, 4.8, 0.12, 0.24, 0.36, 0.18, 0.66
# letters of titles [points]
TITLE_SIZE, FILM_TITLE_SIZE = 10.5, 8.5
# around the sheet; room for the legend of arrows
PAD, ARROWS_ROOM = 0.07, 1.65
# a picture this many times as wide as high is put below the one before, not beside it
WIDE, HALF_WIDE = 3.2, 2.2
MAX_COLUMNS, MAX_NAMES = 4, 24
# of names: letters, lines of names that a footer has room for, height of each further line
# of a line below the time that states why a moment is shown [inches]
REASON = 0.14
LETTERS_PER_INCH, NAME_LINES, NAME_LINE = 13.0, 2, 0.2
# of the arrow in the legend [inches]; of a bar of colours at least
LONGEST_ARROW, LEAST_BAR = 1.0, 0.4
# room for the heading of close-ups [inches]
CLOSE_UP_HEAD = 0.42
# of a film: heights of the picture over the film's width, least width [pixels], frame above
# the picture [inches]
FILM_HEIGHTS, NARROWEST = (0.16, 0.6), 480
FILM_HEAD = 0.52
# with colours or names beside arrows [pixels]
NARROWEST_WITH_ARROWS = 720
# left white below the legend of a film, where players lay their controls [inches]
CONTROLS = 0.45
DPI = 160


def scale_bar(width: float) -> tuple[float, str]:
    """Length [m] and label of the scale bar of a picture of some width [m]."""
    length = round_length(width)
    unit = readable("m", length)
    return length, f"{length * factor('m', unit):g} {unit}"


@dataclass(frozen=True)
class Key:
    """Meaning of colours, lengths and arrows."""

    camera: Camera
    colour_scale: ColourScale
    names: Sequence[tuple[str, str]] = ()
    arrow: float = 0.0  # metres for each unit
    arrow_unit: str = ""
    arrow_size: float = 0.0  # the largest, in its unit
    note: str = ""  # lengths that are magnified

    @property
    def scale_bar(self) -> tuple[float, str]:
        """Length [m] and label of the scale bar."""
        return scale_bar(self.camera.width)

    def arrow_bar(self, panel: float) -> tuple[float, str]:
        """Length [inches] of the legend's arrow beside a picture of this width, and its label.

        It is as long as an arrow of the picture that shows as much.
        """
        unit = readable(self.arrow_unit, self.arrow_size)
        scale = factor(self.arrow_unit, unit) if unit != self.arrow_unit else 1.0
        inches = self.arrow / self.camera.width * panel / scale  # of one unit
        shown = round_length(3.0 * min(LONGEST_ARROW / inches, self.arrow_size * scale))
        return inches * shown, f"{shown:g} {unit}"

    @property
    def arrow_label(self) -> str:
        """The largest force or speed that one arrow shows; a contact may have several."""
        unit = readable(self.arrow_unit, self.arrow_size)
        size = self.arrow_size * (factor(self.arrow_unit, unit) if unit != self.arrow_unit else 1)
        return f"largest arrow {float(f'{size:.3g}'):g} {unit}"

    def footer(self, width: float, panel: float) -> float:
        """Height of the legend below pictures on a sheet of this width [inches]."""
        if self.colour_scale.name or not self.names:
            return FOOTER + NAME_LINE * bool(self.names)
        start, stop = self.between(width, panel)
        lines, _ = name_grid(self.names, stop - start)
        return FOOTER + NAME_LINE * max(lines - NAME_LINES, 0)

    def between(self, width: float, panel: float) -> tuple[float, float]:
        """Left and right end of colours or names, between scale bar and arrows."""
        bar = self.scale_bar[0] / self.camera.width * panel
        start = max(PAD + 0.02 + bar, 1.7 if self.note else 1.2) + 0.3
        return start, width - (ARROWS_ROOM if self.arrow_size else 0.1)


@dataclass(frozen=True)
class Layout:
    """Sizes of a strip [inches]."""

    columns: int
    rows: int
    width: float  # of the sheet
    panel: tuple[float, float]
    title: float
    caption: float
    footer: float = FOOTER
    # of close-ups: rows, size of one
    closer_rows: int = 0
    closer: tuple[float, float] = (0.0, 0.0)

    @property
    def height(self) -> float:
        return PAD + self.title + self.pictures + self.close_ups + self.footer

    @property
    def pictures(self) -> float:
        """Height of the pictures with their captions."""
        return self.rows * (self.panel[1] + self.caption + GAP)

    @property
    def close_ups(self) -> float:
        """Height of the close-ups with their heading and captions; 0 without any."""
        rows = self.closer_rows * (self.closer[1] + CAPTION + GAP)
        return rows + CLOSE_UP_HEAD if self.closer_rows else 0.0

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of one picture [pixels]."""
        return round(self.panel[0] * DPI), round(self.panel[1] * DPI)

    @property
    def closer_pixels(self) -> tuple[int, int]:
        """Width and height of one close-up [pixels]."""
        return round(self.closer[0] * DPI), round(self.closer[1] * DPI)


def wrapped(title: str, width: float) -> list[str]:
    """A title in lines that fit a sheet of this width [inches]."""
    with mpl.rc_context(MATPLOTLIB):
        return lines_of(title, width - 2.0 * PAD, TITLE_SIZE)


def layout(captions: Sequence[str], aspect: float, title: str, width: float = WIDTH) -> Layout:
    """Number of pictures side by side, and their size."""
    count = len(captions)
    most = 1 if aspect >= WIDE else 2 if aspect >= HALF_WIDE else MAX_COLUMNS
    rows = -(-count // most)
    columns = -(-count // rows)
    width -= 2.0 * PAD
    # four tall ones in a row, or rows of as many as fill the width
    panel = (width - GAP * (columns - 1)) / columns
    # a single tall picture need not fill a page
    panel = min(panel, 4.6 * aspect)
    sheet = max(columns * panel + GAP * (columns - 1) + 2.0 * PAD, LEAST_WIDTH)
    lines = len(wrapped(title, sheet))
    head = TITLE + LINE * (lines - 1) if lines else 0.06
    caption = CAPTION + REASON * max((caption.count("\n") for caption in captions), default=0)
    return Layout(columns, rows, sheet, (panel, panel / aspect), head, caption)


def with_footer(sizes: Layout, key: Key) -> Layout:
    """The layout with as high a legend as its names ask for."""
    return replace(sizes, footer=key.footer(sizes.width, sizes.panel[0]))


def draw_scale_bar(axes: Axes, ends: tuple[float, float], height: float) -> None:
    """A line with caps, in inches."""
    axes.plot(ends, (height, height), color=INK, linewidth=2.2, solid_capstyle="butt")
    for end in ends:
        axes.plot([end, end], [height - 0.05, height + 0.05], color=INK, linewidth=1)


@dataclass(frozen=True)
class Margins:
    """Room below the picture of a film, and below the legend in it [inches]."""

    below: float
    bottom_margin: float


class Sheet:
    """The sheet of a film (height, width, 3): a window for the picture, a line for the time."""

    def __init__(
        self, title: str, key: Key, size: tuple[int, int], speed: str, position: Margins
    ) -> None:
        width, height = size
        self.window = film_window(size, position.below)
        with mpl.rc_context(MATPLOTLIB):
            figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
            line = "".join(lines_of(title, 0.96 * width / DPI, FILM_TITLE_SIZE, 1))
            high = 1 - 0.17 * DPI / height
            figure.text(0.02, high, line, va="center", fontsize=FILM_TITLE_SIZE, weight="bold")
            figure.text(
                0.98,
                1 - 0.40 * DPI / height,
                speed,
                va="center",
                ha="right",
                fontsize=7,
                color=MUTED,
            )
            footer(
                figure,
                key,
                width / DPI,
                position.below - position.bottom_margin,
                position.bottom_margin,
            )
            canvas = FigureCanvasAgg(figure)
            canvas.draw()
            self.blank = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()

    def frame(self, picture: np.ndarray, time: str) -> np.ndarray:
        """The sheet with a picture and a time."""
        from PIL import Image, ImageDraw

        left, top, width, height = self.window
        canvas = self.blank.copy()
        canvas[top : top + height, left : left + width] = picture
        image = Image.fromarray(canvas)
        position = (0.02 * canvas.shape[1], 0.40 * DPI)
        ImageDraw.Draw(image).text(position, time, fill=INK, font=_font(), anchor="lm")
        return np.asarray(image)


def narrowest(*, has_arrows: bool, has_more: bool) -> int:
    """Least width [pixels] of a film whose legend has arrows, and colours or names."""
    return NARROWEST_WITH_ARROWS if has_arrows and has_more else NARROWEST


def film_size(
    aspect: float, width: int, least_width: int = NARROWEST, below: float = FOOTER + CONTROLS
) -> tuple[int, int]:
    """Width and height of a film, both even, for a picture of this aspect, at most `width` wide.

    `below` is the height of the rows below the picture [inches].
    """
    least, most = FILM_HEIGHTS
    window = float(np.clip(width / aspect, least * width, most * width))
    whole = float(np.clip(window * aspect, min(least_width, width), width))
    beside = (FILM_HEAD + below) * DPI
    return 2 * round(whole / 2), 2 * round((window + beside) / 2)


def film_window(
    size: tuple[int, int], below: float = FOOTER + CONTROLS
) -> tuple[int, int, int, int]:
    """Left, top, width and height of the picture on the sheet of a film [pixels]."""
    top, bottom = round(FILM_HEAD * DPI), round(below * DPI)
    return 0, top, size[0], size[1] - top - bottom


def _font() -> ImageFont.FreeTypeFont:
    from matplotlib import font_manager
    from PIL import ImageFont

    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), round(9 / 72 * DPI))


def head(figure: Figure, title: str) -> None:
    """The title above pictures."""
    if title:
        width, height = figure.get_size_inches()
        text = "\n".join(wrapped(title, width))
        figure.text(
            PAD / width,
            1 - (PAD + 0.03) / height,
            text,
            va="top",
            fontsize=TITLE_SIZE,
            weight="bold",
        )


def panel(
    figure: Figure,
    picture: np.ndarray,
    position: tuple[float, float, float, float],
    caption: str,
    *,
    is_tall: bool,
) -> Axes:
    """A picture at left, bottom, width and height [inches], with its caption above."""
    width, height = figure.get_size_inches()
    left, bottom, w, h = position
    axes = figure.add_axes((left / width, bottom / height, w / width, h / height))
    axes.imshow(picture, interpolation="antialiased", aspect="auto")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set(visible=True, color="#d5d9dd", linewidth=0.6)
    time, *reasons = caption.split("\n")
    low = (bottom + h + 0.035) / height
    # the reason of a moment is written below its time, in the words of the command
    most = max(int(w * 17), 10)
    for reason in reversed(reasons if is_tall else ()):
        figure.text(left / width, low, fitted(reason, most), fontsize=7, va="bottom", color=MUTED)
        low += REASON / height
    figure.text(left / width, low, time, fontsize=8.5, va="bottom")
    return axes


def footer(figure: Figure, key: Key, panel: float, tall: float, bottom_margin: float = 0.0) -> None:
    """Scale bar on the left, colours or names in the middle, arrows on the right [inches]."""
    width, height = figure.get_size_inches()
    length, label = key.scale_bar
    bar = length / key.camera.width * panel
    # written from the top of the legend downwards: more names take more lines
    low = FOOTER - tall
    axes = figure.add_axes((0, bottom_margin / height, 1, tall / height))
    axes.set_axis_off()
    axes.set_xlim(0, width)
    axes.set_ylim(low, FOOTER)
    left = PAD + 0.02
    draw_scale_bar(axes, (left, left + bar), 0.36)
    axes.text(left, 0.24, label, fontsize=8, va="top", color=INK)
    axes.text(left, 0.11, key.note, fontsize=8, va="top", color=ARROW)
    start, stop = key.between(width, panel)
    if key.colour_scale.name:
        _colour_bar(figure, key.colour_scale, (start, stop), bottom_margin - low)
    if key.names:
        _names(axes, key.names, (start, stop), 0.02 if key.colour_scale.name else 0.42)
    if key.arrow_size:
        _arrow(axes, key, width - ARROWS_ROOM + 0.15, panel)


def _arrow(axes: Axes, key: Key, left: float, panel: float) -> None:
    """An arrow of a round size, as long as it would be in the picture."""
    length, label = key.arrow_bar(panel)
    head = min(0.1, 0.6 * length)
    axes.plot([left, left + length - 0.5 * head], [0.36, 0.36], color=ARROW, linewidth=2)
    tip = [(left + length, 0.36), (left + length - head, 0.41), (left + length - head, 0.31)]
    axes.add_patch(Polygon(tip, color=ARROW, linewidth=0))
    axes.text(left, 0.49, label, fontsize=8, va="bottom", color=INK)
    axes.text(left, 0.24, key.arrow_label, fontsize=8, va="top", color=INK)


def _colour_bar(
    figure: Figure, colour_scale: ColourScale, ends: tuple[float, float], bottom_margin: float
) -> None:
    width, height = figure.get_size_inches()
    start, stop = ends[0], min(max(ends[1] - 0.25, ends[0] + LEAST_BAR), ends[0] + 3.2)
    position = (
        start / width,
        (bottom_margin + 0.34) / height,
        (stop - start) / width,
        0.11 / height,
    )
    axes = figure.add_axes(position)
    scale = colour_scale.scale
    norm = Normalize(colour_scale.low * scale, colour_scale.high * scale)
    bar = figure.colorbar(
        ScalarMappable(norm, colour_scale.cmap), cax=axes, orientation="horizontal"
    )
    ticks = np.linspace(norm.vmin or 0.0, norm.vmax or 0.0, 3)
    bar.set_ticks([float(v) for v in ticks], labels=[tick(float(f"{v:.3g}")) for v in ticks])
    axes.tick_params(labelsize=7.5, length=2)
    axes.grid(False)
    unit = colour_scale.shown_unit if colour_scale.shown_unit not in ("", "1") else ""
    words = ", ".join(part for part in (colour_scale.name.replace("_", " "), unit) if part)
    figure.text(
        start / width, (bottom_margin + 0.49) / height, words, fontsize=8, va="bottom", color=INK
    )


def shown_names(names: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Names with their colours as the legend has room for them."""
    shown = list(names[:MAX_NAMES])
    if len(names) > MAX_NAMES:
        shown[-1] = (f"and {len(names) - MAX_NAMES + 1} more", "#ffffff")
    return shown


def name_width(shown: Sequence[tuple[str, str]]) -> float:
    """Room for a name [inches]: that of the longest."""
    longest = max(len(name) for name, _ in shown)
    return max((longest + 4) / LETTERS_PER_INCH, 0.8)


def name_grid(names: Sequence[tuple[str, str]], room: float) -> tuple[int, int]:
    """Lines and columns of a legend of names in some inches; long names are cut, not lost."""
    count = len(shown_names(names))
    few = -(-count // NAME_LINES) if count > 3 else count
    # a column is 0.8 inches wide, eight letters of a name, to 2 inches
    columns = max(min(few, int(room / min(name_width(shown_names(names)), 2.0))), 1)
    return -(-count // columns), columns


def _names(
    axes: Axes, names: Sequence[tuple[str, str]], ends: tuple[float, float], top: float
) -> None:
    """A square of its colour before each name, from a height on downwards."""
    shown, (start, stop) = shown_names(names), ends
    _, columns = name_grid(names, stop - start)
    step = min((stop - start) / columns, name_width(shown))
    most = max(int(step * LETTERS_PER_INCH) - 3, 5)
    for k, (name, colour) in enumerate(shown):
        row, column = divmod(k, columns)
        x, y = start + column * step, top - NAME_LINE * row
        axes.plot([x + 0.05], [y], "s", color=colour, markersize=6)
        axes.text(x + 0.15, y, fitted(name, most), fontsize=8, va="center", color=INK)


def fitted(name: str, most: int) -> str:
    """A name of at most so many letters: of long ones both ends, which distinguish them."""
    if len(name) <= most:
        return name
    tail = (most - 1) // 2
    return f"{name[: most - 1 - tail]}\N{HORIZONTAL ELLIPSIS}{name[-tail:]}"
