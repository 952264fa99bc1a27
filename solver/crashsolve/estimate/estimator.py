"""Which companions a run gets, and the estimates of all its watched numbers.

A method of order 2 gets two coarser runs, of twice and four times the step: they cost about three
quarters of the run, and show whether the order holds. Those that choose their step by its error
get one finer run, of half the step or of a tolerance divided by 8 (order 2) or 32, for 1.5 to 2
times the run: their errors at kinks, at impacts and by round-off have no order, and on the
battery of benchmarks/estimates coarser runs held for three quarters of the numbers of higher order.
Where coarser steps are unstable two finer runs serve, of half and a quarter of the step, and for
equilibria one of twice the load steps. After a long run companions may cost as much as it did and
no more: a method that chooses its step then gets one coarser run.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module
from math import inf, isfinite

from crashsolve.deck.reading.deck import Deck
from crashsolve.estimate.companion import HIGHEST_POWER, BudgetExceeded, Companions
from crashsolve.estimate.error import Estimate, NumberErrors, is_as_fine
from crashsolve.estimate.formulas import with_formulas
from crashsolve.estimate.mesh import (
    LEAST,
    SHARE,
    Meshes,
    chance_margin,
    coarse_runs,
    window_about,
    window_about_extreme,
    with_mesh,
)
from crashsolve.foundation.errors import SolverError
from crashsolve.model.build import build
from crashsolve.model.curve_steps import unseen
from crashsolve.model.integrator_selection import with_chosen_method
from crashsolve.model.model import Model
from crashsolve.output.channels import Family
from crashsolve.recording.engines import UNPREPARED, Prepared, is_static
from crashsolve.recording.histories import families_of
from crashsolve.recording.questions import look_up
from crashsolve.recording.samples import Channel, Samples
from crashsolve.recording.sampling import Schedule
from crashsolve.study.meshes import has_mesh
from crashsolve.study.methods import chooses_its_step, order_of
from crashsolve.study.watch import Watch, named

COARSER = (4.0, 2.0)
MESH = "the mesh"
OVER_BUDGET = "further runs would cost more than this one; control.estimate: full makes them"
# the second where the first does not shorten the steps, or coarser ones are unstable
FINER = (0.5, 0.25)
# of the longest step that sees a load
APART = 2.0**-0.5


class Estimator:
    """Estimates for one deck; raises DeckErrors for a watched channel that does not exist."""

    def __init__(
        self,
        deck: Deck,
        families: Sequence[Family],
        stopped: Callable[[], bool] = lambda: False,
        prepared: Prepared = UNPREPARED,
    ) -> None:
        self.deck = deck
        # one answer for expectations of the same number
        unique = {(w.channels, w.statistic, w.during): w for w in reversed(named(deck))}
        self.watches: list[Watch] = list(reversed(unique.values()))
        self.channels = look_up(deck, families)
        self.order = order_of(deck.control.integrator)
        self.companions = Companions(deck, self.all_channels, stopped, prepared)
        self.stopped = stopped

    @property
    def all_channels(self) -> list[Channel]:
        """Every channel that is needed, once."""
        named = [channel for channels in self.channels.values() for channel in channels]
        followed = [channel.followed for channel in named]
        return list({c.name: c for c in (*named, *followed) if c is not None}.values())

    @property
    def measures_the_model(self) -> bool:
        """Whether any watched number has an error: those that measure the run's own have none."""
        return not all(any(c.is_of_the_run for c in watched) for watched in self.channels.values())

    @property
    def power(self) -> float:
        """Power of the coarseness by which errors grow."""
        control, order = self.deck.control, self.order or 1.0
        is_free = control.step == "auto" and chooses_its_step(control.integrator)
        return min(order, HIGHEST_POWER) if is_free else order

    @property
    def compares_with_coarser(self) -> bool:
        """Whether the error follows from coarser runs, rather than from a finer one."""
        return not is_static(self.deck) and not chooses_its_step(self.deck.control.integrator)

    def companion_runs(
        self,
        coarseness: float,
        cycles: int,
        problems: list[str],
        budget: float = inf,
        limit: float = inf,
    ) -> list[Samples]:
        """Companions of a run of `cycles` steps, which may cost `budget` [s] of CPU.

        Without a budget they end at `limit`, and are those of a run that is cheap.
        Writes: why one failed. Raises Abandoned.
        """
        self.companions.budget, runs = budget if isfinite(budget) else limit, list[Samples]()
        finer = self._finer(coarseness, cycles)
        coarser = COARSER if self.compares_with_coarser else COARSER[-1:] * isfinite(budget)
        # a multiple of a step that hardly sees a load sees as little of it
        coarser = () if finer[0] < FINER[0] else coarser
        is_unstable = self._is_unstable(coarseness)
        try:
            for factor in () if is_unstable else coarser:
                runs.append(self.companions.run(factor * coarseness))
        except SolverError as error:
            problems.append(f"a coarser run stopped: {error.cause}")
            runs.clear()
        except BudgetExceeded:
            problems.append(OVER_BUDGET)
            return runs
        if runs:
            return runs
        if isfinite(budget) and (finer[0] == FINER[0] or is_static(self.deck)):
            # a finer one would cost more than the run
            problems.append(OVER_BUDGET)
            return []
        try:
            for factor in finer:
                # where coarser steps are unstable, one finer run may agree with this by chance
                if not runs or coarser or is_as_fine(cycles, runs[-1].cycles):
                    runs.append(self.companions.run(factor * coarseness))
        except SolverError as error:
            problems.append(f"a finer run stopped: {error.cause}")
        except BudgetExceeded:
            problems.append(OVER_BUDGET)
        return runs

    def _is_unstable(self, coarseness: float) -> bool:
        """Whether shells are beyond their critical step in coarser runs: without a limit on the
        energy these would end, with any numbers.
        """
        control, parts = self.deck.control, self.deck.entries["parts"].values()
        is_bound = self.compares_with_coarser and control.step == "auto"
        longest = control.safety * COARSER[-1] * coarseness
        return is_bound and longest > 1.0 and any(part.type == "shell" for part in parts)

    def _finer(self, coarseness: float, cycles: int) -> tuple[float, ...]:
        """Factors of finer runs: of a stated step that hardly sees a load, one that sees it.

        Of equilibria those that divide load steps which a run of `cycles` has cut by itself.
        """
        control = self.deck.control
        if control.path == "arc_length":
            return FINER
        if is_static(self.deck):
            span = control.end_time - control.start_time
            cuts = max(round((cycles - 1) * Schedule.of(self.deck).interval / span), 1)
            return tuple(factor / cuts for factor in FINER)
        if control.step == "auto":
            return FINER
        shares = [share for share, _ in unseen(build(self.deck)[0]).values()]
        if not shares:
            return FINER
        # no whole part of the step, which would meet some of the same points
        return (min(FINER[0], APART / (coarseness * max(shares))),)

    def mesh_runs(self, coarseness: float, cpu_time: float) -> Meshes:
        """Runs on coarser meshes of a run that took `cpu_time` [s] of CPU. Raises Abandoned."""
        is_requested = self.deck.control.estimate in ("mesh", "full")
        budget = inf if is_requested else max(SHARE * cpu_time, LEAST)
        return coarse_runs(
            self.deck, self._companions_of, lambda: build(self.deck)[0], coarseness, budget
        )

    def _companions_of(self, deck: Deck) -> tuple[Companions, Model]:
        """Companions of the deck with another mesh, whose channels are other columns."""
        model, state = build(deck)
        companions = Estimator(deck, families_of(model, state), self.stopped).companions
        companions.built = model, state
        return companions, model

    def estimates(
        self, main: Samples, others: Sequence[Samples], meshes: Meshes | None = None
    ) -> list[Estimate]:
        """The estimates of all watched numbers; `meshes` are runs on ever coarser ones."""
        coarse, lengths = (meshes.runs, meshes.lengths) if meshes else ([], [])
        main, *rest = (self._with_steps(samples) for samples in (main, *others, *coarse))
        others, coarse = rest[: len(others)], rest[len(others) :]
        errors = NumberErrors(self.channels, self.order)
        numbers = [errors.estimate(watch, main, others) for watch in self.watches]
        numbers = [with_formulas(estimate, self.deck) for estimate in numbers]
        is_meshed, laws = has_mesh(self.deck), left_out(self.deck)
        if is_meshed and coarse:
            numbers = [self._with_mesh(errors, e, [main, *coarse], lengths) for e in numbers]
        return [
            _without(e, [MESH, *laws] if is_meshed and e.mesh is None else laws) for e in numbers
        ]

    def _with_steps(self, samples: Samples) -> Samples:
        """Samples that know which of them are steps between those of the schedule."""
        own = samples.time[~Schedule.of(self.deck).have(samples.time)]
        return replace(samples, step_times=own)

    def _with_mesh(
        self,
        errors: NumberErrors,
        estimate: Estimate,
        runs: Sequence[Samples],
        lengths: Sequence[float],
    ) -> Estimate:
        """An estimate with the error by the mesh, where the samples serve to tell it."""
        try:
            about = self._about(errors, estimate.watch, runs[0])
            least = chance_margin(errors.numbers(about, runs[:2])) if about else 0.0
            numbers = errors.numbers(estimate.watch, runs)
            return with_mesh(estimate, numbers, self.deck, lengths, least)
        except ValueError:
            return estimate

    def _about(self, errors: NumberErrors, watch: Watch, main: Samples) -> Watch | None:
        """The history about the moment or extreme that a number reads; None where it reads none.

        Raises ValueError where samples do not give the number.
        """
        control = self.deck.control
        (channel, *others) = self.channels[watch.channels[0]]
        # a largest value so far is the same at the end, however histories differ
        if channel.followed and not others and watch.statistic == "final":
            watch = replace(watch, statistic="max")
        moment = window_about(watch, control.start_time, control.last_time)
        return moment or window_about_extreme(watch, errors.history(watch, main))


