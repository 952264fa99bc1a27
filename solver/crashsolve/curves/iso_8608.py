"""Profile of a road by ISO 8608: waves of a stated spectrum with phases drawn at random.

    z(x) = sum_i sqrt(2 G(n_i) dn) cos(2 pi n_i x + phi_i),   G(n) = G_0 (n / n_0)^-w
    n_i = i dn from n_min to n_max,   dn = 1 / length,   n_0 = 0.1 / m

x and z are in metres, n in waves per metre, phi_i even over a turn; one seed is one road. The waves
are harmonics of the length, so that z is periodic over it, and every wave is there with its own
amplitude. Consequence to test: the one-sided spectrum of a period is G at every n_i, and the mean
square of z is the sum of G dn.

Reference: ISO 8608, Mechanical vibration, road surface profiles; the classes, the exponent and the
range of n are from memory, not read in it.
"""

from typing import Literal

import numpy as np
from pydantic import model_validator

from crashsolve.curves._card import EXTRAPOLATE, CurveCard
from crashsolve.curves._piecewise import Array, hermite
from crashsolve.deck.building import Scene
from crashsolve.deck.card import quantity, word

# G_0 [m^3] at n_0 [1/m]: geometric means of the classes
ROUGHNESS = {grade: 16e-6 * 4.0**k for k, grade in enumerate("ABCDEFGH")}
N_0 = 0.1
# cubics within the shortest wave: they keep to it within (2 pi / 16)^4 / 384 = 6e-5 of its height
CUBICS, MAX_CUBICS = 16, 450_000


class Iso8608(CurveCard):
    """Road profile of a class of ISO 8608, height over the distance along the road."""

    grade: Literal["A", "B", "C", "D", "E", "F", "G", "H"] | None = word(
        "class of the road: A is very good, each next one four times as rough", None
    )
    roughness: float | None = quantity("m^3", "G_0 at 0.1 waves per metre; no grade", None, gt=0)
    exponent: float = quantity("1", "w, of the spectrum", 2.0, ge=0)
    start: float = quantity("m", "position at which the road begins", 0.0)
    length: float = quantity("m", "length of the road", gt=0)
    n_min: float = quantity("1/m", "waves per metre of the longest wave", 0.011, gt=0)
    n_max: float = quantity("1/m", "waves per metre of the shortest wave", 2.83, gt=0)
    seed: int = word("seed of the random phases; equal seeds give equal roads", 1, ge=0)
    level: float = quantity("m", "the road is level up to here from its start", 0.0, ge=0)
    rise: float = quantity("m", "length over which roughness grows from zero", 0.0, ge=0)

    @model_validator(mode="after")
    def _consistent(self) -> "Iso8608":
        if (self.grade is None) == (self.roughness is None):
            raise ValueError("needs one of grade and roughness")
        if self.n_min >= self.n_max:
            raise ValueError("n_min: must be below n_max")
        if not len(self.orders()):
            raise ValueError(f"length: has no whole wave of {self.n_min:g} to {self.n_max:g} 1/m")
        if CUBICS * self.n_max * self.length > MAX_CUBICS:
            raise ValueError(
                f"length: needs more than {MAX_CUBICS} cubics; a shorter one, or a smaller n_max"
            )
        if self.level > 0.0 and self.rise == 0.0:
            raise ValueError("rise: must be above 0 behind a level start")
        if self.level + self.rise > self.length:
            raise ValueError(
                "level: the roughness has not reached its full size by the end of the road"
            )
        return self

    def orders(self) -> Array:
        """i of the waves: how many of each the road has."""
        first, last = self.n_min * self.length, self.n_max * self.length
        # a whole number that round-off has moved by a little is meant
        return np.arange(max(np.ceil(first - 1e-9), 1.0), np.floor(last + 1e-9) + 1.0)


def waves(card: Iso8608) -> tuple[Array, Array, Array]:
    """Waves per metre, height [m] and phase [rad] of each."""
    n = card.orders() / card.length
    G_0 = ROUGHNESS[card.grade] if card.grade else card.roughness or 0.0
    phases = 2.0 * np.pi * np.random.default_rng(card.seed).random(len(n))
    return n, np.sqrt(2.0 * G_0 * (n / N_0) ** -card.exponent / card.length), phases


def build(card: Iso8608, scene: Scene) -> tuple[Array, Array, int]:
    """Breakpoints (n,), coefficients (n - 1, 4) and the code of extrapolation."""
    if card.length * card.n_min < 1.0 - 1e-9:
        scene.warnings.append(
            f"the road is {card.length:g} m long, and has no waves longer than that, of up to "
            f"{1.0 / card.n_min:g} m"
        )
    s = np.linspace(0.0, card.length, int(np.ceil(CUBICS * card.n_max * card.length)) + 1)
    z, slope = np.zeros_like(s), np.zeros_like(s)
    for n, height, phase in zip(*waves(card), strict=True):
        z += height * np.cos(2.0 * np.pi * n * s + phase)
        slope -= height * 2.0 * np.pi * n * np.sin(2.0 * np.pi * n * s + phase)
    if card.rise > 0.0:
        t = np.clip((s - card.level) / card.rise, 0.0, 1.0)
        share = t * t * (3.0 - 2.0 * t)
        z, slope = share * z, share * slope + 6.0 * t * (1.0 - t) / card.rise * z
    return s + card.start, hermite(s + card.start, z, slope), EXTRAPOLATE[card.extrapolate]
