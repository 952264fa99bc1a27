"""The figures of `crashpost plot`: channels of one or several results, a panel for each unit."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase

import numpy as np

from crashpost.errors import PostError
from crashpost.figures import gallery
from crashpost.results.answer import answer
from crashpost.results.choice import PATTERN, Choice, choices
from crashpost.results.result import Result
from crashpost.results.table import number
from crashpost.values import words
from crashpost.values.figure import AUTO, Curve, Figure, Pair, Reference, axis_unit
from crashpost.values.measured import Measurement
from crashpost.values.units import Units, on_page, page_time_unit
from crashsolve.channels.display import factor, is_convertible
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import is_a_time, is_of_a_moment, requested_moment


@dataclass(frozen=True)
class PlotRequest:
    """Request for figures: channels, axes and units."""

    channels: Sequence[str] = ()
    against: str = "time"
    units: Units = field(default_factory=Units)
    title: str = ""
    log: str = ""
    x_range: Pair | None = None
    y_range: Pair | None = None
    tests: Sequence[Measurement] = ()


def panels(results: Sequence[Result], names: Sequence[str], request: PlotRequest) -> list[Figure]:
    """The figures; `names` are those of the results in legends. Raises PostError.

    Where several results are drawn a channel has a curve for each that has it.
    """
    for result in results:
        if not len(result.time):
            raise PostError(f"{result.folder} holds no samples")
    figures = _requested(results, names, request)
    unit = page_time_unit(_longest(results), figures, request.units)
    drawn = [c for f in figures for c in (f.x, *(curve.channel for curve in f.y))]
    request.units.check_used([*drawn, *(curve.x for f in figures for curve in f.y if curve.x)])
    figures = [on_page(results[figure.y[0].run], figure, request.units, unit) for figure in figures]
    if request.y_range and len(figures) > 1:
        raise PostError(f"--y-range is for one panel, and {len(figures)} are drawn")
    figures = [_limited(figure, request) for figure in figures]
    return _with_tests(results, figures, request.tests)


def _requested(
    results: Sequence[Result], names: Sequence[str], request: PlotRequest
) -> list[Figure]:
    """Standard figures, then one for the channels of each unit; raises PostError without any."""
    kinds = [word for word in request.channels if word in gallery.KINDS]
    chosen = _chosen(results, [word for word in request.channels if word not in gallery.KINDS])
    figures = [f for kind in kinds for f in _kind(results, names, kind)]
    if chosen:
        figures += _by_unit(results, names, chosen, request)
    if not figures:
        raise PostError(f"nothing to draw: no {', '.join(kinds) or 'figure'} in this result")
    return figures


def _longest(results: Sequence[Result]) -> Result:
    return max(results, key=lambda r: float(np.max(np.abs(r.time), initial=0.0)))


def _chosen(results: Sequence[Result], requested: Sequence[str]) -> dict[Choice, list[int]]:
    """The channels, each with the numbers of the results that have it; raises PostError."""
    runs_of: dict[Choice, list[int]] = {}
    problems: list[PostError] = []
    for word in requested:
        fitting = 0
        for run, result in enumerate(results):
            try:
                for choice in choices(result, [word]):
                    runs_of.setdefault(choice, []).append(run)
                    fitting += 1
            except PostError as error:
                # a pattern may fit in some results only, a name must be in all
                if not PATTERN & set(word) or len(results) == 1:
                    prefix = f"{result.folder}: " if len(results) > 1 else ""
                    raise PostError(f"{prefix}{error}") from error
                problems.append(error)
        if not fitting:
            raise problems[-1]
    return {choice: list(dict.fromkeys(runs)) for choice, runs in runs_of.items()}


def _kind(results: Sequence[Result], names: Sequence[str], kind: str) -> list[Figure]:
    """A standard figure; of several results its first curves, each for every result."""
    if len(results) == 1:
        return gallery.named(results[0], kind)
    figures: dict[str, Figure] = {}
    for run, result in enumerate(results):
        for figure in gallery.named(result, kind):
            curves = tuple(
                replace(curve, run=run, label=f"{_curve_label(curve)}, {names[run]}")
                for curve in figure.y
            )
            known = figures.setdefault(figure.title, replace(figure, y=(), reference=()))
            figures[figure.title] = replace(known, y=known.y + curves)
    # limits and units were chosen for one result
    return [
        replace(f, x_range=None, x_unit=AUTO, y_unit=f.y_unit) if f.x != "time" else f
        for f in figures.values()
    ]


def _curve_label(curve: Curve) -> str:
    return curve.label or words.title([curve.channel])


def _by_unit(
    results: Sequence[Result],
    names: Sequence[str],
    chosen: dict[Choice, list[int]],
    request: PlotRequest,
) -> list[Figure]:
    """A figure for the channels of each unit."""
    groups: dict[str, dict[str, list[int]]] = {}
    for choice, runs in chosen.items():
        own = results[runs[0]].series(choice.channel).unit
        for run in runs[1:]:
            other = results[run].series(choice.channel).unit
            if not is_convertible(own, other):
                raise PostError(f"'{choice.channel}' is in '{own}' and in '{other}'")
        group = groups.setdefault(request.units.wanted(choice.channel, own) or own, {})
        group.setdefault(choice.channel, runs)
    return [_panel(results, names, unit, group, chosen, request) for unit, group in groups.items()]


def _panel(
    results: Sequence[Result],
    names: Sequence[str],
    unit: str,
    group: dict[str, list[int]],
    chosen: dict[Choice, list[int]],
    request: PlotRequest,
) -> Figure:
    """The figure of the channels of one unit."""
    first = results[next(iter(group.values()))[0]]
    shown = any(request.units.wanted(channel, unit) for channel in group)
    y_unit = unit if shown else AUTO
    x_unit = request.units.wanted(request.against, first.series(request.against).unit) or AUTO
    if request.against == "time":
        x_unit = page_time_unit(_longest(results), [], request.units)
    requested = [choice for choice in chosen if choice.statistic and choice.channel in group]
    marks = list[Reference]()
    if requested:
        # marks are in the units of the axes, which must be known
        y_unit = axis_unit(
            [results[r].series(c) for c, runs in group.items() for r in runs], y_unit
        )
        x_unit = axis_unit([result.series(request.against) for result in results], x_unit)
        for choice in requested:
            for run in chosen[choice]:
                name = names[run] if len(results) > 1 else ""
                marks.append(_mark(results[run], choice, request.against, (x_unit, y_unit), name))
    legend = words.legend(list(group))
    curves = [
        Curve(channel, _overlaid(label, names[run], len(results), len(group)), run=run)
        for label, (channel, runs) in zip(legend, group.items(), strict=True)
        for run in runs
    ]
    title = request.title or words.title(list(group))
    figure = Figure(title, tuple(curves), x=request.against, x_unit=x_unit, y_unit=y_unit)
    return replace(figure, reference=tuple(marks))


def _overlaid(label: str, name: str, results: int, channels: int) -> str:
    """A curve's name: its differences from the others of its figure."""
    if results == 1:
        return label
    return name if channels == 1 else f"{label}, {name}"


