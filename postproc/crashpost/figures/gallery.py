"""The figures of a crash engineer, for a result whose deck asks for none, each by its word.

force gap force_displacement crush injury     where there are contacts, crush curves and heads
motion                                        one for each other family of channels
energy momentum                               of the whole model
"""

from collections.abc import Callable, Sequence

import numpy as np

from crashpost.results import ledger
from crashpost.results.choice import plain
from crashpost.results.result import Column, Family, Result
from crashpost.values import injury, words
from crashpost.values.figure import AUTO, Curve, Figure
from crashsolve.channels.display import factor, readable

MAX_CURVES = 8
# names of families in titles; others have their own name
FAMILIES = {
    "rbdout": "Bodies",
    "nodout": "Accelerometers and nodes",
    "deforc": "Springs",
    "jntforc": "Joints",
    "rcforc": "Contacts",
    "bndout": "Loads",
    "disbout": "Distances",
    "matsum": "Parts",
    "elout": "Elements",
    "secforc": "Sections",
    "hinge": "Plastic hinges",
}
# force or moment over stroke or angle of crushable parts: first word of channels, then columns
CRUSHES = (
    ("deforc", "elongation", "force"),
    ("deforc", "length", "force"),
    ("deforc", "angle", "moment"),
    ("hinge", "angle", "moment"),
)
# quantities shown, by the first word of the channels; where they are constant, those that change
IMPORTANCE = {
    "rbdout": ("velocity",),
    "nodout": ("acceleration",),
    "disbout": ("distance", "angle"),
    "matsum": ("plastic", "strain"),
    "hinge": ("moment",),
}
# of the largest value in the same unit, and of the largest range: less is round-off, and unseen
ROUND_OFF, UNSEEN = 1e-9, 1e-3
FORCES = ("force", "torque")


def energy_figures(result: Result) -> list[Figure]:
    """Energies of the model and the error of their sum."""
    figures = []
    curves = tuple(Curve(e.channel.name, e.label) for e in _visible(ledger.energies(result)))
    if curves:
        figures.append(_over_time("Energies", curves, "energy"))
    if balance := ledger.balance_channel(result):
        curves = (Curve(balance, "energy balance"),)
        figures.append(_over_time("Energy balance", curves, "imbalance over largest energy", "%"))
    return figures


def _visible(entries: list[ledger.Entry]) -> list[ledger.Entry]:
    """The largest, without those that never reach a thousandth of it: they cannot be seen."""
    sizes = sorted((entry.largest for entry in entries), reverse=True)
    least = max([sizes[0] / 1000, *sizes[MAX_CURVES : MAX_CURVES + 1]]) if sizes else 0.0
    return [entry for entry in entries if entry.largest > least]


def momentum_figures(result: Result) -> list[Figure]:
    """Momentum and angular momentum, when they are not zero throughout."""
    figures = []
    kinds = {"Momentum": ledger.MOMENTUM, "Angular momentum": ledger.ANGULAR_MOMENTUM}
    for title, unit in kinds.items():
        entries = _visible(ledger.momenta(result, unit))
        curves = tuple(Curve(e.channel.name, e.label) for e in entries)
        if curves:
            figures.append(_over_time(title, curves, title.lower()))
    return figures


def named(result: Result, word: str) -> list[Figure]:
    """The figures of a word of KINDS, none where the result has nothing to show in them."""
    return KINDS[word](result) if len(result.time) else []


def default_figures(result: Result) -> list[Figure]:
    """All but energies and momenta, in the order in which an engineer asks."""
    return [figure for word in DEFAULT for figure in named(result, word)]


def family_figures(result: Result) -> list[Figure]:
    """For each family but glstat, a quantity that moves, in the entities that move most."""
    families = [family for family in result.families.values() if family.name != "glstat"]
    figures = [_family_figure(result, family) for family in families]
    return [figure for figure in figures if figure]


def force_figures(result: Result) -> list[Figure]:
    """Contact forces over time."""
    contacts = _contacts(result, "normal")
    names = _largest(result, contacts)
    curves = tuple(Curve(name) for name in names)
    if not names:
        return []
    return [_over_time(_among(words.title(names), names, contacts), curves, "contact force")]


