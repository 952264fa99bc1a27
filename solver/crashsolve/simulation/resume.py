"""The settings of a deck that may change at a restart from a dump; what a new run removes."""

from pathlib import Path

import yaml

from crashsolve.output.files import reported
from crashsolve.output.restart import SLOTS

# fields of control that affect the continuation only
FREE_CONTROL = (
    "end_time",
    "step",
    "step_max",
    "step_min",
    "safety",
    "tolerance",
    "onset_tolerance",
    "constraint_tolerance",
    "energy_limit",
    "check_every",
    "estimate",
    "threads",
)
# of them those on which the errors of a run depend
OF_ERRORS = tuple(
    f"control.{name}"
    for name in FREE_CONTROL
    if name not in ("end_time", "energy_limit", "check_every", "estimate", "step_min", "threads")
)
FREE_CARDS = ("title", "output", "watch", "expect")
FREE = f"{', '.join(FREE_CARDS)} and of control {', '.join(FREE_CONTROL)}"


def differing(old: str, new: str) -> list[tuple[str, bool]]:
    """Fields in which two decks (Deck.text) differ, and whether the State depends on each."""
    if old == new:
        return []
    decks = [yaml.load(text, yaml.CSafeLoader) for text in (old, new)]
    settings = {".".join(path[:3]): _is_bound(path) for path in _paths(*decks)}
    return list(settings.items())


def _is_bound(path: tuple[str, ...]) -> bool:
    if path[0] == "control":
        return path[1:2] == () or path[1] not in FREE_CONTROL
    return path[0] not in FREE_CARDS


def _paths(old: object, new: object, at: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Paths to values that differ; parameters count by their use."""
    if not (isinstance(old, dict) and isinstance(new, dict)):
        return [] if old == new else [at]
    words = [word for word in {**old, **new} if at or word != "parameters"]
    return [p for word in words for p in _paths(old.get(word), new.get(word), (*at, str(word)))]


def clear_folder(folder: Path) -> None:
    """Remove files of an earlier run that could be mistaken for those of this one.

    Raises: OutputError.
    """
    for name in (*SLOTS, "control.txt", "peaks.txt"):
        path = folder / name
        # a folder of that name is no request to this run, and is reported when requests are read
        if name != "control.txt" or not path.is_dir():
            with reported(path):
                path.unlink(missing_ok=True)
