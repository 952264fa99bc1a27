"""A5: a flyball governor with stiff springs and strong dampers, its first second (IFToMM A05)."""

import crash
import exudyn as exu
import exudyn_runs
import mujoco_runs
import numpy as np
from exudyn.utilities import MarkerKinematicTreeRigid, ObjectConnectorSpringDamper
from problem import Problem

END, GRAVITY, SPIN = 1.0, 9.81, 2 * np.pi
ROD, BALL, SHAFT, SLIDER = 0.3, 5.0, 0.3, 3.0
STIFFNESS, DAMPING, LENGTH = 8e5, 4e4, 0.5
START, HINGE = np.radians(30), 0.05

# mass centre of rod and ball from the hinge, and inertia across the rod about it
CENTRE = (0.5 * ROD + BALL) / (ROD + BALL)
ACROSS = ROD * (1 + 0.01**2) / 12 + ROD * (CENTRE - 0.5) ** 2 + BALL * (1 - CENTRE) ** 2
ALONG = ROD * 2 * 0.01**2 / 12
SHAFT_INERTIA = [SHAFT * (1 + 0.01**2) / 12] * 2 + [SHAFT * 2 * 0.01**2 / 12]
SLIDER_INERTIA = [SLIDER * 2 * 0.1**2 / 12] * 3

# from reference.py; published to 8 digits: 5.58634697, .5218333, .50142092
REFERENCE = [5.58634696586902, 0.52183330162555, 0.50142092237957]


def crashsolve_watch(body):
    slope = (1.0 - body["rod_1"]["r"][2]) / CENTRE
    return crash.angle_of(body["shaft"]), np.arcsin(slope), body["slider"]["r"][2]


def exudyn_tree(system):
    def link(kind, parent, offset, mass, centre, inertia, start=0.0):
        return {
            "type": getattr(exu.JointType, kind),
            "parent": parent,
            "offset": offset,
            "mass": mass,
            "centre": centre,
            "inertia": inertia,
            "start": start,
        }

    rod = (ROD + BALL, [CENTRE, 0, 0], [ALONG, ACROSS, ACROSS])
    node, body = exudyn_runs.tree(
        system,
        [
            link("RevoluteZ", -1, [0, 0, 0], SHAFT, [0, 0, 0.5], SHAFT_INERTIA),
            link("PrismaticZ", 0, [0, 0, 0], SLIDER, [0, 0, 0], SLIDER_INERTIA, 0.5),
            link("RevoluteY", 0, [HINGE, 0, 1], *rod, START),
            link("RevoluteY", 0, [-HINGE, 0, 1], *rod, np.pi - START),
        ],
        [0, 0, -GRAVITY],
        [SPIN, 0, 0, 0],
    )

    def marker(number, position):
        return system.AddMarker(
            MarkerKinematicTreeRigid(objectNumber=body, linkNumber=number, localPosition=position)
        )

    for side, number in ((HINGE, 2), (-HINGE, 3)):
        system.AddObject(
            ObjectConnectorSpringDamper(
                markerNumbers=[marker(1, [side, 0, 0]), marker(number, [0.5, 0, 0])],
                stiffness=STIFFNESS,
                damping=DAMPING,
                referenceLength=LENGTH,
            )
        )

    def watch():
        rotation, height, angle, _ = exudyn_runs.coordinates(system, node)
        return rotation, angle, height

    return watch


def mujoco_text(step, _):
    def inertia(values):
        return " ".join(repr(float(value)) for value in values)

    def rod(name, side, degrees):
        return f"""
      <body name="{name}" pos="{side} 0 1" axisangle="0 1 0 {degrees}">
        <joint type="hinge" axis="0 1 0"/>
        <inertial pos="{CENTRE!r} 0 0" mass="{ROD + BALL}"
          diaginertia="{inertia([ALONG, ACROSS, ACROSS])}"/>
        <site name="{name}" pos="0.5 0 0"/>
      </body>"""

    def link(name):
        return f"""
    <spatial stiffness="{STIFFNESS}" damping="{DAMPING}" springlength="{LENGTH}">
      <site site="slider_{name}"/><site site="{name}"/>
    </spatial>"""

    return f"""
<mujoco>
  <option timestep="{step!r}" gravity="0 0 {-GRAVITY}"/>
  <worldbody>
    <body name="shaft">
      <joint type="hinge" axis="0 0 1"/>
      <inertial pos="0 0 0.5" mass="{SHAFT}" diaginertia="{inertia(SHAFT_INERTIA)}"/>
      <body name="slider" pos="0 0 0.5">
        <joint type="slide" axis="0 0 1"/>
        <inertial pos="0 0 0" mass="{SLIDER}" diaginertia="{inertia(SLIDER_INERTIA)}"/>
        <site name="slider_rod_1" pos="{HINGE} 0 0"/><site name="slider_rod_2" pos="{-HINGE} 0 0"/>
      </body>{rod("rod_1", HINGE, 30)}{rod("rod_2", -HINGE, 150)}
    </body>
  </worldbody>
  <tendon>{link("rod_1")}{link("rod_2")}</tendon>
</mujoco>"""


def mujoco_start(model, data):
    data.qvel[0] = SPIN


def mujoco_watch(model, data):
    return data.qpos[0], START + data.qpos[2], 0.5 + data.qpos[1]


PROBLEM = Problem(
    name="A5",
    title="A5 stiff flyball governor, 1 s",
    measure="largest error of shaft's rotation, rod's angle [rad] and slider's height [m] at 1 s",
    reference=np.array(REFERENCE),
    angles=True,
    methods=[
        *crash.methods(
            crash.DECKS / "benchmark/flyball_governor.yaml",
            [("rattle", "step", [7e-5, 5e-5, 2e-5, 1e-5]), *crash.STIFF],
            crashsolve_watch,
            end_time=END,
            constraint_tolerance=1e-13,
        ),
        *exudyn_runs.methods(
            exudyn_tree,
            END,
            [
                ("GeneralizedAlpha", "tree", [1e-1, 2e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4]),
                ("TrapezoidalIndex2", "tree", [1e-1, 2e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4]),
                ("DOPRI5", "tree", [1e-2, 1e-4, 1e-6]),
            ],
        ),
        *mujoco_runs.methods(
            mujoco_text,
            END,
            [
                ("RK4", "tree", [2.5e-4, 2e-4, 1e-4], 1.0),
                ("implicit", "tree", [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5], 1.0),
                ("implicitfast", "tree", [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5], 1.0),
            ],
            mujoco_watch,
            mujoco_start,
        ),
    ],
)
