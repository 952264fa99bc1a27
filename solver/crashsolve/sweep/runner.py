"""A sweep from end to end: plan, points, the decks of all runs, the runs, the table.

All decks are read before the first run starts. Results are gathered by `crashpost sweep`, in a
process of its own: the result files are the contract.
"""

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from crashsolve.deck.reading.deck import read_deck
from crashsolve.deck.reading.several import Several
from crashsolve.foundation.errors import DeckError, DeckErrors, ExitCode
from crashsolve.foundation.streams import print_line, printable
from crashsolve.model.build import build
from crashsolve.output.errors import OutputError
from crashsolve.output.files import reported
from crashsolve.output.lock import Lock
from crashsolve.simulation.heartbeat import Heartbeat
from crashsolve.study.child_runs import cores
from crashsolve.sweep.axis import as_text
from crashsolve.sweep.design import Point, points_of
from crashsolve.sweep.folder import Run, RunStatus, mark_of, read_sweep, run_status, write_sweep
from crashsolve.sweep.plan import Plan, read_plan
from crashsolve.sweep.run_pool import RunPool
from crashsolve.sweep.script import Queue, submit, write_script

# files that crashpost writes from the runs
GATHERED = ("sweep.csv", "sweep.parquet", "scatter.png", "effects.png", "indices.png")
# runs that failed before and are named
REPORTED = 8


@dataclass(frozen=True)
class Request:
    """Request for a sweep, as on the command line; `queue` requests a job array instead."""

    plan: Path
    folder: Path
    jobs: int | None = None
    again: Sequence[str] = ()
    dry: bool = False
    queue: Queue | None = None


def sweep(request: Request) -> int:
    """Run those runs of a plan that have no results yet; the exit code is the largest of the runs'.

    Raises DeckError for a wrong plan or deck and for results of another, OutputError when the
    folder is in use or cannot be written.
    """
    plan = read_plan(request.plan)
    with Heartbeat("reading the deck of each run", print_line):
        title, runs = prepared(plan)
    if request.dry:
        for run in runs:
            print_line(printable(f"{run.name}  {run.reported()}"))
        return ExitCode.NORMAL
    with reported(request.folder):
        request.folder.mkdir(parents=True, exist_ok=True)
    with Lock(request.folder):
        statuses = {run.number: run_status(request.folder, run) for run in runs}
        _refuse_stale(request, runs, statuses)
        write_sweep(request.folder, plan, title, runs)
        due = [run for run in runs if _is_due(statuses[run.number], request.again)]
        _remove_old(request.folder, due)
        _report_plan(request, runs, statuses)
        if request.queue is not None:
            return _queue(request, due)
        words = [name for name, axis in plan.axes.items() if not axis.is_of_numbers]
        pool = RunPool(
            plan.deck,
            request.folder,
            max(request.jobs or cores(), 1),
            lambda run: tuple(run.values[name] for name in words),
            plan.card.time_limit,
            lambda: _report_problems(request.folder),
        )
        pool.run_all(due)
        is_measured = gather(request.folder)
    failed = [int(ExitCode.SOLVER) for run in runs if _failed_before(run, statuses, pool)]
    code = ExitCode.STOPPED if pool.is_stopping else _code([*pool.codes.values(), *failed])
    return code if is_measured else code or ExitCode.DECK


def task(folder: Path, number: int) -> int:
    """One run of a sweep, as the task of a queue; the exit code is that of the run.

    Raises DeckError when there is no such run, or when its deck has changed since.
    """
    deck, runs = read_sweep(folder)
    run = next((run for run in runs if run.number == number), None)
    if run is None:
        message = f"the sweep in {folder} has {len(runs)} runs"
        raise DeckError(f"--run {number}", None, None, "", message, f"give 1 to {len(runs)}")
    with Lock(folder, is_shared=True):
        difference = mark_of(read_deck(deck, run.overrides)).difference_from(asdict(run.mark))
        if difference:
            advice = "prepare the sweep anew by crashsolve sweep PLAN --slurm"
            raise DeckError(
                str(deck), None, None, "", f"run {run.name} was of {difference}", advice
            )
        if run_status(folder, run).state == "finished":
            print_line(f"  {run.name} finished already")
            return ExitCode.NORMAL
        pool = RunPool(deck, folder, 1, lambda run: ())
        pool.run_all([run])
    return pool.codes.get(run.number, ExitCode.STOPPED)


def prepared(plan: Plan) -> tuple[str, list[Run]]:
    """Title and runs of a plan, the deck of each read. Raises DeckErrors for the first wrong one.

    The model of the first is built as well: errors common to all are known then. What
    changes no run is refused.
    """
    fixed = {name: as_text(value) for name, value in plan.card.set.items()}
    points, runs, title = points_of(plan), list[Run](), plan.card.title
    wrong, several = list[tuple[int, Point, DeckErrors]](), Several()
    for number, point in enumerate(points, 1):
        overrides = {**fixed, **point}
        try:
            deck, overrides = several.read(plan.deck, overrides)
            if not runs:
                build(deck)
                title = title or deck.title
        except DeckErrors as errors:
            wrong.append((number, point, errors))
        except DeckError as error:
            wrong.append((number, point, DeckErrors([error])))
        else:
            runs.append(Run(number, point, overrides, mark_of(deck)))
        if wrong and not runs:
            break
    if not wrong and several.ineffective:
        wrong.append((1, points[0], DeckErrors(list(several.ineffective.values()))))
    if wrong:
        raise _refused(plan, wrong, len(points))
    return title, runs


