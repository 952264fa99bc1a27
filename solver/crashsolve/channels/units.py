"""Units of measure, read from text and converted to SI.

    "54 km/h" -> 15 m/s,   "3 kN/mm" -> 3e6 N/m,   "2 N/m^1.5",   "5 J/(kg m)"

Angle is kept as a dimension of its own, so that a stiffness per radian is not taken for a moment
and a default unit of degrees reaches every angle, angular velocity and torsional stiffness.
References: BIPM, The International System of Units (2019); NIST Special Publication 811 (2008).
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Generic, Protocol, Self, TypeVar

from crashsolve.channels.errors import ChannelError

BASES = ("length", "mass", "time", "angle")
SI_SYMBOLS = ("m", "kg", "s", "rad")


class UnitError(ChannelError):
    """A unit or a number with a unit that cannot be read; the text states the cause."""


@dataclass(frozen=True)
class Unit:
    """A unit: its size in SI units, and its exponents of BASES."""

    factor: float
    exponents: tuple[Fraction, ...] = (Fraction(0),) * 4

    def __mul__(self, other: "Unit") -> "Unit":
        pairs = zip(self.exponents, other.exponents, strict=True)
        return Unit(self.factor * other.factor, tuple(a + b for a, b in pairs))

    def __pow__(self, power: Fraction) -> "Unit":
        return Unit(float(self.factor ** float(power)), tuple(a * power for a in self.exponents))


def _named(factor: float, length: int = 0, mass: int = 0, time: int = 0, angle: int = 0) -> Unit:
    return Unit(factor, (Fraction(length), Fraction(mass), Fraction(time), Fraction(angle)))


PURE = _named(1.0)
PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 0.1, "k": 1e3}
PREFIXES |= {"M": 1e6, "G": 1e9}
PREFIXED = {
    "m": _named(1.0, length=1),
    "g": _named(1e-3, mass=1),
    "s": _named(1.0, time=1),
    "rad": _named(1.0, angle=1),
    "N": _named(1.0, 1, 1, -2),
    "Pa": _named(1.0, -1, 1, -2),
    "bar": _named(1e5, -1, 1, -2),
    "J": _named(1.0, 2, 1, -2),
    "W": _named(1.0, 2, 1, -3),
    "Hz": _named(1.0, time=-1),
}
PLAIN = {
    "1": PURE,
    "%": _named(0.01),
    "t": _named(1e3, mass=1),
    "lb": _named(0.45359237, mass=1),
    "lbf": _named(0.45359237 * 9.80665, 1, 1, -2),
    "kgf": _named(9.80665, 1, 1, -2),
    "tf": _named(9806.65, 1, 1, -2),
    "in": _named(0.0254, length=1),
    "ft": _named(0.3048, length=1),
    "mph": _named(0.44704, length=1, time=-1),
    "min": _named(60.0, time=1),
    "h": _named(3600.0, time=1),
    "deg": _named(math.pi / 180.0, angle=1),
    "rev": _named(2.0 * math.pi, angle=1),
    "rpm": _named(2.0 * math.pi / 60.0, time=-1, angle=1),
    "g0": _named(9.80665, length=1, time=-2),
}

SI: Mapping[str, Unit] = {
    "length": PREFIXED["m"],
    "mass": _named(1.0, mass=1),
    "time": PREFIXED["s"],
    "angle": PREFIXED["rad"],
}

# units as they are often written, and how they are written here
SPELLINGS = {
    **dict.fromkeys(("kmh", "kph", "kmph", "KMH"), "km/h"),
    **dict.fromkeys(("mps",), "m/s"),
    **dict.fromkeys(("kilo", "kilos", "kgs", "Kg", "KG", "kilogram", "kilograms"), "kg"),
    **dict.fromkeys(("gram", "grams", "gr"), "g"),
    **dict.fromkeys(("ton", "tons", "tonne", "tonnes"), "t"),
    **dict.fromkeys(("lbs", "pound", "pounds"), "lb"),
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres", "MM"), "mm"),
    **dict.fromkeys(("inch", "inches"), "in"),
    **dict.fromkeys(("foot", "feet"), "ft"),
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("msec", "msecs"), "ms"),
    **dict.fromkeys(("hr", "hrs", "hour", "hours"), "h"),
    **dict.fromkeys(("degree", "degrees", "degs", "Deg", "DEG"), "deg"),
    **dict.fromkeys(("radian", "radians"), "rad"),
    **dict.fromkeys(("RPM",), "rpm"),
    **dict.fromkeys(("newton", "newtons"), "N"),
    **dict.fromkeys(("KN", "Kn"), "kN"),
    **dict.fromkeys(("Mpa", "mpa"), "MPa"),
    **dict.fromkeys(("Gpa", "gpa"), "GPa"),
    **dict.fromkeys(("joule", "joules"), "J"),
    **dict.fromkeys(("psi", "PSI"), "lbf/in^2"),
    **dict.fromkeys(("gs", "Gs", "G", "gee"), "g0"),
    **{f"{prefix}Nm": f"{prefix}N m" for prefix in ("", "k", "M")},
}

_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(.*?)\s*", re.DOTALL)
_COMMA = re.compile(r",[0-9]")
COMMAS = "write 0.5 for 0,5 and 1000 for 1,000"
_TOKEN = re.compile(r"\s*(?:(\*\*|[*/^()·])|(-?[0-9]+(?:\.[0-9]+)?)|([^\W\d][\w]*|%))")


class Factor(Protocol):
    """A factor of a product of units."""

    def __mul__(self, other: Self) -> Self: ...

    def __pow__(self, power: Fraction) -> Self: ...


F = TypeVar("F", bound=Factor)


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit:
    """The unit a text such as "kN/mm" names; raises UnitError."""
    return read_product(text, symbol_unit)


def read_product(text: str, symbol: Callable[[str], F]) -> F:
    """Value of a text such as "kN/mm", in which each symbol stands for `symbol(word)`.

    Raises UnitError.
    """
    if len(text) > 80:
        raise UnitError("a unit of more than 80 letters")
    parser = _Parser(_tokens(text), text, symbol)
    unit = parser.product()
    if parser.rest:
        raise UnitError(f"cannot read the unit '{text}'")
    return unit


def _tokens(text: str) -> list[str]:
    tokens, at = [], 0
    while at < len(text.rstrip()):
        match = _TOKEN.match(text, at)
        if match is None:
            raise UnitError(f"cannot read the unit '{text}'")
        tokens.append(match.group().strip().replace("**", "^").replace("·", "*"))
        at = match.end()
    return tokens


class _Parser(Generic[F]):
    """product = power {["*"] power} {"/" power};  power = symbol | "1" | "(" product ")" [^ n]."""

    def __init__(self, tokens: list[str], text: str, symbol: Callable[[str], F]) -> None:
        self.rest, self.text, self.symbol = tokens, text, symbol

    def take(self) -> str:
        if not self.rest:
            raise UnitError(f"the unit '{self.text}' is not complete")
        return self.rest.pop(0)

    def product(self) -> F:
        unit = self.power()
        divided = False
        while self.rest and self.rest[0] != ")":
            if self.rest[0] == "/":
                self.take()
                unit, divided = unit * self.power() ** Fraction(-1), True
                continue
            if divided:
                raise UnitError(f"'{self.text}' can be read in two ways; use brackets: 'J/(kg m)'")
            if self.rest[0] == "*":
                self.take()
            unit = unit * self.power()
        return unit

    def power(self) -> F:
        word = self.take()
        if word == "(":
            unit = self.product()
            if self.take() != ")":
                raise UnitError(f"the unit '{self.text}' lacks a closing bracket")
        else:
            unit = self.symbol(word)
        if self.rest and self.rest[0] == "^":
            self.take()
            unit = unit ** _exponent(self.take(), self.text)
        return unit


def _exponent(word: str, text: str) -> Fraction:
    try:
        power = Fraction(word)
    except ValueError:
        raise UnitError(f"the unit '{text}' has the power '{word}', not a number") from None
    if abs(power) > 9:
        raise UnitError(f"the unit '{text}' has a power beyond 9")
    return power


def symbol_unit(word: str) -> Unit:
    """The unit of one symbol, with a prefix or without; raises UnitError."""
    unit = PLAIN.get(word) or PREFIXED.get(word)
    if unit is not None:
        return unit
    base = PREFIXED.get(word[1:])
    if base is None or word[0] not in PREFIXES:
        raise UnitError(f"unknown unit '{word}'{_spelling(word)}")
    return _named(PREFIXES[word[0]]) * base


def _spelling(word: str) -> str:
    """How a unit that nobody knows may be meant; "" where that is anybody's guess."""
    if word[-1] in "23":
        return f"; a power is written '{word[:-1]}^{word[-1]}'"
    return f"; did you mean '{SPELLINGS[word]}'?" if word in SPELLINGS else ""


