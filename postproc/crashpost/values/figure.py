"""Content of a figure of the report, as requested under `output: report: figures:`.

    - title: Buffer force
      y: [rcforc.left.force.normal, {channel: ..., label: ..., x: ...}]
      x: time                        x_unit: ms   y_unit: kN   x_scale: linear   y_scale: log
      x_offset: 0   y_offset: 0      added to the values, in the display unit
      x_label, y_label               axis titles;  x_range, y_range: [from, to]
      note: text below the figure
      reference:                     numbers in the units of the axes
        - {label: ..., kind: level, value: 1.0, source: ...}
        - {label: ..., kind: band,  from: 0.8, to: 1.2}
        - {label: ..., kind: point, points: [[x, y]]}
        - {label: ..., kind: curve, points: [[x, y], ...]}
        - {label: ..., kind: corridor, points: [[x, lower], ...], upper: [[x, upper], ...]}

A reference that also has `channel` and `statistic` is compared with the value of the run; `during:
[t0, t1]` limits the comparison to a time window, `over: [x0, x1]` the width of a level or band.
`tolerance` is the uncertainty of a level or point: a value of the run beyond it is a miss. A
corridor over time needs the channel alone: its measure is the largest distance from the corridor.
"""

from collections.abc import Sequence
from dataclasses import MISSING, dataclass, field, fields
from typing import Any

import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.results.status import Json
from crashsolve.channels.display import readable
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import is_a_time

KINDS = ("level", "band", "point", "curve", "corridor")
SCALES = ("linear", "log")

AUTO = "auto"

Pair = tuple[float, float]


@dataclass(frozen=True)
class Curve:
    """One line of a figure; `x` when it has another abscissa than the figure."""

    channel: str
    label: str = ""
    x: str = ""
    # which of several results it is of; no word of a deck
    run: int = field(default=0, metadata={"inner": True})
    # points in the units of the axes, in place of a history; no word of a deck
    points: tuple[Pair, ...] = field(default=(), metadata={"inner": True})


@dataclass(frozen=True)
class Reference:
    """Something known from elsewhere, drawn behind the curves and compared with them."""

    label: str
    kind: str = "level"
    value: float | None = None
    from_: float | None = None
    to: float | None = None
    points: tuple[Pair, ...] = ()
    upper: tuple[Pair, ...] = ()
    tolerance: float | None = None
    source: str = ""
    channel: str = ""
    statistic: str = ""
    during: Pair | None = None
    over: Pair | None = None


@dataclass(frozen=True)
class Figure:
    """One figure with its axes, curves and references."""

    title: str
    y: tuple[Curve, ...]
    x: str = "time"
    x_unit: str = ""  # SI when empty, a readable multiple of it when AUTO
    y_unit: str = ""
    x_scale: str = "linear"
    y_scale: str = "linear"
    x_offset: float = 0.0
    y_offset: float = 0.0
    x_label: str = ""
    y_label: str = ""
    x_range: Pair | None = None
    y_range: Pair | None = None
    reference: tuple[Reference, ...] = ()
    note: str = ""


def figures_of(report: object) -> list[Figure]:
    """The figures of a result's `report` attribute; raises PostError naming the wrong one."""
    if not isinstance(report, dict) or not isinstance(report.get("figures"), list):
        raise PostError("the report attribute must be {figures: [...]}")
    return [_figure(entry, f"figure {n}") for n, entry in enumerate(report["figures"], start=1)]


def _figure(entry: object, location: str) -> Figure:
    known = _fields(Figure, entry, location)
    location = f"{location} '{known['title']}'"
    if not isinstance(known["y"], list) or not known["y"]:
        raise PostError(f"{location}: y must list channels")
    known["y"] = tuple(_curve(curve, location) for curve in known["y"])
    if not isinstance(known.get("reference", []), list):
        raise PostError(f"{location}: reference must be a list")
    known["reference"] = tuple(_reference(r, location) for r in known.get("reference", ()))
    for scale in ("x_scale", "y_scale"):
        if known.get(scale, "linear") not in SCALES:
            raise PostError(f"{location}: {scale} is linear or log, not '{known[scale]}'")
    return Figure(**known)


def _curve(entry: object, location: str) -> Curve:
    return Curve(
        **_fields(Curve, {"channel": entry} if isinstance(entry, str) else entry, location)
    )


def _reference(entry: object, location: str) -> Reference:
    if isinstance(entry, dict):
        # `from` is a word of the deck but no name in Python
        entry = {"from_" if key == "from" else key: value for key, value in entry.items()}
    reference = Reference(**_fields(Reference, entry, f"{location}, reference"))
    needs = {
        "level": reference.value is not None,
        "band": reference.from_ is not None and reference.to is not None,
        "point": bool(reference.points),
        "curve": len(reference.points) > 1,
        "corridor": min(len(reference.points), len(reference.upper)) > 1,
    }
    if reference.kind not in needs:
        raise unknown("kind of reference", reference.kind, KINDS)
    if not needs[reference.kind]:
        raise PostError(
            f"{location}: reference '{reference.label}': a level needs value, a band from and to, "
            "a point or curve needs points, a corridor points and upper"
        )
    if reference.tolerance is not None and not reference.tolerance >= 0:
        raise PostError(f"{location}: reference '{reference.label}': tolerance is negative")
    if reference.kind == "corridor" and reference.statistic:
        raise PostError(f"{location}: reference '{reference.label}': a corridor takes no statistic")
    if reference.kind != "corridor" and bool(reference.channel) != bool(reference.statistic):
        raise PostError(f"{location}: reference '{reference.label}': channel goes with statistic")
    if reference.statistic and is_a_time(reference.statistic) and not reference.points:
        raise PostError(
            f"{location}: reference '{reference.label}': a time is compared with points"
        )
    return reference


def _fields(record: type, entry: object, location: str) -> Json:
    """The entry's fields, none unknown, none required missing, lists of numbers as tuples."""
    if not isinstance(entry, dict):
        raise PostError(f"{location}: expected fields, found '{entry}'")
    known = {one.name: one for one in fields(record) if not one.metadata.get("inner")}
    for name in entry:
        if name not in known:
            raise unknown("field", str(name), known, whole=location)
    for name, one in known.items():
        if one.default is MISSING and name not in entry:
            raise PostError(f"{location}: '{name}' is missing")
    return {
        name: _typed(value, name, location) for name, value in entry.items() if value is not None
    }


def _typed(value: Any, name: str, location: str) -> object:
    try:
        if name in ("x_range", "y_range", "during", "over"):
            return _pair(value)
        if name in ("points", "upper"):
            return tuple(_pair(point) for point in value)
        if name in ("value", "from_", "to", "tolerance", "x_offset", "y_offset"):
            return float(value)
        if name not in ("y", "reference") and not isinstance(value, str):
            raise TypeError("no text")
    except (TypeError, ValueError, OverflowError) as error:
        raise PostError(f"{location}: '{name}' cannot be {value!r}") from error
    return value


def _pair(value: Any) -> Pair:
    first, second = value
    return float(first), float(second)


def axis_unit(series: Sequence[Series], wanted: str) -> str:
    """The unit of an axis: the requested one, else that of the first series or a multiple of it."""
    if wanted != AUTO:
        return wanted or series[0].unit
    return readable(series[0].unit, max(np.max(np.abs(s.values), initial=0.0) for s in series))
