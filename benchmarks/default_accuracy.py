"""How many numbers are right at default settings: `benchmarks/default_accuracy.py [DECK ...]`.

Decks of the verification and the benchmarks, and the scenes of estimates/scenes.py, run without the
words of `control:` that choose methods and steps (CHOSEN). Counted are the numbers that are exact,
and that a deck states to within 1e-3 of their scale at its own steps: the larger of the number and
of the largest magnitude that the channel, or its vector, has in the run. What measures the run
itself, as its balance of energy, is left out; so are equilibria, which have no steps, and shells,
whose step is that of their mesh. A run beyond LIMIT, or that stops, is named.

Scenes have the samples of a deck that asks for none; LONG are oscillators over many periods.
`--set integrator=auto --set safety=0.05` tries other words of `control:` than the defaults.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.run_cards.control import Control
from crashsolve.estimate.companion import BudgetExceeded
from crashsolve.estimate.estimator import Estimator
from crashsolve.foundation.errors import CrashsolveError
from crashsolve.model.build import build
from crashsolve.model.integrator_selection import with_chosen_method
from crashsolve.recording.engines import engine_of
from crashsolve.recording.histories import Histories
from crashsolve.recording.marching import March
from crashsolve.recording.samples import Samples
from crashsolve.system.engine import Engine

sys.path.insert(0, str(Path(__file__).parent / "estimates"))
from battery import LIMITS, true_error, with_watches  # noqa: E402
from closed_forms import oscillator  # noqa: E402
from scenes import Known, Scene, kinds  # noqa: E402

DECKS = Path(__file__).resolve().parents[1] / "decks"
FOLDERS = ("verification", "benchmark")
CHOSEN = (
    "integrator",
    "step",
    "tolerance",
    "safety",
    "step_max",
    "accuracy",
    "energy_limit",
    "resolve",
)
RIGHT = (1e-3, 1e-2)
LONG = (16, 160)
# [s of CPU] for one run
LIMIT = 4.0


@dataclass(frozen=True)
class Number:
    """A number of a run, and its error over its scale."""

    deck: str
    name: str
    error: float


@dataclass(frozen=True)
class Run:
    """What a deck came to: numbers, method, steps, CPU time of steps and samples [s]."""

    numbers: list[Number]
    method: str
    cycles: int
    spent: float


class Stopwatch:
    """CPU time of steps and samples [s], without building and compiling."""

    def __init__(self) -> None:
        self.spent = 0.0
        for owner, name in ((Engine, "reach"), (Engine, "sample"), (March, "go")):
            setattr(owner, name, self._timed(getattr(owner, name)))

    def _timed(self, method: Callable[..., object]) -> Callable[..., object]:
        def timed(*words: object) -> object:
            begun = time.process_time()
            try:
                return method(*words)
            finally:
                self.spent += time.process_time() - begun

        return timed


def with_defaults(deck: Deck, words: dict[str, str]) -> Deck:
    """The deck without its settings of methods and steps, or with others."""
    kept = {k: v for k, v in deck.control.model_dump(exclude_unset=True).items() if k not in CHOSEN}
    return replace(deck, control=Control(**kept, **words))


def tried(path: Path, words: dict[str, str], watch: Stopwatch) -> Run | None:
    """The run of a deck; None of one that has no number to count. Raises CrashsolveError."""
    deck = read_deck(path, {}, False)
    is_static = deck.control.solution != "transient"
    has_shells = any(entry.type == "shell" for entry in deck.entries["parts"].values())
    if is_static or has_shells or not any(card.because == "exact" for card in deck.expect):
        return None
    deck, estimator, main, spent = solved(with_defaults(deck, words), watch)
    numbers = [
        Number(path.stem, w.name, abs((e.value or 0.0) - card.value) / scale)
        for card in deck.expect
        for w, e in zip(estimator.watches, estimator.estimates(main, []), strict=True)
        if (card.channel, card.statistic, card.during) == (w.channels[0], w.statistic, w.during)
        and card.because == "exact"
        and not any(c.is_of_the_run for c in estimator.channels[w.channels[0]])
        and (scale := max(abs(card.value), e.scale)) > 0.0
        and card.tolerance * (abs(card.value) if card.relative else 1.0) <= RIGHT[0] * scale
    ]
    return Run(numbers, deck.control.integrator, main.cycles, spent)


def solved(deck: Deck, watch: Stopwatch) -> tuple[Deck, Estimator, Samples, float]:
    """The deck as it was run, its watched numbers, their samples, and CPU time [s]."""
    model, state = build(deck)
    deck = with_chosen_method(deck, model)
    estimator = Estimator(deck, Histories(engine_of(deck, model, state)).families)
    estimator.companions.budget, watch.spent = LIMIT, 0.0
    main = estimator.companions.run(1.0)
    return deck, estimator, main, watch.spent


def tried_scene(scene: Scene, words: dict[str, str], watch: Stopwatch, folder: Path) -> Run:
    """The run of a scene whose motion is known. Raises CrashsolveError."""
    path = scene.deck
    if isinstance(path, str):
        path = folder / "deck.yaml"
        path.write_text(f"control: {{end_time: {float(scene.end)!r}}}\n{scene.deck}\n", "utf-8")
    deck = with_watches(read_deck(path, LIMITS, False), "rattle", 1000, scene)
    deck = replace(with_defaults(deck, words), output=deck.output)
    deck, estimator, main, spent = solved(deck, watch)
    known = [(k, s) for k in scene.known for s in k.statistics]
    numbers = [
        Number(scene.name, w.name, true_error(k, s, e, main) / e.scale)
        for (k, s), w, e in zip(
            known, estimator.watches, estimator.estimates(main, []), strict=True
        )
    ]
    return Run(numbers, deck.control.integrator, main.cycles, spent)


def long_oscillators(periods: int) -> Scene:
    """A mass on a spring, a disc on a torsional one and a pair of masses, over many periods."""
    omega = 10.0
    deck = f"""
