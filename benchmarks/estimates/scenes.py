"""Scenes with known answers: decks with the closed forms of their watched channels."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import closed_forms as exact
import numpy as np
from closed_forms import Motion

DECKS = Path(__file__).resolve().parents[2] / "decks"


@dataclass(frozen=True)
class Known:
    """A watched channel with its truth: a motion for any statistics, or the value of one.

    `floor` is how well the truth itself is known, over the scale of the channel. Where the true
    error oscillates and passes zero, an estimate is too large if it exceeds the largest true error
    within the share `near` of the run before the end; none where it is 0.
    """

    channel: str
    statistics: tuple[str, ...]
    truth: Motion | float
    floor: float = 0.0
    near: float = 0.0


@dataclass(frozen=True)
class Scene:
    """A deck until `end` [s], its known answers, and the step of each method [s]."""

    name: str
    deck: str | Path
    end: float
    known: Sequence[Known]
    steps: Sequence[float]
    fixed: Sequence[float] = ()
    tolerances: Sequence[float] = (1e-3, 1e-5, 1e-7, 1e-9)
    safeties: Sequence[float] = (0.05, 0.1, 0.2)
    is_stiff: bool = False


SMOOTH = ("final", "path", "max", "mean", "at:0.7")
# an earliest time is known only where no later swing is as high
DECAYING = (*SMOOTH, "argmin")
G = 9.81


def oscillators(stiffness: float) -> Scene:
    """Springs with and without damper, and a chain of five masses between walls."""
    k, links = stiffness, 5
    bodies = [f"  m{i}: {{mass: 1, inertia: [1, 1, 1], position: [{i}, 2, 0]}}" for i in range(5)]
    bodies[0] = bodies[0].replace("}", ", velocity: [0.5, 0, 0]}")
    ends = ["at_a: [-1, 2, 0], b: m0"] + [f"a: m{i}, b: m{i + 1}" for i in range(links - 1)]
    ends += [f"at_a: [{links}, 2, 0], b: m{links - 1}"]
    springs = [
        f"  s{i}: {{type: linear, {end}, stiffness: {k}, length: 1}}" for i, end in enumerate(ends)
    ]
    deck = "\n".join(
        [
            "bodies:",
            "  free: {mass: 2, inertia: [1, 1, 1], position: [1.1, 0, 0]}",
            "  damped: {mass: 2, inertia: [1, 1, 1], position: [1.1, 1, 0]}",
            *bodies,
            "springs:",
            f"  a: {{type: linear, b: free, stiffness: {k}, length: 1}}",
            f"  b: {{type: linear, at_a: [0, 1, 0], b: damped, stiffness: {k}, damping: 4,",
            "      length: 1}",
            *springs,
        ]
    )
    free, damped = exact.oscillator(2, 0, k, 0.1, 0), exact.oscillator(2, 4, k, 0.1, 0)
    known = [
        Known("rbdout.free.position.x - 1", SMOOTH, free),
        Known("rbdout.damped.position.x - 1", DECAYING, damped),
        Known("deforc.a.force", ("final", "max"), lambda t: k * free(t)),
        *(
            Known(
                f"rbdout.m{i}.position.x",
                ("final", "at:0.7"),
                _moved(exact.chain(5, 1, k, 0.5, i), i),
            )
            for i in (0, 2, 4)
        ),
    ]
    return Scene(
        f"springs and a chain, {k:g} N/m", deck, 2.0, known, (8e-3, 4e-3, 2e-3, 5e-4), (5e-3, 2e-2)
    )


def _moved(motion: Motion, by: float) -> Motion:
    return lambda t: by + motion(t)


def pendulum(speed: float) -> Scene:
    """A pendulum of 1 m from its lowest point."""
    # with the little inertia that a point mass is given
    omega = np.sqrt(G / (1.0 + 1e-9))
    angle = exact.pendulum(speed, omega)
    deck = f"""
