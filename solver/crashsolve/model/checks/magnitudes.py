"""Numbers of a deck that lie outside the physical range of their kind; a wrong unit is the common
error.

    density                   osmium has 22,600 kg/m^3, light foams 10
    wave speed sqrt(E / rho)  soft foams have 10 m/s, diamond 18,000
    angle                     beyond pi, and whole or half: degrees read as radians; a limit, which
                              may be beyond all motion, beyond 2 pi, of 5 to 360 in steps of 5
    mass over volume          of a primitive or a surface of a body, that of a material
    length                    a body, or the point of a joint, 200 times farther than all others,
                              and among them in mm; a section much wider than its beam is long

A density that is too small is reported where g/cm^3, kg/mm^3 or t/mm^3 would make it that of a
solid: beams without mass and decks in units of their own have others. Cards hold SI. An angle of
720 deg is no whole number of radians; a bare 90 is. Consequence to test: E of 210 in place of
210e9 Pa is seen, and no number of the decks in this repository.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import log10, pi, sqrt
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel

from crashsolve.deck.building import EntryOfScene
from crashsolve.deck.fields import declared

# [kg/m^3] of solids, and of bodies with voids; [m/s]; modulus of diamond [Pa] with a margin
SOLIDS, BODIES, WAVE_SPEEDS, STIFFEST = (500.0, 3e4), (0.05, 3e4), (10.0, 5e4), 2e12
# units of densities over kg/m^3
DENSITY_UNITS = {"g/cm^3": 1e3, "kg/mm^3": 1e9, "t/mm^3": 1e12}
# a length that is so many times all others, and mm over m
FAR, MM = 200.0, 1e3
# share of the largest length that a difference of two others leaves by round-off
ROUND_OFF = 1e-14
# and a section over its beam: a cube as a single element is one
WIDE = 2.0
# angles that may be beyond all motion, as those that are powers of ten are; steps of degrees
LIMITS, DEGREES = ("lower", "upper"), (5.0, 360.0)
Entries = Mapping[str, Mapping[str, EntryOfScene]]
# what a number is called, in `check`, by its unit
SHOWN = {
    "m": "lengths",
    "kg": "masses",
    "kg/m^3": "densities",
    "Pa": "moduli and stresses",
    "rad": "angles",
    "N/m": "stiffnesses",
    "m/s": "speeds",
}


class Number(NamedTuple):
    """A number of a deck: section, entry and field, its unit, and its value in SI."""

    section: str
    entry: str
    field: str
    unit: str
    value: float

    def __str__(self) -> str:
        return f"{self.section}.{self.entry}.{self.field}"


def numbers(entries: Entries) -> Iterator[Number]:
    """All numbers with a unit that the cards of a deck hold, given or by default."""
    for section, named in entries.items():
        for name, entry in named.items():
            if isinstance(entry.card, BaseModel):
                for field, unit, value in _of_card(entry.card, ""):
                    yield Number(section, name, field, unit, value)


def _of_card(card: BaseModel, path: str) -> Iterator[tuple[str, str, float]]:
    for name in type(card).model_fields:
        value, word = getattr(card, name), f"{path}{name.rstrip('_')}"
        unit = declared(type(card), name).unit
        for one in value if isinstance(value, (tuple, list)) else (value,):
            if isinstance(one, BaseModel):
                yield from _of_card(one, f"{word}.")
            elif unit and "{" not in unit:
                yield from ((word, unit, x) for x in _flat(one))


def _flat(value: object) -> Iterator[float]:
    if isinstance(value, (tuple, list)):
        for one in value:
            yield from _flat(one)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield float(value)


def magnitude_table(entries: Entries) -> list[str]:
    """Lines of `check`: smallest and largest magnitude of every common unit, and their fields."""
    lines = []
    every = [n for n in numbers(entries) if n.value != 0.0 and np.isfinite(n.value)]
    for unit, words in SHOWN.items():
        own = sorted((n for n in every if n.unit == unit), key=lambda n: abs(n.value))
        if unit == "m":
            own = [n for n in own if abs(n.value) > ROUND_OFF * abs(own[-1].value)]
        if own:
            ends = [f"{abs(n.value):.4g} {unit} ({n})" for n in (own[0], own[-1])]
            lines.append(f"{words}: {' to '.join(dict.fromkeys(ends))}")
    speeds = sorted(_wave_speeds(entries))
    if speeds:
        ends = [f"{c:.4g} m/s ({name})" for c, name, *_ in (speeds[0], speeds[-1])]
        lines.append(f"wave speeds: {' to '.join(dict.fromkeys(ends))}")
    return lines


def magnitude_warnings(entries: Entries, is_static: bool) -> list[str]:
    """Numbers outside the range of their kind, one warning each; equilibria need no densities."""
    own = list(dict.fromkeys(numbers(entries)))
    materials = [] if is_static else [*_densities(own), *_speeds(entries)]
    return [*_angles(own), *materials, *_bodies(entries), *_lengths(entries)]


def _angles(own: Sequence[Number]) -> Iterator[str]:
    for n in own:
        if n.unit == "rad" and _are_degrees(abs(n.value), n.field.split(".")[-1] in LIMITS):
            yield (
                f"{n}: {n.value:g} rad is {abs(n.value) / (2.0 * pi):.3g} revolutions; "
                f"were degrees meant? Write '{n.value:g} deg'"
            )


def _are_degrees(size: float, is_limit: bool) -> bool:
    """Whether the size of an angle [rad] is one that a deck states in degrees."""
    if not is_limit:
        return size > pi and (2.0 * size).is_integer()
    step, most = DEGREES
    return 2.0 * pi < size <= most and size % step == 0.0 and not log10(size).is_integer()


def _densities(own: Sequence[Number]) -> Iterator[str]:
    for n in own:
        if n.unit == "kg/m^3" and n.value > SOLIDS[1]:
            yield f"{n}: {n.value:.4g} kg/m^3 is beyond the density of any material; {_UNITS}"


def _speeds(entries: Entries) -> Iterator[str]:
    low, high = WAVE_SPEEDS
    for speed, name, young, density in _wave_speeds(entries):
        meant = [u for u, f in DENSITY_UNITS.items() if SOLIDS[0] < density * f < SOLIDS[1]]
        if speed < low or young > STIFFEST or (speed > high and meant):
            advice = f"was the density in {meant[0]}? " if speed > high and meant else ""
            yield (
                f"materials.{name}: young = {young:.4g} Pa and density = {density:.4g} kg/m^3 are "
                f"a wave speed of {speed:.4g} m/s, that of no material (steel has 5,200); "
                f"{advice}{_UNITS}"
            )


def _bodies(entries: Entries) -> Iterator[str]:
    """Bodies whose mass does not fit the volume of a primitive, or of a surface."""
    low, high = BODIES
    bodies = entries.get("bodies", {})
    outlines = [
        (f"bodies.{name}", name, outline.shape, outline)
        for name, entry in bodies.items()
        if (outline := getattr(entry.card, "primitive", None)) is not None
    ]
    surfaces = entries.get("surfaces", {}).items()
    outlines += [
        (f"surfaces.{n}", getattr(e.card, "body", ""), e.type, e.card) for n, e in surfaces
    ]
    for where, name, kind, outline in outlines:
        volume = _volume(kind, outline)
        mass = getattr(bodies[name].card, "mass", None) if name in bodies else None
        # a surface may cover a small part of its body
        most = high if where.startswith("bodies.") else np.inf
        if mass is not None and volume > 0.0 and not low <= mass / volume <= most:
            yield (
                f"{where}: {mass:.4g} kg in a volume of {volume:.4g} m^3 are {mass / volume:.4g} "
                f"kg/m^3, the density of no body; {_UNITS}"
            )


def _volume(kind: str, outline: object) -> float:
    """Volume [m^3] of a sphere, cylinder or box, by its fields; 0 of others."""
    size, radius, length = (getattr(outline, word, None) for word in ("size", "radius", "length"))
    if kind == "box" and size is not None:
        return float(np.prod(size))
    if radius is None:
        return 0.0
    # powers of Python raise OverflowError where products are infinite
    disc = pi * float(radius) * float(radius)
    if kind == "cylinder" and length is not None:
        return disc * float(length)
    return 4.0 / 3.0 * disc * float(radius) if kind == "sphere" else 0.0


def _wave_speeds(entries: Entries) -> Iterator[tuple[float, str, float, float]]:
    """Wave speed [m/s] of every material, its name, Young's modulus [Pa] and density [kg/m^3]."""
    for name, entry in entries.get("materials", {}).items():
        young, density = (getattr(entry.card, word, None) for word in ("young", "density"))
        if young and density:
            yield sqrt(young / density), name, young, density


