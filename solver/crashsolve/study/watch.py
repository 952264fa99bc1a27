"""The watched channels of a study, and asking the results of its runs for them.

`crashpost values` answers, in a process of its own: the result files are the contract.
"""

import json
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import NamedTemporaryFile

from crashsolve.channels.errors import ChannelError
from crashsolve.channels.series import Window
from crashsolve.channels.statistic import check, requested_moment, unit_of, words
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.run_cards.expect import Expect
from crashsolve.deck.run_cards.statistic import PATH
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError
from crashsolve.output.files import Json
from crashsolve.recording.sampling import Schedule

KNOWN = ("exact", "published")
_COMPONENT = re.compile(r"[\w.-]+\.[xyz]")


@dataclass(frozen=True)
class Watch:
    """A statistic of a channel, or the largest of several channels', and its value where known."""

    name: str
    channels: tuple[str, ...]
    statistic: str
    during: Window | None = None
    unit: str | None = None
    value: float | None = None
    because: str = ""

    def questions(self) -> list[Json]:
        """Questions to a result."""
        common = {"statistic": self.statistic, "during": self.during, "unit": self.unit}
        requested = [{"channel": channel, **common} for channel in self.channels]
        if self.vector:
            requested.append({"channel": self.vector, "statistic": "max", "unit": self.unit})
        return requested

    @property
    def vector(self) -> str:
        """Magnitude of the vector that a plain channel is a component of; empty for others."""
        (channel, *more) = self.channels
        # a number in another unit is no share of the vector's size
        is_other = self.statistic != PATH and unit_of(self.statistic, "m") != "m"
        if more or is_other or not _COMPONENT.fullmatch(channel):
            return ""
        return "norm(" + ", ".join(f"'{channel[:-1]}{axis}'" for axis in "xyz") + ")"


def watched(deck: Deck, words: Sequence[str]) -> list[Watch]:
    """The requested channels, else those that the deck names, else its energies and motion.

    Raises DeckError for a statistic that does not exist.
    """
    expected = named(deck)
    if not words:
        return expected or overall(deck)
    known = {(w.channels[0], w.statistic): w for w in reversed(expected) if not w.during}
    watches = [_from_word(word) for word in words]
    for watch, word in zip(watches, words, strict=True):
        _refuse_unsampled(deck, watch, word)
    return [known.get((w.channels[0], w.statistic), w) for w in watches]


def _refuse_unsampled(deck: Deck, watch: Watch, word: str) -> None:
    """Raises DeckError for a moment at which no run has a sample: it would have to be guessed."""
    moment = None if watch.statistic == PATH else requested_moment(watch.statistic)
    if moment is None or Schedule.of(deck).has(moment):
        return
    entry = f"watch: [{{channel: {json.dumps(watch.channels[0])}, statistic: {watch.statistic}}}]"
    advice = f"write {entry} into the deck, and every run samples that time"
    raise DeckError(
        f"--channel {word}", None, None, "", f"the runs have no sample at {moment:g} s", advice
    )


def named(deck: Deck) -> list[Watch]:
    """Channels that the deck expects and watches, each once."""
    expected = [_expected(card) for card in deck.expect]
    watches = [
        Watch(
            _name(card.channel, card.statistic, card.during),
            (card.channel,),
            card.statistic,
            card.during,
        )
        for card in deck.watch
    ]
    return list(dict.fromkeys([*expected, *watches]))


def overall(deck: Deck) -> list[Watch]:
    """Numbers that every deck has, and that converge where single paths do not."""
    energies = ["energy.kinetic", "mechanical"]
    energies += ["energy.contact_dissipated"] if deck.entries["contacts"] else []
    watches = [_plain(f"glstat.model.{energy}", "final") for energy in energies]
    for contact in deck.entries["contacts"]:
        parts = ", ".join(f"'rcforc.{contact}.impulse.{axis}'" for axis in "xyz")
        watches.append(Watch(f"impulse of {contact}", (f"norm({parts})",), "final"))
    bodies = [
        "norm(" + ", ".join(f"'rbdout.{body}.velocity.{axis}'" for axis in "xyz") + ")"
        for body in deck.entries["bodies"]
    ]
    if bodies:
        watches.append(Watch("largest speed of a body", tuple(bodies), "max"))
    return watches


def ask(folder: Path, watches: Sequence[Watch]) -> list[Json]:
    """The answer of a results folder for each watch: {value, unit, time} or {problem}."""
    with NamedTemporaryFile("w", suffix=".json", encoding="utf-8") as file:
        json.dump([question for watch in watches for question in watch.questions()], file)
        file.flush()
        done = subprocess.run(
            [sys.executable, "-m", "crashpost", "values", str(folder), file.name],
            capture_output=True,
            text=True,
        )
    if done.returncode != 0:
        problem = done.stderr.strip().splitlines()[-1:] or ["crashpost failed"]
        return [{"problem": problem[0]} for _ in watches]
    answers = iter(json.loads(done.stdout))
    return [_answer(watch, answers) for watch in watches]


def _answer(watch: Watch, answers: Iterator[Json]) -> Json:
    """The answer for one watch, with the size of the vector around its channel, if any."""
    reply = _largest([next(answers) for _ in watch.channels])
    if watch.vector:
        size = next(answers)
        reply |= {"size": size["value"]} if "value" in size else {}
    return reply


def _largest(answers: list[Json]) -> Json:
    """The one answer; of several the one with the largest value, or with a problem."""
    problems = [answer for answer in answers if "problem" in answer]
    if problems or len(answers) == 1:
        return (problems or answers)[0]
    return max(answers, key=lambda answer: float(answer["value"]))


def _expected(card: Expect) -> Watch:
    name = _name(card.channel, card.statistic, card.during)
    is_known = card.because in KNOWN
    return Watch(
        name,
        (card.channel,),
        card.statistic,
        card.during,
        card.unit,
        card.value if is_known else None,
        card.because if is_known else "",
    )


def _name(channel: str, statistic: str, during: Window | None) -> str:
    window = f" from {during[0]:g} to {during[1]:g} s" if during else ""
    return f"{channel} {statistic}{window}"


def _plain(channel: str, statistic: str) -> Watch:
    return Watch(f"{channel} {statistic}", (channel,), statistic)


def _from_word(word: str) -> Watch:
    """CHANNEL, whose whole history is meant, or CHANNEL:STATISTIC."""
    channel, _, statistic = word.partition(":")
    statistic = statistic or PATH
    try:
        if statistic != PATH:
            check(statistic)
    except ChannelError:
        advice = choices(statistic, (*words(), PATH), "statistics")
        message = f"unknown statistic '{statistic}'"
        raise DeckError(f"--channel {word}", None, None, "", message, advice) from None
    return _plain(channel.strip(), statistic)
