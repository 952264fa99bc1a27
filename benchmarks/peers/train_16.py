"""Two trains of eight cars, one at 55 km/h into the other at rest, along one line (section 5.1).

Masses are those of the chapter; the characteristics of the ends are stand-ins. Between two cars the
ends of both act in series: a crush curve of straight pieces, a steep elastic unloading line with a
permanent set, no tension. The force has kinks; high order is lost at those unless they are met.
"""

import tempfile
from pathlib import Path

import crash
import exudyn_runs
import mujoco_runs
import numpy as np
import yaml
from exudyn.utilities import NodeGenericODE2, ObjectGenericODE2
from numba import njit
from problem import Method, Problem, Run

END, SPEED = 1.0, 55 / 3.6
MASS = np.array([68e3, 51e3, 34e3, 34e3, 34e3, 34e3, 34e3, 51e3] * 2)
CARS, COLLISION = len(MASS), 7

# force over the stroke of both ends in series: twice the stroke of one
LOW = np.array([[0.0, 0.0], [0.21, 1.18e6], [0.7, 1.5e6], [0.8, 3.0e6]])
HIGH = np.array([[0.0, 0.0], [0.21, 1.18e6], [0.4, 2.5e6], [2.0, 2.5e6], [2.2, 4.0e6]])
UNLOADING = 2.5e7

# displacements of the cars at 1 s: from reference.py
REFERENCE = """
13.88842213553 13.34525437158 12.58730224384 11.73454115396 10.89695172092 10.01808469053
9.18847033035 8.43045504585 6.16136614948 5.45331597795 4.54138997438 3.69028178975
2.95151098497 2.27275514721 1.68970389598 1.50911412189
"""

START = np.where(np.arange(CARS) <= COLLISION, SPEED, 0.0)


@njit
def crush(stroke, points):
    """The curve between points, continued beyond the last as its last piece."""
    k = 1
    while k < len(points) - 1 and stroke > points[k, 0]:
        k += 1
    slope = (points[k, 1] - points[k - 1, 1]) / (points[k, 0] - points[k - 1, 0])
    return points[k - 1, 1] + slope * (stroke - points[k - 1, 0])


@njit
def interface(i, stroke, kept):
    """Force between car i and the next, for a permanent set."""
    if stroke <= kept:
        return 0.0
    points = HIGH if i == COLLISION else LOW
    return min(crush(stroke, points), UNLOADING * (stroke - kept))


@njit
def forces(x, kept, f):
    """Adds the forces of all interfaces on the cars."""
    for i in range(CARS - 1):
        push = interface(i, x[i] - x[i + 1], kept[i])
        f[i] -= push
        f[i + 1] += push


@njit
def commit(x, kept):
    """The set grows to where the unloading line meets the curve."""
    for i in range(CARS - 1):
        stroke = x[i] - x[i + 1]
        if stroke > kept[i]:
            push = interface(i, stroke, kept[i])
            kept[i] = max(kept[i], stroke - push / UNLOADING)


def deck():
    """The scene as a deck of crashsolve: sixteen bodies, fifteen springs with a curve."""
    points = {"low": LOW, "high": HIGH}
    pitch = 26.0
    fields = {
        "title": "Two trains of eight cars",
        "control": {"end_time": END, "step": 1e-3},
        "curves": {
            name: {"points": (-curve[::-1]).tolist(), "extrapolate": "linear"}
            for name, curve in points.items()
        },
        "bodies": {
            f"car_{i}": {
                "mass": float(MASS[i]),
                "inertia": [1e5, 1e6, 1e6],
                "position": [pitch * i, 0, 0],
                "velocity": [float(START[i]), 0, 0],
            }
            for i in range(CARS)
        },
        "springs": {
            f"ends_{i}": {
                "type": "curve",
                "a": f"car_{i}",
                "b": f"car_{i + 1}",
                "curve": "high" if i == COLLISION else "low",
                "unloading_stiffness": UNLOADING,
                "acts": "compression",
            }
            for i in range(CARS - 1)
        },
    }
    path = Path(tempfile.mkdtemp()) / "train_16.yaml"
    path.write_text(yaml.safe_dump(fields))
    return path


