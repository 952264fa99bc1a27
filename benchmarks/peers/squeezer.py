"""A3: Andrews' squeezer, seven plane bodies in three loops, 0.03 s (IFToMM A03).

All data are those of the project's deck, which are those of the Test Set for IVP Solvers.
"""

import crash
import exudyn_runs
import mujoco_runs
import numpy as np
from exudyn.utilities import LoadTorqueVector, MarkerBodyRigid, ObjectConnectorSpringDamper
from problem import Problem

from crashsolve.deck.reading.deck import read_deck

PATH = crash.DECKS / "benchmark/andrews_squeezer.yaml"
DECK = read_deck(PATH)
END, TORQUE = DECK.control.end_time, DECK.entries["loads"]["motor"].card.torque[2]
SPRING = DECK.entries["springs"]["spring"].card
NAMES = [f"k{k}" for k in range(1, 8)]
BODIES = {name: DECK.entries["bodies"][name].card for name in NAMES}
POINTS = {name: entry.card.at for name, entry in DECK.entries["joints"].items()}

# published, 16 digits, at 0.03 s
BETA, THETA = 15.81077119629904, -15.75637105984298
GAMMA, DELTA = 0.04082224013073101, 0.5244099658805304
PHI, OMEGA, EPSILON = -0.5347301163226948, 0.5347301163226948, 1.048080741042263
END_ANGLES = [BETA, BETA + THETA, GAMMA, PHI + DELTA, DELTA, OMEGA + EPSILON, EPSILON]


def start_angles():
    """Angles of the seven bodies at the start, in the order of END_ANGLES."""
    p = DECK.parameters
    return [p["be"], p["be"], p["ga"], p["ph"] + p["de"], p["de"], p["om"] + p["ep"], p["ep"]]


def foot():
    """End of the spring on k3, in the world at the start."""
    c, s, (x, y, _) = np.cos(start_angles()[2]), np.sin(start_angles()[2]), SPRING.at_b
    return BODIES["k3"].position[:2] + np.array([c * x - s * y, s * x + c * y])


def crashsolve_turns(body):
    rotations = np.array([crash.angle_of(body[name]) for name in NAMES])
    # the deck gives k3 axes that are turned from the start
    rotations[2] -= start_angles()[2]
    return rotations


def exudyn_bodies(system):
    base = exudyn_runs.ground(system)
    created = {"ground": (None, base)}
    for name, card in BODIES.items():
        configuration = [*card.position[:2], 0.0]
        created[name] = exudyn_runs.plane_body(system, card.mass, card.inertia[2], configuration)

    def marker(name, position):
        centre = BODIES[name].position[:2] if name in BODIES else (0.0, 0.0)
        return exudyn_runs.point(system, created[name][1], np.subtract(position[:2], centre))

    for name, entry in DECK.entries["joints"].items():
        a, b, at = entry.card.a, entry.card.b, POINTS[name]
        exudyn_runs.hinge(system, marker(a, at), marker(b, at))
    system.AddObject(
        ObjectConnectorSpringDamper(
            markerNumbers=[marker("ground", SPRING.at_a), marker("k3", foot())],
            stiffness=SPRING.stiffness,
            referenceLength=SPRING.length,
        )
    )
    crank = system.AddMarker(MarkerBodyRigid(bodyNumber=created["k1"][1]))
    system.AddLoad(LoadTorqueVector(markerNumber=crank, loadVector=[0, 0, TORQUE]))
    return lambda: [exudyn_runs.coordinates(system, created[name][0])[2] for name in NAMES]


def mujoco_text(step, closure):
    """Four chains; k3, k4 and k6 are closed on the end of k2 by equality constraints."""

    def chain(name, joint, inside="", parent=(0.0, 0.0)):
        card = BODIES[name]
        return mujoco_runs.plane_body(
            name, card.mass, card.inertia[2], POINTS[joint], card.position, parent, inside
        )

    def site(name, position):
        return f'<site name="{name}" pos="{position[0]!r} {position[1]!r} 0"/>'

    meet = POINTS["p3"]
    at = {"k3": "b", "k4": "e", "k6": "h"}
    anchors = {name: np.subtract(meet, POINTS[joint])[:2].tolist() for name, joint in at.items()}
    loops = "".join(
        f'<connect body1="{name}" body2="k2" anchor="{x!r} {y!r} 0" {closure}/>'
        for name, (x, y) in anchors.items()
    )
    end = site("spring_b", (foot() - POINTS["b"][:2]).tolist())
    return f"""
<mujoco>
  <option timestep="{step!r}" gravity="0 0 0" {mujoco_runs.EXACT}>
    <flag refsafe="disable"/>
  </option>
  <worldbody>
    {site("spring_a", SPRING.at_a)}
    {chain("k1", "o", chain("k2", "crank", parent=POINTS["o"]))}
    {chain("k3", "b", end)}
    {chain("k5", "a5", chain("k4", "e", parent=POINTS["a5"]))}
    {chain("k7", "a7", chain("k6", "h", parent=POINTS["a7"]))}
  </worldbody>
  <tendon>
    <spatial stiffness="{SPRING.stiffness}" springlength="{SPRING.length}">
      <site site="spring_a"/><site site="spring_b"/>
    </spatial>
  </tendon>
  <equality>{loops}</equality>
</mujoco>"""


def mujoco_start(model, data):
    data.qfrc_applied[model.joint("k1").dofadr] = TORQUE


def mujoco_turns(model, data):
    angle = {name: data.joint(name).qpos[0] for name in NAMES}
    for inner, outer in (("k1", "k2"), ("k5", "k4"), ("k7", "k6")):
        angle[outer] += angle[inner]
    return [angle[name] for name in NAMES]


PROBLEM = Problem(
    name="A3",
    title="A3 seven-body mechanism, 0.03 s",
    measure="largest error of the angles of the seven bodies at 0.03 s [rad]",
    reference=np.subtract(END_ANGLES, start_angles()),
    angles=True,
    methods=[
        *crash.methods(
            PATH,
            [("rattle", "step", [1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 2e-7]), *crash.TOLERANCES],
            crashsolve_turns,
            constraint_tolerance=1e-13,
        ),
        *exudyn_runs.methods(
            exudyn_bodies,
            END,
            [
                ("GeneralizedAlpha", "bodies and hinges", [1e-4, 3e-5, 1e-5, 3e-6, 1e-6]),
                ("TrapezoidalIndex2", "bodies and hinges", [1e-4, 3e-5, 1e-5, 3e-6, 1e-6]),
            ],
        ),
        *mujoco_runs.methods(
            mujoco_text,
            END,
            [
                ("RK4", "3 loops in 2 steps", [1e-4, 5e-5, 2e-5, 1e-5, 3e-6, 1e-6, 3e-7], 2.0),
                ("implicitfast", "3 loops in 2 steps", [3e-5, 1e-5, 3e-6, 1e-6], 2.0),
            ],
            mujoco_turns,
            mujoco_start,
        ),
    ],
    notes=["Exudyn's explicit methods do not take loops."],
)
