"""A point of a material by itself, in three dimensions."""

from pathlib import Path

import numpy as np
from one_layer import Example, Layers

from crashsolve.foundation.rows import as_rows

E = 2e5


class Point:
    """A point of a material, strained step by step."""

    def __init__(self, folder: Path, example: Example) -> None:
        layers = Layers(folder, example)
        self.m, self.law, self.curves = layers.m, layers.law, layers.curves
        self.old = as_rows(np.zeros(1, self.law.SOLID.dtype))[0]
        self.new = as_rows(np.zeros(1, self.law.SOLID.dtype))[0]
        self.lost = 0.0

    def tried(self, d: np.ndarray, h: float = 1.0) -> np.ndarray:
        """Stress (6) after strains d (6, twice those of shear) of a step of h; not accepted."""
        stress, self.lost = self.law.solid(
            self.m, self.old, self.new, tuple(d), h, self.curves, self.law
        )
        return np.array([float(s) for s in stress])

    def step(self, d: np.ndarray, h: float = 1.0) -> np.ndarray:
        stress = self.tried(d, h)
        for name in self.law.SOLID.dtype.names:
            self.old[name] = self.new[name]
        return stress

    @property
    def energy(self) -> float:
        return float(self.law.solid_energy(self.m, self.old))

    def free(self, d: np.ndarray, sides: tuple[int, ...], h: float = 1.0) -> np.ndarray:
        """Stress after a step whose strains of `sides` are such that their stresses are 0.

        Newton's method on differences.
        """
        d, wanted = np.array(d, float), list(sides)
        for _ in range(40):
            at = self.tried(d, h)[wanted]
            if np.abs(at).max() < 1e-13 * float(self.m.young):
                break
            slopes = np.empty((len(sides), len(sides)))
            for column, k in enumerate(wanted):
                more = d.copy()
                more[k] += 1e-8
                slopes[:, column] = (self.tried(more, h)[wanted] - at) / 1e-8
            d[wanted] -= np.linalg.solve(slopes, at)
        return self.step(d, h)


def layer_and_point(folder: Path, example: Example, size: float, h: float) -> float:
    """Stress of a point in plane stress less that of a layer, or across it, over E."""
    point, layers, worst = Point(folder, example), Layers(folder, example), 0.0
    steps = [[1, 0.2, 0.5], [1.2, -0.5, 0.8], [0.3, 1, -2], [-2, -1, 0.4], [-1, -1, 1]]
    for x, y, xy in size * np.array(steps):
        layer = layers.step(np.tile([x, y, xy], (16, 1)), h)[0]
        stress = point.free(np.array([x, y, 0.0, xy, 0.0, 0.0]), (2,), h)
        worst = max(worst, float(np.abs(stress[[0, 1, 3]] - layer).max()))
        worst = max(worst, float(np.abs(stress[[2, 4, 5]]).max()))
    return worst / float(point.m.young)
