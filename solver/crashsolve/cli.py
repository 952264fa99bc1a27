"""The command `crashsolve`: run a deck, or check, explain and document decks.

crashsolve DECK [-o DIR] [--set NAME=VALUE] [--restart [--until T]]
crashsolve check DECK    crashsolve explain DECK
crashsolve study DECK [--steps A,B] [--integrators A,B] [--meshes 1,2] [--channel C[:STATISTIC]]
crashsolve sweep PLAN [-o DIR] [--jobs N] [--again failed] [--slurm]
crashsolve posture REQUEST [-o DIR]
crashsolve example [NAME [-o DIR]]    crashsolve manual [PAGE]
crashsolve schema    crashsolve keywords    crashsolve equations    crashsolve completion SHELL
"""

import argparse
import atexit
import ctypes
import gc
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from crashsolve import __version__
from crashsolve.channels.command_line import add_completion, completion, output_path, protected
from crashsolve.channels.errors import ChannelError
from crashsolve.foundation.errors import (
    CrashsolveError,
    DeckError,
    ExitCode,
    cannot_load,
    out_of_memory,
)
from crashsolve.foundation.streams import (
    discard_output,
    open_standard_streams,
    printable,
    report_error,
)

COMMANDS: tuple[str, ...] = ("run", "check", "explain", "study", "sweep", "posture", "example")
COMMANDS += ("manual", "schema", "keywords", "equations", "completion")

Commands = argparse._SubParsersAction

SWEEP = "Run a deck over values of its parameters, as a plan defines them; finished runs are kept"
STUDY = "Run a deck with many steps or methods: error, observed order and CPU time of each"


def main(arguments: list[str] | None = None) -> int:
    """Entry point; returns the exit code."""
    # imports make many objects that stay: looking for garbage among them is a tenth of a warm
    # start, and another at exit
    gc.set_threshold(500_000)
    atexit.register(gc.freeze)
    # nor are the packages of the system searched for extensions of how decks are read
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # numpy's matrices are small here: threads of its library would only wait, and at a cost
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    release_memory()
    open_standard_streams()
    given = protected(sys.argv[1:] if arguments is None else arguments)
    # `crashsolve deck.yaml` is short for `crashsolve run deck.yaml`
    if given and given[0] not in COMMANDS and not given[0].startswith("-"):
        given = ["run", *given]
    options = _parser(given).parse_args(given)
    try:
        code = int(options.act(options))
        sys.stdout.flush()
        return code
    except CrashsolveError as error:
        report_error(str(error))
        return int(error.exit_code)
    except MemoryError:
        report_error(out_of_memory())
        return int(ExitCode.OUTPUT)
    except KeyboardInterrupt:
        report_error("interrupted")
        return int(ExitCode.STOPPED)
    except BrokenPipeError:
        # the reader, such as `head`, has closed the pipe
        discard_output(sys.stdout)
        return int(ExitCode.NORMAL)
    except OSError as error:
        # errors of files are handled where they are opened: this one is of standard output
        if error.filename is not None:
            raise
        if error.errno is None:
            # that of a library, not of a stream
            report_error(cannot_load(error))
            return int(ExitCode.OUTPUT)
        discard_output(sys.stdout)
        report_error(f"standard output: {error.strerror}")
        return int(ExitCode.OUTPUT)


def release_memory() -> None:
    """Make the C library return the memory of large arrays at once, instead of keeping it."""
    with suppress(AttributeError, OSError):
        # M_MMAP_THRESHOLD of glibc; set, it stays where it is
        ctypes.CDLL(None).mallopt(-3, 1 << 18)


