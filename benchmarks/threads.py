"""What several threads bring: share of a step that they do, what pieces cost, speed by the clock.

    python benchmarks/threads.py [threads ...]        2 when absent

"shared" is how often, at moments that have nothing to do with the step, the one thread of a run
that is cut for several is found in a job that they would share: Amdahl's share p, which other
programs on the machine do not change. "pieces" is c, the CPU time of that run over that of a run
which is not cut. Of N cores of one's own follows from both, at most, N / c / (N - (N - 1) p).
Speed by the clock is that of runs in turn, stretch by stretch, and says something only where
nothing else runs: the load is told. The bits are those of one thread, asserted at the end.
"""

import os
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from threading import Event, Thread

import numpy as np

from crashsolve.cli import give_back_memory
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine
from crashsolve.system.threads.jobs import NONE

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
    hold: [{{nodes: u0}}, {{nodes: u1}}, {{nodes: v0}}, {{nodes: v1}}]
{load}"""
LOAD = "loads: {q: {type: pressure, part: plate, pressure: 1e5}}\n"
STRETCHES = 30
# seconds between two looks at what a run is doing, on average
LOOK = 2e-3


class Watched:
    """A run, with what its stretches have taken [s]: CPU of its first thread, of all, the clock."""

    def __init__(self, deck: Path, threads: int, alone: bool = False) -> None:
        self.engine = Engine(*build(read_deck(deck, {"control.threads": str(threads)})))
        self.tables = self.engine._present
        if alone:
            self.tables.of_threads.clear()
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
        """Go on, and be looked at now and then."""
        ended = Event()
        watch = Thread(target=self._watch, args=(ended,))
        watch.start()
        self.advance(until)
        ended.set()
        watch.join()

    def _watch(self, ended: Event) -> None:
        rng, job = np.random.default_rng(1), self.tables.job
        while not ended.wait(rng.uniform(0.0, 2.0 * LOOK)):
            self.looks += 1
            self.shared += int(job["number"][0]) != NONE


def measure(name: str, deck: Path, times: np.ndarray, threads: list[int]) -> None:
    """Go through a deck with one thread, and with one that is cut for several, and with several."""
    one = Watched(deck, 1)
    alone = {n: Watched(deck, n, alone=True) for n in threads}
    several = {n: Watched(deck, n) for n in threads}
    for k, until in enumerate(times):
        for run in (one, *several.values()):
            run.advance(until)
        for run in alone.values():
            # looks disturb what is measured
            (run.advance if k % 2 else run.watched)(until)
    begun = int(one.engine.clock["cycle"])
    print(f"{name}, {begun} steps, {1e6 * sum(one.first) / begun:.0f} us of CPU each")
    for n in threads:
        run, cut = several[n], alone[n]
        for other in (run, cut):
            assert other.engine.state.points.tobytes() == one.engine.state.points.tobytes()
        p = cut.shared / cut.looks
        c = median(a / b for a, b in zip(cut.first[1::2], one.first[1::2], strict=True))
        pairs = [a / b for a, b in zip(one.clock, run.clock, strict=True)]
        limit = n / c / (n - (n - 1) * p)
        print(
            f"  {n} threads: shared {100 * p:.1f} % of {cut.looks} looks, pieces {c:.3f}: at most "
            f"{limit:.2f} times one; by the clock {median(pairs):.2f} (median), "
            f"{sum(one.clock) / sum(run.clock):.2f} (whole); CPU {sum(run.cpu) / sum(one.cpu):.2f} "
            f"of one; {os.getloadavg()[0]:.1f} processes want {os.cpu_count()} cores",
            flush=True,
        )


def main(threads: list[int]) -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "plate.yaml"
        for n, steps in ((100, 400), (316, 24)):
            for name, load in (("", ""), (", pressed", LOAD)):
                deck.write_text(PLATE.format(n=n, thickness=0.1 / n, load=load), "utf-8")
                h = 0.8 / n / 6000
                times = steps * h * np.arange(1, STRETCHES + 1)
                measure(f"plate of {n * n}{name}", deck, times, threads)
    measure("crushed tube", TUBE, np.linspace(0.0, 24e-3, 97)[1:], threads)


if __name__ == "__main__":
    # as in a run
    give_back_memory()
    main([int(word) for word in sys.argv[1:]] or [2])
