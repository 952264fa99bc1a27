"""A study from end to end: settings, runs, answers, findings, table and picture."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from math import ceil, isfinite
from pathlib import Path

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.reading.several import Several
from crashsolve.foundation.errors import DeckError, DeckErrors, ExitCode
from crashsolve.foundation.streams import print_line, printable
from crashsolve.output.files import replace_text, reported
from crashsolve.output.lock import Lock
from crashsolve.recording.engines import is_static
from crashsolve.study.child_runs import cores
from crashsolve.study.convergence import NEAR
from crashsolve.study.findings import NOISE, Finding, cheapest, find, worst, worst_channel
from crashsolve.study.meshes import divisible, finer, undivided
from crashsolve.study.methods import order_of
from crashsolve.study.plot import draw
from crashsolve.study.settings import (
    AUTO,
    MESHES,
    Setting,
    descriptions,
    order_of_mesh,
    resolved,
    settings,
    suited,
)
from crashsolve.study.table import csv_text, legend, text_table
from crashsolve.study.trials import Trial, run_all
from crashsolve.study.watch import Watch, ask, overall, watched

# what answers that are given for a reference are those of
GIVEN, EXPENSIVE = "file", "most expensive run"
# relative error of the last sentence without a target
USUAL = 0.05
ONE_STEP = "the error of a single step is not known: give --steps two or more"
# of meshes: below it halving elements leaves more than two thirds of the error
LEAST_ORDER = 0.5
# an overall number whose estimated error is below this is worth naming
CONVERGED = 0.01


@dataclass(frozen=True)
class Request:
    """Request for a study, as on the command line."""

    deck: Path
    folder: Path
    overrides: dict[str, str] = field(default_factory=dict)
    methods: Sequence[str] = ()
    steps: str | None = None
    tolerances: str | None = None
    channels: Sequence[str] = ()
    meshes: str | None = None
    vary: str | None = None
    reference: Path | None = None
    target: float | None = None
    jobs: int | None = None


def study(request: Request) -> int:
    """Run a deck over its settings and report; the exit code is that of the runs if all failed.

    Raises DeckError for a wrong deck or request, OutputError when the report cannot be written.
    """
    deck = read_deck(request.deck, request.overrides, refuses_ineffective=False)
    methods, notes = _methods(deck, request)
    meshes = request.meshes or _usual_meshes(deck, request)
    grid = settings(
        deck, list(dict.fromkeys(methods)), _steps(request, deck), request.tolerances, meshes,
        request.vary,
    )  # fmt: skip
    _refuse_ineffective(request, grid)
    watches = watched(deck, request.channels)
    # where a path does not converge, these may
    more = [watch for watch in overall(deck) if watch not in watches]
    with reported(request.folder):
        request.folder.mkdir(parents=True, exist_ok=True)
    with Lock(request.folder):
        known = _reference(request, watches)
        for text in (*notes, *_axes(deck, methods, meshes)):
            print_line(text)
        print_line(f"{len(grid)} runs of {request.deck} in {request.folder}")
        jobs = max(request.jobs or cores(), 1)
        trials = run_all(request.deck, grid, request.overrides, request.folder, jobs, _report_trial)
        finished = [trial for trial in trials if trial.has_finished]
        _measure(finished, [*watches, *more], deck, jobs)
        order = None if request.vary else order_of_mesh(deck)
        best = None if known else _most_expensive(request, finished)
        known, kind = (best.answers, EXPENSIVE) if best else (known, GIVEN)
        findings = [
            find(watch, at, trials, known[at] if known else None, order, kind)
            for at, watch in enumerate(watches)
        ]
        # of that run itself no error is known
        for finding in findings:
            if best is not None and finding.kind == EXPENSIVE:
                del finding.errors[best.setting.folder]
        extra = [find(watch, len(watches) + i, trials, None, order) for i, watch in enumerate(more)]
        _report(request, deck, trials, findings, extra)
        return ExitCode.NORMAL if finished else max(trial.code for trial in trials)


def _methods(deck: Deck, request: Request) -> tuple[list[str], list[str]]:
    """The methods of a study, and notes on those left out; with --vary that of the deck."""
    _refuse_for_equilibria(deck, request)
    own = [deck.control.integrator] if request.vary else []
    if request.methods or own:
        return [resolved(deck, method) for method in request.methods or own], []
    return suited(deck)


def _refuse_for_equilibria(deck: Deck, request: Request) -> None:
    """Raise DeckError for words about time steps where a deck seeks equilibria."""
    words = {
        "--integrators": ",".join(request.methods),
        "--steps": request.steps,
        "--tolerances": request.tolerances,
    }
    for option, text in words.items() if is_static(deck) else ():
        if text:
            message = "solution quasi_static has load steps, which a study divides by 2 and 4"
            raise DeckError(f"{option} {text}", None, None, "", message, "leave it out")


def _measure(finished: list[Trial], watches: list[Watch], deck: Deck, jobs: int) -> None:
    """Read the watched numbers of finished runs. Writes: their steps and answers."""
    span = deck.control.end_time - deck.control.start_time
    with ThreadPoolExecutor(jobs) as pool:
        answers = pool.map(lambda trial: ask(trial.folder, watches), finished)
        for trial, answer in zip(finished, answers, strict=True):
            trial.step, trial.answers = span / max(trial.cycles, 1), answer


def _usual_meshes(deck: Deck, request: Request) -> str:
    """The default meshes: those of parts whose refinement keeps their names."""
    if request.vary or not divisible(deck):
        return "1"
    try:
        finer(deck, 2)
    except ValueError as why:
        print_line(f"no finer meshes: {why}")
        return "1"
    return MESHES


def _refuse_ineffective(request: Request, grid: Sequence[Setting]) -> None:
    """Raise DeckErrors for values that change no run, of --set and of --vary."""
    requested, several = {*request.overrides}, Several()
    requested |= {request.vary.partition("=")[0]} if request.vary else set()
    for setting in grid if requested else ():
        try:
            several.read(request.deck, {**request.overrides, **setting.overrides})
        except DeckErrors:
            # a run that fails; others may go
            continue
        if not requested & {*(several.ineffective or ())}:
            return
    if errors := [
        error for name, error in (several.ineffective or {}).items() if name in requested
    ]:
        raise DeckErrors(errors)


def _steps(request: Request, deck: Deck) -> str | None:
    """Requested steps; where values of a field are compared, the deck's own."""
    if request.steps or request.tolerances or not request.vary:
        return request.steps
    return AUTO if deck.control.step == AUTO else repr(float(deck.control.step))


