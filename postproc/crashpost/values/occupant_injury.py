"""Measures of the injury of occupants beside accelerations, by the role of a sensor in its deck.

    role              measures
    neck              Nij, tension and compression
    chest_deflection  D, and VC = 1.3 D_dot D / 0.229 m
    femur_*           compression, the level that it exceeds for 10 ms, and the largest ratio of
                      what it exceeds for any time up to 10 ms to the limit of that time
    head              BrIC = sqrt(sum (max |w_i| / w_i,c)^2), from its angular velocity

    Nij = F_z / F_c + M_y / M_c,   F_c 6806 N tension, 6160 N compression,
                                   M_c 310 N m flexion, 135 N m extension

at every moment, all for a man of the 50th percentile, whatever the occupant's size. M_y is the
moment about the occipital condyles: that of the section and those of the springs that limit and
resist the rotation of its joint. Signs are those of SAE J211: F_z positive in tension, M_y in
flexion; the sensor's axes are x forward, y left, z up. Filters: CFC 600 for the neck and the femur,
180 for the chest, 60 for BrIC; where the samples do not serve a filter nothing is judged. Limits:
UN R94 for VC and femur (9.07 kN at once, 7.58 kN for 10 ms, a straight line between), UN R137 for
42 mm; 1 for Nij.
Intercepts of Nij and its filter are from memory and were not read in the regulation.

Measures for which a deck has no sensor are named.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crashpost.errors import PostError
from crashpost.results.choice import plain
from crashpost.results.result import Result
from crashpost.results.status import Json
from crashpost.results.table import number
from crashpost.values.injury import sensor_cards
from crashpost.values.words import capital

Row = list[str]

# limits of the femur [N], of no time and of FEMUR_TIME [s] and longer
FEMUR_AT_ONCE, FEMUR_HELD, FEMUR_TIME = 9070.0, 7580.0, 10e-3
TENSION, COMPRESSION, FLEXION, EXTENSION = 6806.0, 6160.0, 310.0, 135.0
CHEST_DEPTH, VC_FACTOR = 0.229, 1.3
# [rad/s] about the head's axes x, y and z
CRITICAL_SPINS = (66.25, 56.45, 42.87)
# sensors of a whole occupant, and the measure that each serves
ROLES = {
    "head": "HIC, Severity Index and BrIC",
    "chest": "3 ms clip of the chest",
    "neck": "Nij",
    "chest_deflection": "chest deflection and VC",
    "femur_left": "force of the left femur",
    "femur_right": "force of the right femur",
}
# roles that only occupants have: one of them, and the rest is missed
OF_OCCUPANTS = ("neck", "chest_deflection", "femur_left", "femur_right")


class Filtered(NamedTuple):
    """A history and why it is not filtered; empty where it is."""

    values: np.ndarray
    plain_because: str


def rows(result: Result) -> list[Row]:
    """A row for each measure: name, measure, value, limit, verdict, time; and the missing
    channels.
    """
    cards = sensor_cards(result)
    measures: dict[str, Callable[[Result, str, Json], list[Row]]] = {
        "neck": _neck,
        "chest_deflection": _chest,
        "femur_left": _femur,
        "femur_right": _femur,
        "head": _head_rotation,
    }
    measures_of_all = []
    for name, card in cards.items():
        if card.get("role") in measures:
            try:
                measures_of_all += measures[card["role"]](result, name, card)
            except PostError as reason:
                measures_of_all.append([_title(name), "not stated", "-", "", "", str(reason)])
    return measures_of_all + _missing(cards)


def nij(force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Nij over time, of tension [N] and flexion [N m], both positive."""
    axial = np.where(force > 0.0, force / TENSION, -force / COMPRESSION)
    return axial + np.where(moment > 0.0, moment / FLEXION, -moment / EXTENSION)


def viscous(time: np.ndarray, deflection: np.ndarray) -> np.ndarray:
    """VC over time [m/s], of the deflection of the chest [m]; 0 where the chest is expanded."""
    rate = np.gradient(deflection, time)
    criterion: np.ndarray = VC_FACTOR * rate * np.maximum(deflection, 0.0) / CHEST_DEPTH
    return criterion


def femur_share(time: np.ndarray, force: np.ndarray) -> float:
    """Largest ratio of a compression [N] to the limit of the time for which it is exceeded.

    In one span each: of a force that is exceeded for 5 ms the limit is 8.325 kN.
    """
    held, largest = force, 0.0
    for lag in range(len(time)):
        # least of every lag + 1 samples in a row
        held = force if lag == 0 else np.minimum(held[:-1], force[lag:])
        lasting = time[lag:] - time[: len(time) - lag]
        limit = np.interp(lasting, [0.0, FEMUR_TIME], [FEMUR_AT_ONCE, FEMUR_HELD])
        largest = max(largest, float((held / limit).max()))
        if lasting.min() >= FEMUR_TIME:
            break
    return largest


def bric(spins: list[np.ndarray]) -> float:
    """BrIC, of the angular velocity of the head about its axes x, y and z [rad/s]."""
    parts = [np.abs(w).max() / c for w, c in zip(spins, CRITICAL_SPINS, strict=True)]
    return float(np.sqrt(np.sum(np.square(parts))))


