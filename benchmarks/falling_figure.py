"""Accuracy against CPU time: a figure of 13 bodies on 12 balls falls and tumbles for 3 s.

    python benchmarks/falling_figure.py

Trunk in three parts, neck, head, arms and legs in two parts each: cylinders of the shares of mass
of de Leva (1996), 73 kg. It begins upright, with an angular velocity of some 2 rad/s of every body.
The error is the largest distance of a mass centre at the end from where it is by dormand_prince_8
with a tolerance of 1e-13. CPU time of steps alone, the least of three runs. With MuJoCo installed
the same figure in joint angles stands beside it.
"""

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
    rng, found = np.random.default_rng(5), dict[str, Body]()
    for name, (parent, share, joint, along, radius) in SEGMENTS.items():
        mass, length, at = MASS * share, abs(along[2]), np.array(joint)
        across = mass * (3.0 * radius**2 + length**2) / 12.0
        w, r, v = rng.normal(0.0, 2.0, 3), at + 0.5 * np.array(along), np.zeros(3)
        if parent:
            a = found[parent]
            v = a["velocity"] + np.cross(a["angular_velocity"], at - a["position"])
        found[name] = {
            "mass": mass,
            "inertia": [across, across, 0.5 * mass * radius**2],
            "position": r,
            "velocity": v + np.cross(w, r - at),
            "angular_velocity": w,
        }
    return found


def deck_of(bodies: dict[str, Body], control: Mapping[str, object]) -> Path:
    """The figure as a deck."""
    deck = {
        "title": "A figure of 13 bodies falls",
        "control": {"end_time": END, "estimate": "off", **control},
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
    }
    path = Path(tempfile.mkdtemp()) / "figure.yaml"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), "utf-8")
    return path


def crashsolve(bodies: dict[str, Body], control: Mapping[str, object]) -> tuple[np.ndarray, float]:
    """Mass centres at the end [m], and CPU time [s]."""
    deck = read_deck(deck_of(bodies, control), {})
    engine = Engine(*build(deck))
    engine.start()
    begun = time.process_time()
    engine.advance(END)
    return engine.state.nodes["r"][1 : 1 + len(bodies)].copy(), time.process_time() - begun


def mjcf(bodies: dict[str, Body], step: float, integrator: str) -> str:
    """The figure as a model of MuJoCo: positions of a body's frame are those of its joint."""

    def element(name: str) -> str:
        parent, _, joint, along, _ = SEGMENTS[name]
        at = np.array(joint) - np.array(SEGMENTS[parent][2] if parent else np.zeros(3))
        inertia = " ".join(f"{x:.17g}" for x in bodies[name]["inertia"])
        children = "".join(element(other) for other, row in SEGMENTS.items() if row[0] == name)
        kind = '<joint type="ball"/>' if parent else "<freejoint/>"
        return (
            f'<body name="{name}" pos="{at[0]:.17g} {at[1]:.17g} {at[2]:.17g}">{kind}'
            f'<inertial pos="0 0 {0.5 * along[2]:.17g}" mass="{bodies[name]["mass"]:.17g}" '
            f'diaginertia="{inertia}"/>{children}</body>'
        )

    return (
        f'<mujoco><option timestep="{step:.17g}" integrator="{integrator}" '
        f'gravity="0 0 {-GRAVITY}"/><worldbody>{element("pelvis")}</worldbody></mujoco>'
    )


def mujoco_run(bodies: dict[str, Body], step: float, integrator: str) -> tuple[np.ndarray, float]:
    """The same by MuJoCo."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(mjcf(bodies, step, integrator))
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
    mujoco.mj_step(model, data, nstep=round(END / step))
    spent = time.process_time() - begun
    mujoco.mj_forward(model, data)
    order = [model.body(name).id for name in bodies]
    return data.xipos[order].copy(), spent


def main() -> None:
    bodies = figure()
    exact, _ = crashsolve(bodies, {"integrator": "dormand_prince_8", "tolerance": 1e-13})
    runs: dict[str, Callable[[], tuple[np.ndarray, float]]] = {
        "crashsolve, as by default": partial(crashsolve, bodies, {}),
    }
    for method, word, values in (
        ("rattle", "step", (1e-3, 2.5e-4)),
        ("dormand_prince_8", "tolerance", (1e-4, 1e-6)),
    ):
        for value in values:
            control = {"integrator": method, word: value}
            runs[f"crashsolve, {method}, {word} {value:g}"] = lambda c=control: crashsolve(
                bodies, c
            )
    try:
        import mujoco

        for integrator, step in (("Euler", 1e-3), ("Euler", 1e-4), ("RK4", 5e-3), ("RK4", 1e-3)):
            name = f"MuJoCo {mujoco.__version__}, {integrator}, step {step:g} s"
            runs[name] = partial(mujoco_run, bodies, step, integrator)
    except ImportError:
        print("without MuJoCo, which is not installed\n")
    print("| | error, mm | CPU, s |\n|---|---|---|")
    for name, run in runs.items():
        found = [run() for _ in range(3)]
        error = np.linalg.norm(found[0][0] - exact, axis=1).max()
        print(f"| {name} | {1e3 * error:.2g} | {min(spent for _, spent in found):.3f} |")


if __name__ == "__main__":
    main()
