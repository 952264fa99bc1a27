"""Rigid bar of section 4.5: strikes a wall with one end, turns over, strikes it with the other.

The force of the contact is K d^1.5, with no loss and no friction, so that the problem is an
ordinary differential equation with two short events; impacts without duration (contacts at 0.5 and
0.7765 s, spin 6.928 rad/s between them) are its limit for K without bound, and are not compared.
"""

import crash
import exudyn as exu
import exudyn_runs
import mujoco_runs
import numpy as np
from exudyn.utilities import CreateSymbolicUserFunction, ObjectConnectorCartesianSpringDamper
from numba import njit
from problem import Problem

END, WALL, SPEED, MASS, LENGTH, K = 1.2, 1.0, 2.0, 20.0, 1.0, 1.2e8
ANGLE, RADIUS = np.radians(35.2), 0.0284777
INERTIA = MASS * LENGTH**2 / 12
START = [-0.5 * LENGTH * np.cos(ANGLE), 0.5 * LENGTH * np.sin(ANGLE), -ANGLE]

# centre's x, cosine and sine of the bar's angle: from reference.py
REFERENCE = [-0.248009381498, -0.790914316185, -0.611926911038]


@njit
def bar_force(q, v, f, _):
    """Adds the forces of the wall on (x, y, angle) of the bar."""
    for side in (0.5, -0.5):
        depth = q[0] + side * LENGTH * np.cos(q[2]) - WALL
        if depth > 0.0:
            push = K * depth * np.sqrt(depth)
            f[0] -= push
            f[2] += push * side * LENGTH * np.sin(q[2])


def crashsolve_watch(body):
    matrix = crash.rotation(body["bar"])
    return body["bar"]["r"][0], matrix[0, 0], matrix[1, 0]


def wall_force(system, time, number, distance, velocity, stiffness, damping, offset):
    """Force of a user's connector between the wall's point and an end of the bar."""
    depth = exu.symbolic.max(0.0, distance[0])
    return [K * depth * exu.symbolic.sqrt(depth), 0.0, 0.0]


def exudyn_bar(system):
    node, bar = exudyn_runs.plane_body(system, MASS, INERTIA, START, [SPEED, 0.0, 0.0])
    wall = exudyn_runs.point(system, exudyn_runs.ground(system), [WALL, 0])
    law = CreateSymbolicUserFunction(
        system,
        function=wall_force,
        itemTypeName="ObjectConnectorCartesianSpringDamper",
        userFunctionName="springForceUserFunction",
    )
    for side in (0.5, -0.5):
        end = exudyn_runs.point(system, bar, [side * LENGTH, 0])
        system.AddObject(
            ObjectConnectorCartesianSpringDamper(
                markerNumbers=[wall, end], springForceUserFunction=law
            )
        )

    def watch(_keep=law):
        x, _, angle = exudyn_runs.coordinates(system, node)
        return x, np.cos(angle), np.sin(angle)

    return watch


def mujoco_text(step, _):
    return f"""
<mujoco>
  <option timestep="{step!r}" gravity="0 0 0"/>
  <worldbody>
    <body>
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
    </body>
  </worldbody>
</mujoco>"""


def mujoco_start(model, data):
    data.qpos[:], data.qvel[:] = START, [SPEED, 0.0, 0.0]


def mujoco_watch(model, data):
    return data.qpos[0], np.cos(data.qpos[2]), np.sin(data.qpos[2])


PROBLEM = Problem(
    name="rigid_bar",
    title="Rigid bar against a wall, 1.2 s",
    measure="largest error of the centre's x [m] and of the bar's direction at 1.2 s",
    reference=np.array(REFERENCE),
    methods=[
        *crash.methods(
            crash.DECKS / "scenes/rigid_bar.yaml",
            [
                ("rattle", "step_max", [1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6]),
                ("rattle", "safety", [0.3, 0.1, 0.03, 0.01, 1e-3]),
                ("rattle", "step", [1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6]),
                *crash.TOLERANCES,
            ],
            crashsolve_watch,
            # of the automatic step, where that is not varied
            safety=0.01,
        ),
        *exudyn_runs.methods(
            exudyn_bar,
            END,
            [
                ("DOPRI5", "user's law", [1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12]),
                ("RK44", "user's law", [2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5]),
            ],
        ),
        *mujoco_runs.methods(
            mujoco_text,
            END,
            [("RK4", "user's law", [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5], 1.0)],
            mujoco_watch,
            mujoco_start,
            mujoco_runs.native(bar_force),
        ),
    ],
    notes=[
        "MuJoCo has no contact of this law (its own are soft constraints without an exponent): the "
        "law is a compiled function that it calls. Exudyn's is a symbolic user function.",
    ],
)
