"""From process start to the first step: time cold and warm, and peak memory, of every deck.

    python benchmarks/start.py [DECK ...]
    python benchmarks/start.py decks/tutorial/bouncing_ball.yaml \\
        decks/benchmark/andrews_squeezer.yaml decks/scenes/train_test.yaml \\
        decks/benchmark/tube_crush.yaml decks/verification/parts/shell_radau.yaml
    python benchmarks/start.py --all

A child process (first_step.py) runs the command `crashsolve DECK` and ends where its first step
begins; the time it has used by then is counted from the start of the process. Cold: an empty cache
of compiled code. Warm: the median of 5 further starts, with Python's own compiled files in place as
in an installed package. Memory: the largest of a warm process above that of
`python -c "import numpy, h5py"`. Budget: cold 8 s by the clock and of CPU time, 1.0 s of CPU time
warm, +150 MB. The first run of a scene has a child process that compiles: its time counts as cold,
its memory stands in the last column, without a budget. The second command names small and large
scenes, shell_radau.yaml the largest of all.

`--all` is shorter and reports every deck: CPU time of one cold and one warm start, worst first,
with the parts of the cold one that read and build (this process) and that compile (its child).
Decks with beams or shells are marked flexible.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
CHILD = Path(__file__).with_name("first_step.py")
STARTS = 5
BUDGET = {"cold wall": 8.0, "cold s": 8.0, "warm s": 1.0, "memory MB": 150.0}
BARE = "import resource, numpy, h5py; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"


def decks() -> list[Path]:
    """Every deck of the project; in `shared`, and without `control:`, are parts for others."""
    paths = sorted((ROOT / "decks").rglob("*.yaml"))
    alone = [path for path in paths if path.parent.name != "shared"]
    return [path for path in alone if "\ncontrol:" in path.read_text("utf-8")]


class Start(NamedTuple):
    """One start: time on the clock and CPU time [s] of the run and of its compiler, and memory."""

    wall: float
    run: float
    compiler: float
    peak: float  # [MB] of the run
    compiler_peak: float
    is_flexible: bool

    @property
    def cpu(self) -> float:
        return self.run + self.compiler


def start(deck: Path, cache: str) -> Start:
    """One start of a deck with a cache. Raises SystemExit with the message of a run that fails."""
    environment = os.environ | {"CRASHSOLVE_CACHE": cache}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        child = subprocess.run(
            [sys.executable, CHILD, str(deck), folder],
            env=environment,
            capture_output=True,
            text=True,
        )
    wall = time.monotonic() - begun
    if child.returncode:
        raise SystemExit(f"{deck}: {child.stderr.strip()}")
    return Start(wall, *json.loads(child.stdout.splitlines()[-1]))


def _output(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def measure(deck: Path, bare: float) -> dict[str, float]:
    """The three figures of the budget for one deck, and the memory of the compiler."""
    with tempfile.TemporaryDirectory() as cache:
        cold = start(deck, cache)
        warm = [start(deck, cache) for _ in range(STARTS)]
    memory = max(one.peak for one in warm) - bare
    measures = {"cold wall": cold.wall, "cold s": cold.cpu, "memory MB": memory}
    measures["warm s"] = median(one.cpu for one in warm)
    return {name: measures[name] for name in BUDGET} | {"compiler MB": cold.compiler_peak}


def survey() -> None:
    """The table of `--all`; the number of decks done so far goes to standard error."""
    starts, apart, all_decks = [], [], decks()
    for number, deck in enumerate(all_decks, 1):
        name = deck.relative_to(ROOT)
        try:
            with tempfile.TemporaryDirectory() as cache:
                starts.append((name, start(deck, cache), start(deck, cache)))
        except SystemExit as reason:
            apart.append(f"{name} has no first step: {str(reason).splitlines()[0]}")
            continue
        message = f"{number} of {len(all_decks)}: {name} {starts[-1][1].cpu:.2f} s"
        print(message, file=sys.stderr, flush=True)
    starts.sort(key=lambda row: -row[1].cpu)
    print(f"CPU time [s] {'':40}    cold =    run + compiler    warm")
    for deck, cold, warm in starts:
        kind = "flexible" if cold.is_flexible else "rigid"
        figures = (cold.cpu, cold.run, cold.compiler, warm.cpu)
        print(f"{deck!s:52}{kind:9}" + "".join(f"{figure:8.2f}" for figure in figures))
    for flexible in (False, True):
        cold_ones = [cold.cpu for _, cold, _ in starts if cold.is_flexible == flexible]
        kind = "flexible" if flexible else "rigid"
        print(f"{len(cold_ones)} {kind}: median {median(cold_ones):.2f}, most {max(cold_ones):.2f}")
    print(*apart, sep="\n")


def main() -> None:
    if sys.argv[1:] == ["--all"]:
        return survey()
    given = [Path(name).resolve() for name in sys.argv[1:]]
    bare = float(_output(sys.executable, "-c", BARE)) / 1024
    print(f"bare: {bare:.0f} MB")
    print(f"{'deck':48}" + "".join(f"{name:>11}" for name in (*BUDGET, "compiler")))
    print(f"{'budget':48}" + "".join(f"{limit:11.2f}" for limit in BUDGET.values()))
    for deck in given or decks():
        figures = measure(deck, bare)
        name = deck.relative_to(ROOT) if deck.is_relative_to(ROOT) else deck
        missed = [word for word, limit in BUDGET.items() if figures[word] > limit]
        line = f"{name!s:48}" + "".join(f"{figure:11.2f}" for figure in figures.values())
        print(line + (f"  over: {', '.join(missed)}" if missed else ""), flush=True)


if __name__ == "__main__":
    main()
