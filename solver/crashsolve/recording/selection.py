"""Channels that a run writes: all, or those that `output.history.channels` names, with what the
deck, the checks of the run and its estimates of errors need.

A watched component of a vector comes with the others, which give its scale, and a largest value so
far with the channel that it follows. Consequence to test: each channel is that of a run
that writes all, to the bit, and estimated errors are the same.
"""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase

from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.words import choices, listed, shortened
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.model.model import Model, State
from crashsolve.output.channels import Family
from crashsolve.recording.histories import MOMENTA, families_of
from crashsolve.recording.questions import channels_of_report, look_up
from crashsolve.recording.samples import needed_for

# families that are always written, but for momenta: energies of the model and of its parts
ALWAYS = ("glstat", "matsum")
# quantities that are always written, as events are found by them: of contacts, and of all others
OF_CONTACTS = ("normal", "peak_normal", "onsets", "first_touch", "last_release")
# motions of bodies, by which a run that estimates errors knows what its samples miss of them
# (simulation/missed_motions.py)
MOTIONS = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")
OF_EVENTS = ("plastic", "plastic_angle", "plastic_strain", "set", "failed", "deleted")


def written_channels(deck: Deck, model: Model, state: State) -> frozenset[str] | None:
    """Names of the channels that a run of the deck writes; None for all.

    Raises DeckErrors for a pattern that fits no channel, and for a channel that does not exist.
    """
    patterns = deck.output.history.channels
    if patterns is None:
        return None
    families = families_of(model, state)
    names = [name for family in families for name in family.channels()]
    written, problems = set[str](), list[DeckError]()
    for pattern in patterns:
        fitting = [name for name in names if fnmatchcase(name, pattern)]
        written.update(fitting)
        if not fitting:
            message = f"channels: '{shortened(pattern)}' fits no channel"
            advice = _advice(pattern, families, names)
            problems.append(
                DeckError(str(deck.path), None, None, "output: history", message, advice)
            )
    if problems:
        raise DeckErrors(problems)
    written.update(name for family in families for name in _always(family))
    watched = [channel for some in look_up(deck, families).values() for channel in some]
    written |= needed_for(watched) | channels_of_report(deck, families)
    if deck.control.estimate != "off" and (deck.watch or deck.expect):
        bodies = (family for family in families if family.word == "rbdout")
        written.update(name for family in bodies for name in _of_quantities(family, MOTIONS))
    return frozenset(written)


def _always(family: Family) -> Iterator[str]:
    """Channels of a family that every run writes."""
    quantities = OF_CONTACTS if family.word == "rcforc" else OF_EVENTS
    if family.word in ALWAYS:
        quantities = tuple(c.quantity for c in family.columns if c.quantity not in MOMENTA)
    return _of_quantities(family, quantities)


def _of_quantities(family: Family, quantities: Sequence[str]) -> Iterator[str]:
    """Channels of some quantities of all entities."""
    for k, column in enumerate(family.columns):
        if column.quantity in quantities:
            yield from (family.channel(entity, k) for entity in range(len(family.ids)))


def _advice(pattern: str, families: Sequence[Family], names: Sequence[str]) -> str:
    """Names near to a pattern that fits none: of families, of entities, of quantities."""
    if any(fnmatchcase(name, f"{pattern}.*") for name in names):
        return f"write '{pattern}.*'"
    word, _, rest = pattern.partition(".")
    entity, _, path = rest.partition(".")
    same = [family for family in families if fnmatchcase(family.word, word)]
    if not same:
        return choices(word, dict.fromkeys(family.word for family in families), "families")
    holders = [f for f in same if any(fnmatchcase(name, entity) for name in f.ids)]
    if not holders:
        return choices(entity, [name for family in same for name in family.ids], "names")
    if path:
        columns = [c.path.replace("/", ".") for family in holders for c in family.columns]
        return choices(path, dict.fromkeys(columns), "quantities")
    from difflib import get_close_matches

    near = get_close_matches(pattern, names, n=3, cutoff=0.3) or names
    return f"a channel is family.name.quantity.component, such as {listed(near[:3])}"
