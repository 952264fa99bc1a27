"""What crashpost says when it cannot do what was asked."""

from collections.abc import Iterable
from difflib import get_close_matches


class PostError(Exception):
    """A request that cannot be met: its text says why and what would work."""

    exit_code = 2


def unknown(kind: str, word: str, known: Iterable[str], whole: str = "") -> PostError:
    """The error for a word that does not exist in `whole`, with the nearest one that does."""
    names = list(known)
    near = get_close_matches(word, names, n=1, cutoff=0.5)
    advice = f"; did you mean '{near[0]}'?" if near else ""
    shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    place = f"'{whole}': " if whole and whole != word else ""
    return PostError(f"{place}unknown {kind} '{word}'{advice} (known: {shown or 'none'})")
