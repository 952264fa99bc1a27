"""Measures of injury and of crash pulses, by the role that an accelerometer has in its deck.

    role     filter    measures                                limits
    head     CFC 1000  peak, 3 ms clip, HIC, Severity Index    HIC 700 and 1000, 80 g in 3 ms
    chest    CFC 180   peak, 3 ms clip                         60 g in 3 ms
    pelvis   CFC 1000  peak, 3 ms clip                         none
    vehicle  CFC 60    peak, 3 ms clip, velocity change, OLC   none

Filter classes are those of SAE J211-1. Limits: 49 CFR 571.208 for HIC of 15 ms and the chest,
UN R94 for HIC of 36 ms and 80 g; both for a 50th percentile man. No sections are cited: their
numbers were not checked against the texts. `injury_table.py` has these measures and
those of `occupant_injury.py`, each with its error by the interval of the samples.
Accelerations are filtered axis by axis; where the samples do not serve the filter, they are taken
as they are, and the measure states it.
"""

from dataclasses import dataclass, replace

from crashpost.errors import PostError
from crashpost.results.answer import answer
from crashpost.results.choice import plain
from crashpost.results.result import Result
from crashpost.results.status import Json
from crashpost.results.table import number
from crashpost.values.figure import Curve, Figure, Reference
from crashpost.values.injury_measure import Measure
from crashpost.values.pulse import pulse_measures
from crashpost.values.words import capital
from crashsolve.channels.errors import TooShort
from crashsolve.channels.roles import CLASSES

HIC = ("15 ms", "36 ms")
CLIP = "3 ms"
# [m/s^2]
G0 = 9.80665
# greatest values allowed, of HIC and in SI units, and where
LIMITS = {
    "head": {
        "HIC, 15 ms": (700.0, "49 CFR 571.208"),
        "HIC, 36 ms": (1000.0, "UN R94"),
        "3 ms clip": (80.0 * G0, "UN R94"),
    },
    "chest": {"3 ms clip": (60.0 * G0, "49 CFR 571.208")},
}


@dataclass(frozen=True)
class SensorPosition:
    """An accelerometer with a role, and its resultant acceleration."""

    name: str
    role: str
    channel: str
    sensor: str
    # why it is not filtered; empty where it is
    plain_because: str = ""
    has_gravity: bool = False

    @property
    def filter(self) -> str:
        """Filter of its acceleration, in words."""
        return "" if self.plain_because else f"CFC {CLASSES[self.role]}"


def positions(result: Result) -> list[SensorPosition]:
    """All accelerometers to which the deck gives a role."""
    known = {
        entity
        for family in result.families.values()
        if family.word == "nodout"
        for entity in family.ids
    }
    return [
        _position(result, name, card["role"], has_gravity=card.get("gravity") is True)
        for name, card in sensors(result).items()
        if name in known and card.get("role") in CLASSES and _is_written(result, name)
    ]


def measures(result: Result) -> list[Measure]:
    """The measures of each position, after its filter and what it does with gravity."""
    measured = []
    for position in positions(result):
        message = position.plain_because or "axis by axis"
        measured.append(Measure(position.name, position.filter or "not filtered", when=message))
        held = "as instruments show it" if position.has_gravity else "left out"
        measured.append(Measure(position.name, "gravity", when=held))
        measured += [_with_limit(position, one) for one in _measures(result, position)]
    return measured + _unwritten(result)


def _unwritten(result: Result) -> list[Measure]:
    """A remark on each position of whose acceleration the run did not write all components."""
    if not result.chosen_channels:
        return []
    names = [name for name, card in sensors(result).items() if card.get("role") in CLASSES]
    message = "output.history.channels did not choose all of nodout.{}.acceleration"
    return [
        Measure(capital(name.replace("_", " ")), "not stated", when=message.format(name))
        for name in names
        if not _is_written(result, name)
    ]


def _is_written(result: Result, sensor: str) -> bool:
    """Whether all components of an acceleration are in the history."""
    return all(result.has(f"nodout.{sensor}.acceleration.{axis}") for axis in "xyz")


def injury_figures(result: Result) -> list[Figure]:
    """The acceleration of every sensor, with the window of HIC of 15 ms of heads, 3 ms clip."""
    figures = []
    for position in positions(result):
        peak = result.value(position.channel, "max", unit="g0")
        if not peak > 0:
            continue
        curve = Curve(position.channel, position.filter or "resultant, not filtered")
        title = f"{position.name}: acceleration"
        marks = _marks(result, position, peak)
        figure = Figure(title, (curve,), x_unit="s", y_unit="g0", reference=marks)
        figures.append(replace(figure, y_label="acceleration"))
    return figures


