"""The phases of a run: which follow each other, and when each one ends."""

from importlib import import_module
from types import ModuleType
from typing import NamedTuple

from crashsolve.deck.building import Columns, DeckOfScene, Scene


class Phase(NamedTuple):
    """A stretch of the run's time [s], with the module of its type and its card."""

    name: str
    module: ModuleType
    p: Columns
    end: float


def build_phases(deck: DeckOfScene, scene: Scene) -> list[Phase]:
    """Phases in the order of the deck; none where the run is one. Writes: scene.errors."""
    control, entries = deck.control, list(deck.entries["phases"].values())
    phases, begun = [], control.start_time
    for number, entry in enumerate(entries, start=1):
        is_last, given = number == len(entries), entry.card.end_time
        with scene.building(entry):
            if control.solution != "transient":
                raise scene.fail("a quasi-static solution has no phases; set solution: transient")
            if is_last and given is not None:
                raise scene.fail(
                    f"the last phase ends with the run, at {control.end_time:g} s; leave it out",
                    "end_time",
                )
            if not is_last and given is None:
                raise scene.fail("another phase follows: give end_time, at which this one ends")
            end = control.end_time if given is None else given
            if not begun < end <= control.end_time or (end == control.end_time and not is_last):
                bounds = f"between {begun:g} s, where the phase begins, and {control.end_time:g} s"
                raise scene.fail(
                    f"must lie {bounds}, where the run ends", None if is_last else "end_time"
                )
            module = import_module(entry.module_name)
            phases.append(Phase(entry.name, module, module.build(entry.card, scene), end))
            begun = end
    return phases