bodies:
  free: {{mass: 2, inertia: [1, 1, 1], position: [1.1, 0, 0]}}
  disc: {{mass: 1, inertia: [1, 1, 1], position: [0, 5, 0], angular_velocity: [0, 0, {omega}]}}
springs:
  a: {{type: linear, b: free, stiffness: {2 * omega**2}, length: 1}}
  b: {{type: torsional, b: disc, axis: [0, 0, 1], stiffness: {omega**2}}}
"""
    known = [
        Known("rbdout.free.position.x - 1", ("final", "max"), oscillator(2, 0, 200, 0.1, 0)),
        Known("deforc.a.force", ("final",), lambda t: 200 * oscillator(2, 0, 200, 0.1, 0)(t)),
        Known("deforc.b.angle", ("final", "max"), oscillator(1, 0, 100, 0, omega)),
    ]
    # a quarter of a period more, where an error of the phase shows most
    end = 2.0 * np.pi / omega * (periods + 0.125)
    return Scene(f"{periods} periods", deck, end, known, ())


def runs(paths: list[Path], words: dict[str, str]) -> Iterator[tuple[str, Run | str]]:
    """Every deck and scene with its result, or the cause of its failure."""
    watch = Stopwatch()
    # an error by the mesh is none of the steps
    scenes = [s for kind in kinds() for s in kind if not s.name.startswith("meshes")]
    scenes += [long_oscillators(periods) for periods in LONG]
    with TemporaryDirectory() as folder:
        tries = [(path.stem, partial(tried, path, words, watch)) for path in paths]
        if paths == every_deck():
            tries = [
                (scene.name, partial(tried_scene, scene, words, watch, Path(folder)))
                for scene in scenes
            ] + tries
        for name, run in tries:
            try:
                estimates = run()
            except BudgetExceeded:
                yield name, f"more than {LIMIT:g} s of CPU"
            except (CrashsolveError, ValueError) as error:
                yield name, str(error).splitlines()[0]
            else:
                if estimates is not None and estimates.numbers:
                    yield name, estimates


def every_deck() -> list[Path]:
    """Decks that run by themselves, in order."""
    paths = sorted(path for folder in FOLDERS for path in (DECKS / folder).rglob("*.yaml"))
    return [path for path in paths if "\ncontrol:" in path.read_text("utf-8")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("decks", nargs="*", type=Path)
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    given = parser.parse_args()
    words = dict(word.split("=", 1) for word in given.set)
    numbers, spent = list[Number](), 0.0
    for name, run in runs(given.decks or every_deck(), words):
        if isinstance(run, str):
            print(f"{name:30} left out: {run}", flush=True)
            continue
        numbers += run.numbers
        spent += run.spent
        worst = max(run.numbers, key=lambda number: number.error)
        print(
            f"{name:30}{run.method:18}{run.cycles:8} steps{run.spent:8.3f} s"
            f"{worst.error:9.1e}  {worst.name}",
            flush=True,
        )
    for bound in RIGHT:
        right = sum(number.error <= bound for number in numbers)
        print(f"{right} of {len(numbers)} numbers are right to {bound:g}")
    for number in sorted(numbers, key=lambda number: -number.error):
        if not number.error <= RIGHT[0]:
            print(f"  {number.error:9.1e}  {number.deck}: {number.name}")
    print(f"{spent:.3g} s of CPU in steps and samples")


if __name__ == "__main__":
    main()