def _parser(requested: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="crashsolve",
        description="Solves the impact of multibody systems from an input deck.",
        epilog="exit codes: 0 normal, 1 internal, 2 deck, 3 stopped on request, 4 numerical stop, "
        "5 output failed",
    )
    parser.add_argument("--version", action="version", version=f"crashsolve {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="solve a deck (the word run may be left out)")
    _deck_arguments(run)
    run.add_argument("-o", "--output", type=output_path, metavar="DIR", help="results folder")
    run.add_argument("--restart", action="store_true", help="continue from the newest dump")
    run.add_argument(
        "--until", metavar="T", help='with --restart: another end time, such as 0.2 or "200 ms"'
    )
    run.set_defaults(act=_run)
    # a run does not pay for the words of others
    if list(requested[:1]) != ["run"]:
        _other_commands(parser, commands)
    return parser


def _other_commands(parser: argparse.ArgumentParser, commands: Commands) -> None:
    from crashsolve.sweep.command import add_arguments

    for word, act, text in (
        ("check", _check, "read and build a deck without running it"),
        (
            "explain",
            _explain,
            "list the laws that the scene uses and those it does not, and print its composed step",
        ),
    ):
        command = commands.add_parser(word, help=text)
        _deck_arguments(command)
        command.set_defaults(act=act)
    commands.choices["explain"].add_argument(
        "--expanded",
        action="store_true",
        help="print the deck instead: in SI, with included files, defaults and the cards of its "
        "structures; the printed deck can be run",
    )
    _study_arguments(
        commands.add_parser("study", help=STUDY[0].lower() + STUDY[1:], description=STUDY)
    )
    sweep = commands.add_parser("sweep", help=SWEEP[0].lower() + SWEEP[1:], description=SWEEP)
    add_arguments(sweep)
    _posture_arguments(commands)
    _document_arguments(commands)
    add_completion(commands)
    commands.choices["completion"].set_defaults(act=lambda options: _completion(parser, options))


def _posture_arguments(commands: Commands) -> None:
    from crashsolve.photogrammetry.command import add_arguments

    text = "initial posture of an occupant from digitised points in the pictures of cameras"
    add_arguments(commands.add_parser("posture", help=text, description=text.capitalize()))


def _document_arguments(commands: Commands) -> None:
    """Commands that print the examples, the manual, and pages made from the cards."""
    example = commands.add_parser("example", help="list example decks, print one, or write it")
    example.add_argument("name", nargs="?", help="name of a deck; without a name all are listed")
    example.add_argument(
        "-o",
        "--output",
        type=output_path,
        metavar="DIR",
        help="folder for the deck and the files that it includes",
    )
    example.set_defaults(act=_example)
    manual = commands.add_parser("manual", help="list the pages of the manual, or print one")
    manual.add_argument("page", nargs="?", help="name of a page; without a name all are listed")
    manual.set_defaults(act=_manual)
    for word, act, text in (
        ("schema", _schema, "JSON Schema of the deck, for editors"),
        ("keywords", _keywords, "the keyword manual, as Markdown"),
        ("equations", _equations, "the file that holds each equation of the chapter, as Markdown"),
    ):
        commands.add_parser(word, help=text).set_defaults(act=act)


def _deck_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("deck", type=Path, help="input deck (YAML)")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="override a parameter of the deck, or any number or word of it by its path, as in "
        "control.step=1e-4, contacts.wall.normal.stiffness=1e6, bodies.ball.velocity.3=-2 (entries "
        "of lists count from 1); may be repeated",
    )


def _study_arguments(parser: argparse.ArgumentParser) -> None:
    _deck_arguments(parser)
    parser.set_defaults(act=_study)
    parser.add_argument(
        "-o", "--output", type=output_path, metavar="DIR", help="results folder; default DECK.study"
    )
    parser.add_argument(
        "--steps",
        metavar="H,...",
        help="time steps in s, or auto; default: those of the deck times 4, 2, 1, 1/2, 1/4, 1/8",
    )
    parser.add_argument(
        "--tolerances", metavar="T,...", help="tolerances, for methods that choose their step"
    )
    parser.add_argument(
        "--integrators",
        default="",
        metavar="NAME,...",
        help="methods; default: all that can run the deck",
    )
    parser.add_argument(
        "--meshes",
        metavar="M,...",
        help="factors on the number of elements of every part; default: 1,2,4 where there are any",
    )
    parser.add_argument(
        "--vary",
        metavar="PATH[=A,B,...]",
        help="compare the values of a field, such as parts.frame.deformation (all its values, or "
        "those given), with the method and step of the deck unless others are given; the reference "
        "is that of --reference, or the most expensive of these runs",
    )
    parser.add_argument(
        "--channel",
        action="append",
        default=[],
        metavar="CHANNEL[:STATISTIC]",
        help="channel and statistic to compare; without a statistic the whole history. Default: "
        "the channels that the deck expects or watches, else final energies, impulses of contacts "
        "and the largest speed; may be repeated",
    )
    parser.add_argument(
        "--reference",
        type=Path,
        metavar="RESULTS",
        help="results to compare with where the deck gives no exact or published value; "
        "default: extrapolation of the runs",
    )
    parser.add_argument(
        "--target",
        type=float,
        metavar="E",
        help="report the cheapest setting within this relative error",
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="runs at a time; default: all cores")


def _overrides(options: argparse.Namespace) -> dict[str, str]:
    pairs = {}
    for text in options.set:
        name, equals, value = text.partition("=")
        if not equals or not name:
            raise DeckError(f"--set {text}", None, None, "", "no value", "write --set NAME=VALUE")
        pairs[name] = value
    return pairs