def left_out(deck: Deck) -> list[str]:
    """Approximations of contact laws that no run of the deck shows: their LEFT_OUT."""
    cards = [contact.card for contact in deck.entries["contacts"].values()]
    laws = [getattr(card, word, None) for card in cards for word in ("normal", "friction")]
    modules = [import_module(type(law).__module__) for law in laws if law is not None]
    omissions = [getattr(module, "LEFT_OUT", "") for module in modules]
    return sorted({words for words in omissions if words})


def _without(estimate: Estimate, words: Sequence[str]) -> Estimate:
    """An estimate that names the errors it does not contain."""
    if not words or not estimate.error:
        return estimate
    return replace(estimate, how=f"{estimate.how}; without {' and '.join(words)}")


def estimate_in_memory(deck: Deck) -> tuple[Samples, list[Estimate], float]:
    """A run without files: its samples, its estimates, and their cost over that of the run."""
    model, state = build(deck)
    deck = deck if is_static(deck) else with_chosen_method(deck, model)
    estimator = Estimator(deck, families_of(model, state))
    main = estimator.companions.run(1.0)
    others = estimator.companion_runs(1.0, main.cycles, [])
    meshes = estimator.mesh_runs(1.0, inf)
    cpu_time = sum(run.cpu for run in (*others, *meshes.runs))
    return main, estimator.estimates(main, others, meshes), cpu_time / main.cpu