def split_quantity(text: str) -> tuple[float, str]:
    """Number and unit text of "54 km/h"; "" for a bare number [1]. Raises UnitError."""
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise UnitError(f"'{text}' is not a number with a unit")
    value = float(match[1])
    if not math.isfinite(value):
        raise UnitError(f"'{text}' is too large")
    if _COMMA.match(match[2]):
        raise UnitError(f"'{text}' has a comma; {COMMAS}")
    return value, match[2]


def describe(unit: Unit) -> str:
    """The SI name of the dimension of a unit, such as "N/m"; "1" for a pure number."""
    for name in ("N", "Pa", "J", "W", "N/m", "N s/m", "N m/rad", "N m s/rad"):
        if parse_unit(name).exponents == unit.exponents:
            return name
    return product_of(SI_SYMBOLS, unit)


def product_of(symbols: Iterable[str], unit: Unit) -> str:
    """The dimension of a unit in these units of BASES, such as "t mm/ms^2"; "1" for a number."""
    pairs = list(zip(symbols, unit.exponents, strict=True))
    above = [_with_power(symbol, power) for symbol, power in pairs if power > 0]
    below = [_with_power(symbol, -power) for symbol, power in pairs if power < 0]
    return "/".join([" ".join(above) or "1", *below])


def _with_power(symbol: str, power: Fraction) -> str:
    return symbol if power == 1 else f"{symbol}^{float(power):g}"


def default_factor(unit: Unit, bases: Mapping[str, Unit]) -> float:
    """Size in SI units of a bare number of this dimension, with these units of BASES."""
    if bases is SI:
        return 1.0
    factors = (
        float(bases[name].factor ** float(p)) for name, p in zip(BASES, unit.exponents, strict=True)
    )
    return math.prod(factors)


def to_si(text: str, wanted: str, bases: Mapping[str, Unit] = SI) -> float:
    """Value in SI of "54 km/h", checked against the dimension of `wanted`; raises UnitError."""
    value, name = split_quantity(text)
    target = parse_unit(wanted)
    unit = parse_unit(name) if name else Unit(default_factor(target, bases), target.exponents)
    if unit.exponents != target.exponents:
        hint = " (the gram; standard gravity is 'g0')" if name == "g" else ""
        own = describe(unit)
        raise UnitError(f"'{text}' is {'a pure number' if own == '1' else f'in {own}'}{hint}")
    return value * unit.factor
