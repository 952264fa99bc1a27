"""A6: heavy top, a disc 1 m from its fixed point that spins with 150 rad/s, for 2 s."""

import crash
import exudyn as exu
import exudyn_runs
import mujoco_runs
import numpy as np
from exudyn.utilities import (
    LoadForceVector,
    MarkerNodeCoordinate,
    NodePointGround,
    ObjectConnectorCoordinate,
    RigidBodyInertia,
)
from problem import Problem

END, MASS, GRAVITY = 2.0, 15.0, 9.81
INERTIA, SPIN = [0.234375, 0.46875, 0.234375], [0.0, 150.0, -4.61538]

# rotation matrix by rows, from reference.py; its second column, the mass centre, is published to 8
# digits: (-.15041682, -.72416559, -.67302227)
REFERENCE = [
    [-0.48744908223653, -0.15041682274577, 0.86009776866461],
    [-0.53793974384381, -0.72416559163704, -0.43151480609851],
    [0.68776029561180, -0.67302226956026, 0.27207866593309],
]


def exudyn_body(kind):
    """Body whose mass is put at the fixed point, with the inertia about that and the weight where
    it acts: explicit methods can leave held coordinates out only when nothing couples with them."""

    def fill(system):
        about_tip = np.diag(INERTIA) + MASS * np.diag([1.0, 0.0, 1.0])
        created = system.CreateRigidBody(
            nodeType=getattr(exu.NodeType, kind),
            inertia=RigidBodyInertia(mass=MASS, inertiaTensor=about_tip),
            initialAngularVelocity=SPIN,
            returnDict=True,
        )
        node = created["nodeNumber"]
        centre = exudyn_runs.point(system, created["bodyNumber"], [0, 1])
        system.AddLoad(LoadForceVector(markerNumber=centre, loadVector=[0, 0, -MASS * GRAVITY]))
        still = system.AddNode(NodePointGround())
        fixed = system.AddMarker(MarkerNodeCoordinate(nodeNumber=still, coordinate=0))
        for k in range(3):
            moved = system.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=k))
            system.AddObject(ObjectConnectorCoordinate(markerNumbers=[fixed, moved]))
        return lambda: system.GetNodeOutput(node, exu.OutputVariableType.RotationMatrix)

    return fill


def mujoco_text(step, _):
    return f"""
<mujoco>
  <option timestep="{step!r}" gravity="0 0 {-GRAVITY}"/>
  <worldbody>
    <body name="top">
      <joint type="ball"/>
      <inertial pos="0 1 0" mass="{MASS}" diaginertia="{" ".join(map(repr, INERTIA))}"/>
    </body>
  </worldbody>
</mujoco>"""


def mujoco_start(model, data):
    data.qvel[:] = SPIN


def mujoco_watch(model, data):
    matrix = np.zeros(9)
    mujoco_runs.mujoco.mju_quat2Mat(matrix, data.qpos / np.linalg.norm(data.qpos))
    return matrix


EXPLICIT_STEPS = [5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5]

PROBLEM = Problem(
    name="A6",
    title="A6 heavy top, 2 s",
    measure="largest error of the elements of the rotation matrix at 2 s",
    reference=np.ravel(REFERENCE),
    methods=[
        *crash.methods(
            crash.DECKS / "benchmark/heavy_top.yaml",
            [("rattle", "step", [1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6]), *crash.TOLERANCES],
            lambda body: crash.rotation(body["top"]).ravel(),
            constraint_tolerance=1e-13,
        ),
        *exudyn_runs.methods(
            exudyn_body("RotationRotationVector"),
            END,
            [
                ("RK44", "Lie group", EXPLICIT_STEPS),
                ("RK67", "Lie group", EXPLICIT_STEPS[:6]),
            ],
        ),
        *exudyn_runs.methods(
            exudyn_body("RotationEulerParameters"),
            END,
            [("GeneralizedAlpha", "Euler parameters", [1e-3, 5e-4, 1e-4, 5e-5])],
        ),
        *mujoco_runs.methods(
            mujoco_text,
            END,
            [("RK4", "ball joint", EXPLICIT_STEPS, 1.0)],
            mujoco_watch,
            mujoco_start,
        ),
    ],
)
