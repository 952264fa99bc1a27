"""A strip: pictures of a run at some moments on one sheet, with close-ups below them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from crashpost.errors import PostError
from crashpost.figures.style import INK, MATPLOTLIB
from crashpost.renders.close_up import ASPECT, CloseUp
from crashpost.renders.sheet import (
    CAPTION,
    CLOSE_UP_HEAD,
    DPI,
    GAP,
    MAX_COLUMNS,
    PAD,
    Key,
    Layout,
    draw_scale_bar,
    footer,
    head,
    panel,
    scale_bar,
)
from crashpost.results.whole_file import whole_file

# width of a close-up at most [inches]
WIDEST = 2.6


@dataclass(frozen=True)
class Content:
    """Content of a strip: pictures with their captions, and close-ups at the same times."""

    title: str
    captions: Sequence[str]
    pictures: Sequence[np.ndarray]
    close_up: CloseUp | None = None
    closer: Sequence[np.ndarray] = ()


def with_close_ups(sizes: Layout, count: int) -> Layout:
    """The layout with rows of close-ups."""
    rows = -(-count // MAX_COLUMNS)
    columns = -(-count // rows)
    width = min((sizes.width - 2.0 * PAD - GAP * (columns - 1)) / columns, WIDEST)
    return replace(sizes, closer_rows=rows, closer=(width, width / ASPECT))


def strip(path: Path, content: Content, key: Key, sizes: Layout) -> None:
    """Write a sheet with a picture for each moment; raises PostError."""
    with mpl.rc_context(MATPLOTLIB):
        figure = Figure(figsize=(sizes.width, sizes.height), dpi=DPI)
        head(figure, content.title)
        w, h = sizes.panel
        is_tall = sizes.caption > CAPTION
        for k, (picture, caption) in enumerate(
            zip(content.pictures, content.captions, strict=True)
        ):
            row, column = divmod(k, sizes.columns)
            left = PAD + column * (w + GAP)
            top = sizes.height - PAD - sizes.title - row * (h + sizes.caption + GAP)
            position = (left, top - sizes.caption - h, w, h)
            axes = panel(figure, picture, position, caption, is_tall=is_tall)
            if content.close_up:
                x, y, wide, high = content.close_up.frame(k)
                window = Rectangle((x, y), wide, high, transform=axes.transAxes)
                window.set(fill=False, edgecolor=INK, linewidth=0.8)
                axes.add_patch(window)
        if content.close_up:
            _close_ups(figure, content, content.close_up, sizes)
        footer(figure, key, w, sizes.footer)
        with whole_file(path) as partial:
            try:
                figure.savefig(partial, dpi=DPI)
            except ValueError as error:
                raise PostError(f"{path}: {error}") from error


def _close_ups(figure: Figure, content: Content, close: CloseUp, sizes: Layout) -> None:
    """The close-ups below the pictures, with a heading and a scale bar of their own."""
    w, h = sizes.closer
    columns = -(-len(content.closer) // sizes.closer_rows)
    top = sizes.footer + sizes.close_ups
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.set_xlim(0, sizes.width)
    axes.set_ylim(0, sizes.height)
    words = f"Close-up: {close.name}"
    axes.text(PAD, top - 0.12, words, fontsize=8.5, weight="bold", va="center")
    length, label = scale_bar(close.width)
    right = sizes.width - PAD
    left = right - length / close.width * w
    draw_scale_bar(axes, (left, right), top - 0.12)
    axes.text(left - 0.08, top - 0.12, label, fontsize=8, va="center", ha="right", color=INK)
    for k, (picture, caption) in enumerate(zip(content.closer, content.captions, strict=True)):
        row, column = divmod(k, columns)
        below = top - CLOSE_UP_HEAD + 0.12 - row * (h + CAPTION + GAP)
        position = (PAD + column * (w + GAP), below - CAPTION - h, w, h)
        panel(figure, picture, position, caption.partition("\n")[0], is_tall=False)
