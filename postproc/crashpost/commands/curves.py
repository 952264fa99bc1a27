"""The commands `plot`, `compare` and `export`: words turned into figures, tables and files."""

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crashpost.errors import PostError
from crashpost.results.text import printable_lines
from crashsolve.channels.command_line import output_path

if TYPE_CHECKING:
    from crashpost.compare.difference import Compared
    from crashpost.results.result import Result

CHANNELS = "name, pattern such as 'rcforc.*.force.x', or arithmetic such as '-a.b.c / 2'"
KINDS = "force, gap, force_displacement, crush, injury, motion, energy, momentum"

Add = Callable[[str, Callable[[argparse.Namespace], int], str], argparse.ArgumentParser]


def add_commands(add: Add) -> None:
    """Put `plot`, `compare` and `export` among the commands."""
    sub = add("plot", _plot, "plot channels of one or several results in one diagram")
    about = f"more results; {CHANNELS}; or a figure by its word: {KINDS}"
    sub.add_argument("words", nargs="+", metavar="RESULT|CHANNEL[:STATISTIC]", help=about)
    sub.add_argument("--against", default="time", metavar="CHANNEL", help="abscissa, default time")
    sub.add_argument("--along", metavar="PATTERN", help="abscissa of entities, at the moments --at")
    sub.add_argument("--at", default="", metavar="T,T,...", help="moments [s] of --along")
    sub.add_argument("--log", choices=("x", "y", "xy"), default="", help="logarithmic axes")
    sub.add_argument("--x-range", metavar="FROM:TO", help="limits, in the unit shown")
    sub.add_argument("--y-range", metavar="FROM:TO", help="the same")
    sub.add_argument("--title", default="", help="of the figure; words of its channels when absent")
    _add_tests(sub)
    sub.add_argument(
        "-o", "--output", type=output_path, help="png, svg or pdf; default RESULT/plot.png"
    )
    add_units(sub)
    sub = add("compare", _compare, "compare results side by side; exit code 1 where they differ")
    about = f"more results; {CHANNELS}; all if absent"
    sub.add_argument("words", nargs="+", metavar="RESULT|CHANNEL", help=about)
    sub.add_argument(
        "--tolerance",
        default="1 %",
        metavar="SHARE",
        help="differences up to this fraction of a channel's range count as none, default 1 %%",
    )
    sub.add_argument("--all", action="store_true", help="list channels within the tolerance too")
    _add_tests(sub)
    sub.add_argument("--during", metavar="FROM:TO", help="rate these times alone (seconds)")
    sub.add_argument(
        "-o", "--output", type=output_path, metavar="PAGE", help="an HTML page with figures"
    )
    add_units(sub)
    sub = add("export", _export, "write channels as CSV, Parquet or ISO-MME")
    sub.add_argument("channels", nargs="*", metavar="CHANNEL", help=f"{CHANNELS}; all if absent")
    sub.add_argument(
        *("-o", "--output", "--csv"),
        type=Path,
        required=True,
        metavar="FILE",
        help="to be written: .csv, .parquet or .mme",
    )


def add_units(sub: argparse.ArgumentParser) -> None:
    """The option of units."""
    about = "show a channel in this unit; or units for all that fits, such as kN,mm,ms"
    _add_repeated(sub, "--unit", "[CHANNEL=]UNIT", about)


def _add_tests(sub: argparse.ArgumentParser) -> None:
    about = "measured curves: columns 'time [ms], force [kN], lower [kN], upper [kN]'"
    _add_repeated(sub, "--test", "FILE", about, type=Path)


def _add_repeated(
    sub: argparse.ArgumentParser, word: str, metavar: str, about: str, **more: Any
) -> None:
    """An option that may be given several times."""
    sub.add_argument(word, action="append", default=[], metavar=metavar, help=about, **more)


def _results(options: argparse.Namespace) -> tuple[list["Result"], list[str]]:
    """The results and the other words; raises PostError for a result that is not there."""
    from crashpost.results.result import Result

    results, words = [Result(options.result)], list[str]()
    for word in options.words:
        path = Path(word.strip())
        if (path / "history.h5").is_file() or path.suffix in (".results", ".h5"):
            results.append(Result(path))
        elif path.is_dir():
            raise PostError(f"{path}: a folder without history.h5 is no result")
        else:
            words.append(word)
    folders = [result.folder.resolve() for result in results]
    if len(set(folders)) < len(folders):
        raise PostError("a result is named twice")
    return results, words