def _most_expensive(request: Request, finished: list[Trial]) -> Trial | None:
    """The most expensive run, with which others are compared where a field is varied.

    Different models do not tend to each other, so that nothing can be extrapolated.
    """
    if not request.vary or not finished:
        return None
    best = max(finished, key=lambda trial: trial.cpu_steps)
    print_line(
        f"errors are differences from {best.setting.name}, the most expensive run; see --reference"
    )
    return best


def _axes(deck: Deck, methods: Sequence[str], meshes: str) -> list[str]:
    """Axes of the study in words, and a note where there is no choice of descriptions."""
    message = [f"integrators: {', '.join(methods)}"]
    if divisible(deck):
        message.append(f"meshes: elements of all parts times {meshes.replace(',', ', ')}")
        if meshes != "1" and (kept := undivided(deck)):
            message.append(
                f"not divided, for their mesh is listed or of a file: {', '.join(kept)}; "
                "their part in the error stays"
            )
    known = descriptions(deck)
    if len(known) == 1:
        message.append(f"deformation: {known[0]}, the only description that these parts know")
    return message


def _reference(request: Request, watches: list[Watch]) -> list[dict[str, object]] | None:
    """The answers of the reference folder. Raises DeckError when it holds no results."""
    if request.reference is None:
        return None
    if not (request.reference / "history.h5").exists():
        location, advice = f"--reference {request.reference}", "name the results folder of a run"
        raise DeckError(location, None, None, "", "no results there", advice)
    known = ask(request.reference, watches)
    for watch, answer in zip(watches, known, strict=True):
        if "remark" in answer:
            print_line(printable(f"--reference, {watch.name}: {answer['remark']}"))
    return known


def _report_trial(trial: Trial) -> None:
    """One line as soon as a run has ended."""
    how = "kept" if trial.was_reused else "done"
    words = how if trial.has_finished else f"exit code {trial.code}, {trial.message}"
    print_line(printable(f"  {trial.setting.name}: {words}"))


def _report(
    request: Request,
    deck: Deck,
    trials: list[Trial],
    findings: list[Finding],
    extra: list[Finding],
) -> None:
    """Write study.csv and study.png, print the table and its conclusions."""
    replace_text(request.folder / "study.csv", csv_text(trials, findings))
    title = deck.title or request.deck.stem
    missing = draw(request.folder / "study.png", title, trials, findings)
    print_line()
    print_line(text_table(trials, findings))
    print_line()
    print_line(legend(findings))
    if any(finding.diverges for finding in findings):
        print_line(_still_converging([*findings, *extra]))
    print_line()
    print_line(_verdict(findings, trials, USUAL if request.target is None else request.target))
    print_line()
    print_line(
        f"{request.folder / 'study.csv'}" + ("" if missing else f", {request.folder}/study.png")
    )
    if missing:
        print_line(missing)


