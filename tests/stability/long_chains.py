"""Decks of many hinged rods, whose steady turn is known: a chain on a pivot, and a closed loop."""

from math import cos, pi, sin, tan
from typing import Any

Table = dict[str, Any]
# the rods are 1 m long and have 1 kg
INERTIA = [1e-3, 1 / 12, 1 / 12]
# the pull of 1000 rods, 5e5 N, swings a rod at sqrt(12 T/m l) = 2450 rad/s: (w h)^2 = 0.4
STEP = 2.5e-4
SPIN = 1.0
END = 0.5


def chain(count: int) -> Table:
    """A straight chain rotates about its first end as one."""
    bodies = {f"rod_{i}": _rod(i + 0.5, 0.0, 0.0) for i in range(count)}
    joints = {
        f"hinge_{i}": _hinge(f"rod_{i - 1}" if i else "ground", f"rod_{i}", [float(i), 0.0, 0.0])
        for i in range(count)
    }
    tip = count - 0.5
    pull = SPIN**2 * count**2 / 2
    # the method errs by (w h)^2/8 of the angle, 4e-9
    known = [
        _known(f"rbdout.rod_{count - 1}.position.x", tip * cos(SPIN * END), 1e-6 * tip),
        _known(f"rbdout.rod_{count - 1}.position.y", tip * sin(SPIN * END), 1e-6 * tip),
        _known("norm(jntforc.hinge_0.force.x, jntforc.hinge_0.force.y)", pull, 1e-4 * pull),
    ]
    return _deck(f"A chain of {count} rods", bodies, joints, known)


def loop(count: int) -> Table:
    """A regular polygon rotates about its middle as one."""
    inner = 0.5 / tan(pi / count)
    outer = 0.5 / sin(pi / count)
    bodies, joints = {}, {}
    for i in range(count):
        angle = 2 * pi * i / count
        bodies[f"rod_{i}"] = _rod(inner, angle, angle + pi / 2)
        corner = angle + pi / count
        at = [outer * cos(corner), outer * sin(corner), 0.0]
        joints[f"hinge_{i}"] = _hinge(f"rod_{i}", f"rod_{(i + 1) % count}", at)
    known = [
        _known("rbdout.rod_0.position.x", inner * cos(SPIN * END), 1e-6 * outer),
        _known("rbdout.rod_0.position.y", inner * sin(SPIN * END), 1e-6 * outer),
    ]
    return _deck(f"A loop of {count} rods", bodies, joints, known)


def _rod(radius: float, angle: float, rotation: float) -> Table:
    """A rod whose middle lies at `radius` and `angle`, itself turned by `rotation`, in steady
    spin.
    """
    x, y = radius * cos(angle), radius * sin(angle)
    return {
        "mass": 1.0,
        "inertia": INERTIA,
        "position": [x, y, 0.0],
        "rotation": {"axis": [0, 0, 1], "angle": rotation},
        "velocity": [-SPIN * y, SPIN * x, 0.0],
        "angular_velocity": [0.0, 0.0, SPIN],
    }


def _hinge(a: str, b: str, at: list[float]) -> Table:
    return {"type": "revolute", "a": a, "b": b, "at": at, "axis": [0, 0, 1]}


def _known(channel: str, value: float, tolerance: float) -> Table:
    source = "it turns as one: (w h)^2/8 of the angle, and round-off"
    return {
        "channel": channel,
        "statistic": "final",
        "value": value,
        "tolerance": tolerance,
        "because": "exact",
        "source": source,
    }


def _deck(title: str, bodies: Table, joints: Table, known: list[Table]) -> Table:
    energy = _known("glstat.model.balance", 0.0, 1e-4) | {"statistic": "abs_max"}
    return {
        "title": title,
        "control": {"end_time": END, "step": STEP},
        "output": {"history": {"interval": END / 2}, "states": {"interval": END}},
        "bodies": bodies,
        "joints": joints,
        "expect": [*known, energy],
    }
