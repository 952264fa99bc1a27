"""The command `crashpost`: one sub-command per question about a result.

Exit codes: 0 answered, 1 an expectation failed or a measure has no value, 2 the request cannot be
met.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from crashpost.commands import curves, pictures
from crashpost.errors import PostError, memory_limit
from crashpost.results.text import printable, printable_lines
from crashsolve import __version__
from crashsolve.channels.command_line import add_completion, completion, output_path, protected

if TYPE_CHECKING:
    from crashpost.results.result import Result

# exit code of a request that cannot be met
REFUSED = 2
# commands whose output does not show that a run has not finished
REPORTING = {"value", "values", "injury", "plot", "compare", "export", "render", "film"}
CHANNELS = "name, pattern such as 'rcforc.*.force.x', or arithmetic such as '-a.b.c / 2'"
STATISTIC = "as under expect in a deck: max, mean, at:T with T in seconds, ..."


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    given = sys.argv[1:] if arguments is None else arguments
    options = _parser().parse_args(protected(given))
    try:
        code: int = options.command(options)
        if options.word in REPORTING:
            _report_unfinished(options)
        sys.stdout.flush()
        return code
    except PostError as error:
        print(printable(f"crashpost: error: {error}"), file=sys.stderr)
        return REFUSED
    except MemoryError:
        limit = memory_limit() or "that of this machine is used up"
        print(f"crashpost: error: out of memory: {limit}", file=sys.stderr)
        return REFUSED
    except BrokenPipeError:
        # the reader, such as `head`, has closed the pipe
        _discard_output()
        return 0
    except OSError as error:
        # errors of files are handled where they are opened: this one is of standard output
        if error.filename is not None:
            raise
        _discard_output()
        print(f"crashpost: error: standard output: {error.strerror}", file=sys.stderr)
        return REFUSED
    except KeyboardInterrupt:
        print("crashpost: interrupted", file=sys.stderr)
        return REFUSED


def _discard_output() -> None:
    """Discard output that is not flushed yet: no error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _report_unfinished(options: argparse.Namespace) -> None:
    """Beside numbers, curves and pictures of a run that did not end, on standard error."""
    from crashpost.results.status import read_status, unfinished

    for path in (options.result, *map(Path, getattr(options, "words", []))):
        folder = path if path.is_dir() else path.parent
        is_result = (folder / "history.h5").is_file()
        text = unfinished(read_status(folder / "status.json")) if is_result else ""
        if text:
            print(printable(f"crashpost: {folder}: {text}"), file=sys.stderr)


