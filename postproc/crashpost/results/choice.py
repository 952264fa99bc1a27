"""Channels as every command takes them: names, shell patterns and expressions, with a statistic.

rcforc.left.force.normal    rcforc.*.force.x    -rbdout.a.velocity.x    rcforc.left.force.x:max
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

from crashpost.errors import PostError
from crashpost.results.history import History
from crashsolve.channels.statistic import check

PATTERN = frozenset("*?[")
# a word with one of these is arithmetic, with stars or without
ARITHMETIC = frozenset(" /+(,")


def plain(name: str) -> str:
    """A channel's name as an expression holds it: in quotes where it has other characters."""
    return name if re.fullmatch(r"[A-Za-z_][\w.]*", name) else f"'{name}'"


class Choice(NamedTuple):
    """A channel or expression, and the word of a statistic; "" where none was given."""

    channel: str
    statistic: str = ""


def choices(result: History, words: Sequence[str]) -> list[Choice]:
    """The channels and statistics that words name, each once and in order; raises PostError for a
    word that names none.
    """
    selected: dict[Choice, None] = {}
    for word in words:
        channel, _, statistic = word.strip().partition(":")
        if statistic:
            check(statistic)
        selected |= dict.fromkeys(Choice(name, statistic) for name in _fitting(result, channel))
    return list(selected)


def channels(result: History, words: Sequence[str]) -> list[str]:
    """The channels that words name, where statistics have no meaning; raises PostError for one."""
    selected = choices(result, words)
    for choice in selected:
        if choice.statistic:
            name = f"{choice.channel}:{choice.statistic}"
            raise PostError(f"'{name}': leave out the statistic; whole histories are taken")
    return [choice.channel for choice in selected]


def _fitting(result: History, word: str) -> list[str]:
    """The channels that fit a word, or the expression it is; raises PostError."""
    if result.has(word):
        return [word]
    names = [channel.name for channel in result.channels(word)] if PATTERN & set(word) else []
    if names:
        return names
    try:
        result.series(word)
    except PostError:
        if PATTERN & set(word) and not ARITHMETIC & set(word):
            raise PostError(f"no channel fits '{word}'; see `crashpost channels`") from None
        raise
    return [word]
