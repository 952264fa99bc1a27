"""Cost of a tyre and of the sports car, median CPU time per step.

    python benchmarks/car_cost.py tyre        one tyre, on a plane and on a profile
    python benchmarks/car_cost.py rolling     the car of 16 rigid bodies
    python benchmarks/car_cost.py crash       the scenario head-on, of 0.2 s: all steps

The cost of a tyre is the increase of a step of one body on four by 32 further tyres, over 32.
Budget: a tyre 0.2 us, the rigid car 10 us, a scenario 0.6 s.
"""

import sys
import tempfile
from pathlib import Path
from statistics import median

import yaml
from step_cost import ROOT, step_cost

FEW, MANY = 4, 36
LAW = {
    "wheel": "sledge",
    "radius": 0.3,
    "stiffness": 2e5,
    "damping": 500.0,
    "slip_stiffness": 8e4,
    "cornering_stiffness": 6e4,
    "friction_max": 1.0,
}
ROADS = {"plane": {"road": ["ground"]}, "profile": {"profile": {"curve": "road"}}}


def sledge(law: str, road: str, count: int) -> Path:
    """A body that slides along and aside on many tyres, whose wheels do not turn."""
    tyres = {
        f"tyre_{k}": {"type": law, **LAW, **ROADS[road], "at": [0.1 * k, 0.05 * (k % 2), 0.0]}
        for k in range(count)
    }
    deck = {
        "title": f"{count} tyres of type {law} on a {road}",
        "control": {"end_time": 0.5, "step": 5e-5, "energy_limit": "off"},
        "bodies": {
            "sledge": {
                "mass": 2000.0 * count,
                "inertia": [1e6, 1e6, 1e6],
                "mass_centre": [0.05 * (count - 1), 0.0, 0.0],
                "position": [0, 0, 0.2],
                "velocity": [20.0, 1.0, 0.0],
                "angular_velocity": [0.0, 0.0, 0.0],
            }
        },
        "curves": {"road": {"points": [[-50, 0], [50, 0]]}},
        "surfaces": {"ground": {"type": "plane"}},
        "tyres": tyres,
        "loads": {"weight": {"type": "gravity"}},
    }
    path = Path(tempfile.mkdtemp()) / "sledge.yaml"
    path.write_text(yaml.safe_dump(deck))
    return path


def tyre() -> None:
    print(f"{'tyre':8} {'road':8} {'us':>6}")
    for law in ("gim", "fiala"):
        for road in ROADS:
            costs = {n: step_cost(sledge(law, road, n), {})[1] for n in (FEW, MANY)}
            print(f"{law:8} {road:8} {1e6 * (costs[MANY] - costs[FEW]) / (MANY - FEW):6.3f}")


def rolling() -> None:
    typical, least, steps, iterations = step_cost(ROOT / "decks/scenes/sports_car/rolling.yaml", {})
    print(f"rigid car: median {1e6 * typical:.1f} us a step, least {1e6 * least:.1f}, ", end="")
    print(f"{iterations:.2f} iterations")


def crash() -> None:
    path, costs = ROOT / "decks/scenes/sports_car.yaml", []
    for _ in range(3):
        # nine stretches of ten, in steps of the same kind: all steps are those of ten
        typical, least, steps, _ = step_cost(path, {})
        costs.append(10 * steps * typical)
        print(f"crash: median {1e6 * typical:.1f} us a step, least {1e6 * least:.1f}")
    print(f"scenario of 0.2 s: about {median(costs):.2f} s of CPU")


if __name__ == "__main__":
    for name in sys.argv[1:] or ("tyre", "rolling", "crash"):
        {"tyre": tyre, "rolling": rolling, "crash": crash}[name]()
