"""A1: a point mass on a massless rod swings from the horizontal for 10 s (IFToMM benchmark A01)."""

import crash
import exudyn as exu
import exudyn_runs
import mujoco_runs
import numpy as np
from problem import Problem

END, GRAVITY, INERTIA = 10.0, 9.81, 1e-9

# from reference.py; published to 10 digits for a bob without inertia: (-.2750874626, -.9614192051)
REFERENCE = [-0.27508748345412, -0.96141919912537]


def exudyn_tree(system):
    link = {
        "type": exu.JointType.RevoluteZ,
        "parent": -1,
        "offset": [0, 0, 0],
        "mass": 1.0,
        "centre": [-1, 0, 0],
        "inertia": [INERTIA] * 3,
    }
    node, _ = exudyn_runs.tree(system, [link], [0, -GRAVITY, 0], [0.0])

    def watch():
        angle = exudyn_runs.coordinates(system, node)[0]
        return -np.cos(angle), -np.sin(angle)

    return watch


def exudyn_hinge(system):
    node, bob = exudyn_runs.plane_body(system, 1.0, INERTIA, [-1.0, 0.0, 0.0])
    base = exudyn_runs.point(system, exudyn_runs.ground(system), [0, 0])
    exudyn_runs.hinge(system, base, exudyn_runs.point(system, bob, [1, 0]))
    exudyn_runs.weight(system, bob, [0, -GRAVITY, 0])
    return lambda: exudyn_runs.coordinates(system, node)[:2]


def mujoco_text(step, _):
    bob = mujoco_runs.plane_body("bob", 1.0, INERTIA, [0, 0], [-1, 0])
    return f"""
<mujoco>
  <option timestep="{step!r}" gravity="0 {-GRAVITY} 0"/>
  <worldbody>{bob}</worldbody>
</mujoco>"""


def mujoco_watch(model, data):
    return -np.cos(data.qpos[0]), -np.sin(data.qpos[0])


PROBLEM = Problem(
    name="A1",
    title="A1 pendulum, 10 s",
    measure="largest error of x and y of the bob at 10 s [m]",
    reference=np.array(REFERENCE),
    methods=[
        *crash.methods(
            crash.DECKS / "benchmark/pendulum.yaml",
            [
                ("rattle", "step", [3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5]),
                ("dormand_prince_8", "step", [0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05]),
                *crash.TOLERANCES,
            ],
            lambda body: body["bob"]["r"][:2],
            constraint_tolerance=1e-13,
        ),
        *exudyn_runs.methods(
            exudyn_tree,
            END,
            [
                ("DOPRI5", "joint angle", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11]),
                ("RK67", "joint angle", [1e-1, 5e-2, 2e-2, 1e-2]),
            ],
        ),
        *exudyn_runs.methods(
            exudyn_hinge,
            END,
            [
                ("GeneralizedAlpha", "body and hinge", [1e-2, 3e-3, 1e-3, 3e-4]),
                ("TrapezoidalIndex2", "body and hinge", [1e-2, 3e-3, 1e-3, 3e-4]),
            ],
        ),
        *mujoco_runs.methods(
            mujoco_text,
            END,
            [("RK4", "joint angle", [2e-1, 1e-1, 5e-2, 2e-2, 1e-2, 5e-3, 2e-3], 1.0)],
            mujoco_watch,
        ),
    ],
)
