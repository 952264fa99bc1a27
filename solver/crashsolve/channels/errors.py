"""Errors of questions about channels."""

from collections.abc import Iterable


class ChannelError(ValueError):
    """A channel, expression, statistic or unit that does not exist; the text states the cause, and
    what does.
    """


class TooShort(ChannelError):
    """A history that does not last as long, or has not as many samples, as a function needs."""


def unknown(kind: str, word: str, known: Iterable[str], whole: str = "") -> ChannelError:
    """The error for a word that does not exist in `whole`, with the nearest one that does."""
    names = list(known)
    from difflib import get_close_matches

    near = get_close_matches(word, names, n=1, cutoff=0.5)
    advice = f"; did you mean '{near[0]}'?" if near else ""
    shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    location = f"'{whole}': " if whole and whole != word else ""
    return ChannelError(f"{location}unknown {kind} '{word}'{advice} (known: {shown or 'none'})")
