"""Claim: titles of pictures lie within their sheet, whatever their letters are."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from crashpost.figures.style import MATPLOTLIB
from crashpost.renders.sheet import DPI, WIDTH, head
from crashpost.renders.title import lines_of

TITLES = ["W" * 300, "i" * 300, "word " * 100, r"$\frac{1}{0}$ \mu {x} %s", "a\nb\tc", "x"]


@pytest.mark.parametrize("title", TITLES)
def test_nothing_of_a_title_is_beyond_its_sheet(title: str) -> None:
    with mpl.rc_context(MATPLOTLIB):
        figure = Figure(figsize=(WIDTH, 2.0), dpi=DPI)
        head(figure, title)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
    ink = np.asarray(canvas.buffer_rgba())[..., :3].min(axis=(0, 2)) < 128
    columns = np.flatnonzero(ink)
    # a column of pixels next to either border would be a letter that is cut
    assert columns[0] > 1 and columns[-1] < len(ink) - 2


def test_a_title_that_is_too_long_ends_with_dots() -> None:
    assert lines_of("a b", 3.0, 10.0, 1) == ["a b"]
    (line,) = lines_of("word " * 100, 3.0, 10.0, 1)
    assert line.endswith("word\N{HORIZONTAL ELLIPSIS}")
    assert lines_of("", 3.0, 10.0) == []
