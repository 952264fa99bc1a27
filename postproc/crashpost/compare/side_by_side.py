"""The table, ratings and page of `crashpost compare`."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from crashpost.compare.corridors import HEADER
from crashpost.compare.difference import Compared, Difference
from crashpost.compare.rating import rating
from crashpost.errors import PostError
from crashpost.figures.panels import PlotRequest, panels
from crashpost.results.choice import choices
from crashpost.results.result import Result
from crashpost.results.table import number, text_table
from crashpost.results.whole_file import write_html
from crashpost.values.measured import read_test
from crashpost.values.units import Units
from crashpost.values.words import title
from crashsolve.channels.display import is_convertible

MAX_ROWS, MAX_FIGURES = 60, 12
MEASURE = (
    "difference: largest distance of the two histories in time, in % of the range of both; rms: "
    "root of the mean square of the distance, in % of the same range"
)
RATINGS = ("result", "channel", "test", "rating", "", "corridor", "phase", "magnitude", "slope")


def rows(
    differences: Sequence[Difference], named: Sequence[str], tolerance: float
) -> list[list[str]]:
    """A row for each difference: verdict, channel, sizes, difference in % of the range, when."""
    return [
        [
            "beyond" if one.is_beyond(tolerance) else "within",
            one.channel,
            named[one.run],
            one.unit or "-",
            *map(number, one.sizes),
            f"{100 * one.largest:.3g}%",
            f"{100 * one.rms:.3g}%",
            number(one.time),
        ]
        for one in differences
    ]


def header(named: Sequence[str]) -> tuple[str, ...]:
    """The names of the columns of `rows`."""
    sizes = (f"largest in {named[0]}", "in this result")
    return ("", "channel", "result", "unit", *sizes, "difference", "rms", "at s")


def differences_text(
    compared: Compared, named: Sequence[str], tolerance: float, *, everything: bool
) -> str:
    """Channels that differ, or all, as text; "" where nothing was compared."""
    if not compared.differences and not compared.remarks:
        return ""
    beyond = [one for one in compared.differences if one.is_beyond(tolerance)]
    shown = compared.differences if everything else beyond[:MAX_ROWS]
    parts = [text_table(header(named), rows(shown, named, tolerance))] if shown else []
    if len(beyond) > MAX_ROWS and not everything:
        parts.append(f"... and {len(beyond) - MAX_ROWS} more; --all lists them")
    parts += [MEASURE, summary(compared, tolerance)]
    parts += [f"remark: {remark}" for remark in compared.remarks]
    return "\n".join(parts)


def summary(compared: Compared, tolerance: float) -> str:
    """Number of channels that differ, in words."""
    beyond = sum(one.is_beyond(tolerance) for one in compared.differences)
    return (
        f"{beyond} of {len(compared.differences)} channels differ by more than "
        f"{100 * tolerance:.4g} % of their range"
    )


def rating_rows(
    results: Sequence[Result],
    named: Sequence[str],
    words: Sequence[str],
    tests: Sequence[Path],
    during: tuple[float, float] | None,
) -> list[list[str]]:
    """ISO 18571 of every channel named against every measured curve of its kind."""
    if during and not tests:
        raise PostError("--during limits ratings, which need --test")
    if tests and not words:
        raise PostError("name the channel that is rated against the test")
    lines = []
    for test in map(read_test, tests):
        fitting = 0
        for result, name in zip(results, named, strict=True):
            for choice in choices(result, words):
                series = result.series(choice.channel)
                for curve in test.curves:
                    if is_convertible(series.unit, curve.unit):
                        rated = rating(series, test, curve, during)
                        numbers = [f"{value:.3f}" for value in rated[1:5]]
                        row = [name, choice.channel, f"{test.name}: {curve.name}"]
                        lines.append([*row, f"{rated.overall:.3f}", rated.grade, *numbers])
                        fitting += 1
        if not fitting and test.corridor is None:
            raise PostError(f"test '{test.name}' has no curve in the unit of {' '.join(words)}")
    return lines


def ratings_text(rated: Sequence[Sequence[str]]) -> str:
    """Ratings as text, "" without any."""
    return text_table(RATINGS, rated) if rated else ""


def write_page(
    results: Sequence[Result],
    named: Sequence[str],
    compared: Compared,
    tolerance: float,
    rated: Sequence[Sequence[str]],
    in_corridors: Sequence[Sequence[str]],
    options: argparse.Namespace,
) -> None:
    """The page of a comparison: the largest differences as figures, then tables. Raises
    PostError.
    """
    from crashpost.figures.page import block, escape, page, table, tiles

    beyond = [one for one in compared.differences if one.is_beyond(tolerance)]
    heading = " and ".join(named) if len(named) < 3 else f"{len(named)} results"
    units = Units.read(options.unit)
    shown = list(dict.fromkeys(one.channel for one in beyond or compared.differences))[:MAX_FIGURES]
    shown = shown or list(dict.fromkeys(row[1] for row in (*rated, *in_corridors)))
    classes = ("", "name", "", "unit", "num", "num", "num", "num", "num")
    listed = compared.differences if options.all else beyond
    remarks = "".join(f'<p class="problem">{escape(remark)}</p>' for remark in compared.remarks)
    facts = [
        (str(len(beyond)), f"channels differ by more than {100 * tolerance:.4g} % of their range"),
        (str(len(compared.differences) - len(beyond)), "channels within"),
    ]
    body = [
        '<header><div class="eyebrow">crashsolve results compared</div>'
        f"<h1>{escape(results[0].title)}: {escape(heading)}</h1>{tiles(facts)}{remarks}</header>",
        block("ratings", "Rating, ISO/TS 18571", table(RATINGS, rated, ("",) * len(RATINGS))),
        block("corridors", "Corridors", table(HEADER, in_corridors, ("",) * len(HEADER))),
        block("curves", "Curves", _figures(results, named, shown, options.test, units)),
        block(
            "differences",
            "Differences",
            table(header(named), rows(listed, named, tolerance), classes),
            f'<p class="note">{MEASURE[0].upper()}{MEASURE[1:]}.</p>' * bool(listed),
        ),
    ]
    write_html(options.output, page(f"{results[0].title}, compared", body))


def _figures(
    results: Sequence[Result],
    named: Sequence[str],
    channels: Sequence[str],
    tests: Sequence[Path],
    units: Units,
) -> str:
    """A figure for each channel, of all results that have it, with the tests that fit."""
    from crashpost.figures import draw
    from crashpost.figures.page import figure

    parts = []
    for at, channel in enumerate(channels):
        fitting = [
            test
            for test in map(read_test, tests)
            if test.fits("s", results[0].series(channel).unit)
        ]
        general = Units(of_all=units.of_all)
        request = PlotRequest([channel], title=title([channel]), units=general, tests=fitting)
        for one in panels(results, named, request):
            drawing, keys = draw.svg(results, one, f"c{at}")
            parts.append(figure(one.title, drawing, keys, ""))
    return f'<div class="figures">{"".join(parts)}</div>' if parts else ""
