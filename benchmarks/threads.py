"""Gain by several threads: their share of a step, cost of pieces, speed by the clock.

    python benchmarks/threads.py [SCENE ...] [THREADS ...]        all scenes, and 2, when absent

Scenes are `plates` of 10^4 and 10^5 shells, `spheres`, 1000 and 4000 that fall into a box, and the
first 8 ms of the crushed `tube`: begun folds, contact of its ends and of the tube with itself. The
last is reported as a whole, too, by runs of the command in turn, with start, samples and all files.

"shared" is how often, at moments that have nothing to do with the step, the one thread of a run
that is cut for several is found in a job that they would share: Amdahl's share p, which other
programs on the machine do not change. "pieces" is c, the CPU time of that run over that of a run
which is not cut. Of N cores of one's own follows from both, at most, N / c / (N - (N - 1) p).
Speed by the clock is that of runs in turn, section by section, and is meaningful only where
nothing else runs: the load is reported. The bits are those of one thread, asserted at the end.
"""

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from threading import Event, Thread

import numpy as np
import spheres

from crashsolve.cli import release_memory
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine
from crashsolve.threads.jobs import NONE

TUBE = Path(__file__).resolve().parents[1] / "decks/benchmark/tube_crush.yaml"
PLATE = """
title: shells
control: {{end_time: 1, safety: 0.9, energy_limit: "off", estimate: "off"}}
materials:
  steel: {{type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 2.5e8}}
parts:
  plate:
    type: shell
    mesh: {{type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [{n}, {n}]}}
    thickness: {thickness}
    material: steel
    supports: [{{nodes: u0}}, {{nodes: u1}}, {{nodes: v0}}, {{nodes: v1}}]
{load}"""
LOAD = "loads: {q: {type: pressure, part: plate, pressure: 1e5}}\n"
STRETCHES = 30
# number of spheres, [s] from which on they are measured, after first contacts, and for how long
SPHERES, FALLEN, WATCHED = (1000, 4000), 0.15, 0.09
TUBE_END, TUBE_STRETCHES = 8e-3, 32
# runs of the command, of which the fastest counts
WHOLE = 2
# seconds between two samples of the activity of a run, on average
LOOK = 2e-3


class Alone(Engine):
    """One thread that does all pieces of several."""

    def bind(self) -> None:
        super().bind()
        for tables in (self._present, self._sampled):
            tables.of_threads.clear()


class Watched:
    """A run, with the times of its sections [s]: CPU of its first thread, of all, the clock."""

    def __init__(self, deck: Deck, threads: int, alone: bool = False) -> None:
        control = deck.control.model_copy(update={"threads": threads})
        self.engine = (Alone if alone else Engine)(*build(replace(deck, control=control)))
        self.engine.start()
        self.first: list[float] = []
        self.cpu: list[float] = []
        self.clock: list[float] = []
        self.looks = self.shared = 0

    def advance(self, until: float) -> None:
        """Go on, and take the time."""
        begun = time.thread_time(), time.process_time(), time.perf_counter()
        self.engine.advance(until)
        self.first.append(time.thread_time() - begun[0])
        self.cpu.append(time.process_time() - begun[1])
        self.clock.append(time.perf_counter() - begun[2])

    def watched(self, until: float) -> None:
        """Continue, and sample the state from time to time."""
        ended = Event()
        watch = Thread(target=self._watch, args=(ended,))
        watch.start()
        self.advance(until)
        ended.set()
        watch.join()

    def _watch(self, ended: Event) -> None:
        rng = np.random.default_rng(1)
        while not ended.wait(rng.uniform(0.0, 2.0 * LOOK)):
            self.looks += 1
            # lists of near pairs are renewed between steps, with new tables
            self.shared += int(self.engine._present.job["number"][0]) != NONE


