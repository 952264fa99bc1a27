"""One contact of a small deck, its kernels run as plain Python and driven by hand."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from bench import BODIES, Bench, spoil

from crashsolve.foundation.rows import as_rows
from crashsolve.system.contact.pair import Slide

SPHERES = """
surfaces:
  one: {type: sphere, body: a, radius: 0.2}
  other: {type: sphere, body: b, radius: 0.3}
"""
CURVES = """
curves:
  stiff: {points: [[0, 0], [0.02, 2000], [0.03, 1500], [1, 4000]]}
  soft: {points: [[0, 0], [0.02, 400], [1, 500]]}
  short: {points: [[0, 0], [0.02, 400]]}
  from_one: {points: [[0, 1], [1, 1000]]}
  pulls: {points: [[0, 0], [0.1, 100], [0.2, -1]]}
"""


class Contact:
    """The first contact group of a deck with bodies a and b."""

    def __init__(
        self,
        folder: Path,
        normal: str = "{type: hertz, stiffness: 1e4}",
        friction: str = "",
        surfaces: str = SPHERES,
        sides: str = "a: [one], b: [other]",
        bodies: str = BODIES,
    ) -> None:
        friction_force = f", friction: {friction}" if friction else ""
        text = (
            f"{CURVES}{surfaces}\ncontacts:\n  hit: {{{sides}, normal: {normal}{friction_force}}}\n"
        )
        self.bench = Bench(folder, text, bodies)
        self.model = self.bench.model
        self.group = self.model.contact_groups[0]
        self.pairs = as_rows(self.group.parameters)
        self.p = self.pairs[0]
        self.old, self.new = (as_rows(self.group.history)[side, 0] for side in (0, 1))
        self.old.depth = -1.0
        # sliding velocity at the start of the step, and as it was asked for last
        self.slip = self._slip = np.zeros(3)

    def gaps(self) -> list[tuple[float, np.ndarray, np.ndarray]]:
        """Depth, normal and point of every pair of elements."""
        gap, nodes = self.group.narrow.gap, self.bench.nodes
        a, b = as_rows(self.group.elements_a), as_rows(self.group.elements_b)
        data = tuple(as_rows(array) for array in self.group.data)
        contacts = (gap(a[p.a], b[p.b], nodes, data) for p in self.pairs)
        return [(float(depth), np.array(n), np.array(x)) for depth, n, x in contacts]

    def deepest(self) -> tuple[float, np.ndarray, np.ndarray]:
        """The deepest pair of elements, or the nearest."""
        return max(self.gaps(), key=lambda gap: gap[0])

    def press(self, depth: float, rate: float, h: float = 0.0, mass: float = 1.0) -> Any:
        """Normal force at a depth and a closing speed, the onset latched as the step does it."""
        self._spoil(self.group.normal)
        self.new.depth, self.new.active = depth, 1
        begins = self.old.active == 0
        self.new.impact_speed = max(rate, 0.0) if begins else self.old.impact_speed
        kernel = self.group.normal.normal_force
        result = kernel(self.p, self.old, self.new, h, depth, rate, mass, self.bench.curves)
        names = ("force", "stored", "power", "loss", "stiffness", "damping")
        return SimpleNamespace(**dict(zip(names, result, strict=True)))

    def friction_force(
        self,
        normal: float,
        slip: Sequence[float] | np.ndarray,
        n: Sequence[float] | np.ndarray,
        h: float = 0.0,
        mass: float = 1.0,
        compliance: float = 0.0,
        direction: Any = None,
        middle: Any = None,
    ) -> Any:
        """Friction on side a at a sliding velocity, `middle` that of the middle of the step.

        A law that is stretched by the slip over the step is given that, by the trapezoidal rule.
        """
        law = self.group.friction
        self._spoil(law)
        self.new.active = 1
        kernel = law.friction_force
        u, m = tuple(map(float, slip)), tuple(map(float, n))
        if getattr(law, "STEPWISE", False):
            before = self.slip if self.old.active else np.zeros(3)
            direction = 0.5 * h * (before + np.asarray(u)) * self.old.active
            direction = tuple(direction - direction @ np.asarray(n) * np.asarray(n))
        self._slip = np.asarray(u)
        curves = self.bench.curves
        slide = Slide(normal, u, middle, direction, m, mass, compliance)
        result = kernel(self.p, self.old, self.new, slide, curves)
        names = ("force", "stored", "power", "loss", "stiffness", "damping")
        friction = SimpleNamespace(**dict(zip(names, result, strict=True)))
        friction.force = self.new.friction_force = np.array(friction.force)
        return friction

    def release(self, law: Any) -> None:
        """The bodies are apart."""
        self._spoil(law)
        self.new.active, self.new.depth, self.new.impact_speed = 0, -1.0, 0.0
        law.release(self.p, self.old, self.new)

    def accept(self) -> None:
        """The step is accepted: new becomes old."""
        for name in self.old.dtype.names:
            self.old[name] = self.new[name]
        self.slip = self._slip

    def _spoil(self, law: Any) -> None:
        spoil(self.new, law.HISTORY)


def pressed_apart(
    contact: Contact, depth: float, speed: float, h: float, mass: float
) -> tuple[float, float]:
    """Speed at which a free mass leaves, and the energy lost, by the velocity Verlet method.

    It begins at a depth with a closing speed [m, m/s].
    """
    x, v, lost = depth, speed, 0.0
    now = contact.press(x, v, 0.0, mass)
    contact.accept()
    while True:
        half = v - 0.5 * h * now.force / mass
        x += h * half
        if x <= 0.0:
            return -half, lost
        after = contact.press(x, half - 0.5 * h * now.force / mass, h, mass)
        v = half - 0.5 * h * after.force / mass
        lost += 0.5 * h * (now.power + after.power) + after.loss
        now = after
        contact.accept()