def gap_figures(result: Result) -> list[Figure]:
    """The smallest gap of every contact over time, negative where it touches."""
    contacts = _contacts(result, "depth")
    names = _moving(result, contacts)
    if not names:
        return []
    labels = words.labels(names) if len(names) > 1 else [words.entity(names[0])]
    curves = tuple(Curve(f"-{plain(n)}", label) for n, label in zip(names, labels, strict=True))
    title = "Smallest gap" if len(names) > 1 else f"{labels[0]}: smallest gap"
    title = _among(title, names, contacts)
    return [_over_time(title, curves, "gap, negative in contact")]


def force_displacement_figures(result: Result) -> list[Figure]:
    """Contact force over penetration, of contacts with one pair: of more, pairs differ in both."""
    known = [name.removesuffix("depth") + "normal" for name in _contacts(result, "depth")]
    single = [name for name in known if _is_single(result, name)]
    names = _largest(result, single)
    depths = [name.removesuffix("normal") + "depth" for name in names]
    if not names:
        return []
    deepest = max(result.span(depth)[1] for depth in depths)
    if not deepest > 0:
        return []
    unit = readable("m", deepest)
    labels = words.labels(names) if len(names) > 1 else [words.entity(names[0])]
    curves = tuple(map(Curve, names, labels, depths))
    return [
        Figure(
            _among("Contact force over penetration", names, single),
            curves,
            x=depths[0],
            x_unit=unit,
            y_unit=AUTO,
            x_label="penetration",
            y_label="contact force",
            # before contact the depth is a gap, which has its own figure
            x_range=(0.0, 1.05 * deepest * factor("m", unit)),
        )
    ]


def _is_single(result: Result, normal: str) -> bool:
    """Whether a contact never has more than one pair that touches, as far as is known."""
    touching = normal.removesuffix("normal") + "touching"
    if not result.has(touching):
        return not result.chosen_channels
    return result.span(touching)[1] <= 1.0


def crush_figures(result: Result) -> list[Figure]:
    """Force over stroke, and moment over angle, of springs, hinges and parts that yield."""
    figures = [f for kind in CRUSHES for f in [_crush_figure(result, *kind)] if f]
    return figures + _part_figures(result)


def _part_figures(result: Result) -> list[Figure]:
    """Contact forces over the travel of the body that moves most, where a part yields."""
    plastic = [f"matsum.{e}.plastic" for f in _families(result, "matsum") for e in f.ids]
    known = [name for name in plastic if result.has(name)]
    forces = _largest(result, _contacts(result, "normal"))
    candidates = [
        name
        for f in _families(result, "rbdout")
        for e in f.ids
        for name in (f"rbdout.{e}.position.{axis}" for axis in "xyz")
        if result.has(name)
    ]
    if not _largest(result, known) or not forces or not candidates:
        return []
    channel = max(candidates, key=lambda name: _range(result, name))
    start = float(result.series(channel).values[0])
    stroke = f"abs({plain(channel)} - '{start!r} m')"
    labels = words.labels(forces) if len(forces) > 1 else [words.entity(forces[0])]
    body = words.entity(channel)
    return [
        Figure(
            f"Contact force over travel of {body}",
            tuple(map(Curve, forces, labels)),
            x=stroke,
            x_unit=AUTO,
            y_unit=AUTO,
            x_label=f"travel of {body} along {channel[-1]}",
            y_label="contact force",
        )
    ]


def _crush_figure(result: Result, family: str, stroke: str, force: str) -> Figure | None:
    names = [
        f"{one.word}.{entity}.{force}"
        for one in result.families.values()
        if one.word == family
        and {stroke, force} <= {column.name for column in one.columns}
        # a spring with an elongation is not shown over its length as well
        and not (stroke == "length" and any(c.name == "elongation" for c in one.columns))
        for entity in one.ids
    ]
    every, names = names, _largest(result, names)
    if not names:
        return None
    strokes = [name.removesuffix(force) + stroke for name in names]
    labels = words.labels(names) if len(names) > 1 else [words.entity(names[0])]
    title = _among(f"{FAMILIES[family]}: {force} over {stroke}", names, every)
    curves = tuple(map(Curve, names, labels, strokes))
    return Figure(
        title, curves, x=strokes[0], x_unit=AUTO, y_unit=AUTO, x_label=stroke, y_label=force
    )


def _contacts(result: Result, column: str) -> list[str]:
    """A channel of every contact, where the run wrote it."""
    names = [f"rcforc.{e}.{column}" for f in _families(result, "rcforc") for e in f.ids]
    return [name for name in names if result.has(name)]