bodies:
  bob: {{mass: 1, inertia: [1e-9, 1e-9, 1e-9], position: [0, -1, 0], velocity: [{speed}, 0, 0],
        angular_velocity: [0, 0, {speed}]}}
joints: {{pin: {{type: revolute, b: bob, at: [0, 0, 0], axis: [0, 0, 1]}}}}
loads: {{weight: {{type: gravity, acceleration: [0, {-G}, 0]}}}}
"""
    known = [
        Known("rbdout.bob.position.x", SMOOTH, lambda t: np.sin(angle(t))),
        Known("rbdout.bob.position.y", ("final", "max", "mean"), lambda t: -np.cos(angle(t))),
        Known(
            "norm(jntforc.pin.force.x, jntforc.pin.force.y)",
            ("final", "path"),
            lambda t: np.abs(
                speed**2 - 2.0 * omega**2 * (1.0 - np.cos(angle(t))) + G * np.cos(angle(t))
            ),
        ),
    ]
    return Scene(
        f"pendulum, {speed:g} rad/s", deck, 3.0, known, (8e-3, 4e-3, 2e-3, 5e-4), (1e-2, 3e-2)
    )


def spinning(spin: float) -> Scene:
    """A free symmetric body, a conical pendulum, and a rocket that turns as it pushes."""
    rate = np.sqrt(G / 0.8)
    # angular momentum (1, 0, 2 spin) of the free body; its axis goes round it
    momentum = np.array([1.0, 0.0, 2.0 * spin])
    L = np.linalg.norm(momentum)
    deck = f"""
bodies:
  free: {{mass: 1, inertia: [1, 1, 2], angular_velocity: [1, 0, {spin}]}}
  cone: {{mass: 1, inertia: [1e-9, 1e-9, 1e-9], position: [10.6, 0, -0.8],
         velocity: [0, {0.6 * rate}, 0], angular_velocity: [0, 0, {rate}]}}
  rocket: {{mass: 2, inertia: [1, 1, 1], position: [20, 0, 0], angular_velocity: [0, 0, {spin}]}}
joints: {{tip: {{type: spherical, b: cone, at: [10, 0, 0]}}}}
loads:
  weight: {{type: force, body: cone, force: [0, 0, {-G}]}}
  thrust: {{type: force, body: rocket, force: [5, 0, 0], axes: body}}
"""

    def axis_part(t: np.ndarray) -> np.ndarray:
        """World y of w = L/I1 + (1 - I3/I1) w3 e3, e3 turning about L with L/I1."""
        unit = momentum / L
        e3 = np.array([0.0, 0.0, 1.0])
        across = np.cross(unit, e3)
        return -spin * across[1] * np.sin(L * t)

    push = 5.0 / (2.0 * spin)
    known = [
        Known("rbdout.free.angular_velocity.y", ("final", "path", "max"), axis_part),
        Known("rbdout.cone.position.y", ("final", "path"), lambda t: 0.6 * np.sin(rate * t)),
        Known("rbdout.cone.position.x", ("final", "mean"), lambda t: 10 + 0.6 * np.cos(rate * t)),
        Known("rbdout.rocket.velocity.x", ("final", "max"), lambda t: push * np.sin(spin * t)),
        Known(
            "rbdout.rocket.position.y",
            ("final", "path"),
            lambda t: push * (t - np.sin(spin * t) / spin),
        ),
    ]
    return Scene(
        f"turning bodies, {spin:g} rad/s", deck, 2.0, known, (8e-3, 4e-3, 2e-3, 5e-4), (5e-3, 2e-2)
    )


def torsion(stiffness: float) -> Scene:
    """Discs on torsional springs, one damped."""
    wound = exact.oscillator(0.5, 0.0, stiffness, 0.0, 5.0)
    damped = exact.oscillator(0.5, 0.8, stiffness, -0.3, 0.0)
    deck = f"""