def _lengths(entries: Entries) -> Iterator[str]:
    """Positions of bodies and joints that would lie among the others if they were in mm, and
    sections that would fit their beams.
    """
    bodies = _points(entries, "bodies", "position")
    for name, point in bodies.items():
        others = [p for other, p in bodies.items() if other != name]
        yield from _far(f"bodies.{name}.position", point, others)
    # a body has its origin somewhere, the ground has none
    for name, point in _points(entries, "joints", "at").items():
        yield from _far(f"joints.{name}.at", point, list(bodies.values()))
    yield from _thick_beams(entries)


def _points(entries: Entries, section: str, field: str) -> dict[str, np.ndarray]:
    """Points [m] that the cards of a section state in a field, by their entries."""
    cards = {name: entry.card for name, entry in entries.get(section, {}).items()}
    points = {name: getattr(card, field, None) for name, card in cards.items()}
    return {name: np.asarray(at, float) for name, at in points.items() if at is not None}


def _far(where: str, point: np.ndarray, points: Sequence[np.ndarray]) -> Iterator[str]:
    if not points:
        return
    others = np.array(points)
    reach = float(np.linalg.norm(others, axis=1).max())
    away = float(np.linalg.norm(others - point, axis=1).min())
    if away > FAR * reach > 0.0 and np.linalg.norm(point) / MM <= reach:
        yield (
            f"{where}: {away:.4g} m from all other bodies, which lie within "
            f"{reach:.4g} m of the origin; were these mm? {_UNITS}"
        )


def _thick_beams(entries: Entries) -> Iterator[str]:
    """Sections much wider than the beams are long that have them."""
    sections = {name: entry.card for name, entry in entries.get("sections", {}).items()}
    for name, entry in entries.get("parts", {}).items():
        mesh, section = getattr(entry.card, "mesh", None), getattr(entry.card, "section", None)
        start, end = (getattr(mesh, word, None) for word in ("from_", "to"))
        if section not in sections or start is None or end is None:
            continue
        length = float(np.linalg.norm(np.subtract(end, start)))
        lengths = [(word, x) for word, unit, x in _of_card(sections[section], "") if unit == "m"]
        for word, x in lengths:
            if x > WIDE * length:
                yield (
                    f"sections.{section}.{word}: {x:.4g} m for the beam '{name}' of "
                    f"{length:.4g} m; were these mm? {_UNITS}"
                )


_UNITS = (
    "bare numbers are SI: name the unit with the number, such as '210 GPa', '7.85 g/cm^3', '5 mm'"
)
