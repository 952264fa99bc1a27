"""Figures for a result whose deck asks for none: energies, balance, momenta, one per family."""

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase

import numpy as np

from crashpost import ledger
from crashpost.answer import answer
from crashpost.choice import Choice
from crashpost.errors import PostError
from crashpost.figure import AUTO, Curve, Figure, Reference, axis_unit
from crashpost.result import Column, Family, Result
from crashsolve.channels.statistic import is_a_time, is_of_a_moment, moment_asked

MOST_CURVES = 8
# what is worth a look, by the first word of the channels; where it rests, what moves
WORTH = {"rbdout": ("velocity",), "nodout": ("acceleration",), "disbout": ("distance", "angle")}
FORCES = ("force", "torque")


def energy_figures(result: Result) -> list[Figure]:
    """Energies of the model and what is missing from their sum."""
    figures = []
    curves = tuple(Curve(e.channel.name, e.label) for e in _visible(ledger.energies(result)))
    if curves:
        figures.append(_over_time("Energies", curves, "energy"))
    if balance := ledger.balance_channel(result):
        curves = (Curve(balance, "energy balance"),)
        figures.append(_over_time("Energy balance", curves, "missing over the largest energy", "%"))
    return figures


def _visible(entries: list[ledger.Entry]) -> list[ledger.Entry]:
    """The largest, without those that never reach a thousandth of it: they cannot be seen."""
    sizes = sorted((entry.largest for entry in entries), reverse=True)
    least = max([sizes[0] / 1000, *sizes[MOST_CURVES : MOST_CURVES + 1]]) if sizes else 0.0
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


def family_figures(result: Result) -> list[Figure]:
    """For each family but glstat, a quantity that moves, in the entities that move most."""
    families = [family for family in result.families.values() if family.name != "glstat"]
    figures = [_family_figure(result, family) for family in families]
    return [figure for figure in figures if figure]


def _over_time(
    title: str, curves: tuple[Curve, ...], y_label: str = "", y_unit: str = AUTO
) -> Figure:
    return Figure(title, curves, x_unit=AUTO, y_unit=y_unit, y_label=y_label)


def _family_figure(result: Result, family: Family) -> Figure | None:
    if not len(result.time):
        return None
    quantities = dict.fromkeys(column.path.split("/")[0] for column in family.columns)
    worth = WORTH.get(family.word, FORCES)
    for quantity in sorted(quantities, key=lambda name: name not in worth):
        columns = [c for c in family.columns if c.path.split("/")[0] == quantity]
        columns = [c for c in columns if c.unit == columns[0].unit]
        ranges = _ranges(result, family, columns)
        moving = sorted((name for name in ranges if ranges[name] > 0), key=lambda n: -ranges[n])
        if moving:
            chosen = [name for name in ranges if name in moving[:MOST_CURVES]]
            curves = tuple(Curve(name) for name in chosen)
            return _over_time(f"{family.name}: {quantity.replace('_', ' ')}", curves)
    return None


def _ranges(result: Result, family: Family, columns: list[Column]) -> dict[str, float]:
    """Greatest minus least value of every channel of the columns, entity by entity."""
    ranges = np.array([np.ptp(result.block(family, column), axis=0) for column in columns])
    return {
        f"{family.word}.{entity}.{column.name}": float(ranges[c, e])
        for e, entity in enumerate(family.ids)
        for c, column in enumerate(columns)
    }


def panels(
    result: Result, choices: Sequence[Choice], against: str, units: Mapping[str, str]
) -> list[Figure]:
    """The channels as figures, one for each unit, against time or another channel.

    The statistic of a choice is told in the legend, and marked where it is a value of the channel.
    """
    channels = list(dict.fromkeys(choice.channel for choice in choices))
    for name in units:
        if not any(_is_meant(name, channel) for channel in (against, *channels)):
            raise PostError(f"--unit names '{name}', which is not drawn")
    groups: dict[str, list[str]] = {}
    for channel in channels:
        unit = _wanted(units, channel) or result.series(channel).unit
        groups.setdefault(unit, []).append(channel)
    return [_panel(result, unit, group, choices, against, units) for unit, group in groups.items()]


def _is_meant(name: str, channel: str) -> bool:
    """Whether a name or pattern is that of a channel."""
    return name == channel or fnmatchcase(channel, name)


def _wanted(units: Mapping[str, str], channel: str) -> str:
    """The unit in which a channel is to be shown; "" for any."""
    return next((unit for name, unit in units.items() if _is_meant(name, channel)), "")


def _panel(
    result: Result,
    unit: str,
    group: Sequence[str],
    choices: Sequence[Choice],
    against: str,
    units: Mapping[str, str],
) -> Figure:
    """The figure of the channels of one unit."""
    y_unit = unit if any(_wanted(units, channel) for channel in group) else AUTO
    x_unit, marks = _wanted(units, against) or AUTO, list[Reference]()
    asked = [choice for choice in choices if choice.statistic and choice.channel in group]
    if asked:
        # marks are in the units of the axes, which must be known
        y_unit = axis_unit([result.series(channel) for channel in group], y_unit)
        x_unit = axis_unit([result.series(against)], x_unit)
        marks = [_mark(result, choice, against, (x_unit, y_unit)) for choice in asked]
    title = ", ".join(group)
    curves = tuple(map(Curve, group))
    return Figure(title, curves, x=against, x_unit=x_unit, y_unit=y_unit, reference=tuple(marks))


def _mark(result: Result, choice: Choice, against: str, units: tuple[str, str]) -> Reference:
    """A level at a statistic, or a point where it is a moment or measures something else."""
    channel, word = choice
    series, found = result.series(channel), answer(result, channel, word)
    is_value = found.unit == series.unit
    if is_value:
        found = answer(result, channel, word, None, units[1])
    elif is_a_time(word) and against == "time":
        found = answer(result, channel, word, None, units[0])
    number = f"{word} {found.value:.5g} {found.unit}".rstrip()
    if is_value and not is_of_a_moment(word):
        return Reference(number, value=found.value)
    moment = result.value(channel, word) if is_a_time(word) else moment_asked(word)
    moment = float(series.time[-1]) if moment is None else moment
    at = f"at:{moment!r}"
    x, y = answer(result, against, at, None, units[0]), answer(result, channel, at, None, units[1])
    return Reference(number, "point", points=((x.value, y.value),))