def _mark(
    result: Result, choice: Choice, against: str, units: tuple[str, str], name: str
) -> Reference:
    """A level at a statistic, or a point where it is a moment or measures something else."""
    channel, word = choice
    series, marked = result.series(channel), answer(result, channel, word)
    is_value = marked.unit == series.unit
    if is_value:
        marked = answer(result, channel, word, None, units[1])
    elif is_a_time(word) and against == "time":
        marked = answer(result, channel, word, None, units[0])
    message = f"{word} {marked.value:.5g} {marked.unit}".rstrip() + (f", {name}" if name else "")
    if is_value and not is_of_a_moment(word):
        return Reference(message, value=marked.value)
    moment = result.value(channel, word) if is_a_time(word) else requested_moment(word)
    moment = float(series.time[-1]) if moment is None else moment
    at = f"at:{moment!r}"
    x, y = answer(result, against, at, None, units[0]), answer(result, channel, at, None, units[1])
    return Reference(message, "point", points=((x.value, y.value),))


def _limited(figure: Figure, request: PlotRequest) -> Figure:
    """The figure with the requested axes."""
    for axis in request.log:
        is_x = axis == "x"
        figure = replace(figure, x_scale="log") if is_x else replace(figure, y_scale="log")
    if request.x_range:
        figure = replace(figure, x_range=request.x_range)
    if request.y_range:
        figure = replace(figure, y_range=request.y_range)
    return replace(figure, title=request.title) if request.title else figure