def _plot(options: argparse.Namespace) -> int:
    results, words = _results(options)
    from crashpost.figures.draw import save
    from crashpost.figures.overlay import names
    from crashpost.figures.panels import PlotRequest, panels, profile
    from crashpost.values.measured import read_test
    from crashpost.values.units import Units

    request = PlotRequest(
        channels=words,
        against=options.against.strip(),
        units=Units.read(options.unit),
        title=options.title,
        log=options.log,
        x_range=_ends(options.x_range, "--x-range"),
        y_range=_ends(options.y_range, "--y-range"),
        tests=[read_test(path) for path in options.test],
    )
    if not words:
        raise PostError(f"name what to draw: channels, or {KINDS}")
    if options.along:
        if len(words) > 1 or len(results) > 1 or options.test:
            raise PostError("--along draws one pattern of one result")
        moments = [_moment(text) for text in options.at.split(",") if text.strip()]
        figures = [profile(results[0], words[0].strip(), options.along.strip(), moments, request)]
    else:
        if options.at:
            raise PostError("--at goes with --along")
        figures = panels(results, names(results), request)
    output = options.output or results[0].folder / "plot.png"
    save(results, figures, output)
    print(printable_lines(str(output)))
    return 0


def _compare(options: argparse.Namespace) -> int:
    results, words = _results(options)
    from crashpost.compare.corridors import HEADER, corridor_rows
    from crashpost.compare.difference import Compared, compare
    from crashpost.compare.side_by_side import (
        differences_text,
        rating_rows,
        ratings_text,
        write_page,
    )
    from crashpost.figures.overlay import names
    from crashpost.results.table import text_table

    tolerance = _share(options.tolerance)
    during = _ends(options.during, "--during")
    named = names(results)
    rated = rating_rows(results, named, words, options.test, during)
    in_corridors, exceeds = corridor_rows(results, named, words, options.test, during)
    # one result alone may be rated against a test
    is_alone = len(results) == 1 and bool(options.test)
    compared = Compared([], []) if is_alone else compare(results, words)
    parts = [
        differences_text(compared, named, tolerance, everything=options.all),
        ratings_text(rated),
    ]
    parts.append(text_table(HEADER, in_corridors) if in_corridors else "")
    print(printable_lines("\n\n".join(part for part in parts if part)))
    if options.output:
        write_page(results, named, compared, tolerance, rated, in_corridors, options)
        print(printable_lines(str(options.output)))
    return 1 if differ(compared, tolerance) or exceeds else 0


def differ(compared: "Compared", tolerance: float) -> bool:
    """Whether results differ: a channel beyond the tolerance, or in one of them only."""
    return bool(compared.remarks) or any(one.is_beyond(tolerance) for one in compared.differences)


def _export(options: argparse.Namespace) -> int:
    from crashpost.exports.files import export
    from crashpost.results.result import Result

    count = export(Result(options.result), options.output, options.channels or ["*"])
    print(printable_lines(f"{options.output}: {count} channels"))
    return 0


def _ends(text: str | None, option: str) -> tuple[float, float] | None:
    """Two different numbers; raises PostError."""
    if text is None:
        return None
    try:
        first, last = map(float, text.split(":"))
    except ValueError:
        raise PostError(f"{option} takes FROM:TO, not '{text}'") from None
    if first == last or not (math.isfinite(first) and math.isfinite(last)):
        raise PostError(f"{option} takes two different numbers, not '{text}'")
    return first, last


def _moment(text: str) -> float:
    """A time [s] such as 0.05 or 50ms; raises PostError."""
    from crashsolve.channels.display import factor
    from crashsolve.channels.units import split_quantity

    number, unit = split_quantity(text.strip())
    return float(number) * (factor(unit, "s") if unit else 1.0)


def _share(text: str) -> float:
    """A share such as 1 % or 0.01; raises PostError."""
    bare = text.strip()
    try:
        value = float(bare.removesuffix("%")) / (100.0 if bare.endswith("%") else 1.0)
    except ValueError:
        value = math.nan
    if not 0.0 <= value < math.inf:
        raise PostError(f"--tolerance takes a share such as '1 %' or 0.01, not '{text}'")
    return value
