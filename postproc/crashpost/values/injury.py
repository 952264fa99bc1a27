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
from functools import partial

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
# greatest values allowed, of HIC and in g, and where
LIMITS = {
    "head": {
        "HIC, 15 ms": (700.0, "49 CFR 571.208"),
        "HIC, 36 ms": (1000.0, "UN R94"),
        "3 ms clip": (80.0, "UN R94"),
    },
    "chest": {"3 ms clip": (60.0, "49 CFR 571.208")},
}
# measure, value, unit and when
Number = tuple[str, float | None, str, str]


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
        measured += [_with_limit(position, *one) for one in _measures(result, position)]
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


def _measures(result: Result, position: SensorPosition) -> list[Number]:
    """Measure, value, unit and when."""
    message = partial(_reported, result)
    clip = f"clip({position.channel}, '{CLIP}')"
    measured = [_peak(result, position.channel), ("3 ms clip", *message(clip, "max", "g"))]
    if position.role == "head":
        measured += [_hic(result, position.channel, window) for window in HIC]
        measured.append(("Severity Index", *message(f"si({position.channel})", "final")))
    if position.role == "vehicle":
        try:
            measured += pulse_measures(result, position.sensor)
        except PostError as reason:
            measured.append(("velocity change and OLC", None, "", str(reason)))
    return measured


def _with_limit(
    position: SensorPosition, measure: str, value: float | None, unit: str, when: str
) -> Measure:
    limit, source = LIMITS.get(position.role, {}).get(measure, (None, ""))
    is_filtered = not position.plain_because
    return Measure(position.name, measure, value, unit, when, limit, source, is_filtered)


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


def _peak(result: Result, channel: str) -> Number:
    when = result.value(channel, "argmax")
    peak = result.value(channel, "max", unit="g0")
    return "largest acceleration", peak, "g", f"at {1e3 * when:.5g} ms"


def _hic(result: Result, channel: str, window: str) -> Number:
    value, _, message = _reported(result, f"hic({channel}, '{window}')", "final")
    if value is None:
        return f"HIC, {window}", None, "", message
    start, end = (
        1e3 * result.value(f"hic_{edge}({channel}, '{window}')", "final")
        for edge in ("start", "end")
    )
    return f"HIC, {window}", value, "", f"{start:.5g} to {end:.5g} ms"


def _reported(
    result: Result, channel: str, statistic: str, unit: str = ""
) -> tuple[float | None, str, str]:
    """The number with its unit, or why there is none."""
    try:
        return answer(result, channel, statistic, None, unit.replace("g", "g0")).value, unit, ""
    except TooShort as error:
        return None, unit, str(error)


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