def _still_converging(findings: list[Finding]) -> str:
    """Names of numbers that converge although a watched channel does not."""
    names = [
        f"{finding.watch.name} (to {finding.estimate:.1g})"
        for finding in findings
        if finding.estimate < CONVERGED and not (finding.is_absolute or finding.diverges)
    ]
    if not names:
        return "Neither energies, impulses nor the largest speed converge."
    return "What still converges: " + "; ".join(names) + "."


def _verdict(findings: list[Finding], trials: list[Trial], target: float) -> str:
    """The cheapest setting that meets the wanted error, or the one that would be needed.

    Channels that meshes do not bring to a value are named, and left out where others are brought.
    """
    absolute = [finding.watch.name for finding in findings if finding.is_absolute]
    left_out = f" (not rated, as its reference is zero: {', '.join(absolute)})" if absolute else ""
    best, without = cheapest(findings, trials, target), ""
    if best is None:
        stuck = [finding for finding in findings if _is_stuck(finding, trials, target)]
        rest = [finding for finding in findings if finding not in stuck]
        if stuck and len(rest) > len(absolute):
            names = ", ".join(finding.watch.name for finding in stuck)
            without = f"; none meets it in {names}, which finer meshes hardly bring to a value"
            findings, best = rest, cheapest(rest, trials, target)
    if best is None:
        return _advice(findings, trials, target, left_out) + without
    cost = f"{best.cpu_steps:.3g} s of CPU in steps"
    if best.cpu_steps <= NOISE:
        cost = f"no more than {NOISE:g} s of CPU in steps, below which none is ranked"
    error = _error_of(findings, best)
    if any(finding.is_of_one_step for finding in findings):
        error += f" by the mesh alone; {ONE_STEP}"
    return f"target {target:g}: {best.setting.name}, {cost}, {error}{left_out}{without}"


def _is_stuck(finding: Finding, trials: list[Trial], target: float) -> bool:
    """Whether no setting meets the wanted error in a channel, nor do finer meshes soon."""
    if finding.is_absolute or not finding.mesh_orders or cheapest([finding], trials, target):
        return False
    orders = [order for order in finding.mesh_orders.values() if isfinite(order)]
    return not orders or max(orders) < LEAST_ORDER


def _advice(findings: list[Finding], trials: list[Trial], target: float, left_out: str) -> str:
    """The nearest setting where none meets the wanted error, and the one that would be needed."""
    text = f"target {target:g}: none of these settings meets it{left_out}"
    uncertain = [f.watch.name for f in findings if f.is_uncertain(target)]
    if uncertain:
        return f"{text}; not to be trusted: {', '.join(uncertain)}"
    usable = [trial for trial in trials if isfinite(worst(findings, trial))]
    single = ""
    if len({trial.setting.label for trial in trials}) == 1:
        single = f"; {ONE_STEP}"
    if not usable:
        return text + single
    nearest = min(usable, key=lambda trial: worst(findings, trial))
    error = worst(findings, nearest)
    if error <= target:
        return (
            f"target {target:g}: not decided{left_out}; {nearest.setting.name} has an error of "
            f"{error:.2g}, but of finer runs a larger one is known, or none{single}"
        )
    text += f"{single}; the nearest is {nearest.setting.name}, {_error_of(findings, nearest)}"
    if needed := _mesh_needed(findings, nearest, target):
        return text + needed
    order = order_of(nearest.setting.series.method)
    own = [f.order(nearest) for f in findings if not f.is_absolute]
    if order and all(abs(p - order) <= NEAR for p in own):
        text += (
            f"; a step near {nearest.step * (target / error) ** (1 / order):.2g} s should suffice"
        )
    return text


def _error_of(findings: list[Finding], trial: Trial) -> str:
    """The largest error of a trial, of several channels with the name of its own."""
    error, name = worst_channel(findings, trial)
    return f"error {error:.2g}" + (f" of {name}" if len(findings) > 1 else "")


def _mesh_needed(findings: list[Finding], nearest: Trial, target: float) -> str:
    """The mesh that the wanted error needs by the orders of the meshes; "" where there are none."""
    factors = []
    for finding in (f for f in findings if not f.is_absolute and f.error(nearest) > target):
        order = finding.mesh_order(nearest)
        if not isfinite(order) or order < LEAST_ORDER:
            return ""
        factors.append((finding.error(nearest) / target) ** (1.0 / order))
    mesh = nearest.setting.series.mesh * max(factors, default=1.0)
    return f"; elements divided by {ceil(mesh)} should suffice" if factors else ""
