"""From process start to the first step: time cold and warm, and peak memory, of every deck.

    python benchmarks/start.py [DECK ...]
    python benchmarks/start.py decks/tutorial/bouncing_ball.yaml \\
        decks/benchmark/andrews_squeezer.yaml decks/scenes/train_test.yaml \\
        decks/benchmark/tube_crush.yaml decks/verification/parts/shell_radau.yaml

A child process runs the command `crashsolve DECK` and ends after its first step; what it has used
by then is counted from the start of the process. Cold: an empty cache of compiled code. Warm: the
median of 5 further starts, with Python's own compiled files in place as in an installed package.
Memory: the largest of a warm process above that of `python -c "import numpy, h5py"`. Budget: cold
8 s by the clock and of CPU time, 1.0 s of CPU time warm, +150 MB. The first run of a scene has a
child process that compiles: its time counts as cold, its memory stands in the last column, without
a budget. The second command names small and large scenes, shell_radau.yaml the largest of all.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent
STARTS = 5
BUDGET = {"cold wall": 8.0, "cold s": 8.0, "warm s": 1.0, "memory MB": 150.0}
PROCESSES = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
BARE = "import resource, numpy, h5py; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"


def decks() -> list[Path]:
    """Every deck of the project; a file without `control:` is a part for others to include."""
    found = sorted((ROOT / "decks").rglob("*.yaml"))
    return [path for path in found if "\ncontrol:" in path.read_text("utf-8")]


def end_after_first_step(deck: str, folder: str) -> None:
    """Run the command until the first step is done, then say what that has used."""
    from crashsolve.system.engine import Engine

    step = Engine._step

    def one_step(engine: Engine, until: float, _: float) -> None:
        # the result is not wanted, only that one step is done
        first = min(until, float(engine.clock["time"] + engine.clock["next_step"]))
        step(engine, first, first)
        peaks = [resource.getrusage(who).ru_maxrss / 1024 for who in PROCESSES]
        print(json.dumps([sum(os.times()[:4]), *peaks]), flush=True)
        os._exit(0)

    Engine._step = one_step  # type: ignore[method-assign]
    from crashsolve.cli import main

    sys.exit(main([deck, "-o", folder]))


def start(deck: Path, cache: str) -> tuple[float, float, float, float]:
    """Clock and CPU time [s], peak memory [MB] of the run and its compiler, of one start."""
    environment = os.environ | {"CRASHSOLVE_CACHE": cache}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        child = subprocess.run(
            [sys.executable, __file__, "--child", str(deck), folder],
            env=environment,
            capture_output=True,
            text=True,
        )
    wall = time.monotonic() - begun
    if child.returncode:
        raise SystemExit(f"{deck}: {child.stderr.strip()}")
    cpu, peak, compiler = json.loads(child.stdout.splitlines()[-1])
    return wall, cpu, peak, compiler


def _output(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def measure(deck: Path, bare: float) -> dict[str, float]:
    """The three figures of the budget for one deck, and the memory of the compiler."""
    with tempfile.TemporaryDirectory() as cache:
        wall, cold, _, compiler = start(deck, cache)
        warm = [start(deck, cache) for _ in range(STARTS)]
    memory = max(peak for _, _, peak, _ in warm) - bare
    warm_cpu = median(cpu for _, cpu, _, _ in warm)
    found = {"cold wall": wall, "cold s": cold, "warm s": warm_cpu, "memory MB": memory}
    return found | {"compiler MB": compiler}


def main() -> None:
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
    if sys.argv[1:2] == ["--child"]:
        end_after_first_step(*sys.argv[2:])
    main()
