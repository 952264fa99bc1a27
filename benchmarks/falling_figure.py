"""Accuracy against CPU time: a figure of 13 bodies on 12 balls falls and tumbles for 3 s.

    python benchmarks/falling_figure.py [SECONDS]

Trunk in three parts, neck, head, arms and legs in two parts each: cylinders of the shares of mass
of de Leva (1996), 73 kg. It begins upright, with an angular velocity of some 2 rad/s of every body.
The error is the largest distance of a mass centre at the end from where it is by dormand_prince_8
with a tolerance of 1e-13. CPU time of steps alone, the least of three runs. With MuJoCo installed
the same figure in joint angles stands beside it.

Two tables: in free flight, and onto the ground, which the feet reach after 0.1 m, with a sphere at
the far end of every part and friction. The second lasts 3 s or the seconds given. There the codes
have different laws of contact, so each is compared with itself at much smaller steps.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

END, GRAVITY, MASS = 3.0, 9.81, 73.0
FRICTION = 0.5
# name: (parent, mass share, joint to the parent [m], axis from it to the far end [m], radius [m])
SEGMENTS: dict[str, tuple[str, float, tuple[float, ...], tuple[float, ...], float]] = {
    "pelvis": ("", 0.1117, (0.0, 0.0, 1.0), (0.0, 0.0, 0.15), 0.14),
    "abdomen": ("pelvis", 0.1633, (0.0, 0.0, 1.15), (0.0, 0.0, 0.21), 0.13),
    "chest": ("abdomen", 0.1596, (0.0, 0.0, 1.36), (0.0, 0.0, 0.17), 0.14),
    "neck": ("chest", 0.02, (0.0, 0.0, 1.53), (0.0, 0.0, 0.11), 0.06),
    "head": ("neck", 0.0494, (0.0, 0.0, 1.64), (0.0, 0.0, 0.2), 0.09),
}
for side, y in (("left", 1.0), ("right", -1.0)):
    SEGMENTS |= {
        f"arm_{side}": ("chest", 0.0271, (0.0, 0.17 * y, 1.5), (0.0, 0.0, -0.28), 0.045),
        f"forearm_{side}": (f"arm_{side}", 0.0223, (0.0, 0.17 * y, 1.22), (0.0, 0.0, -0.3), 0.04),
        f"thigh_{side}": ("pelvis", 0.1416, (0.0, 0.08 * y, 1.0), (0.0, 0.0, -0.42), 0.075),
        f"shank_{side}": (f"thigh_{side}", 0.057, (0.0, 0.08 * y, 0.58), (0.0, 0.0, -0.43), 0.05),
    }
Body = dict[str, Any]


def figure() -> dict[str, Body]:
    """Mass, inertia, position and velocities of every body, which its joints allow."""
    rng, bodies = np.random.default_rng(5), dict[str, Body]()
    for name, (parent, share, joint, along, radius) in SEGMENTS.items():
        mass, length, at = MASS * share, abs(along[2]), np.array(joint)
        across = mass * (3.0 * radius**2 + length**2) / 12.0
        w, r, v = rng.normal(0.0, 2.0, 3), at + 0.5 * np.array(along), np.zeros(3)
        if parent:
            a = bodies[parent]
            v = a["velocity"] + np.cross(a["angular_velocity"], at - a["position"])
        bodies[name] = {
            "mass": mass,
            "inertia": [across, across, 0.5 * mass * radius**2],
            "position": r,
            "velocity": v + np.cross(w, r - at),
            "angular_velocity": w,
        }
    return bodies


def ground(bodies: dict[str, Body]) -> dict[str, Any]:
    """Cards of the ground and of the sphere at the far end of every part."""
    spheres = {
        f"{name}_end": {
            "type": "sphere",
            "body": name,
            "at": [0.5 * x for x in SEGMENTS[name][3]],
            "radius": SEGMENTS[name][4],
        }
        for name in bodies
    }
    law = {"type": "exact_restitution", "stiffness": 5e5, "restitution": 0.2}
    friction = {
        "type": "coulomb",
        "friction_coefficient": FRICTION,
        "none_below": 0.01,
        "full_above": 0.1,
    }
    fall = {"a": list(spheres), "b": ["ground"], "normal": law, "friction": friction}
    return {
        "surfaces": spheres | {"ground": {"type": "plane", "at": [0.0, 0.0, 0.0]}},
        "contacts": {"fall": fall | {"speed_floor": 0.1}},
    }


def deck_of(
    bodies: dict[str, Body], end: float, lands: bool, control: Mapping[str, object]
) -> Path:
    """The figure as a deck."""
    deck = {
        "title": "A figure of 13 bodies falls",
        "control": {"end_time": end, "estimate": "off", **control},
        "bodies": {
            name: {word: np.array(value).tolist() for word, value in body.items()}
            for name, body in bodies.items()
        },
        "joints": {
            name: {"type": "spherical", "a": parent, "b": name, "at": list(joint)}
            for name, (parent, _, joint, _, _) in SEGMENTS.items()
            if parent
        },
        "loads": {"weight": {"type": "gravity", "acceleration": [0.0, 0.0, -GRAVITY]}},
    } | (ground(bodies) if lands else {})
    path = Path(tempfile.mkdtemp()) / "figure.yaml"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), "utf-8")
    return path


Run = Callable[[], tuple[np.ndarray, float]]


def crashsolve(
    bodies: dict[str, Body], end: float, lands: bool, control: Mapping[str, object]
) -> tuple[np.ndarray, float]:
    """Mass centres at the end [m], and CPU time [s]."""
    deck = read_deck(deck_of(bodies, end, lands, control), {})
    engine = Engine(*build(deck))
    engine.start()
    begun = time.process_time()
    engine.advance(end)
    return engine.state.nodes["r"][1 : 1 + len(bodies)].copy(), time.process_time() - begun


# spheres meet the ground alone
SPHERE = f'type="sphere" friction="{FRICTION} 0 0" condim="3" contype="0" conaffinity="1"'
PLANE = f'<geom type="plane" size="9 9 1" friction="{FRICTION} 0 0" contype="1" conaffinity="0"/>'


def mjcf(bodies: dict[str, Body], lands: bool, step: float, integrator: str) -> str:
    """The figure as a model of MuJoCo: positions of a body's frame are those of its joint."""

    def element(name: str) -> str:
        parent, _, joint, along, radius = SEGMENTS[name]
        at = np.array(joint) - np.array(SEGMENTS[parent][2] if parent else np.zeros(3))
        inertia = " ".join(f"{x:.17g}" for x in bodies[name]["inertia"])
        children = "".join(element(other) for other, row in SEGMENTS.items() if row[0] == name)
        kind = '<joint type="ball"/>' if parent else "<freejoint/>"
        kind += f'<geom size="{radius:.17g}" pos="0 0 {along[2]:.17g}" {SPHERE}/>' * lands
        return (
            f'<body name="{name}" pos="{at[0]:.17g} {at[1]:.17g} {at[2]:.17g}">{kind}'
            f'<inertial pos="0 0 {0.5 * along[2]:.17g}" mass="{bodies[name]["mass"]:.17g}" '
            f'diaginertia="{inertia}"/>{children}</body>'
        )

    world = PLANE * lands + element("pelvis")
    return (
        f'<mujoco><option timestep="{step:.17g}" integrator="{integrator}" '
        f'gravity="0 0 {-GRAVITY}"/><worldbody>{world}</worldbody></mujoco>'
    )