def _with_tests(
    results: Sequence[Result], figures: list[Figure], tests: Sequence[Measurement]
) -> list[Figure]:
    """Measured curves and corridors in every figure whose axes they fit; raises PostError."""
    for test in tests:
        fitting = 0
        for at, figure in enumerate(figures):
            x_unit, y_unit = units_of(results, figure)
            if test.fits(x_unit, y_unit):
                marks = _measured(test, x_unit, y_unit)
                known = replace(figure, x_unit=x_unit, y_unit=y_unit)
                figures[at] = replace(known, reference=(*figure.reference, *marks))
                fitting += 1
        if not fitting:
            heads = ", ".join(f"{c.name} [{c.unit or '-'}]" for c in (test.abscissa, *test.columns))
            raise PostError(f"test '{test.name}' fits no figure drawn; it has {heads}")
    return figures


def units_of(results: Sequence[Result], figure: Figure) -> tuple[str, str]:
    """The units of a figure's axes."""
    xs = [results[curve.run].series(curve.x or figure.x) for curve in figure.y]
    ys = [results[curve.run].series(curve.channel) for curve in figure.y]
    return axis_unit(xs, figure.x_unit), axis_unit(ys, figure.y_unit)


def _measured(test: Measurement, x_unit: str, y_unit: str) -> list[Reference]:
    references = [
        Reference(f"{test.name}: {one.name}", "curve", points=test.points(one, x_unit, y_unit))
        for one in test.curves
        if is_convertible(one.unit, y_unit)
    ]
    if test.corridor and is_convertible(test.corridor[0].unit, y_unit):
        low, high = (test.points(one, x_unit, y_unit) for one in test.corridor)
        references.append(Reference(f"{test.name}: corridor", "corridor", points=low, upper=high))
    return references


def profile(
    result: Result, word: str, along: str, moments: Sequence[float], request: PlotRequest
) -> Figure:
    """Values along an interface: a curve for each moment [s], a point for each entity.

    `word` and `along` are patterns, or expressions with one, such as
    'rbdout.tube_*.position.z - 0.05'. Raises PostError.
    """
    ys, xs = _entities(result, word), _entities(result, along)
    names = [name for name in ys if name in xs]
    if len(names) < 2:
        raise PostError(f"'{word}' and '{along}' share fewer than two entities")
    x_own, y_own = (result.series(channel[names[0]]).unit for channel in (xs, ys))
    moments = list(moments) or [float(result.time[0]), float(result.time[-1])]
    x_all, y_all = (
        np.array([[answer(result, one[n], f"at:{t!r}").value for n in names] for t in moments])
        for one in (xs, ys)
    )
    x_unit, y_unit = (
        axis_unit([Series(np.arange(values.size), values.ravel(), own)], wanted or AUTO)
        for values, own, wanted in (
            (x_all, x_own, request.units.wanted(along, x_own)),
            (y_all, y_own, request.units.wanted(word, y_own)),
        )
    )
    x_all, y_all = x_all * factor(x_own, x_unit), y_all * factor(y_own, y_unit)
    order = np.argsort(x_all[0])
    time_unit = page_time_unit(result, [], request.units)
    x_words, y_words = (
        words.quantity_of_all(list(one.values())) or given
        for one, given in ((xs, along), (ys, word))
    )
    lines = tuple(
        Curve(
            word,
            f"{number(t * factor('s', time_unit))} {time_unit}",
            points=tuple(zip(x[order].tolist(), y[order].tolist(), strict=True)),
        )
        for t, x, y in zip(moments, x_all, y_all, strict=True)
    )
    return Figure(
        request.title or f"{words.capital(y_words)} over {x_words}",
        lines,
        x=along,
        x_unit=x_unit,
        y_unit=y_unit,
        x_label=x_words,
        y_label=y_words,
    )


def _entities(result: Result, word: str) -> dict[str, str]:
    """An expression with a pattern for every entity that fits: {entity: expression}."""
    match = re.search(r"'?\b([a-z]+)\.([^.\s()+/']*[*?\[][^.\s()+/']*)\.([\w.]+)'?", word)
    if match is None:
        raise PostError(f"'{word}' has no pattern of entities, such as rbdout.tube_*.position.z")
    family, pattern, column = match.groups()
    entities = {
        entity: word[: match.start()] + f"'{family}.{entity}.{column}'" + word[match.end() :]
        for one in result.families.values()
        if one.word == family and column in {c.name for c in one.columns}
        for entity in one.ids
        if fnmatchcase(entity, pattern)
    }
    if not entities:
        raise PostError(f"no channel fits '{match[0]}'; see `crashpost channels`")
    bare = word[: match.start()].strip() or word[match.end() :].strip()
    return entities if bare else {e: name.strip("'") for e, name in entities.items()}
