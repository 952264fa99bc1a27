"""The command line of `crashsolve sweep`, parsed without loading its modules."""

import argparse
from pathlib import Path

from crashsolve.channels.command_line import output_path
from crashsolve.foundation.errors import DeckError, ExitCode


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the words of the command."""
    parser.set_defaults(act=_act)
    parser.add_argument("plan", type=Path, help="plan (YAML); with --run the folder of a sweep")
    parser.add_argument(
        "-o", "--output", type=output_path, metavar="DIR", help="results folder; default PLAN.sweep"
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="runs at a time; default: all cores")
    parser.add_argument(
        "--again",
        action="append",
        default=[],
        choices=("failed", "stale"),
        help="run again those that failed, or those of another deck or version; may be repeated",
    )
    parser.add_argument("--list", action="store_true", help="list the runs, without running them")
    queue = parser.add_argument_group("job arrays of Slurm (crashsolve manual QUEUE)")
    queue.add_argument(
        "--slurm", action="store_true", help="write the script of a job array instead of running"
    )
    queue.add_argument(
        "--submit", action="store_true", help="write the script and submit it by sbatch"
    )
    queue.add_argument(
        "--at-once",
        type=int,
        default=16,
        metavar="N",
        help="largest number of tasks at a time; default 16",
    )
    queue.add_argument(
        "--time", default="01:00:00", help="time limit of each task; default 01:00:00"
    )
    queue.add_argument(
        "--sbatch",
        action="append",
        default=[],
        metavar="OPTION",
        help="a further option of sbatch, as in --sbatch=--mem=2G",
    )
    queue.add_argument(
        "--run", type=int, metavar="N", help="run this run of a folder alone, as a task does"
    )


def _act(options: argparse.Namespace) -> int:
    from crashsolve.sweep.runner import Request, sweep, task
    from crashsolve.sweep.script import Queue

    if options.run is not None:
        return task(options.plan, options.run)
    for name in ("jobs", "at_once"):
        number = getattr(options, name)
        if number is not None and number < 1:
            word = f"--{name.replace('_', '-')} {number}"
            raise DeckError(word, None, None, "", "must be at least 1")
    queue = None
    if options.slurm or options.submit:
        more = tuple(options.sbatch)
        queue = Queue(options.at_once, options.time, options=more, submits=options.submit)
    request = Request(
        plan=options.plan,
        folder=options.output or Path(options.plan.stem + ".sweep"),
        jobs=options.jobs,
        again=options.again,
        dry=options.list,
        queue=queue,
    )
    return int(sweep(request) or ExitCode.NORMAL)
