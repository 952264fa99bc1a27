"""Units as channels show them: products that keep their symbols, and conversion between them.

"N s/m", "kg m^2", "N/m^1.5" are written in the symbols of `units.py`. Radians count as pure numbers
here: a channel in rad/s may be added to one in 1/s.
"""

import math
from fractions import Fraction
from typing import NamedTuple

from crashsolve.channels.errors import ChannelError
from crashsolve.channels.units import UnitError, read_product, symbol_unit

# other meaning of a symbol, for values that cannot have the dimension of the symbol itself
ELSEWHERE = {("t", "N"): "tf", ("g", "m/s^2"): "g0"}


class Size(NamedTuple):
    """A unit's size in SI and its powers of metre, kilogram and second."""

    factor: float
    powers: tuple[Fraction, ...]


ONE = Size(1.0, (Fraction(0),) * 3)


class Product(dict[str, Fraction]):
    """A product of unit symbols: symbol -> power."""

    @classmethod
    def parse(cls, text: str) -> "Product":
        """Read "N s/m" as {N: 1, s: 1, m: -1}, nothing as the pure number; raises UnitError."""
        return read_product(text, cls.of) if text.strip() else cls()

    @classmethod
    def of(cls, symbol: str) -> "Product":
        """One symbol; raises UnitError for an unknown one."""
        symbol_unit(symbol)
        return cls() if symbol == "1" else cls({symbol: Fraction(1)})

    def __mul__(self, other: "Product") -> "Product":
        return self.times(other)

    def __pow__(self, power: Fraction) -> "Product":
        return Product({symbol: own * power for symbol, own in self.items() if own * power})

    def times(self, other: "Product", power: int = 1) -> "Product":
        """The unit of a product, or of a quotient with power = -1."""
        product = Product(self)
        for symbol, exponent in other.items():
            product[symbol] = product.get(symbol, Fraction(0)) + power * exponent
            if not product[symbol]:
                del product[symbol]
        return product

    def size(self) -> Size:
        """Factor to SI and dimension."""
        above, below, powers = 1.0, 1.0, list(ONE.powers)
        for symbol, power in self.items():
            unit = symbol_unit(symbol)
            # one division at the end keeps 3600/1000 the 3.6 it is
            above *= unit.factor ** max(float(power), 0.0)
            below *= unit.factor ** max(-float(power), 0.0)
            powers = [p + power * q for p, q in zip(powers, unit.exponents[:3], strict=True)]
        return Size(above / below, tuple(powers))

    def __str__(self) -> str:
        above = " ".join(_power(s, p) for s, p in self.items() if p > 0)
        below = "".join("/" + _power(s, -p) for s, p in self.items() if p < 0)
        return (above or ("1" if below else "")) + below


def _power(symbol: str, power: Fraction) -> str:
    return symbol if power == 1 else f"{symbol}^{float(power):g}"


def same_dimension(a: Product, b: Product) -> bool:
    """Whether values in the two units can be added as they are."""
    return a == b or a.size() == b.size()


def measure_the_same(a: str, b: str) -> bool:
    """Whether values in units of these names can be added; an unknown unit is like none other."""
    try:
        return a == b or same_dimension(Product.parse(a), Product.parse(b))
    except UnitError:
        return False


def factor(source: str, wanted: str) -> float:
    """Values in `source` times this are values in `wanted`; raises ChannelError.

    A force in "t" is shown in tonne-force, an acceleration in "g" in standard gravity.
    """
    if source == wanted:
        return 1.0
    unit, target = Product.parse(source), Product.parse(wanted)
    for (symbol, of), other in ELSEWHERE.items():
        if wanted == symbol and unit.size().powers == Product.parse(of).size().powers:
            target = Product.parse(other)
    ratio = unit.times(target, -1).size()
    if ratio.powers != ONE.powers:
        raise ChannelError(f"cannot show '{source}' in '{wanted}': they measure different things")
    return ratio.factor


def is_convertible(source: str, wanted: str) -> bool:
    """Whether values in one unit can be shown in the other."""
    try:
        factor(source, wanted)
    except ChannelError:
        return False
    return True


def readable(unit: str, largest: float) -> str:
    """The prefixed form of a unit in which `largest` lies between 1 and 1000."""
    steps = {"m": ("mm", "m", "km"), "s": ("ms", "s")}
    steps |= {
        u: (u, "k" + u, "M" + u, "G" + u) for u in ("N", "J", "W", "Pa", "N s", "N m", "N m s")
    }
    if unit not in steps or not largest > 0 or not math.isfinite(largest):
        return unit
    fitting = [u for u in steps[unit] if largest * factor(unit, u) >= 1]
    return fitting[-1] if fitting else steps[unit][0]