def mujoco_run(
    bodies: dict[str, Body], end: float, lands: bool, step: float, integrator: str
) -> tuple[np.ndarray, float]:
    """The same by MuJoCo."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(mjcf(bodies, lands, step, integrator))
    data = mujoco.MjData(model)
    for k in range(1, model.nbody):
        name = model.body(k).name
        parent, w = SEGMENTS[name][0], bodies[name]["angular_velocity"]
        first = model.jnt_dofadr[model.body_jntadr[k]]
        # all axes are parallel at the start
        if parent:
            data.qvel[first : first + 3] = w - bodies[parent]["angular_velocity"]
        else:
            # the pelvis' frame, in its joint, rests
            data.qvel[first : first + 6] = [0.0, 0.0, 0.0, *w]
    begun = time.process_time()
    mujoco.mj_step(model, data, nstep=round(end / step))
    spent = time.process_time() - begun
    mujoco.mj_forward(model, data)
    order = [model.body(name).id for name in bodies]
    return data.xipos[order].copy(), spent


def table(exact: dict[str, np.ndarray], runs: dict[str, Run]) -> None:
    """Error and CPU time of runs, each compared with the positions of the code it begins with."""
    print("| | error, mm | CPU, s |\n|---|---|---|")
    for name, run in runs.items():
        results = [run() for _ in range(3)]
        error = np.linalg.norm(results[0][0] - exact[name.split(maxsplit=1)[0]], axis=1).max()
        print(
            f"| {name} | {1e3 * error:.2g} | {min(spent for _, spent in results):.3f} |", flush=True
        )


def flight(bodies: dict[str, Body], mujoco: str) -> None:
    """Free flight: all against one reference."""
    own = partial(crashsolve, bodies, END, False)
    exact, _ = own({"integrator": "dormand_prince_8", "tolerance": 1e-13})
    runs: dict[str, Run] = {"crashsolve as by default": partial(own, {})}
    for method, word, values in (
        ("rattle", "step", (1e-3, 2.5e-4)),
        ("dormand_prince_8", "tolerance", (1e-4, 1e-6)),
    ):
        for value in values:
            control = {"integrator": method, word: value}
            runs[f"crashsolve {method}, {word} {value:g}"] = partial(own, control)
    for integrator, step in (("Euler", 1e-3), ("Euler", 1e-4), ("RK4", 5e-3), ("RK4", 1e-3)):
        if mujoco:
            name = f"MuJoCo {mujoco}, {integrator}, step {step:g} s"
            runs[name] = partial(mujoco_run, bodies, END, False, step, integrator)
    print(f"Free flight of {END:g} s\n")
    table({"crashsolve": exact, "MuJoCo": exact}, runs)


def landing(bodies: dict[str, Body], mujoco: str, end: float) -> None:
    """Onto the ground: every code against itself."""
    own, other = partial(crashsolve, bodies, end, True), partial(mujoco_run, bodies, end, True)
    exact = {"crashsolve": own({"safety": 2e-3})[0]}
    runs: dict[str, Run] = {
        f"crashsolve safety {value:g}": partial(own, {"safety": value})
        for value in (0.4, 0.15, 0.1, 0.05)
    }
    if mujoco:
        exact["MuJoCo"] = other(2e-6, "implicitfast")[0]
        for step in (1e-3, 1e-4, 2e-5):
            name = f"MuJoCo {mujoco}, implicitfast, step {step:g} s"
            runs[name] = partial(other, step, "implicitfast")
    print(f"\nOnto the ground, {end:g} s\n")
    table(exact, runs)


def main() -> None:
    bodies, mujoco = figure(), version_of_mujoco()
    flight(bodies, mujoco)
    landing(bodies, mujoco, float(sys.argv[1]) if sys.argv[1:] else END)


def version_of_mujoco() -> str:
    """Empty where it is not installed."""
    try:
        import mujoco
    except ImportError:
        print("without MuJoCo, which is not installed\n")
        return ""
    return str(mujoco.__version__)


if __name__ == "__main__":
    main()
