"""Expected size of the output of a run, reported before it, and refused where the disk is too
small.
"""

from collections.abc import Iterable
from pathlib import Path

from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.errors import DeckError
from crashsolve.output.blocks import Block
from crashsolve.output.channels import Family
from crashsolve.output.size import free_space, history_size, in_words, states_size
from crashsolve.recording.sampling import Schedule

# beyond, the times of two samples may be the same number
MAX_SAMPLES = 2.0**53


def expected_size(
    deck: Deck, families: Iterable[Family], blocks: Iterable[Block], folder: Path
) -> str:
    """Size of the history, and of the states if blocks are known, in words.

    Raises DeckError where they exceed the free space on the disk of the folder, and where there
    are more samples than numbers.
    """
    schedule = Schedule.of(deck)
    span = schedule.end - schedule.start
    if not span / schedule.interval < MAX_SAMPLES:
        message = f"{span:.3g} s at {schedule.interval:.3g} s have too many samples to be numbered"
        advice = "give a longer output.history.interval, or an earlier control.end_time"
        raise DeckError(str(deck.path), None, None, "output.history", message, advice)
    samples = schedule.number(schedule.end) + 1
    interval = deck.output.states.interval or span / 50 or 1.0
    families = tuple(families)
    history = history_size(families, samples)
    states = states_size(blocks, int(min(span / interval + 2, samples)))
    chosen = ""
    if deck.output.history.channels:
        count = sum(len(family.ids) * len(family.columns) for family in families)
        chosen = f" of {count} channels, by output.history.channels"
    noun = "sample" if samples == 1 else "samples"
    text = f"history of {samples:.4g} {noun}{chosen}: {in_words(history)}"
    text += f"; states: {in_words(states)}" if states else ""
    free = free_space(folder)
    if history + states > free:
        worst = "history" if history >= states else "states"
        message = f"{text}; {in_words(free)} are free on the disk of {folder}"
        advice = f"give a longer output.{worst}.interval"
        raise DeckError(str(deck.path), None, None, f"output.{worst}", message, advice)
    return text
