"""Measures of the injury of occupants beside accelerations, by the role of a sensor in its deck.

    role              measures
    neck              Nij, tension and compression
    chest_deflection  D, and VC = 1.3 D_dot D / 0.229 m
    femur_*           compression, the level that it exceeds for 10 ms, and the largest ratio of
                      what it exceeds for any time up to 10 ms to the limit of that time
    head              BrIC = sqrt(sum (max |w_i| / w_i,c)^2), from its angular velocity
    seat              largest distance from the seat, and when it is 0.5 m and 1 m
    every belt        largest force of any segment, and webbing drawn from the retractor

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

Measures for which a deck has no sensor are named. A distance of 1 m from the seat, more than half
of the width of a vehicle, is called ejection.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crashpost.errors import PostError
from crashpost.results.choice import plain
from crashpost.results.result import Result
from crashpost.results.status import Json
from crashpost.values.injury import sensor_cards
from crashpost.values.injury_measure import Measure
from crashpost.values.words import capital
from crashsolve.channels.roles import CLASSES

# limits of the femur [N], of no time and of FEMUR_TIME [s] and longer
FEMUR_AT_ONCE, FEMUR_HELD, FEMUR_TIME = 9070.0, 7580.0, 10e-3
TENSION, COMPRESSION, FLEXION, EXTENSION = 6806.0, 6160.0, 310.0, 135.0
CHEST_DEPTH, VC_FACTOR = 0.229, 1.3
# [m]; [m/s]
CHEST_LIMIT, VC_LIMIT = 0.042, 1.0
# [m] from the seat
LEFT_SEAT, EJECTED = 0.5, 1.0
BRAIN_CLASS = 60
# [rad/s] about the head's axes x, y and z
CRITICAL_SPINS = (66.25, 56.45, 42.87)
# springs with a moment that act between two bodies, and not within a joint
MOMENTS_APART = ("bushing", "torsional", "curve_torsional", "segment")
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
    cfc: int

    @property
    def missing(self) -> str:
        """What its values lack to be compared with a limit."""
        return "not filtered" if self.plain_because else ""


def measures(result: Result) -> list[Measure]:
    """Measures of all sensors and belts, and the missing channels."""
    cards = sensor_cards(result)
    of_role: dict[str, Callable[[Result, str, Json], list[Measure]]] = {
        "neck": _neck,
        "chest_deflection": _chest,
        "femur_left": _femur,
        "femur_right": _femur,
        "head": _head_rotation,
        "seat": _seat,
    }
    measured = []
    for name, card in cards.items():
        if card.get("role") in of_role:
            try:
                measured += of_role[card["role"]](result, name, card)
            except PostError as reason:
                measured.append(Measure(_title(name), "not stated", when=str(reason)))
    if any(card.get("role") in ROLES for card in cards.values()):
        measured += _belts(result)
    return measured + _missing(cards)


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


def _neck(result: Result, name: str, card: Json) -> list[Measure]:
    force = _history(result, f"-{plain(f'secforc.{name}.force.z')}", CLASSES["neck"])
    parts = [f"secforc.{name}.moment.y", *_moments(result, card.get("joint"))]
    moment = "-(" + " + ".join(plain(p) for p in parts) + ")"
    load = nij(force.values, _history(result, moment, CLASSES["neck"]).values)
    at = int(load.argmax())
    case = "tension" if force.values[at] > 0 else "compression"
    case += f" and {_bending(result, moment, at)}"
    least, most = int(force.values.argmin()), int(force.values.argmax())
    pull, push = max(float(force.values[most]), 0.0), max(-float(force.values[least]), 0.0)
    title, left_out = _title(name), _left_out(result, _title(name), card.get("joint"))
    missing = force.missing or ("moments are missing" if left_out else "")
    neck = _at(result, title, f"Nij, {case}", float(load[at]), "", at)
    return [
        _filter(name, force),
        *left_out,
        neck._replace(limit=1.0, source="49 CFR 571.208", missing=missing),
        _at(result, title, "neck tension", pull, "N", most),
        _at(result, title, "neck compression", push, "N", least),
    ]


def _bending(result: Result, moment: str, at: int) -> str:
    values = _history(result, moment, CLASSES["neck"]).values
    return "flexion" if values[at] > 0 else "extension"


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


def _left_out(result: Result, title: str, joint: object) -> list[Measure]:
    """The springs between the bodies of a joint that do not name it: their moments are unknown."""
    own = sensor_cards(result, "joints").get(str(joint), {})
    bodies = {own.get("a"), own.get("b")}
    names = [
        f"'{name}'"
        for name, card in sensor_cards(result, "springs").items()
        if card.get("type") in MOMENTS_APART and own and {card.get("a"), card.get("b")} == bodies
    ]
    if not names:
        return []
    when = f"of {', '.join(names)}; springs count that name the joint '{joint}'"
    return [Measure(title, "Nij is without moments", when=when)]


def _chest(result: Result, name: str, card: Json) -> list[Measure]:
    channel = f"-{plain(f'disbout.{name}.change')}"
    deflection = _history(result, channel, CLASSES["chest_deflection"])
    load, title = viscous(result.time, deflection.values), _title(name)
    at, fastest = int(deflection.values.argmax()), int(load.argmax())
    deep = _at(result, title, "deflection", float(deflection.values[at]), "m", at)
    speed = _at(result, title, "VC", float(load[fastest]), "m/s", fastest)
    missing = deflection.missing
    return [
        _filter(name, deflection),
        deep._replace(limit=CHEST_LIMIT, source="UN R137", missing=missing),
        speed._replace(limit=VC_LIMIT, source="UN R94", missing=missing),
    ]


def _femur(result: Result, name: str, card: Json) -> list[Measure]:
    force = _history(result, f"-{plain(f'secforc.{name}.force.z')}", CLASSES["femur_left"])
    at, title = int(force.values.argmax()), _title(name)
    held, in_span = _held_for(result.time, force.values)
    top = _at(result, title, "compression", max(float(force.values[at]), 0.0), "N", at)
    span, ratio = "compression for 10 ms", "share of the limit of its time"
    share, source = femur_share(result.time, force.values), "UN R94"
    return [
        _filter(name, force),
        top._replace(limit=FEMUR_AT_ONCE, source=source, missing=force.missing),
        Measure(title, span, held, "N", in_span, FEMUR_HELD, source, force.missing),
        Measure(title, ratio, share, "", "", 1.0, source, force.missing),
    ]


def _head_rotation(result: Result, name: str, card: Json) -> list[Measure]:
    channels = [plain(f"nodout.{name}.angular_velocity.{a}") for a in "xyz"]
    spins = [_history(result, channel, BRAIN_CLASS) for channel in channels]
    message = next((w.plain_because for w in spins if w.plain_because), "")
    value = bric([w.values for w in spins])
    return [Measure(_title(name), "BrIC", value, when=message)]


def _seat(result: Result, name: str, card: Json) -> list[Measure]:
    distance = result.series(plain(f"disbout.{name}.distance")).values
    at, title = int(distance.argmax()), _title(name)
    measured = [_at(result, title, "largest distance", float(distance[at]), "m", at)]
    for level, words in ((LEFT_SEAT, "leaves the seat"), (EJECTED, "is ejected")):
        beyond = np.flatnonzero(distance > level)
        when = f"at {level:g} m" if len(beyond) else f"is never {level:g} m away"
        moment = _passing(result.time, distance, int(beyond[0]), level) if len(beyond) else None
        measured.append(Measure(title, words, moment, "s", when))
    return measured


def _passing(time: np.ndarray, values: np.ndarray, at: int, level: float) -> float:
    """Time at which values pass a level before the sample `at`, by the chord."""
    if at == 0:
        return float(time[0])
    share = (level - values[at - 1]) / (values[at] - values[at - 1])
    return float(time[at - 1] + share * (time[at] - time[at - 1]))


def _belts(result: Result) -> list[Measure]:
    """The largest force in each belt, and the webbing that has left its retractor."""
    belts: dict[str, list[str]] = {}
    for channel in result.channels("beltout.*.force.*"):
        belts.setdefault(channel.name.split(".")[1], []).append(channel.name)
    measured = []
    for name, channels in belts.items():
        forces = np.array([result.series(plain(channel)).values for channel in channels])
        segment, at = np.unravel_index(forces.argmax(), forces.shape)
        top = _at(result, _title(name), "largest force", float(forces[segment, at]), "N", int(at))
        measured.append(top._replace(when=f"{top.when}, segment {int(segment) + 1}"))
        drawn = result.series(plain(f"beltout.{name}.pay_out")).values
        if np.any(drawn):
            at, most = int(drawn.argmax()), float(drawn.max())
            measured.append(_at(result, _title(name), "largest pay-out", most, "m", at))
    return measured


def _held_for(time: np.ndarray, force: np.ndarray) -> tuple[float | None, str]:
    """Level [N] that a compression [N] is not below for 10 ms, and a remark; None in less time."""
    if time[-1] - time[0] < FEMUR_TIME:
        return None, "needs a history of 10 ms or more"
    return _exceeded_for(time, force, FEMUR_TIME), "in one span"


def _exceeded_for(time: np.ndarray, values: np.ndarray, span: float) -> float:
    """Largest level that values are not below for `span` [s] without a break; 0 of shorter runs."""
    last = np.searchsorted(time, time + span * (1.0 - 1e-9))
    levels = [values[i : j + 1].min() for i, j in enumerate(last) if j < len(time)]
    return max([0.0, *map(float, levels)])


def _history(result: Result, expression: str, cfc: int) -> Filtered:
    """A channel filtered, or as it is and why. Raises PostError where it does not exist."""
    plain_values = result.series(expression).values
    try:
        return Filtered(result.series(f"cfc({expression}, {cfc})").values, "", cfc)
    except PostError as reason:
        # without the expression that the message ends with
        return Filtered(plain_values, str(reason).partition(" in '")[0], cfc)


def _filter(name: str, history: Filtered) -> Measure:
    """The remark about the filter of a sensor."""
    measure = "not filtered" if history.plain_because else f"CFC {history.cfc}"
    return Measure(_title(name), measure, when=history.plain_because)


def _at(result: Result, title: str, measure: str, value: float, unit: str, row: int) -> Measure:
    """A number in SI and the time of its sample."""
    return Measure(title, measure, value, unit, "at {}", times=(float(result.time[row]),))


def _title(name: str) -> str:
    return capital(name.replace("_", " "))


def _missing(cards: dict[str, Json]) -> list[Measure]:
    """Measures of an occupant for which the deck has no sensors."""
    roles = {card.get("role") for card in cards.values()}
    if not roles & set(OF_OCCUPANTS):
        return []
    return [
        Measure("Occupants", ROLES[role], when=f"no sensor has the role {role}")
        for role in ROLES
        if role not in roles
    ]