def _run(options: argparse.Namespace) -> int:
    from crashsolve.compiler.machine import load_linker

    load_linker()
    from crashsolve.simulation.solve import solve

    folder = options.output or Path(options.deck.stem + ".results")
    overrides = _overrides(options)
    if options.until is not None:
        if not options.restart:
            advice = "give --restart, or --set control.end_time=T"
            raise DeckError("--until", None, None, "", "continues from a dump", advice)
        overrides["control.end_time"] = options.until
    return solve(options.deck, folder, overrides, options.restart)


def _study(options: argparse.Namespace) -> int:
    from crashsolve.study.runner import Request, study

    request = Request(
        deck=options.deck,
        folder=options.output or Path(options.deck.stem + ".study"),
        overrides=_overrides(options),
        methods=[name.strip() for name in options.integrators.split(",") if name.strip()],
        steps=options.steps,
        tolerances=options.tolerances,
        meshes=options.meshes,
        vary=options.vary,
        channels=options.channel,
        reference=options.reference,
        target=options.target,
        jobs=options.jobs,
    )
    return study(request)


def _check(options: argparse.Namespace) -> int:
    from crashsolve.deck.reading.deck import read_deck
    from crashsolve.model.build import build
    from crashsolve.model.checks.magnitudes import magnitude_table
    from crashsolve.recording.histories import families_of
    from crashsolve.recording.pictured import look_up_pictured
    from crashsolve.recording.questions import look_up
    from crashsolve.recording.selection import written_channels
    from crashsolve.simulation.expected_size import expected_size
    from crashsolve.simulation.freedom import freedom
    from crashsolve.simulation.shell_steps import remark_on_safety

    deck = read_deck(options.deck, _overrides(options))
    model, state = build(deck)
    families = families_of(model, state, written_channels(deck, model, state))
    look_up(deck, families)
    look_up_pictured(deck, model)
    size = expected_size(deck, families, (), Path(options.deck.stem + ".results"))
    for text in (*deck.unread, *model.warnings):
        print(printable(f"warning: {text}"))
    for text in freedom(model, state, deck.control.start_time):
        print(printable(text))
    for text in (*magnitude_table(deck.entries), *remark_on_safety(deck, model)):
        print(printable(text))
    print(printable(f"output: {size}"))
    print(printable(f"{options.deck}: no errors found"))
    return ExitCode.NORMAL


def _explain(options: argparse.Namespace) -> int:
    from crashsolve.deck.reading.deck import read_deck
    from crashsolve.explain import explain
    from crashsolve.model.build import build

    deck = read_deck(options.deck, _overrides(options))
    model, _ = build(deck)
    print(deck.text.rstrip("\n") if options.expanded else explain(deck, model))
    return ExitCode.NORMAL


def _example(options: argparse.Namespace) -> int:
    from crashsolve import examples

    known = examples.decks()
    if options.name is None:
        print(examples.listing(known))
        return ExitCode.NORMAL
    path = examples.named(options.name, known, "example")
    if options.output:
        for target in examples.write(path, options.output):
            print(target)
        return ExitCode.NORMAL
    print(path.read_text("utf-8"), end="")
    others = [file.name for file in examples.needed(path)[1:]]
    if others:
        message = (
            f"it needs {', '.join(others)}: crashsolve example {options.name} -o DIR writes all"
        )
        print(message, file=sys.stderr)
    return ExitCode.NORMAL


def _manual(options: argparse.Namespace) -> int:
    from crashsolve import examples

    known = examples.pages()
    if options.page is None:
        print(examples.listing(known))
    else:
        print(examples.named(options.page, known, "page").read_text("utf-8"), end="")
    return ExitCode.NORMAL


def _completion(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    try:
        print(completion(parser, options.shell))
    except ChannelError as error:
        raise DeckError("completion", None, None, "", str(error)) from None
    return ExitCode.NORMAL


def _schema(options: argparse.Namespace) -> int:
    import json

    from crashsolve.deck.schema import json_schema

    print(json.dumps(json_schema(), indent=1))
    return ExitCode.NORMAL


def _keywords(options: argparse.Namespace) -> int:
    from crashsolve.deck.schema import keywords_markdown

    print(keywords_markdown(), end="")
    return ExitCode.NORMAL


def _equations(options: argparse.Namespace) -> int:
    from crashsolve.deck.schema import equations_markdown

    print(equations_markdown(), end="")
    return ExitCode.NORMAL


if __name__ == "__main__":
    sys.exit(main())
