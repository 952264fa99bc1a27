"""Checks that the channels named in a deck are among those of its run.

They are those of expect and watch, of the figures of its report, and of the times of its scenes.
Names, units and the sampling that a function needs are checked; a run may still be too short.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from fnmatch import fnmatchcase

import numpy as np

from crashsolve.channels.display import is_convertible
from crashsolve.channels.errors import TooShort
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import requested_moment, unit_of
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.run_cards.expect import Expect
from crashsolve.deck.run_cards.statistic import PATH
from crashsolve.deck.run_cards.watch import Watch
from crashsolve.deck.source import Position
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.output.channels import Family
from crashsolve.recording.samples import Channel, Samples, find
from crashsolve.recording.sampling import Schedule

# samples on which expressions are tried out before the run
TRIAL_SAMPLES = 256


def look_up(deck: Deck, families: Sequence[Family]) -> dict[str, list[Channel]]:
    """The channels of every expression of expect and watch. Raises DeckErrors."""
    channels_of: dict[str, list[Channel]] = {}
    diagnostics, interval = [], Schedule.of(deck).interval
    sections: list[tuple[str, Sequence[Expect | Watch], list[Position]]] = [
        ("expect", deck.expect, deck.expect_at),
        ("watch", deck.watch, deck.watch_at),
    ]
    for keyword, cards, locations in sections:
        for number, (card, location) in enumerate(zip(cards, locations, strict=True), 1):
            for problem in _problems_of(card, families, channels_of, deck):
                diagnostics.append(DeckError(*location, f"{keyword} {number}", problem))
    for where, expression in _of_report(deck):
        try:
            if not _fits_some(expression, families):
                _evaluate_on_trial(expression, find(expression, families), interval)
        except ValueError as problem:
            message = f"output: report: {where}"
            diagnostics.append(
                DeckError(str(deck.path), None, None, message, f"channel: {problem}")
            )
    if diagnostics:
        raise DeckErrors(diagnostics)
    return channels_of


def _of_report(deck: Deck) -> Iterator[tuple[str, str]]:
    """Figures and scenes of the report by their titles, each with a channel it asks for."""
    report = deck.output.report
    if report is None:
        return
    for figure in report.figures:
        requested = [figure.x, *(x for curve in figure.y for x in (curve.channel, curve.x))]
        requested += [reference.channel for reference in figure.reference]
        for channel in requested:
            if channel not in ("", "time"):
                yield f"figure '{figure.title}'", channel
    for scene in report.scenes:
        for moment in scene.at:
            kind, _, channel = moment.partition(":")
            if kind in ("max", "min", "abs_max") and channel:
                yield f"scene '{scene.title}'", channel.strip()


def channels_of_report(deck: Deck, families: Sequence[Family]) -> set[str]:
    """Names of the channels that the figures and scenes of the report need, all of which exist."""
    names = set[str]()
    for _, expression in _of_report(deck):
        if _fits_some(expression, families):
            every = (name for family in families for name in family.channels())
            names.update(name for name in every if fnmatchcase(name, expression))
        else:
            names.update(channel.name for channel in find(expression, families))
    return names


def _fits_some(pattern: str, families: Sequence[Family]) -> bool:
    """Whether a pattern such as rcforc.*.normal is that of a channel."""
    if not set("*?[") & set(pattern):
        return False
    return any(fnmatchcase(name, pattern) for family in families for name in family.channels())


def _problems_of(
    card: Expect | Watch,
    families: Sequence[Family],
    channels_of: dict[str, list[Channel]],
    deck: Deck,
) -> Iterator[str]:
    """Errors of a card, by its fields; adds its channels to `channels_of`."""
    start = deck.control.start_time
    try:
        channels_of[card.channel] = find(card.channel, families)
        tried = _evaluate_on_trial(
            card.channel, channels_of[card.channel], Schedule.of(deck).interval
        )
        if tried is not None and isinstance(card, Expect) and card.unit:
            unit = unit_of(card.statistic, tried.unit)
            if not is_convertible(card.unit, unit):
                yield f"value: is in {card.unit}, but '{card.statistic}' of the channel in {unit}"
    except ValueError as problem:
        yield f"channel: {problem}"
    moment = None if card.statistic == PATH else requested_moment(card.statistic)
    if moment is not None and moment < start:
        yield f"statistic: '{card.statistic}' is before the run, from {start:g} s on"


def _evaluate_on_trial(
    expression: str, channels: Sequence[Channel], interval: float
) -> Series | None:
    """Evaluate the expression on trial samples; None where they are too few for it.

    Raises ChannelError where units do not fit, or samples are too far apart for a function.

    The run may still be too short for a function, which its results report.
    """
    count = np.arange(TRIAL_SAMPLES)
    values = {c.name: 1.0 + 0.1 * np.cos(count + i) for i, c in enumerate(channels)}
    samples = Samples(interval * count, values, units={c.name: c.unit for c in channels})
    with suppress(TooShort):
        return samples.series(expression)
    return None