bodies:
  disc: {{mass: 1, inertia: [0.3, 0.3, 0.5], angular_velocity: [0, 0, 5]}}
  other: {{mass: 1, inertia: [0.5, 0.3, 0.3]}}
springs:
  wound: {{type: torsional, b: disc, axis: [0, 0, 1], stiffness: {stiffness}}}
  dashpot: {{type: torsional, b: other, axis: [1, 0, 0], stiffness: {stiffness}, damping: 0.8,
            angle: 0.3}}
"""
    known = [
        Known("deforc.wound.angle", SMOOTH, wound),
        Known("deforc.wound.torque", ("final", "max"), lambda t: stiffness * wound(t)),
        Known(
            "deforc.dashpot.angle", ("final", "path", "mean", "argmax"), lambda t: damped(t) + 0.3
        ),
    ]
    return Scene(
        f"torsional springs, {stiffness:g} N m/rad",
        deck,
        2.0,
        known,
        (8e-3, 4e-3, 1e-3),
        (5e-3, 2e-2),
    )


def impacts(speed: float) -> Scene:
    """Balls on a wall by Hertz, Hunt-Crossley and Lankarani-Nikravesh."""
    laws = {
        "hertz": ("", 0.0),
        "hunt_crossley": (", restitution: 0.7", 1.5 * 0.3),
        "lankarani_nikravesh": (", restitution: 0.5", 0.75 * 0.75),
    }
    bodies, surfaces, contacts, known = [], ["  wall: {type: plane}"], [], []
    for i, (law, (words, chi)) in enumerate(laws.items()):
        name = f"b{i}"
        bodies.append(
            f"  {name}: {{mass: 1, inertia: [0.1, 0.1, 0.1], position: [{i}, 0, 0.1001],"
            f" velocity: [0, 0, {-speed}]}}"
        )
        surfaces.append(f"  {name}: {{type: sphere, body: {name}, radius: 0.1}}")
        contacts.append(
            f"  {name}: {{a: [{name}], b: [wall], normal: {{type: {law}, stiffness: 1e8{words}}}}}"
        )
        x = exact.returned(chi) if chi else 1.0
        known += [
            Known(f"rbdout.{name}.velocity.z", ("final",), x * speed),
            Known(f"rcforc.{name}.peak_depth", ("final",), exact.deepest(chi, 1.0, 1e8, speed)),
            Known(f"rcforc.{name}.impulse.z", ("final",), (1.0 + x) * speed),
        ]
        if chi:
            lost = 0.5 * speed**2 * (1.0 - x * x)
            known.append(Known(f"rcforc.{name}.dissipated", ("final",), lost))
    end = 1.2e-4 / speed + 5.0e-3 / speed**0.2
    deck = "\n".join(
        [
            "bodies:",
            *bodies,
            "surfaces:",
            *surfaces,
            "contacts:",
            *contacts,
        ]
    )
    steps = [end / n for n in (100, 200, 400, 1600)]
    return Scene(f"impacts at {speed:g} m/s", deck, end, known, steps, [end / 60])


def to_and_fro(speed: float) -> Scene:
    """A ball between two walls of linear stiffness: ten impacts or so."""
    gap, k = 0.1, 1e4
    end = 5.3 * (2 * gap / speed + np.pi / np.sqrt(k))
    motion = exact.bounces(speed, k, 1.0, gap)
    deck = f"""
bodies: {{ball: {{mass: 1, inertia: [1, 1, 1], velocity: [0, 0, {-speed}]}}}}
surfaces:
  floor: {{type: plane, at: [0, 0, -0.2], normal: [0, 0, 1]}}
  roof: {{type: plane, at: [0, 0, 0.2], normal: [0, 0, -1]}}
  ball: {{type: sphere, body: ball, radius: 0.1}}
contacts:
  low: {{a: [ball], b: [floor], normal: {{type: kelvin_voigt, stiffness: {k}, damping: 0}}}}
  high: {{a: [ball], b: [roof], normal: {{type: kelvin_voigt, stiffness: {k}, damping: 0}}}}