def measure(name: str, path: Path, times: np.ndarray, threads: list[int]) -> None:
    """Go through a deck with one thread, and with one that is cut for several, and with several.

    What comes before the first time is left out.
    """
    deck = read_deck(path)
    one = Watched(deck, 1)
    alone = {n: Watched(deck, n, alone=True) for n in threads}
    several = {n: Watched(deck, n) for n in threads}
    for run in (one, *alone.values(), *several.values()):
        run.engine.advance(times[0])
    begun = int(one.engine.clock["cycle"])
    for k, until in enumerate(times[1:]):
        for run in (one, *several.values()):
            run.advance(until)
        for run in alone.values():
            # samples disturb the measurement
            (run.advance if k % 2 else run.watched)(until)
    steps = int(one.engine.clock["cycle"]) - begun
    print(f"{name}, {steps} steps, {1e6 * sum(one.first) / steps:.0f} us of CPU each")
    for n in threads:
        run, cut = several[n], alone[n]
        for other in (run, cut):
            for table in ("points", "nodes", "cards", "card_history"):
                a, b = (getattr(each.engine.state, table) for each in (other, one))
                assert a.tobytes() == b.tobytes(), table
        p = cut.shared / cut.looks
        c = median(a / b for a, b in zip(cut.first[1::2], one.first[1::2], strict=True))
        pairs = [a / b for a, b in zip(one.clock, run.clock, strict=True)]
        limit = n / c / (n - (n - 1) * p)
        print(
            f"  {n} threads: shared {100 * p:.1f} % of {cut.looks} looks, pieces {c:.3f}: at most "
            f"{limit:.2f} times one; by the clock {median(pairs):.2f} (median), "
            f"{sum(one.clock) / sum(run.clock):.2f} (whole); CPU {sum(run.cpu) / sum(one.cpu):.2f} "
            f"of one; {load()}",
            flush=True,
        )


def measure_whole(name: str, path: Path, end: float, threads: list[int]) -> None:
    """Runs of the command up to a time [s], with start, samples and files, one after the other."""
    for n in threads:
        spent: dict[int, list[float]] = {1: [], n: []}
        for _ in range(WHOLE):
            for count, times in spent.items():
                with tempfile.TemporaryDirectory() as folder:
                    words = ("-o", folder, "--set", f"control.end_time={end}")
                    words += ("--set", f"control.threads={count}", "--set", "control.estimate=off")
                    begun = time.perf_counter()
                    command = [sys.executable, "-m", "crashsolve", str(path), *words]
                    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
                    times.append(time.perf_counter() - begun)
        one, several = (min(times) for times in spent.values())
        print(
            f"{name} as a whole, to {1e3 * end:g} ms: {one:.1f} s with one thread, {several:.1f} s "
            f"with {n}: {one / several:.2f} times one; {load()}",
            flush=True,
        )


def load() -> str:
    """Who else wants the machine."""
    return f"{os.getloadavg()[0]:.1f} processes want {os.cpu_count()} cores"


def plates(folder: Path, threads: list[int]) -> None:
    """Square plates, with and without a pressure."""
    path = folder / "plate.yaml"
    for n, steps in ((100, 400), (316, 24)):
        for name, pressure in (("", ""), (", pressed", LOAD)):
            path.write_text(PLATE.format(n=n, thickness=0.1 / n, load=pressure), "utf-8")
            h = 0.8 / n / 6000
            measure(f"plate of {n * n}{name}", path, steps * h * np.arange(STRETCHES + 1), threads)


def falling(folder: Path, threads: list[int]) -> None:
    """Spheres in a box (spheres.py), from their first contacts on."""
    path = folder / "spheres.yaml"
    for count in SPHERES:
        path.write_text(spheres.deck_text(count), "utf-8")
        times = FALLEN + WATCHED * np.linspace(0.0, 1.0, STRETCHES + 1)
        measure(f"{count} spheres", path, times, threads)


def tube(folder: Path, threads: list[int]) -> None:
    """The crushed tube."""
    measure("crushed tube", TUBE, np.linspace(0.0, TUBE_END, TUBE_STRETCHES + 1), threads)
    measure_whole("crushed tube", TUBE, TUBE_END, threads)


SCENES = {"plates": plates, "spheres": falling, "tube": tube}


def main(words: list[str]) -> None:
    """Print the table."""
    threads = [int(word) for word in words if word.isdecimal()] or [2]
    names = [word for word in words if not word.isdecimal()] or list(SCENES)
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            SCENES[name](Path(folder), threads)


if __name__ == "__main__":
    # as in a run
    release_memory()
    main(sys.argv[1:])
