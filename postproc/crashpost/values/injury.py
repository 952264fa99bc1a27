"""Measures of injury of heads, found by their names: peak, 3 ms clip, HIC and Severity Index.

A head is an accelerometer or a body one of whose words is `head`: driver_head, head-form. Its
acceleration is filtered by channel frequency class 1000, axis by axis, as the rules of crash tests
have it for heads (SAE J211-1); where the run was sampled too rarely for that, or is too short, it
is taken as it was sampled, and the measure says so.
"""

import re
from dataclasses import dataclass, replace

from crashpost.errors import PostError
from crashpost.results.answer import answer
from crashpost.results.choice import plain
from crashpost.results.result import Result
from crashpost.results.table import number
from crashpost.values.figure import Curve, Figure, Reference
from crashpost.values.words import capital
from crashsolve.channels.errors import TooShort

HIC = ("15 ms", "36 ms")
# channel frequency class of accelerations of heads, SAE J211-1
CLASS = 1000


@dataclass(frozen=True)
class Head:
    """A head and its resultant acceleration."""

    name: str
    channel: str
    # why it is not filtered; empty where it is
    plain_because: str = ""


def heads(result: Result) -> list[Head]:
    """All heads: their accelerometers, bodies only where there are none."""
    for family in ("nodout", "rbdout"):
        known = {c.name for f in result.families.values() if f.word == family for c in f.columns}
        if "acceleration.x" not in known:
            continue
        bodies = _bodies_of_accelerometers(result) if family == "nodout" else {}
        found = [
            _head(result, capital(entity.replace("_", " ")), f"{family}.{entity}")
            for one in result.families.values()
            if one.word == family
            for entity in one.ids
            if _is_head(entity) or _is_head(bodies.get(entity, ""))
        ]
        if found:
            return found
    return []


def measures(result: Result) -> list[list[str]]:
    """A row for each measure of each head: head, measure, value, when."""
    rows = []
    for head in heads(result):
        if head.plain_because:
            rows.append([head.name, "not filtered", "", head.plain_because])
        rows.append([head.name, "largest acceleration", *_peak(result, head.channel)])
        clip = f"clip({head.channel}, '3 ms')"
        rows.append([head.name, "3 ms clip", *_told(result, clip, "max", "g")])
        for window in HIC:
            rows.append([head.name, f"HIC, {window}", *_hic(result, head.channel, window)])
        index = f"si({head.channel})"
        rows.append([head.name, "Severity Index", *_told(result, index, "final")])
    return rows


def injury_figures(result: Result) -> list[Figure]:
    """The acceleration of every head, with the window of its HIC of 15 ms and its 3 ms clip."""
    figures = []
    for head in heads(result):
        peak = result.value(head.channel, "max", unit="g0")
        if not peak > 0:
            continue
        curve = Curve(head.channel, "resultant" if head.plain_because else f"CFC {CLASS}")
        title = f"{head.name}: acceleration"
        marks = _marks(result, head.channel, peak)
        figure = Figure(title, (curve,), x_unit="s", y_unit="g0", reference=marks)
        figures.append(replace(figure, y_label="acceleration"))
    return figures


def _marks(result: Result, channel: str, peak: float) -> tuple[Reference, ...]:
    marks = []
    try:
        hic = f"({channel}, '{HIC[0]}')"
        value, start, end = (
            result.value(f"{name}{hic}", "final") for name in ("hic", "hic_start", "hic_end")
        )
        if end > start:
            label = f"HIC {HIC[0]}: {number(value)}"
            marks.append(Reference(label, "band", from_=0.0, to=peak, over=(start, end)))
        clip = result.value(f"clip({channel}, '3 ms')", "max", unit="g0")
        marks.append(Reference(f"3 ms clip: {number(clip)} g", value=clip))
    except TooShort:
        pass
    return tuple(marks)


def _peak(result: Result, channel: str) -> tuple[str, str]:
    when = result.value(channel, "argmax")
    return f"{number(result.value(channel, 'max', unit='g0'))} g", f"at {1e3 * when:.5g} ms"


def _hic(result: Result, channel: str, window: str) -> tuple[str, str]:
    value, _ = _told(result, f"hic({channel}, '{window}')", "final")
    try:
        start, end = (
            1e3 * result.value(f"hic_{edge}({channel}, '{window}')", "final")
            for edge in ("start", "end")
        )
    except PostError:
        return value, ""
    return value, f"{start:.5g} to {end:.5g} ms"


def _told(result: Result, channel: str, statistic: str, unit: str = "") -> tuple[str, str]:
    """The number with its unit, or why there is none."""
    try:
        found = answer(result, channel, statistic, None, unit.replace("g", "g0"))
    except TooShort as error:
        return "-", str(error)
    return f"{number(found.value)} {unit}".rstrip(), ""


def _head(result: Result, name: str, prefix: str) -> Head:
    """A head, filtered where that can be."""
    axes = [plain(f"{prefix}.acceleration.{axis}") for axis in "xyz"]
    filtered = f"resultant({', '.join(f'cfc({axis}, {CLASS})' for axis in axes)})"
    try:
        result.value(filtered, "max")
    except PostError as reason:
        return Head(name, f"resultant({', '.join(axes)})", str(reason))
    return Head(name, filtered)


def _is_head(name: str) -> bool:
    return "head" in re.split(r"[^a-z]+", name.lower())


def _bodies_of_accelerometers(result: Result) -> dict[str, str]:
    """The body of each accelerometer, as the stored deck tells; empty where it cannot be read."""
    import yaml

    try:
        sensors = (yaml.safe_load(result.deck_text) or {}).get("sensors") or {}
        return {str(name): str(card.get("body", "")) for name, card in sensors.items()}
    except (yaml.YAMLError, AttributeError, RecursionError, ValueError):
        return {}
