"""Scenes whose answers are known: decks with the closed forms of what they watch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import closed_forms as exact
import numpy as np
from closed_forms import Motion

DECKS = Path(__file__).resolve().parents[2] / "decks"


@dataclass(frozen=True)
class Known:
    """A watched channel with its truth: a motion for any statistics, or the value of one."""

    channel: str
    statistics: tuple[str, ...]
    truth: Motion | float


@dataclass(frozen=True)
class Scene:
    """A deck until `end` [s], its known answers, and what a step of each method is set to [s]."""

    name: str
    deck: str
    end: float
    known: Sequence[Known]
    steps: Sequence[float]
    fixed: Sequence[float] = ()
    tolerances: Sequence[float] = (1e-3, 1e-5, 1e-7, 1e-9)
    safeties: Sequence[float] = field(default=(0.05, 0.1, 0.2))


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


def all_scenes() -> list[Scene]:
    """Every scene of the battery; those of one kind share their machine code."""
    made: list[tuple[Callable[[float], Scene], Sequence[float]]] = [
        (oscillators, (100.0, 900.0)),
        (pendulum, (2.0, 5.5)),
        (spinning, (3.0, 12.0)),
        (torsion, (4.0, 60.0)),
        (impacts, (0.3, 5.0)),
        (to_and_fro, (0.5, 3.0)),
        (curves, (0.13, 0.37)),
    ]
    return [make(value) for make, values in made for value in values]
