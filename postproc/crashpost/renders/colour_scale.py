"""Colours of a field: from its least to its greatest value, readable by the colour-blind."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crashsolve.channels.display import factor, readable

# one hue to another by lightness, for values from zero; two hues about zero
SEQUENTIAL, DIVERGING = "YlGnBu", "RdBu_r"


@dataclass(frozen=True)
class ColourScale:
    """The colours of a field, the same for all pictures of a strip or film."""

    name: str = ""
    unit: str = ""
    low: float = 0.0
    high: float = 1.0

    @classmethod
    def of(cls, name: str, unit: str, low: float, high: float) -> "ColourScale":
        """A scale from zero where no value is negative, else symmetric about zero."""
        if not low <= high:
            low = high = 0.0
        size = max(abs(low), abs(high)) or 1.0
        return cls(name, unit, -size if low < -1e-6 * size else 0.0, size)

    @property
    def cmap(self) -> str:
        """Name of the scale in matplotlib."""
        return DIVERGING if self.low < 0.0 else SEQUENTIAL

    @property
    def shown_unit(self) -> str:
        """A readable multiple of the unit."""
        return readable(self.unit, max(abs(self.low), abs(self.high)))

    @property
    def scale(self) -> float:
        """Factor on values in the unit shown."""
        return factor(self.unit, self.shown_unit) if self.unit != self.shown_unit else 1.0

    @cached_property
    def table(self) -> np.ndarray:
        """Colours (256, 3)."""
        from matplotlib import colormaps

        colours: np.ndarray = 255.0 * colormaps[self.cmap](np.linspace(0.0, 1.0, 256))[:, :3]
        return colours

    def colours(self, values: np.ndarray) -> np.ndarray:
        """Red, green and blue (n, 3), 0 to 255."""
        share = (values - self.low) / (self.high - self.low)
        rgb: np.ndarray = self.table[np.clip(255.0 * share + 0.5, 0, 255).astype(int)]
        return rgb


def rgb(colour: str) -> np.ndarray:
    """Red, green and blue, 0 to 255, of `#0072b2`."""
    return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], float)
