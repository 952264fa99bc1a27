"""Titles in the width of a sheet, measured by their letters; a title is text, never mathematics."""

import textwrap

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

# lines of the title of a strip
MAX_LINES = 4
# [of the size of letters] of the narrowest
NARROWEST = 0.25


def lines_of(title: str, width: float, size: float, most_lines: int = MAX_LINES) -> list[str]:
    """A title in bold letters of a size [points] in lines that fit a width [inches], cut where they
    are too many.
    """
    letters = max(int(72.0 * width / (NARROWEST * size)), 1)
    lines = _wrapped(title, letters, most_lines)
    while letters > 1 and any(_width(line, size) > width for line in lines):
        letters = max(int(0.95 * letters), 1)
        lines = _wrapped(title, letters, most_lines)
    return lines


def _wrapped(title: str, letters: int, most_lines: int) -> list[str]:
    return textwrap.wrap(
        title, letters, max_lines=most_lines, placeholder="\N{HORIZONTAL ELLIPSIS}"
    )


def _width(line: str, size: float) -> float:
    """Width of a line [inches]."""
    font = FontProperties(weight="bold", size=size)
    points, _, _ = text_to_path.get_text_width_height_descent(line, font, ismath=False)
    return float(points) / 72.0