"""
    known = [
        Known("rbdout.ball.position.z", ("final", "path", "max", "mean"), motion),
        Known("rcforc.low.normal", ("max",), speed * np.sqrt(k)),
        Known("rcforc.low.peak_depth", ("final",), speed / np.sqrt(k)),
    ]
    return Scene(
        f"between walls at {speed:g} m/s",
        deck,
        end,
        known,
        [end / n for n in (500, 1000, 2000, 8000)],
        [end / 300],
    )


def curves(ramp: float) -> Scene:
    """Forces of a kinked and of a smooth curve of time."""
    deck = f"""
curves:
  kinked: {{type: table, points: [[0, 0], [{ramp}, 1], [{2 * ramp}, 0]], extrapolate: hold}}
bodies:
  kinked: {{mass: 2, inertia: [1, 1, 1]}}
  swung: {{mass: 2, inertia: [1, 1, 1], position: [1.1, 1, 0]}}
loads:
  kinked: {{type: force, body: kinked, force: [30, 0, 0], curve: kinked}}
springs:
  a: {{type: linear, at_a: [0, 1, 0], b: swung, stiffness: 300, length: 1}}
"""
    known = [
        Known("rbdout.kinked.position.x", ("final", "path", "at:0.7"), exact.triangle(30, ramp, 2)),
        Known("rbdout.swung.position.x - 1", ("final",), exact.oscillator(2, 0, 300, 0.1, 0)),
    ]
    return Scene(
        f"curves with a kink at {ramp:g} s",
        deck,
        1.0,
        known,
        (8e-3, 4e-3, 2e-3, 5e-4),
        (7e-3, 2e-2),
    )


def heavy_top() -> Scene:
    """The heavy top of IFToMM A06; its axis passes a millionth from hanging straight down."""
    # benchmarks/peers/reference.py: Gauss collocation
    position = (-0.15041682274577, -0.72416559163704, -0.67302226956026)
    known = [
        Known(f"rbdout.top.position.{c}", ("final",), value)
        for c, value in zip("xyz", position, strict=True)
    ]
    deck = DECKS / "benchmark" / "heavy_top.yaml"
    return Scene("heavy top A6", deck, 2.0, known, (2e-4, 1e-4, 5e-5), (2e-3, 1e-3))


def spinning_top(spin: float) -> Scene:
    """A top that falls from its horizontal position and goes round as it nods."""
    rotation = 2.0
    deck = f"""
bodies:
  top: {{mass: 15, inertia: [0.234375, 0.46875, 0.234375], mass_centre: [0, 1, 0],
        angular_velocity: [0, {spin}, {-rotation}]}}
