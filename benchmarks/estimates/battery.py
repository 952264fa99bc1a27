"""The battery: every scene by every method and setting, estimated errors against true ones."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scenes import Known, Scene, kinds

from crashsolve.channels.series import Series
from crashsolve.channels.statistic import refined
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.run_cards.watch import Watch
from crashsolve.deck.source import Position
from crashsolve.estimate.error import Estimate
from crashsolve.estimate.estimator import estimate_in_memory
from crashsolve.model.build import build
from crashsolve.model.integrator_selection import with_chosen_method
from crashsolve.recording.samples import Samples
from crashsolve.study.child_runs import cores

# methods that choose their step
CHOOSERS = (
    "dormand_prince_5",
    "dormand_prince_8",
    "generalized_alpha",
    "radau_iia_5",
    "auto",
)
# and those for scenes whose steps stiffness would bound
STIFF = CHOOSERS[2:]
LIMITS = {"control.step": "auto", "control.energy_limit": "off"}
# an error below this share of the scale is round-off, and the tolerance of the joints
ROUND_OFF = 1e-10
FACTOR = 10.0


@dataclass(frozen=True)
class RatedNumber:
    """One number of one run: its estimate and its true error, in the unit of the number."""

    scene: str
    method: str
    setting: str
    number: str
    estimate: Estimate
    true: float
    near: float
    floor: float
    cost: float

    @property
    def counts(self) -> bool:
        """Whether the error is one of the method and not round-off, or of the truth."""
        return self.true > self.floor * self.estimate.scale

    @property
    def ratio(self) -> float:
        """Estimated over true error; over the largest near the moment if it exceeds that."""
        error = self.estimate.error or 0.0
        if error < self.true:
            return error / self.true
        return max(1.0, error / max(self.true, self.near))

    @property
    def holds(self) -> bool:
        """Whether estimate and truth are within the factor; not where nothing was estimated."""
        return 1.0 / FACTOR <= self.ratio <= FACTOR


def settings(scene: Scene) -> Iterator[tuple[str, str, dict[str, str], int]]:
    """Method, setting in words, overrides of control, number of samples."""
    for step in map(float, scene.steps):
        yield "rattle", f"step {step:.3g}", {"control.step": f"{step!r} s"}, 1000
    for safety in scene.safeties:
        yield "rattle", f"safety {safety:g}", {"control.safety": repr(safety)}, 200
    for method in STIFF if scene.is_stiff else CHOOSERS:
        for tolerance in scene.tolerances if method != "auto" else scene.tolerances[1::2]:
            yield method, f"tolerance {tolerance:g}", {"control.tolerance": repr(tolerance)}, 50
        for step in map(float, scene.fixed if method != "auto" else ()):
            yield method, f"step {step:.3g}", {"control.step": f"{step!r} s"}, 100


def rate_scene(scene: Scene, folder: Path) -> Iterator[list[RatedNumber]]:
    """The numbers of every run of a scene."""
    path = scene.deck
    if isinstance(path, str):
        path = folder / "deck.yaml"
        path.write_text(f"control: {{end_time: {float(scene.end)!r}}}\n{scene.deck}\n", "utf-8")
    for method, words, overrides, samples in settings(scene):
        deck = with_watches(read_deck(path, LIMITS | overrides, False), method, samples, scene)
        main, estimates, cost = estimate_in_memory(deck)
        numbers = [(k, s) for k in scene.known for s in k.statistics]
        yield [
            RatedNumber(
                *(scene.name, method, words, f"{k.channel} {s}", e),
                *(true_error(k, s, e, main), near_error(k, s, main)),
                *(max(ROUND_OFF, k.floor), cost),
            )
            for (k, s), e in zip(numbers, estimates, strict=True)
        ]


def with_watches(deck: Deck, method: str, samples: int, scene: Scene) -> Deck:
    """The deck with the method, the samples and the watched numbers of the battery."""
    control = deck.control.model_copy(update={"integrator": method, "end_time": scene.end})
    deck = replace(deck, control=control)
    if method == "auto":
        # as a run does it
        control = with_chosen_method(deck, build(deck)[0]).control
    history = deck.output.history.model_copy(update={"interval": scene.end / samples})
    watch = [Watch(channel=k.channel, statistic=s) for k in scene.known for s in k.statistics]
    return replace(
        deck,
        control=control,
        output=deck.output.model_copy(update={"history": history}),
        watch=watch,
        watch_at=[Position(deck.path, 1, 1)] * len(watch),
        expect=[],
        expect_at=[],
    )


def true_error(known: Known, statistic: str, estimate: Estimate, main: Samples) -> float:
    """Distance of a number from its truth."""
    if not callable(known.truth):
        return abs((estimate.value or 0.0) - known.truth)
    if statistic == "path":
        values = main.series(known.channel).values
        return float(np.max(np.abs(values - known.truth(main.time))))
    # 64 points between samples: a parabola, or Simpson's rule, leaves less than round-off
    fine = np.linspace(main.time[0], main.time[-1], 64 * (len(main.time) - 1) + 1)
    if statistic.startswith("at:"):
        truth = float(known.truth(np.array([float(statistic[3:])]))[0])
    else:
        truth = refined(Series(fine, known.truth(fine)), statistic)
    return abs((estimate.value or 0.0) - truth)


def near_error(known: Known, statistic: str, main: Samples) -> float:
    """Largest error of a final number near the end; 0 where that of the moment alone counts."""
    if not (known.near and callable(known.truth) and statistic == "final"):
        return 0.0
    last = main.time >= main.time[-1] - known.near * (main.time[-1] - main.time[0])
    errors = main.series(known.channel).values - known.truth(main.time)
    return float(np.max(np.abs(errors[last])))


def run_all(words: Sequence[str] = ()) -> list[list[RatedNumber]]:
    """All runs, each a list of its numbers; kinds of scenes side by side on the cores.

    Only kinds whose first scene has one of the words in its name, where some are given.
    """
    names = [scenes[0].name for scenes in kinds()]
    wanted = [k for k, name in enumerate(names) if not words or any(w in name for w in words)]
    with ProcessPoolExecutor(cores()) as pool:
        return [run for runs in pool.map(run_kind, wanted) for run in runs]


def run_kind(number: int) -> list[list[RatedNumber]]:
    """The runs of one kind of scenes."""
    with TemporaryDirectory() as folder:
        return [run for scene in kinds()[number] for run in rate_scene(scene, Path(folder))]


def share(numbers: list[RatedNumber]) -> float:
    """Share of the numbers whose estimate holds."""
    return sum(number.holds for number in numbers) / max(len(numbers), 1)


def table(runs: list[list[RatedNumber]]) -> str:
    """How many estimates hold, by method; and every one that does not."""
    numbers = [number for run in runs for number in run if number.counts]
    lines = [
        f"{len(runs)} runs, {len(numbers)} numbers with a true error above {ROUND_OFF:g} of their "
        f"scale; {100 * share(numbers):.1f} % of the estimates are within a factor {FACTOR:g}. "
        "The cost is the CPU time of the estimates over that of the run, the median.",
        "",
        "| method | runs | numbers | within | too small | too large | cost |",
        "|---|---|---|---|---|---|---|",
    ]
    for method in dict.fromkeys(number.method for number in numbers):
        chosen = [number for number in numbers if number.method == method]
        costs = [run[0].cost for run in runs if run[0].method == method]
        small = sum(number.ratio < 1 / FACTOR for number in chosen)
        large = sum(number.ratio > FACTOR for number in chosen)
        lines.append(
            f"| {method} | {len(costs)} | {len(chosen)} | {100 * share(chosen):.1f} % | {small} | "
            f"{large} | {np.median(costs):.2f} |"
        )
    return "\n".join([*lines, "", *_failures(numbers)])


def _failures(numbers: list[RatedNumber]) -> list[str]:
    lines = [
        "| scene | method | setting | number | estimated | true |",
        "|---|---|---|---|---|---|",
    ]
    for n in numbers:
        if not n.holds:
            error = "-" if n.estimate.error is None else f"{n.estimate.error:.1e}"
            lines.append(
                f"| {n.scene} | {n.method} | {n.setting} | {n.number} | {error} | {n.true:.1e} |"
            )
    return lines
