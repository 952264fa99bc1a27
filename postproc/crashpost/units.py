"""Units of channels: products, dimension checks and conversion for display.

A unit is a product of symbols to powers, written as in the result files: "N s/m", "kg m^2",
"N/m^1.5". A slash divides by the one symbol that follows it. Radians count as pure numbers.
"""

import math
import re
from typing import NamedTuple

from crashpost.errors import PostError

GRAVITY = 9.80665

# symbol: (size in SI, (powers of m, kg, s))
SYMBOLS: dict[str, tuple[float, tuple[int, int, int]]] = {
    "m": (1.0, (1, 0, 0)),
    "g": (1e-3, (0, 1, 0)),
    "t": (1e3, (0, 1, 0)),
    "s": (1.0, (0, 0, 1)),
    "min": (60.0, (0, 0, 1)),
    "h": (3600.0, (0, 0, 1)),
    "rad": (1.0, (0, 0, 0)),
    "deg": (math.pi / 180, (0, 0, 0)),
    "rpm": (math.pi / 30, (0, 0, -1)),
    "Hz": (1.0, (0, 0, -1)),
    "N": (1.0, (1, 1, -2)),
    "tf": (1e3 * GRAVITY, (1, 1, -2)),
    "J": (1.0, (2, 1, -2)),
    "W": (1.0, (2, 1, -3)),
    "Pa": (1.0, (-1, 1, -2)),
    "bar": (1e5, (-1, 1, -2)),
    "g0": (GRAVITY, (1, 0, -2)),
    "%": (1e-2, (0, 0, 0)),
    "1": (1.0, (0, 0, 0)),
}
PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}
PREFIXED = {"m", "g", "s", "rad", "Hz", "N", "J", "W", "Pa"}
FORCE = SYMBOLS["N"][1]

_FACTOR = re.compile(r"\s*(/?)\s*([A-Za-zµ%]+0?|1)(?:\^(-?\d+(?:\.\d+)?))?\s*[*·]?")


class Size(NamedTuple):
    """A unit's size in SI and its powers of metre, kilogram and second."""

    factor: float
    powers: tuple[float, float, float]


ONE = Size(1.0, (0.0, 0.0, 0.0))


class Unit(dict[str, float]):
    """A product of unit symbols: symbol -> power."""

    @classmethod
    def parse(cls, text: str) -> "Unit":
        """Read "N s/m" as {N: 1, s: 1, m: -1}; raises PostError."""
        unit, position, text = cls(), 0, text.strip()
        while position < len(text):
            factor = _FACTOR.match(text, position)
            if not factor:
                raise PostError(f"cannot read the unit '{text}'")
            slash, symbol, power = factor.groups()
            unit._add(symbol, float(power or 1) * (-1 if slash else 1))
            position = factor.end()
        return unit

    def times(self, other: "Unit", power: int = 1) -> "Unit":
        """The unit of a product, or of a quotient with power = -1."""
        product = Unit(self)
        for symbol, exponent in other.items():
            product._add(symbol, power * exponent)
        return product

    def _add(self, symbol: str, power: float) -> None:
        if symbol == "1":
            return
        self[symbol] = self.get(symbol, 0.0) + power
        if not self[symbol]:
            del self[symbol]

    def size(self) -> Size:
        """Factor to SI and dimension; raises PostError for an unknown symbol."""
        above, below, powers = 1.0, 1.0, [0.0, 0.0, 0.0]
        for symbol, power in self.items():
            size = _symbol_size(symbol)
            # one division at the end keeps 3600/1000 the 3.6 it is
            above *= size.factor ** max(power, 0)
            below *= size.factor ** max(-power, 0)
            powers = [p + power * q for p, q in zip(powers, size.powers, strict=True)]
        return Size(above / below, (powers[0], powers[1], powers[2]))

    def __str__(self) -> str:
        above = " ".join(_power(s, p) for s, p in self.items() if p > 0)
        below = "".join("/" + _power(s, -p) for s, p in self.items() if p < 0)
        return (above or ("1" if below else "")) + below


def _power(symbol: str, power: float) -> str:
    return symbol if power == 1 else f"{symbol}^{power:g}"


def _symbol_size(symbol: str) -> Size:
    if symbol in SYMBOLS:
        return Size(*SYMBOLS[symbol])
    prefix, rest = symbol[:1], symbol[1:]
    if prefix in PREFIXES and rest in PREFIXED:
        factor, powers = SYMBOLS[rest]
        return Size(PREFIXES[prefix] * factor, powers)
    raise PostError(
        f"unknown unit '{symbol}' (for instance mm, m/s, km/h, kN, t, tf, kJ, deg, g0, %)"
    )


def same_dimension(a: Unit, b: Unit) -> bool:
    """Whether values in the two units can be added; unknown symbols only match themselves."""
    if a == b:
        return True
    try:
        return a.size() == b.size()
    except PostError:
        return False


def factor(source: str, wanted: str) -> float:
    """Values in `source` times this are values in `wanted`; raises PostError.

    A force asked for in "t" comes in tonne-force.
    """
    unit, target = Unit.parse(source), Unit.parse(wanted)
    if wanted == "t" and unit.size().powers == FORCE:
        target = Unit.parse("tf")
    ratio = unit.times(target, -1).size() if unit != target else ONE
    if ratio.powers != ONE.powers:
        raise PostError(f"cannot show '{source}' in '{wanted}': they measure different things")
    return ratio.factor


def readable(unit: str, largest: float) -> str:
    """The prefixed form of a unit in which `largest` lies between 1 and 1000."""
    steps = {"m": ("mm", "m", "km"), "s": ("ms", "s")}
    steps |= {u: (u, "k" + u, "M" + u) for u in ("N", "J", "W", "Pa", "N s", "N m", "N m s")}
    if unit not in steps or not largest > 0 or not math.isfinite(largest):
        return unit
    fitting = [u for u in steps[unit] if largest * factor(unit, u) >= 1]
    return fitting[-1] if fitting else steps[unit][0]