joints: {{tip: {{type: spherical, b: top, at: [0, 0, 0]}}}}
loads: {{weight: {{type: gravity, acceleration: [0, 0, {-G}]}}}}
"""
    axis = exact.top(15.234375, 0.46875, spin, -rotation, 15.0 * G, 1.0)
    known = [
        Known(f"rbdout.top.position.{c}", ("final", "path", "at:0.3"), partial(component, axis, i))
        for i, c in enumerate("xyz")
    ]
    known += [Known("rbdout.top.position.z", ("min", "mean"), partial(component, axis, 2))]
    steps = [0.4 * h / spin for h in (0.25, 0.125, 0.0625, 0.02)]
    return Scene(f"top, {spin:g} rad/s", deck, 1.0, known, steps, [0.3 / spin])


def component(motion: Motion, i: int, t: np.ndarray) -> np.ndarray:
    """One coordinate of many."""
    return motion(t)[i]


def squeezer() -> Scene:
    """Andrews' squeezer, IFToMM A03: published at 0.03 s to 16 digits."""
    beta, gamma, delta = 15.81077119629904, 0.04082224013073101, 0.5244099658805304
    ra, xb, sa, sb, ya, ta, tb = 0.00092, -0.03635, 0.01874, 0.01043, -0.00227, 0.02308, 0.00916
    at_end = {
        "k1.position.x": ra * np.cos(beta),
        "k1.angular_velocity.z": 1139.920302151208,
        "k2.angular_velocity.z": 1139.920302151208 - 1424.379294994111,
        "k3.angular_velocity.z": 11.03291221937134,
        "k4.angular_velocity.z": 19.29337464421385 + 0.5735699284790808,
        "k7.angular_velocity.z": 0.3231791658026955,
        "k3.position.x": xb + sa * np.sin(gamma) + sb * np.cos(gamma),
        "k5.position.y": ya + ta * np.sin(delta) + tb * np.cos(delta),
    }
    # methods of this code agree to 1e-8 on rates 3e-8 away from the published, of positions on
    # 1e-11
    floor = {True: 1e-7, False: 1e-9}
    known = [
        Known(f"rbdout.{name}", ("final",), value, floor["velocity" in name])
        for name, value in at_end.items()
    ]
    deck = DECKS / "benchmark" / "andrews_squeezer.yaml"
    return Scene("squeezer", deck, 0.03, known, (1.6e-5, 8e-6, 4e-6, 2e-6), (3e-5,))


def governor() -> Scene:
    """The stiff governor, IFToMM A05, by Gauss collocation in least coordinates."""
    # benchmarks/peers/reference.py: its rotation, the angle of a rod, and the slider at 1 s
    rotation, slope, slider = 5.58634696586902, 0.52183330162555, 0.50142092237957
    centre = (0.5 * 0.3 + 5.0) / 5.3
    known = [
        Known("disbout.turn.angle", ("final",), rotation),
        Known("rbdout.slider.position.z", ("final",), slider),
        Known("rbdout.rod_1.position.z", ("final",), 1.0 - centre * np.sin(slope)),
    ]
    deck = DECKS / "benchmark" / "flyball_governor.yaml"
    tolerances = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    return Scene("governor", deck, 1.0, known, (), (2e-2, 5e-3), tolerances, (), True)


def driven(stiffness: float) -> Scene:
    """Drivers: a carriage with a mass on a spring, a disc that winds another, a pivot of a rod."""
    end, k, a = 1.0, stiffness, 0.75 * G
    # 3 x^2 - 2 x^3 and its second derivative
    rise, bend = np.poly1d([-2.0, 3.0, 0.0, 0.0]), np.poly1d([-12.0, 6.0])
    omega = np.sqrt(k)
    drawn = exact.drawn(rise, bend, omega)
    # hangs from a pivot with acceleration a as if the weight pointed along (-a, -g)
    swing = exact.swing(np.arctan2(a, G), np.sqrt(np.hypot(a, G) / (1.0 + 1e-9)))
    lean = np.arctan2(a, G)
    deck = f"""
curves:
  rise: {{type: formula, expression: "3*x**2 - 2*x**3", from: 0, to: {end}, segments: 1}}
  run: {{type: formula, expression: "{0.5 * a}*x**2", from: 0, to: {end}, segments: 1}}
  rest: {{type: table, points: [[0, 0], [{end}, 0]]}}
bodies:
  carriage: {{mass: 2, inertia: [1, 1, 1]}}
  mass: {{mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
  disc: {{mass: 1, inertia: [1, 1, 2], position: [0, 5, 0]}}
  wound: {{mass: 1, inertia: [1, 1, 1], position: [0, 5, 0]}}
  pivot: {{mass: 2, inertia: [1, 1, 1], position: [0, 10, 0]}}
  bob: {{mass: 1, inertia: [1e-9, 1e-9, 1e-9], position: [0, 10, -1]}}
joints:
  rail: {{type: prismatic, b: carriage, at: [0, 0, 0], axis: [1, 0, 0]}}
  motor: {{type: translation_driver, joint: rail, curve: rise}}
  axle: {{type: revolute, b: disc, at: [0, 5, 0], axis: [0, 0, 1]}}
  winder: {{type: rotation_driver, joint: axle, curve: rise}}
  pin: {{type: revolute, a: pivot, b: bob, at: [0, 10, 0], axis: [0, 1, 0]}}
  guide: {{type: prismatic, b: pivot, at: [0, 10, 0], axis: [1, 0, 0]}}
  puller: {{type: translation_driver, joint: guide, curve: run}}
springs:
  link: {{type: linear, a: carriage, b: mass, stiffness: {k}, length: 1}}
  shaft: {{type: torsional, a: disc, b: wound, axis: [0, 0, 1], stiffness: {k}}}
loads: {{weight: {{type: force, body: bob, force: [0, 0, {-G}]}}}}
"""
    known = [
        Known("rbdout.mass.position.x - 1", ("final", "path", "at:0.7"), drawn),
        Known("deforc.link.force", ("final", "max"), lambda t: k * (drawn(t) - rise(t))),
        Known(
            "jntforc.motor.force.x",
            ("final",),
            float(2.0 * bend(end) + k * (rise(end) - drawn(np.array([end]))[0])),
        ),
        Known("deforc.shaft.angle", ("final", "path"), lambda t: drawn(t) - rise(t)),
        Known(
            "rbdout.bob.position.x - rbdout.pivot.position.x",
            ("final", "path", "mean"),
            lambda t: np.sin(swing(t) - lean),
        ),
        Known("rbdout.bob.position.z", ("final", "max"), lambda t: -np.cos(swing(t) - lean)),
    ]
    return Scene(f"drivers, {k:g} N/m", deck, end, known, (8e-3, 4e-3, 2e-3, 5e-4), (5e-3, 2e-2))