def _say(text: str) -> None:
    """Print lines whose names and titles cannot imitate other lines."""
    print(printable_lines(text))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="crashpost", description="Evaluates crashsolve results.")
    parser.add_argument("--version", action="version", version=f"crashpost {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(command: str, function: object, words: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(command, help=words, description=words)
        sub.add_argument("result", type=Path, help="results folder, or the history.h5 in it")
        sub.set_defaults(command=function, word=command)
        return sub

    add("summary", _summary, "print status, energies, balances, peaks and warnings")
    sub = add("channels", _channels, "list the channels")
    sub.add_argument("channels", nargs="*", metavar="CHANNEL", help=CHANNELS)
    sub = add(
        "value", _value, "print numbers of channels, for scripts; of one channel the number alone"
    )
    sub.add_argument("channels", nargs="+", metavar="CHANNEL[:STATISTIC]", help=CHANNELS)
    sub.add_argument("--statistic", metavar="WORD", help=STATISTIC)
    sub.add_argument("--during", metavar="FROM:TO", help="only samples of these times (seconds)")
    sub.add_argument("--unit", help="unit of the numbers; their own when absent")
    sub = add("values", _values, "print many numbers at once, for programs: JSON in, JSON out")
    sub.add_argument(
        "questions",
        type=Path,
        help="JSON list of {channel, statistic, during, unit}; statistic: as of value, or path",
    )
    add("injury", _injury, "print measures of injury with their limits and errors of samples")
    sub = add("expect", _expect, "evaluate the deck's expectations")
    sub.add_argument("--partial", action="store_true", help="also of a run that did not finish")
    curves.add_commands(add)
    pictures.add_commands(add)
    sub = add("sweep", _sweep, "gather the runs of a sweep in one table, and draw them")
    sub.add_argument(
        "-o", "--output", type=output_path, help="folder of the pictures; default RESULT"
    )
    sub.add_argument("--table", action="store_true", help="only the table")
    sub = add("report", _report, "write one self-contained HTML page")
    sub.add_argument("-o", "--output", type=output_path, help="default RESULT/report.html")
    curves.add_units(sub)
    sub.add_argument(
        "--pictures",
        choices=("all", "strips", "none"),
        default="all",
        help="strips: without film and 3-D; none: curves and tables only",
    )
    add_completion(commands)
    commands.choices["completion"].set_defaults(
        command=lambda o: _completion(parser, o), word="completion"
    )
    return parser


def _open(options: argparse.Namespace) -> "Result":
    # h5py and numpy are loaded only once a result is really opened
    from crashpost.results.result import Result

    return Result(options.result)


def _summary(options: argparse.Namespace) -> int:
    from crashpost.values.summary import summary

    _say(summary(_open(options)))
    return 0


def _injury(options: argparse.Namespace) -> int:
    from crashpost.results.table import text_table
    from crashpost.values.injury_measure import HEADER
    from crashpost.values.injury_table import notes, table

    rows = table(_open(options))
    if not rows:
        raise PostError(f"{options.result}: no sensor has a role, or there are no samples yet")
    _say("\n".join((text_table(HEADER, rows), "", *notes(rows))))
    return 0


def _channels(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.results.choice import channels
    from crashpost.results.table import text_table

    known = {channel.name: channel for channel in result.channels()}
    rows = []
    for name in channels(result, options.channels) if options.channels else known:
        unit = known[name].unit if name in known else result.series(name).unit
        meaning = known[name].meaning if name in known else "expression"
        rows.append([name, unit or "-", str(len(result.time)), meaning])
    _say(text_table(("channel", "unit", "samples", "meaning"), rows))
    return 0


def _value(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.results.answer import answer
    from crashpost.results.choice import choices
    from crashpost.results.table import text_table

    during = _window(options.during) if options.during else None
    rows = []
    for word in options.channels:
        if Path(word, "status.json").is_file():
            raise PostError(f"{word} is another results folder; crashpost compare reads several")
    for channel, own in choices(result, options.channels):
        word = own or options.statistic
        if not word:
            raise PostError("name the number: CHANNEL:STATISTIC, or --statistic WORD")
        reply = answer(result, channel, word, during, options.unit)
        if reply.remark:
            print(printable(f"crashpost: {channel}: {reply.remark}"), file=sys.stderr)
        rows.append([channel, word, repr(reply.value), reply.unit or "-"])
    if len(rows) == 1:
        print(rows[0][2])
    else:
        _say(text_table(("channel", "statistic", "value", "unit"), rows))
    return 0


def _values(options: argparse.Namespace) -> int:
    import json

    from crashpost.values.questions import answers

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
    from crashpost.values.expectation import check_expectations, verdict_table

    state = result.status.get("state", "unknown")
    if not result.finished and not options.partial:
        raise PostError(
            f"the run is not finished (state: {state}); --partial evaluates the results so far"
        )
    verdicts = check_expectations(result)
    if not verdicts:
        print("the deck has no expectations")
        return 0
    _say(verdict_table(verdicts))
    failed = sum(not verdict.passed for verdict in verdicts)
    print(f"\n{len(verdicts) - failed} of {len(verdicts)} expectations met")
    return 1 if failed else 0


def _completion(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    print(completion(parser, options.shell))
    return 0


def _sweep(options: argparse.Namespace) -> int:
    from crashpost.sweeps import table

    sweep = table.read(options.result)
    _say(table.summary(sweep, table.write(sweep)))
    # a measure that no run has is an error of the plan
    code = 1 if table.unanswered(sweep) else 0
    if options.table:
        return code
    from crashpost.sweeps.effects_table import write_tables
    from crashpost.sweeps.pictures import draw

    folder = options.output or options.result
    paths, missing = draw(sweep, folder)
    for line in (*write_tables(sweep, folder), *map(str, paths), *missing):
        _say(line)
    return code


def _report(options: argparse.Namespace) -> int:
    result = _open(options)
    from crashpost.reports.build import report
    from crashpost.results.whole_file import write_html
    from crashpost.values.units import Units

    text, problems = report(result, options.pictures, Units.read(options.unit))
    output = options.output or result.folder / "report.html"
    write_html(output, text)
    _say(str(output))
    if problems:
        raise PostError("; ".join(problems))
    return 0
