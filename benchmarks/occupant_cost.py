"""What a cone of feasible motion and a belt of six segments cost in a step.

    python benchmarks/occupant_cost.py

A pendulum on a ball swings with none of them and with eight: a law costs the eighth of the
difference. Belts are drawn back and forth and slip, are held by friction, or are slack; the
pendulum is within its cones or past their limits. Asked for: 0.3 us each. CPU time, median of nine
stretches of a run; all scenes in turn, three times: the least of three.
"""

import tempfile
from pathlib import Path
from typing import Any

import yaml
from step_cost import step_cost

COUNT, STEP, STEPS = 8, 1e-5, 60_000
ROUTE = [(1.0, 0.2), (0.8, 0.5), (0.5, 0.3), (0.3, 0.6), (0.1, 0.4)]

Scene = dict[str, Any]


def pendulum(more: Scene) -> Path:
    """A deck of a rod that swings on a ball, by 0.5 rad to each side in 0.6 s."""
    deck = {
        "title": "A pendulum",
        "control": {"end_time": STEP * STEPS, "step": STEP, "energy_limit": "off"},
        "output": {"history": {"interval": STEP * STEPS}, "states": {"interval": STEP * STEPS}},
        "bodies": {
            "rod": {
                "mass": 40.0,
                "inertia": [3.0, 3.0, 3.0],
                "position": [0.0, 0.0, 0.5],
                "velocity": [2.0, 0.0, 0.0],
                "angular_velocity": [0.0, 4.0, 0.0],
            }
        },
        "joints": {"ball": {"type": "spherical", "b": "rod", "at": [0, 0, 0]}},
        # a spring that turns it back
        "springs": {
            "back": {"type": "rotation_friction", "joint": "ball", "torque": 1e4, "stiffness": 2e3},
        },
    }
    for name, entries in more.items():
        deck[name] = deck.get(name, {}) | entries
    path = Path(tempfile.mkdtemp()) / "pendulum.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    return path


def belts(friction: float, slack: float) -> Scene:
    """Six segments through five rings of the ground, from the ground to the rod."""
    rings = [{"ring": {"at": [x, 0.0, z], "friction_coefficient": friction}} for x, z in ROUTE]
    ends = {"anchor": {"at": [1.2, 0.0, 0.0]}}, {"anchor": {"body": "rod", "at": [0.0, 0.0, 0.2]}}
    card = {
        "webbing": {"stiffness": 2e4},
        "slack": slack,
        "route": [ends[0], *rings, ends[1]],
    }
    return {"belts": {f"belt_{i}": card for i in range(COUNT)}}


def cones(half: float) -> Scene:
    card = {
        "type": "cone_stop",
        "joint": "ball",
        "axis": [0, 0, 1],
        "toward": [1, 0, 0],
        "pointer": [0, 0, 1],
        "half_angles": [half, 1.2 * half, half, 0.8 * half],
        "stiffness": 100.0,
        "transition": 0.2,
    }
    return {"springs": {f"cone_{i}": card for i in range(COUNT)}}


SCENES = {
    "none": {},
    "belt, slips in every step": belts(0.1, -0.2),
    "belt, held by friction": belts(5.0, -0.2),
    "belt, slack": belts(0.1, 3.0),
    "cone, within": cones(1.5),
    "cone, past its limit": cones(0.01),
}


def main() -> None:
    paths = {name: pendulum(more) for name, more in SCENES.items()}
    costs = dict.fromkeys(SCENES, float("inf"))
    for _ in range(3):
        for name, path in paths.items():
            costs[name] = min(costs[name], step_cost(path, {})[0])
    print("| | us per step | us each | of the pendulum's step |\n|---|---|---|---|")
    bare = costs["none"]
    for name, cost in costs.items():
        each = (cost - bare) / COUNT
        print(f"| {name} | {1e6 * cost:.2f} | {1e6 * each:.3f} | {each / bare:.2f} |")


if __name__ == "__main__":
    main()