def rigid_bar(stiffness: float) -> Scene:
    """The rigid bar of section 4.5 of Ambrosio (2003): free but for two contacts by Hertz."""
    end, radius = 1.2, 0.0284777
    channels = exact.rigid_bar(20.0, 1.0, 2.0, np.radians(35.2), stiffness, end)
    deck = f"""
bodies:
  bar:
    mass: 20
    inertia: [{10.0 * radius**2}, {20 / 12}, {20 / 12}]
    position: [{-0.5 * np.cos(np.radians(35.2))}, {0.5 * np.sin(np.radians(35.2))}, 0]
    rotation: {{axis: [0, 0, -1], angle: "35.2 deg"}}
    velocity: [2, 0, 0]
surfaces:
  node_1: {{type: point_set, body: bar, points: [[0.5, 0, 0]]}}
  node_2: {{type: point_set, body: bar, points: [[-0.5, 0, 0]]}}
  wall: {{type: plane, at: [1, 0, 0], normal: [-1, 0, 0]}}
contacts:
  node_1: {{a: [node_1], b: [wall], normal: {{type: hertz, stiffness: {stiffness}}}}}
  node_2: {{a: [node_2], b: [wall], normal: {{type: hertz, stiffness: {stiffness}}}}}
"""
    known = [Known(name, (statistic,), value) for name, statistic, value in channels]
    steps = [1.2 / n for n in (2000, 8000, 16000, 64000)]
    return Scene(f"rigid bar, {stiffness:g} N/m^1.5", deck, end, known, steps, [1.2 / 1000])


