"""The command `crashpost`: one sub-command per question about a result.

Exit codes: 0 answered, 1 an expectation failed, 2 the request cannot be met.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from crashpost import pictures
from crashpost.errors import PostError
from crashpost.text import printable, printable_lines

if TYPE_CHECKING:
    from crashpost.result import Result

STATISTICS_HELP = "max | min | abs_max | mean | final | integral | argmax | argmin | at:T (seconds)"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    options = _parser().parse_args(arguments)
    try:
        code: int = options.command(options)
        sys.stdout.flush()
        return code
    except PostError as error:
        print(printable(f"crashpost: error: {error}"), file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        # the reader, such as `head`, has seen enough
        _give_up_output()
        return 0
    except OSError as error:
        # files are answered for where they are opened: what is left is standard output
        if error.filename is not None:
            raise
        _give_up_output()
        print(f"crashpost: error: standard output: {error.strerror}", file=sys.stderr)
        return PostError.exit_code
    except KeyboardInterrupt:
        print("crashpost: interrupted", file=sys.stderr)
        return PostError.exit_code


def _give_up_output() -> None:
    """Send what is left to flush nowhere: no error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _say(text: str) -> None:
    """Print lines of which none can pass for another, whatever names and titles hold."""
    print(printable_lines(text))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="crashpost", description="Look into crashsolve results.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(command: str, function: object, words: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(command, help=words, description=words)
        sub.add_argument("result", type=Path, help="results folder, or the history.h5 in it")
        sub.set_defaults(command=function)
        return sub

    add("summary", _summary, "status, energies, balances, peaks and warnings on one screen")
    sub = add("channels", _channels, "list the channels")
    sub.add_argument("--match", default="*", metavar="GLOB", help="only names that fit")
    sub = add("value", _value, "one number of a channel, for scripts")
    sub.add_argument("channel", help="channel, or arithmetic on channels, as in '(-a.b.c)'")
    sub.add_argument("--statistic", required=True, metavar="WORD", help=STATISTICS_HELP)
    sub.add_argument("--during", metavar="FROM:TO", help="only samples of these times (seconds)")
    sub.add_argument("--unit", help="unit of the channel's values; its own when absent")
    sub = add("values", _values, "many numbers at once, for programs: JSON in, JSON out")
    sub.add_argument(
        "questions",
        type=Path,
        help="JSON list of {channel, statistic, during, unit}; statistic: as of value, or path",
    )
    sub = add("expect", _expect, "evaluate the deck's expectations")
    sub.add_argument("--partial", action="store_true", help="also of a run that did not finish")
    sub = add("plot", _plot, "draw channels")
    sub.add_argument("channels", nargs="+", metavar="channel")
    sub.add_argument("--against", default="time", metavar="CHANNEL", help="abscissa, default time")
    sub.add_argument("-o", "--output", type=Path, help="png, svg or pdf; default RESULT/plot.png")
    sub.add_argument(
        "--unit",
        action="append",
        default=[],
        metavar="CHANNEL=UNIT",
        help="show a channel, or time, in this unit",
    )
    pictures.add_commands(add)
    sub = add("export", _export, "write channels as comma-separated values")
    sub.add_argument("--csv", type=Path, required=True, metavar="FILE")
    sub.add_argument("--channels", nargs="+", default=["*"], metavar="GLOB")
    sub = add("report", _report, "write one self-contained HTML page")
    sub.add_argument("-o", "--output", type=Path, help="default RESULT/report.html")
    sub.add_argument(
        "--pictures",
        choices=("all", "strips", "none"),
        default="all",
        help="strips: without film and 3-D; none: curves and tables only",
    )
    return parser


def _open(options: argparse.Namespace) -> "Result":
    # h5py and numpy are loaded only once a result is really opened
    from crashpost.result import Result

    return Result(options.result)


def _summary(options: argparse.Namespace) -> int:
    from crashpost.summary import summary

    _say(summary(_open(options)))
    return 0


def _channels(options: argparse.Namespace) -> int:
    from crashpost.table import text_table

    channels = list(_open(options).channels(options.match))
    if not channels:
        raise PostError(f"no channel fits '{options.match}'")
    rows = [[c.name, c.unit or "-", str(c.samples), c.meaning] for c in channels]
    _say(text_table(("channel", "unit", "samples", "meaning"), rows))
    return 0


def _value(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.expression import Series
    from crashpost.statistic import statistic
    from crashpost.units import factor

    time, values, unit = result.series(options.channel)
    if options.unit:
        values = values * factor(unit, options.unit)
    series = Series(time, values, options.unit or unit)
    during = _window(options.during) if options.during else None
    print(repr(statistic(series, options.statistic, during)))
    return 0


def _values(options: argparse.Namespace) -> int:
    import json

    from crashpost.questions import answers

    print(json.dumps(answers(_open(options), options.questions)))
    return 0


def _window(text: str) -> tuple[float, float]:
    try:
        first, last = map(float, text.split(":"))
    except ValueError:
        raise PostError(f"--during takes FROM:TO in seconds, not '{text}'") from None
    return first, last


def _expect(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.expectation import judge, verdict_table

    state = result.status.get("state", "unknown")
    if not result.finished and not options.partial:
        raise PostError(f"the run is not finished (state: {state}); --partial judges what there is")
    verdicts = judge(result)
    if not verdicts:
        print("the deck expects nothing")
        return 0
    _say(verdict_table(verdicts))
    failed = sum(not verdict.passed for verdict in verdicts)
    print(f"\n{len(verdicts) - failed} of {len(verdicts)} expectations met")
    return 1 if failed else 0


def _plot(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.draw import save
    from crashpost.gallery import panels

    units = dict(_unit_choice(text) for text in options.unit)
    output = options.output or result.folder / "plot.png"
    save(result, panels(result, options.channels, options.against, units), output)
    _say(str(output))
    return 0


def _unit_choice(text: str) -> tuple[str, str]:
    channel, equals, unit = text.rpartition("=")
    if not equals or not unit:
        raise PostError(f"--unit takes CHANNEL=UNIT, not '{text}'")
    return channel, unit


def _export(options: argparse.Namespace) -> int:
    from crashpost.export import export_csv

    count = export_csv(_open(options), options.csv, options.channels)
    _say(f"{options.csv}: {count} channels")
    return 0


def _report(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.report import report

    text, problems = report(result, options.pictures)
    output = options.output or result.folder / "report.html"
    try:
        output.write_text(text, encoding="utf-8", errors="xmlcharrefreplace")
    except OSError as error:
        raise PostError(f"{output}: {error.strerror}") from error
    _say(str(output))
    if problems:
        raise PostError("; ".join(problems))
    return 0