def _families(result: Result, word: str) -> list[Family]:
    return [family for family in result.families.values() if family.word == word]


def _largest(result: Result, names: Sequence[str]) -> list[str]:
    """The channels with the largest magnitudes, in their order; none that is zero throughout."""
    sizes = {name: max(map(abs, result.span(name))) for name in names}
    most = sorted((n for n in sizes if sizes[n] > 0), key=lambda n: -sizes[n])[:MAX_CURVES]
    return [name for name in names if name in most]


def _moving(result: Result, names: Sequence[str]) -> list[str]:
    """The channels with the largest ranges, in their order; none that is constant."""
    ranges = {name: _range(result, name) for name in names}
    most = sorted((n for n in ranges if ranges[n] > 0), key=lambda n: -ranges[n])[:MAX_CURVES]
    return [name for name in names if name in most]


def _among(title: str, shown: Sequence[str], every: Sequence[str]) -> str:
    """The title of a figure, with the number of channels where not all are shown."""
    if len(shown) < MAX_CURVES or len(every) == len(shown):
        return title
    return f"{title}, the {len(shown)} largest of {len(every)}"


def _range(result: Result, name: str) -> float:
    """Greatest less least value of a channel."""
    least, greatest = result.span(name)
    return greatest - least


def motion_figures(result: Result) -> list[Figure]:
    """One for each family that has no figure of its own here."""
    families = [f for f in result.families.values() if f.word not in ("glstat", "rcforc")]
    figures = [figure for family in families if (figure := _family_figure(result, family))]
    sizes = [_size(result, figure) for figure in figures]
    forces = [result.span(name)[1] for name in _contacts(result, "normal")]
    scale: dict[str, float] = {"N": max(forces, default=0.0)}
    for size, unit in sizes:
        scale[unit] = max(scale.get(unit, 0.0), size)
    sized = zip(figures, sizes, strict=True)
    return [figure for figure, (size, unit) in sized if size > ROUND_OFF * scale[unit]]


def _size(result: Result, figure: Figure) -> tuple[float, str]:
    """The largest magnitude in a figure, with its unit."""
    series = [result.series(curve.channel) for curve in figure.y]
    return max(float(np.max(np.abs(one.values))) for one in series), series[0].unit


def _over_time(
    title: str, curves: tuple[Curve, ...], y_label: str = "", y_unit: str = AUTO
) -> Figure:
    return Figure(title, curves, x_unit=AUTO, y_unit=y_unit, y_label=y_label)


def _family_figure(result: Result, family: Family) -> Figure | None:
    if not len(result.time):
        return None
    quantities = dict.fromkeys(column.path.split("/")[0] for column in family.columns)
    importance = IMPORTANCE.get(family.word, FORCES)
    for quantity in sorted(
        quantities, key=lambda q: importance.index(q) if q in importance else len(importance)
    ):
        columns = [c for c in family.columns if c.path.split("/")[0] == quantity]
        columns = [c for c in columns if c.unit == columns[0].unit]
        ranges = _ranges(result, family, columns)
        least = UNSEEN * max(ranges.values(), default=0.0)
        moving = sorted((name for name in ranges if ranges[name] > least), key=lambda n: -ranges[n])
        if moving:
            chosen = [name for name in ranges if name in moving[:MAX_CURVES]]
            shared = words.quantity_of_all(chosen)
            what = FAMILIES.get(family.word, words.capital(family.name))
            title = f"{what}: {shared or quantity.replace('_', ' ')}"
            return _over_time(_among(title, chosen, moving), tuple(map(Curve, chosen)))
    return None


def _ranges(result: Result, family: Family, columns: list[Column]) -> dict[str, float]:
    """Greatest minus least value of every channel of the columns, entity by entity."""
    spans = [result.extremes(family, column) for column in columns]
    ranges = np.array([one.greatest - one.least for one in spans])
    return {
        f"{family.word}.{entity}.{column.name}": float(ranges[c, e])
        for e, entity in enumerate(family.ids)
        for c, column in enumerate(columns)
    }


KINDS: dict[str, Callable[[Result], list[Figure]]] = {
    "force": force_figures,
    "gap": gap_figures,
    "force_displacement": force_displacement_figures,
    "crush": crush_figures,
    "injury": injury.injury_figures,
    "motion": motion_figures,
    "energy": energy_figures,
    "momentum": momentum_figures,
}
DEFAULT = ("force", "gap", "force_displacement", "crush", "injury", "motion")
