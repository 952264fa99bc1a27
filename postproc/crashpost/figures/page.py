"""The few pieces of HTML the report is made of; all text is escaped here."""

from collections.abc import Sequence
from html import escape

from crashpost.figures.draw import Key, repeats_title
from crashpost.figures.style import CSS

# words of verdicts
GOOD, BAD = frozenset({"pass", "met", "within"}), frozenset({"FAIL", "missed", "beyond"})

# captions of large values that say something was missed
EXPECTED, MISSED_PUBLISHED = "expectations met, the others missed", "published numbers missed"
BAD_FACTS = frozenset({EXPECTED, MISSED_PUBLISHED})

__all__ = ["block", "escape", "figure", "details", "page", "table", "tiles"]


def page(title: str, body: Sequence[str]) -> str:
    """A complete document that needs nothing from anywhere else."""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{CSS}</style></head>\n<body>\n"
        + "\n".join(part for part in body if part)
        + "\n</body></html>\n"
    )


def block(anchor: str, title: str, *parts: str) -> str:
    """A section with a heading; nothing when it has no content."""
    content = "\n".join(part for part in parts if part)
    return (
        f'<section id="{anchor}"><h2>{escape(title)}</h2>\n{content}</section>' if content else ""
    )


def table(header: Sequence[str], rows: Sequence[Sequence[str]], classes: Sequence[str]) -> str:
    """Rows of cells; `classes` has the CSS class of each column: "", "num", "unit" or "name"."""
    if not rows:
        return ""
    heads = [
        f'<th class="num">{escape(words)}</th>'
        if css_class == "num"
        else f"<th>{escape(words)}</th>"
        for words, css_class in zip(header, classes, strict=True)
    ]
    lines = ["".join(map(_cell, row, classes)) for row in rows]
    # a row that reports a miss is coloured as one
    body = "\n".join(
        f'<tr class="missed">{line}</tr>' if BAD & set(row) else f"<tr>{line}</tr>"
        for row, line in zip(rows, lines, strict=True)
    )
    return (
        f'<div class="scroll"><table><thead><tr>{"".join(heads)}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def tiles(facts: Sequence[tuple[str, str]]) -> str:
    """Large values with a small caption each."""
    cells = [
        f'<div class="tile{" bad" if caption in BAD_FACTS else ""}"><b>{escape(value)}</b>'
        f"<span>{escape(caption)}</span></div>"
        for value, caption in facts
    ]
    return f'<div class="tiles">{"".join(cells)}</div>' if cells else ""


def details(title: str, content: str, *, unfolded: bool = False) -> str:
    """A section with a title that unfolds on demand."""
    state = " open" if unfolded else ""
    return (
        f"<details{state}><summary>{escape(title)}</summary>{content}</details>" if content else ""
    )


def figure(title: str, drawing: str, keys: Sequence[Key], below: str) -> str:
    """A drawing with its title and legend above and its comparison below."""
    keys = [] if repeats_title([key.label for key in keys], title) else keys
    items = "".join(f"<li>{_swatch(key)}{escape(key.label)}</li>" for key in keys)
    legend = f'<ul class="legend">{items}</ul>' if items else ""
    above = f"<figcaption><h3>{escape(title)}</h3>{legend}</figcaption>"
    return f"<figure>{above}{drawing}{below}</figure>"


def _cell(text: str, css_class: str) -> str:
    css_class = "fail" if text in BAD else "pass" if text in GOOD else css_class
    # a long channel name may be broken after its dots, and only there
    shown = escape(text).replace(".", ".<wbr>") if css_class == "name" else escape(text)
    return f'<td class="{css_class}">{shown}</td>' if css_class else f"<td>{shown}</td>"


def _swatch(key: Key) -> str:
    """The mark of a legend entry, drawn as in the figure."""
    dashes = " ".join(f"{2 * length:g}" for length in key.dashes) or "none"
    colour = key.colour
    line = (
        f'<line x1="0" y1="6" x2="24" y2="6" stroke="{colour}" stroke-width="2.4" '
        f'stroke-dasharray="{dashes}"/>'
    )
    marks = {
        "band": f'<rect width="24" height="12" fill="{colour}" fill-opacity=".28"/>',
        "point": f'<circle cx="12" cy="6" r="4" fill="#fff" stroke="{colour}" stroke-width="2"/>',
    }
    drawn = marks.get(key.mark, line)
    return f'<svg viewBox="0 0 24 12" aria-hidden="true">{drawn}</svg>'
