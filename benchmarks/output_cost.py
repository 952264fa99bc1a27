"""What output costs beside the steps: `python benchmarks/output_cost.py [CASE ...]`.

A sample and a state are measured in steps of the run, by CPU time: a sample from runs with samples
at 10 kHz and at 20 kHz, in neither of which intervals have to be run again, a state from runs with
few states and with many. All have the lines of the log. Beside them CPU time of the steps of a
whole run of the case at 10 kHz, of its histories and 100 states, and their share. All of it is
measured with all channels, and with those that sensors measure. A sample evaluates all forces, as a
step does: where steps are not much shorter than 0.1 ms, 10 kHz alone is more than a tenth.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
from shell_cost import DECK
from step_cost import forty_bodies

DECKS = Path(__file__).resolve().parents[1] / "decks"
RATE, STATES = 1e4, 100
# samples of the run with few of them: more than lines in the log
FEW = 25


@dataclass(frozen=True)
class Case:
    """A deck, its text or the function that writes it, the part of it that is run here, and how
    long a whole run lasts [s].
    """

    deck: str | Callable[[], Path]
    whole: float
    part: float
    values: tuple[str, ...] = ()
    # channels that sensors and load cells measure
    measured: str = "rcforc.*.force.*"


SHELLS = DECK.format(
    n=316, element="reduced", material="plastic", thickness=3e-4, pressure=1e5, end=1e-4
)
CASES = {
    # 10^5 shells of 3 mm on a square metre
    "shells": Case(SHELLS, 24e-3, 1e-4, measured="glstat.*"),
    "tube": Case("benchmark/tube_crush.yaml", 24e-3, 4e-3, ("across=12", "along=72")),
    "ball": Case("tutorial/bouncing_ball.yaml", 0.6, 0.6),
    "train": Case("scenes/train_test.yaml", 0.6, 0.6),
    "train_sets": Case("scenes/train_sets.yaml", 1.5, 0.3),
    "dominoes": Case("benchmark/dominoes.yaml", 0.9, 0.9),
    "forty_bodies": Case(forty_bodies, 1.0, 0.3),
    "sports_car": Case("scenes/sports_car.yaml", 1.0, 0.1),
    "rollover": Case(
        "scenes/rollover.yaml", 3.0, 0.3, measured="nodout.* rcforc.*.force.* beltout.*.force.*"
    ),
}


@dataclass(frozen=True)
class Cost:
    """Of a run: steps and their CPU time [s], CPU time of all output, samples, states, channels."""

    steps: int
    stepping: float
    output: float
    samples: int
    states: int
    channels: int


def cost_once(case: Case, folder: Path, history: float, states: float, channels: str) -> Cost:
    """Run the part of a case with samples and states so far apart [s]; channels are all if ""."""
    if not isinstance(case.deck, str):
        deck = case.deck()
    elif "\n" in case.deck:
        deck = folder / "deck.yaml"
        deck.write_text(case.deck, "utf-8")
    else:
        deck = DECKS / case.deck
    settings = {
        "control.estimate": "off",
        "control.end_time": repr(case.part),
        "output.history.interval": repr(history),
        "output.states.interval": repr(states),
        "output.history.channels": channels or "null",
    }
    values = [*case.values, *(f"{name}={value}" for name, value in settings.items())]
    words = [word for value in values for word in ("--set", value)]
    command = [sys.executable, "-m", "crashsolve", str(deck), "-o", str(folder / "out"), *words]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    status = json.loads((folder / "out" / "status.json").read_text("utf-8"))
    stages, kept = status["cpu_stages"], list((folder / "out" / "states").glob("*.h5"))
    with h5py.File(folder / "out" / "history.h5") as file:
        channels = sum(_width(group) for group in file.values())
        samples = len(file["glstat/time"])
    cycles = int(status["cycle"])
    return Cost(cycles, stages["steps"], stages["output"], samples, len(kept), channels)


def _width(group: h5py.Group) -> int:
    datasets = []
    group.visititems(
        lambda path, item: datasets.append(path) if getattr(item, "ndim", 0) == 2 else None
    )
    return len(datasets) * len(group["ids"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(CASES))
    about = "runs of each kind, of which the least CPU time counts"
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help=about)
    options = parser.parse_args()
    print("case        channels  us a step  a sample  a state, steps  steps s  output s  share")
    for name in options.cases or CASES:
        for channels in ("", CASES[name].measured):
            report(name, CASES[name], channels, options.repeat)


def report(name: str, case: Case, channels: str, repeat: int) -> None:
    """Print the cost of output of a case, from the least of `repeat` runs of each kind."""

    def cost(history: float, states: float) -> Cost:
        runs = [cost_once(case, Path(folder), history, states, channels) for _ in range(repeat)]
        stepping, output = (min(getattr(r, part) for r in runs) for part in ("stepping", "output"))
        return replace(runs[0], stepping=stepping, output=output)

    with tempfile.TemporaryDirectory() as folder:
        few = cost(case.part / FEW, case.part)
        # short parts have no hundred samples at that rate
        often = min(1.0 / RATE, case.part / 100)
        sampled, twice = cost(often, case.part), cost(0.5 * often, case.part)
        drawn = cost(case.part / FEW, case.part / FEW)
    step = few.stepping / few.steps
    sample = (twice.output - sampled.output) / (twice.samples - sampled.samples)
    state = (drawn.output - few.output) / (drawn.states - few.states)
    # samples may cut steps
    steps = (sampled if often == 1.0 / RATE else few).stepping * case.whole / case.part
    output = sample * RATE * case.whole + state * STATES
    print(
        f"{name:12}{few.channels:8}{1e6 * step:11.3g}{sample / step:10.2f}{state / step:16.1f}"
        f"{steps:9.3g}{output:10.3g}{100 * output / steps:7.1f} %",
        flush=True,
    )


if __name__ == "__main__":
    main()