def _neck(result: Result, name: str, card: Json) -> list[Row]:
    force = _history(result, f"-{plain(f'secforc.{name}.force.z')}", 600)
    parts = [f"secforc.{name}.moment.y", *_moments(result, card.get("joint"))]
    moment = _history(result, "-(" + " + ".join(plain(p) for p in parts) + ")", 600)
    load = nij(force.values, moment.values)
    at = int(load.argmax())
    case = "tension" if force.values[at] > 0 else "compression"
    case += " and flexion" if moment.values[at] > 0 else " and extension"
    where = _when(result, at)
    message = force.plain_because or moment.plain_because
    return [
        _row_with_limit(name, f"Nij, {case}", load[at], "", 1.0, where, message),
        _row(name, "neck tension", 1e-3 * force.values.max(initial=0.0), "kN", message),
        _row(name, "neck compression", -1e-3 * force.values.min(initial=0.0), "kN", message),
    ]


def _moments(result: Result, joint: object) -> list[str]:
    """Channels of the moments of all springs within a joint, on its second body."""
    springs = {
        name
        for name, card in sensor_cards(result, "springs").items()
        if joint is not None and card.get("joint") == joint
    }
    return [
        channel.name
        for channel in result.channels("deforc.*.moment.y")
        if channel.name.split(".")[1] in springs
    ]


def _chest(result: Result, name: str, card: Json) -> list[Row]:
    deflection = _history(result, f"-{plain(f'disbout.{name}.change')}", 180)
    load = viscous(result.time, deflection.values)
    message, at = deflection.plain_because, int(deflection.values.argmax())
    top, fastest = 1e3 * deflection.values[at], int(load.argmax())
    return [
        _row_with_limit(name, "deflection", top, "mm", 42.0, _when(result, at), message),
        _row_with_limit(name, "VC", load[fastest], "m/s", 1.0, _when(result, fastest), message),
    ]


def _femur(result: Result, name: str, card: Json) -> list[Row]:
    force = _history(result, f"-{plain(f'secforc.{name}.force.z')}", 600)
    message, at = force.plain_because, int(force.values.argmax())
    held = 1e-3 * _exceeded_for(result.time, force.values, FEMUR_TIME)
    share = femur_share(result.time, force.values)
    top = 1e-3 * max(float(force.values[at]), 0.0)
    return [
        _row_with_limit(name, "compression", top, "kN", 9.07, _when(result, at), message),
        _row_with_limit(name, "compression for 10 ms", held, "kN", 7.58, "in one span", message),
        _row_with_limit(name, "share of the limit of its time", share, "", 1.0, "", message),
    ]


def _head_rotation(result: Result, name: str, card: Json) -> list[Row]:
    spins = [_history(result, plain(f"nodout.{name}.angular_velocity.{a}"), 60) for a in "xyz"]
    message = next((w.plain_because for w in spins if w.plain_because), "")
    return [_row(name, "BrIC", bric([w.values for w in spins]), "", message)]


def _exceeded_for(time: np.ndarray, values: np.ndarray, span: float) -> float:
    """Largest level that values are not below for `span` [s] without a break; 0 of shorter runs."""
    last = np.searchsorted(time, time + span * (1.0 - 1e-9))
    levels = [values[i : j + 1].min() for i, j in enumerate(last) if j < len(time)]
    return max([0.0, *map(float, levels)])


def _history(result: Result, expression: str, cfc: int) -> Filtered:
    """A channel filtered, or as it is and why. Raises PostError where it does not exist."""
    plain_values = result.series(expression).values
    try:
        return Filtered(result.series(f"cfc({expression}, {cfc})").values, "")
    except PostError as reason:
        return Filtered(plain_values, str(reason))


def _row_with_limit(
    name: str, measure: str, value: float, unit: str, limit: float, when: str, message: str
) -> Row:
    """A row with its limit; a signal that was not filtered is not judged."""
    shown = f"{limit:g} {unit}".rstrip()
    verdict = "within" if value <= limit else "beyond"
    if message:
        return [*_row(name, measure, value, unit)[:3], shown, "not assessed: not filtered", message]
    return [*_row(name, measure, value, unit)[:3], shown, verdict, when]


def _row(name: str, measure: str, value: float, unit: str, message: str = "") -> Row:
    return [_title(name), measure, f"{number(float(value))} {unit}".rstrip(), "", "", message]


def _when(result: Result, row: int) -> str:
    return f"at {1e3 * float(result.time[row]):.5g} ms"


def _title(name: str) -> str:
    return capital(name.replace("_", " "))


def _missing(cards: dict[str, Json]) -> list[Row]:
    """Measures of an occupant for which the deck has no sensors."""
    roles = {card.get("role") for card in cards.values()}
    if not roles & set(OF_OCCUPANTS):
        return []
    return [
        ["Occupants", ROLES[role], "-", "", "", f"no sensor has the role {role}"]
        for role in ROLES
        if role not in roles
    ]