def beams(damping: float) -> Scene:
    """Rods of four elements, clamped, that a load at the end pulls, twists or bends suddenly."""
    end, count, rod = 0.1, 4, exact.Rod(length=1.0, radius=0.05, density=1e3, young=1e7)
    # so small that neither turns nor the pull of bending matter, (w / r)^2 = 1e-9
    bend = 3e-5
    parts, joints, loads = ["parts:"], ["joints:"], ["loads:"]
    for y, (name, load) in enumerate(
        {
            "pulled": "{type: force, body: pulled_end, force: [100, 0, 0]}",
            "twisted": "{type: torque, body: twisted_end, torque: [1, 0, 0]}",
            "bent": f"{{type: force, body: bent_end, force: [0, {bend}, 0]}}",
        }.items()
    ):
        parts.append(
            f"  {name}: {{type: beam, section: round, material: soft, damping: {damping},"
            f" side: [0, 1, 0], mesh:"
            f" {{shape: line, from: [0, {y}, 0], to: [1, {y}, 0], elements: {count}}}}}"
        )
        joints.append(f"  {name}: {{type: weld, b: {name}_start, at: [0, {y}, 0]}}")
        loads.append(f"  {name}: {load}")
    deck = "\n".join(
        [
            "materials: {soft: {type: elastic, young: 1e7, poisson: 0.3, density: 1000}}",
            "sections: {round: {type: circle, radius: 0.05}}",
            *(*parts, *joints, *loads),
        ]
    )
    pulled, its_speed = exact.chain_of_elements(*rod.bar(count), damping, 100.0)
    twisted, _ = exact.chain_of_elements(*rod.shaft(count), damping, 1.0)
    bent, rises = exact.chain_of_elements(*rod.beam(count), damping, bend)
    known = [
        Known(
            "rbdout.pulled_end.position.x - 1",
            ("final", "path", "max"),
            partial(component, pulled, -1),
        ),
        Known("rbdout.pulled_1.velocity.x", ("final", "max"), partial(component, its_speed, 0)),
        Known(
            "elout.twisted_1.curvature.x",
            ("final", "path", "mean"),
            lambda t: twisted(t)[0] * count,
        ),
        Known("rbdout.bent_end.velocity.y", ("final", "path"), partial(component, rises, -2), 1e-8),
        Known("elout.bent_1.curvature.z", ("final", "max"), lambda t: bent(t)[1] * count, 1e-8),
    ]
    return Scene(
        f"beams, damping {damping:g} s", deck, end, known, (4e-4, 2e-4, 1e-4, 2.5e-5), (1e-3, 4e-4)
    )


def meshes(count: float) -> Scene:
    """Rods of few elements, clamped and pulled or twisted at the end: true are those of no mesh."""
    end, rod = 0.006, exact.Rod(length=1.0, radius=0.05, density=1e3, young=1e7)
    area = np.pi * rod.radius**2
    polar, shear = 0.5 * area * rod.radius**2, rod.young / 2.6
    deck = f"""
materials: {{soft: {{type: elastic, young: 1e7, poisson: 0.3, density: 1000}}}}
sections: {{round: {{type: circle, radius: 0.05}}}}
parts:
  pulled: {{type: beam, section: round, material: soft, side: [0, 1, 0],
    mesh: {{shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: {int(count)}}}}}
  twisted: {{type: beam, section: round, material: soft, side: [0, 1, 0],
    mesh: {{shape: line, from: [0, 1, 0], to: [1, 1, 0], elements: {int(count)}}}}}
joints:
  pulled: {{type: weld, b: pulled_start, at: [0, 0, 0]}}
  twisted: {{type: weld, b: twisted_start, at: [0, 1, 0]}}
loads:
  pulled: {{type: force, body: pulled_end, force: [100, 0, 0]}}
  twisted: {{type: torque, body: twisted_end, torque: [1, 0, 0]}}
sensors: {{turn: {{type: angle, b: twisted_end, axis: [1, 0, 0]}}}}
"""
    # elements of length l have no period shorter than pi l / c, and errors of the mesh oscillate no
    # faster: a third of that is l / c, the time of a wave through an element
    near = [1.0 / count / np.sqrt(modulus / rod.density) / end for modulus in (rod.young, shear)]
    # behind a front that has not come to the clamp the end moves at F / (A sqrt(E rho))
    speed = 100.0 / (area * np.sqrt(rod.young * rod.density))
    spin = 1.0 / (polar * np.sqrt(shear * rod.density))
    known = [
        Known(channel, ("final", "path", "mean"), truth, near=share)
        for channel, truth, share in (
            ("rbdout.pulled_end.position.x - 1", lambda t: speed * t, near[0]),
            ("disbout.turn.angle", lambda t: spin * t, near[1]),
        )
    ]
    steps = (4e-5, 2e-5, 1e-5)
    return Scene(f"meshes of {int(count)}", deck, end, known, steps, (2e-4, 1e-4), (1e-4, 1e-6))