def _refused(plan: Plan, wrong: list[tuple[int, Point, DeckErrors]], count: int) -> DeckErrors:
    """The errors of the first run that has any, at their positions in the plan where it set
    them.
    """
    number, point, errors = wrong[0]
    refusals = []
    values = ", ".join(f"{name} = {text}" for name, text in point.items())
    given = {name: as_text(value) for name, value in plan.card.set.items()} | point
    for error in errors.errors:
        name = error.file.removeprefix("--set ").partition("=")[0]
        card = ": ".join(filter(None, (f"run {number}", error.card)))
        if error.file.startswith("--set ") and name in plan.locations:
            text = f"{name} = {given[name]}: {error.message}"
            refusals.append(DeckError(*plan.locations[name], card, text, error.advice))
        else:
            advice = "; ".join(filter(None, (error.advice, f"with {values}")))
            location = error.file, error.line, error.column
            refusals.append(DeckError(*location, card, error.message, advice))
    if len(wrong) > 1:
        message = f"{len(wrong)} of the {count} runs have a wrong deck; this was the first"
        refusals.append(DeckError(str(plan.path), None, None, "", message))
    return DeckErrors(refusals)


def _refuse_stale(request: Request, runs: Sequence[Run], statuses: dict[int, RunStatus]) -> None:
    """Raise DeckErrors for results of another deck or version: to run them anew is to lose them."""
    stale = [run for run in runs if statuses[run.number].state == "stale"]
    if not stale or "stale" in request.again:
        return
    reason = statuses[stale[0].number].message
    message = f"{len(stale)} of {len(runs)} runs are there already, of {reason}"
    advice = "name another folder with -o, or discard them and run again with --again stale"
    raise DeckError(str(request.folder), None, None, "", message, advice)


def _remove_old(folder: Path, due: Sequence[Run]) -> None:
    """Remove earlier tables and pictures: readers must not take them for new ones.

    Raises OutputError.
    """
    with reported(folder):
        for name in GATHERED if due else ():
            (folder / name).unlink(missing_ok=True)


def _is_due(status: RunStatus, again: Sequence[str]) -> bool:
    if status.state in ("failed", "stale"):
        return status.state in again
    return status.state != "finished"


def _report_plan(request: Request, runs: Sequence[Run], statuses: dict[int, RunStatus]) -> None:
    """Print which runs are started, which are not, and why."""
    finished = [run for run in runs if statuses[run.number].state == "finished"]
    going = [run for run in runs if statuses[run.number].state in ("stopped", "killed")]
    failed = [run for run in runs if not _is_due(statuses[run.number], request.again)]
    failed = [run for run in failed if run not in finished]
    words = [f"{len(runs)} runs in {request.folder}"]
    words += [f"{len(finished)} finished already"] if finished else []
    words += [f"{len(going)} continue from where they were stopped"] if going else []
    print_line(printable("; ".join(words)))
    for run in failed[:REPORTED]:
        print_line(printable(f"  {run.name} failed before: {statuses[run.number].message}"))
    if failed:
        more = f"{len(failed) - REPORTED} more failed before; " if len(failed) > REPORTED else ""
        print_line(f"  {more}--again failed runs them once more")


def _failed_before(run: Run, statuses: dict[int, RunStatus], pool: RunPool) -> bool:
    return statuses[run.number].state == "failed" and run.number not in pool.codes


def _code(codes: Sequence[int]) -> int:
    """Exit code of a sweep: 0 when all have finished, 3 when some have only been stopped."""
    bad = [int(ExitCode.INTERNAL) if code < 0 else code for code in codes if code]
    worse = [code for code in bad if code != ExitCode.STOPPED]
    return max(worse or bad, default=int(ExitCode.NORMAL))


def _queue(request: Request, due: Sequence[Run]) -> int:
    """Write the script of a job array, and submit it if asked to."""
    assert request.queue is not None
    if not due:
        print_line("no runs are left")
        gather(request.folder)
        return ExitCode.NORMAL
    path = write_script(request.folder, [run.number for run in due], request.queue)
    print_line(printable(f"{path}: an array of {len(due)} tasks"))
    if request.queue.submits:
        print_line(printable(submit(path)))
    else:
        print_line(printable(f"read it, then: sbatch {path}"))
    print_line(
        printable(f"table of what has finished, at any time: crashpost sweep {request.folder}")
    )
    return ExitCode.NORMAL


def gather(folder: Path) -> bool:
    """Let crashpost write the table and print its lines; whether every measure has a value.

    Raises OutputError when it cannot.
    """
    done = _gathered(folder)
    if done.returncode > 1:
        last_line = done.stderr.strip().splitlines()[-1:] or [f"crashpost: code {done.returncode}"]
        raise OutputError(folder, f"the table cannot be gathered: {last_line[0]}")
    for line in done.stdout.splitlines():
        print_line(printable(line))
    return done.returncode == 0


def _report_problems(folder: Path) -> None:
    """Print errors of the measures after the first run, while there is time to correct them."""
    done = _gathered(folder)
    if done.returncode == 1:
        for line in done.stdout.splitlines()[1:]:
            print_line(printable(line))
        print_line("  measures may be corrected in the plan: finished runs are kept")


def _gathered(folder: Path) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "crashpost", "sweep", str(folder), "--table"]
    return subprocess.run(words, capture_output=True, text=True, errors="replace")