def _measures(result: Result, position: SensorPosition) -> list[Measure]:
    """The measures of a position, without their limits."""
    name, channel = position.name, position.channel
    measured = [_peak(result, position), Measure(name, f"{CLIP} clip", *_clip(result, channel))]
    if position.role == "head":
        measured += [_hic(result, position, window) for window in HIC]
        value, message = _reported(result, f"si({channel})", "final")
        measured.append(Measure(name, "Severity Index", value, when=message))
    if position.role == "vehicle":
        try:
            measured += pulse_measures(result, position.sensor, name)
        except PostError as reason:
            measured.append(Measure(name, "velocity change and OLC", when=str(reason)))
    return measured


def _clip(result: Result, channel: str) -> tuple[float | None, str, str]:
    """The 3 ms clip with its unit, and why there is none."""
    value, message = _reported(result, f"clip({channel}, '{CLIP}')", "max")
    return value, "m/s^2", message


def _with_limit(position: SensorPosition, one: Measure) -> Measure:
    limit, source = LIMITS.get(position.role, {}).get(one.measure, (None, ""))
    missing = "not filtered" if position.plain_because else ""
    return one._replace(limit=limit, source=source, missing=missing)


def _marks(result: Result, position: SensorPosition, peak: float) -> tuple[Reference, ...]:
    marks = []
    try:
        if position.role == "head":
            hic = f"({position.channel}, '{HIC[0]}')"
            value, start, end = (
                result.value(f"{name}{hic}", "final") for name in ("hic", "hic_start", "hic_end")
            )
            if end > start:
                label = f"HIC {HIC[0]}: {number(value)}"
                marks.append(Reference(label, "band", from_=0.0, to=peak, over=(start, end)))
        clip = result.value(f"clip({position.channel}, '{CLIP}')", "max", unit="g0")
        marks.append(Reference(f"3 ms clip: {number(clip)} g", value=clip))
    except TooShort:
        pass
    return tuple(marks)


def _peak(result: Result, position: SensorPosition) -> Measure:
    when, peak = (result.value(position.channel, statistic) for statistic in ("argmax", "max"))
    return Measure(position.name, "largest acceleration", peak, "m/s^2", "at {}", times=(when,))


def _hic(result: Result, position: SensorPosition, window: str) -> Measure:
    channel, measure = position.channel, f"HIC, {window}"
    value, message = _reported(result, f"hic({channel}, '{window}')", "final")
    if value is None:
        return Measure(position.name, measure, when=message)
    span = tuple(
        result.value(f"hic_{edge}({channel}, '{window}')", "final") for edge in ("start", "end")
    )
    return Measure(position.name, measure, value, when="{} to {}", times=span)


def _reported(result: Result, channel: str, statistic: str) -> tuple[float | None, str]:
    """The number in SI, or why there is none."""
    try:
        return answer(result, channel, statistic, None, "").value, ""
    except TooShort as error:
        return None, str(error)


def _position(result: Result, sensor: str, role: str, *, has_gravity: bool) -> SensorPosition:
    """A position, filtered where that can be."""
    name = capital(sensor.replace("_", " "))
    axes = [plain(f"nodout.{sensor}.acceleration.{axis}") for axis in "xyz"]
    filtered = f"resultant({', '.join(f'cfc({axis}, {CLASSES[role]})' for axis in axes)})"
    try:
        result.value(filtered, "max")
    except PostError as reason:
        channel = f"resultant({', '.join(axes)})"
        return SensorPosition(name, role, channel, sensor, str(reason), has_gravity)
    return SensorPosition(name, role, filtered, sensor, has_gravity=has_gravity)


def sensors(result: Result) -> dict[str, Json]:
    """The cards of accelerometers, as the stored deck states."""
    cards = sensor_cards(result)
    return {name: card for name, card in cards.items() if card.get("type") == "accelerometer"}


def sensor_cards(result: Result, section: str = "sensors") -> dict[str, Json]:
    """Cards of a section of the stored deck, sensors or others; none where it cannot be read."""
    import yaml

    try:
        cards = (yaml.safe_load(result.deck_text) or {}).get(section) or {}
        return {str(name): dict(card) for name, card in cards.items()}
    except (yaml.YAMLError, AttributeError, TypeError, RecursionError, ValueError):
        return {}