def crashsolve_watch(body):
    return [body[f"car_{i}"]["r"][0] - 26.0 * i for i in range(CARS)]


def exudyn_cars(system):
    """One general object of sixteen coordinates whose forces are a compiled function."""
    node = system.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * CARS,
            initialCoordinates=[0.0] * CARS,
            initialCoordinates_t=START.tolist(),
            numberOfODE2Coordinates=CARS,
        )
    )
    kept, f = np.zeros(CARS - 1), np.zeros(CARS)

    def force(_system, _time, _number, q, _rates):
        f[:] = 0.0
        forces(np.asarray(q), kept, f)
        return f

    def step_begins(_system, _time):
        commit(exudyn_runs.coordinates(system, node), kept)
        return True

    system.AddObject(
        ObjectGenericODE2(
            nodeNumbers=[node],
            massMatrix=np.diag(MASS),
            forceUserFunction=force,
        )
    )
    system.SetPreStepUserFunction(step_begins)
    return lambda: exudyn_runs.coordinates(system, node)


def mujoco_text(step, _):
    cars = "".join(
        f'<body><joint type="slide" axis="1 0 0"/>'
        f'<inertial pos="0 0 0" mass="{mass}" diaginertia="1e5 1e6 1e6"/></body>'
        for mass in MASS
    )
    return f"""
<mujoco>
  <option timestep="{step!r}" gravity="0 0 0"/>
  <worldbody>{cars}</worldbody>
</mujoco>"""


KEPT = np.zeros(CARS)


@njit
def mujoco_force(q, v, f, kept):
    """The last element counts the four calls of a step; the first sees the accepted state."""
    if kept[CARS - 1] % 4 == 0:
        commit(q, kept)
    kept[CARS - 1] += 1
    forces(q, kept, f)


def mujoco_start(model, data):
    data.qvel[:] = START


@njit
def leap_frog(x, v, h, steps):
    """What a program written for this scene alone takes: a floor, not a competitor."""
    kept, f = np.zeros(CARS - 1), np.zeros(CARS)
    for _ in range(steps):
        f[:] = 0.0
        forces(x, kept, f)
        v += h * f / MASS
        x += h * v
        commit(x, kept)


def kernel(step):
    x, v, steps = np.zeros(CARS), START.copy(), round(END / step)
    # no force acts at the start: the velocities of half a step before are the same
    return Run(lambda: leap_frog(x, v, END / steps, steps), lambda: x)


PROBLEM = Problem(
    name="train_16",
    title="Two trains of eight cars, 1 s",
    measure="largest error of the cars' displacements at 1 s [m]",
    reference=np.array(REFERENCE.split(), float),
    methods=[
        *crash.methods(
            deck(),
            [("rattle", "step", [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5]), *crash.TOLERANCES],
            crashsolve_watch,
        ),
        *exudyn_runs.methods(
            exudyn_cars,
            END,
            [
                ("RK44", "compiled law", [1e-2, 3e-3, 1e-3, 3e-4, 1e-4]),
                ("VelocityVerlet", "compiled law", [1e-2, 3e-3, 1e-3, 3e-4, 1e-4]),
                ("DOPRI5", "compiled law", [1e-3, 1e-5, 1e-7, 1e-9]),
            ],
        ),
        *mujoco_runs.methods(
            mujoco_text,
            END,
            [("RK4", "compiled law", [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5], 1.0)],
            lambda model, data: data.qpos,
            mujoco_start,
            mujoco_runs.native(mujoco_force, KEPT),
        ),
        Method(
            "(kernel)", "leap-frog by hand", "step", [1e-2, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6], kernel
        ),
    ],
    notes=[
        "Neither peer has this law: it is a compiled function that they call. Exudyn does so "
        "through Python, once per stage and once per step for the set.",
        "(kernel) is a leap-frog loop written for this scene alone, as a floor; it is no peer.",
    ],
)