def hinges(speed: float) -> Scene:
    """A rotor bends a hinge that yields, and a slider one on an ellipse of force and moment."""
    moment, inertia, k = 300.0, 2.0, 3e5
    limit, mass, stiff, rotation = 1000.0, 10.0, 1e6, 0.6
    # of the ellipse, with J / m = k_M / k_F = (M_p / F_p)^2: one motion, in newtons and metres
    fast, ratio = speed / 4.0, (moment / limit) ** 2
    cosine = 1.0 / np.hypot(1.0, rotation)
    deck = f"""
curves:
  turn: {{points: [[0, 0], [{moment / k}, {moment}], [9, {moment}]]}}
  bend: {{points: [[0, 0], [{moment / (stiff * ratio)}, {moment}], [9, {moment}]]}}
  pull: {{points: [[0, 0], [{limit / stiff}, {limit}], [9, {limit}]]}}
bodies:
  rotor: {{mass: 1, inertia: [1, 1, {inertia}], angular_velocity: [0, 0, {speed}]}}
  slider: {{mass: {mass}, inertia: [1, 1, {mass * ratio}], position: [1, 0, 0],
           velocity: [{fast}, 0, 0], angular_velocity: [0, 0, {rotation * fast * limit / moment}]}}
hinges:
  rotor: {{type: bending, b: rotor, at: [0, 0, 0], axis: [0, 0, 1], curve: turn}}
  both: {{type: axial_bending, b: slider, at: [1, 0, 0], axis: [0, 0, 1], beam: [1, 0, 0],
         curve: bend, axial_curve: pull}}
"""
    far, reach = inertia * speed**2 / 2.0 / moment, moment / k
    stroke, back = mass * fast**2 / 2.0 / (limit * cosine), limit * cosine / stiff
    angle = (stroke - back / 2.0) * rotation * limit / moment
    # corners of laws are met to 1e-10 of a step or so
    floor = 3e-10
    known = [
        Known("hinge.rotor.residual_angle", ("final",), far - reach / 2.0, floor),
        Known("hinge.rotor.plastic_angle", ("final",), far - reach / 2.0, floor),
        Known("hinge.both.residual_stroke", ("final",), stroke - back / 2.0, floor),
        Known("hinge.both.residual_angle", ("final",), angle, floor),
    ]
    end = 1.3 * inertia * speed / moment
    return Scene(f"plastic hinges, {speed:g} rad/s", deck, end, known, (4e-4, 2e-4, 1e-4, 5e-5))


def kinds() -> list[list[Scene]]:
    """Every scene of the battery; those of one kind share their machine code."""
    families: list[tuple[Callable[[float], Scene], Sequence[float]]] = [
        (oscillators, (100.0, 900.0)),
        (pendulum, (2.0, 5.5)),
        (spinning, (3.0, 12.0)),
        (torsion, (4.0, 60.0)),
        (impacts, (0.3, 5.0)),
        (to_and_fro, (0.5, 3.0)),
        (curves, (0.13, 0.37)),
        (spinning_top, (20.0, 60.0)),
        (driven, (100.0, 900.0)),
        (rigid_bar, (1.2e8, 1.2e6)),
        (beams, (0.0, 1e-4)),
        (meshes, (16, 32, 64)),
        (hinges, (12.0, 5.0)),
    ]
    groups = [[make(value) for value in values] for make, values in families]
    return [*groups, [heavy_top()], [squeezer()], [governor()]]
