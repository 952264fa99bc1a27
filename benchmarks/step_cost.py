"""Cost of one step, median CPU time, in the compiled loop of three scenes.

    python benchmarks/step_cost.py [SCENE ...]

Every figure is the median of 9 stretches of the same run; the quietest is printed beside it.
Budget: the three-wagon scene 8 us, 40 bodies with 40 hinges and 20 contacts 30 us, seven-body
mechanism 10 us.
"""

import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

ROOT = Path(__file__).resolve().parent.parent
STRETCHES = 9


def forty_bodies() -> Path:
    """Eight chains of five hinged rods swing over a floor; twenty of the rods carry spheres."""
    bodies, joints, surfaces = {}, {}, {"floor": {"type": "plane", "at": [0, 0, -0.96]}}
    for chain in range(8):
        above = "ground"
        for link in range(5):
            name = f"rod_{chain}_{link}"
            # 45 degrees off the vertical: hanging straight the lowest would begin in the floor
            x, z, half = 0.3 * chain + link * 0.1414, -link * 0.1414, 0.0707
            bodies[name] = {
                "mass": 1.0,
                "inertia": [0.0034, 0.0034, 0.0002],
                "position": [x + half, 0, z - half],
            }
            joints[f"hinge_{chain}_{link}"] = {
                "type": "revolute",
                "a": above,
                "b": name,
                "at": [x, 0, z],
                "axis": [0, 1, 0],
            }
            if (5 * chain + link) % 2 == 0:
                at = [half, 0, -half]
                surfaces[f"tip_{chain}_{link}"] = {
                    "type": "sphere",
                    "body": name,
                    "at": at,
                    "radius": 0.05,
                }
            above = name
    tips = [name for name in surfaces if name != "floor"]
    deck = {
        "title": "40 bodies, 40 hinges, 20 contacts",
        "control": {"end_time": 10.0, "step": 1e-4, "energy_limit": "off"},
        "bodies": bodies,
        "joints": joints,
        "surfaces": surfaces,
        "contacts": {
            "floor": {
                "a": tips,
                "b": ["floor"],
                "normal": {"type": "lankarani_nikravesh", "stiffness": 1e5, "restitution": 0.9},
            }
        },
        "loads": {
            "weight": {"type": "gravity"},
            "push": {"type": "gravity", "acceleration": [3.0, 0, 0]},
        },
    }
    path = Path(tempfile.mkdtemp()) / "forty_bodies.yaml"
    path.write_text(yaml.safe_dump(deck))
    return path


def step_cost(path: Path, overrides: dict[str, str]) -> tuple[float, float, int, float]:
    """Median and least CPU time per step [s], steps of a stretch, position iterations per step."""
    deck = read_deck(path, overrides)
    engine = Engine(*build(deck))
    engine.start()
    start, end = deck.control.start_time, deck.control.end_time
    # long enough stretches that the clock is exact, all within the run
    length = (end - start) / (STRETCHES + 1)
    engine.advance(start + length)
    costs, cycles = [], 0
    for k in range(STRETCHES):
        before = int(engine.clock["cycle"])
        begun = time.process_time()
        engine.advance(start + (k + 2) * length)
        cycles = int(engine.clock["cycle"]) - before
        costs.append((time.process_time() - begun) / cycles)
    return median(costs), min(costs), cycles, engine.clock["iterations"] / engine.clock["cycle"]


SCENES = {
    "three wagons": lambda: ROOT / "decks/scenes/train_test.yaml",
    "forty bodies": forty_bodies,
    "seven bodies": lambda: ROOT / "decks/benchmark/andrews_squeezer.yaml",
}


def main() -> None:
    print(f"{'scene':14} {'median us':>10} {'least us':>9} {'steps':>7} {'iterations':>10}")
    for name in sys.argv[1:] or SCENES:
        typical, least, steps, iterations = step_cost(SCENES[name](), {})
        print(f"{name:14} {1e6 * typical:10.2f} {1e6 * least:9.2f} {steps:7d} {iterations:10.2f}")


if __name__ == "__main__":
    main()
