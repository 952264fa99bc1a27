"""Cost of one step of N spheres falling into a box, against N log N.

    python benchmarks/spheres.py [N ...]

Spheres of 100 mm on a jittered lattice, in layers as wide as high, fall on a floor between four
walls. The deck states an onset tolerance, so that thousands of impacts do not each cut a step. The
first stretch, up to the first contacts in number, warms up; then the median CPU time of 9 stretches
of equal time. "growth" is the cost per step over N log2 N, relative to the first line: budget 1.
"""

import random
import sys
import tempfile
import time
from math import ceil, log2
from pathlib import Path
from statistics import median

import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.energy import IMBALANCE, LARGEST
from crashsolve.system.engine import Engine

RADIUS, SPACING, JITTER = 0.05, 0.115, 0.005
WARM_UP, STRETCH, STRETCHES = 0.15, 0.01, 9


def deck_text(count: int) -> str:
    """A deck of `count` spheres, the same on every call."""
    side = ceil(count ** (1 / 3))
    chance = random.Random(1)
    bodies, surfaces = {}, {}
    for i in range(count):
        cell = (i % side, i // side % side, i // side**2)
        bodies[f"ball_{i}"] = {
            "primitive": {"shape": "sphere", "radius": RADIUS, "density": 1000},
            "position": [SPACING * (k + 0.5) + chance.uniform(-JITTER, JITTER) for k in cell],
            "velocity": [chance.uniform(-0.5, 0.5) for _ in cell],
        }
        surfaces[f"ball_{i}"] = {"type": "sphere", "body": f"ball_{i}", "radius": RADIUS}
    balls, width = list(surfaces), SPACING * side
    walls = {
        "floor": ([0, 0, 0], [0, 0, 1]),
        "left": ([0, 0, 0], [1, 0, 0]),
        "right": ([width, 0, 0], [-1, 0, 0]),
        "front": ([0, 0, 0], [0, 1, 0]),
        "back": ([0, width, 0], [0, -1, 0]),
    }
    for name, (at, normal) in walls.items():
        surfaces[name] = {"type": "plane", "at": at, "normal": normal}
    law = {"type": "lankarani_nikravesh", "stiffness": 1e7, "restitution": 0.9}
    deck = {
        "title": f"{count} spheres fall into a box",
        "control": {"end_time": 1.0, "onset_tolerance": 1e-3},
        "bodies": bodies,
        "surfaces": surfaces,
        "contacts": {
            "spheres": {"a": balls, "b": balls, "normal": law},
            "walls": {"a": balls, "b": list(walls), "normal": law},
        },
        "loads": {"weight": {"type": "gravity"}},
    }
    return str(yaml.dump(deck, Dumper=yaml.CSafeDumper))


def engine_of(count: int) -> Engine:
    """The scene, read from a file as a user's deck is."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spheres.yaml"
        path.write_text(deck_text(count), "utf-8")
        return Engine(*build(read_deck(path, {})))


def measure(count: int) -> dict[str, float]:
    """Figures of one line of the table."""
    begun = time.process_time()
    engine = engine_of(count)
    engine.start()
    built = time.process_time() - begun
    engine.advance(WARM_UP)
    costs, cycles = [], int(engine.clock["cycle"])
    for k in range(STRETCHES):
        before, begun = int(engine.clock["cycle"]), time.process_time()
        engine.advance(WARM_UP + (k + 1) * STRETCH)
        costs.append((time.process_time() - begun) / (int(engine.clock["cycle"]) - before))
    engine.sample()
    return {
        "build s": built,
        "steps": int(engine.clock["cycle"]) - cycles,
        "touching": float(engine.state.cards["touching"].sum()),
        "balance %": 100.0 * float(engine.ledger[IMBALANCE] / engine.ledger[LARGEST]),
        "us/step": 1e6 * median(costs),
        "ns/step/N": 1e9 * median(costs) / count,
    }


def main() -> None:
    first, head = 0.0, ""
    for count in [int(word) for word in sys.argv[1:]] or [100, 1000, 10000]:
        figures = measure(count)
        share = figures["us/step"] / (count * log2(count))
        first = first or share
        if not head:
            head = f"{'N':>7}" + "".join(f"{name:>11}" for name in [*figures, "growth"])
            print(head)
        cells = "".join(f"{value:11.4g}" for value in [*figures.values(), share / first])
        print(f"{count:7d}{cells}", flush=True)


if __name__ == "__main__":
    main()
