"""Families of laws: what a folder states of itself, so that nothing outside it need know it.

A folder of the package with `FAMILY = Family(...)` in its `__init__.py` is a family: its name is a
keyword of decks, its files are types. What else a scene asks of it is declared there, all of it: a
declaration that is missing, or a law that does not provide what the family promises, is one error
at import, in words.
"""

import re
from dataclasses import dataclass, fields
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

S = TypeVar("S")
PACKAGE = __name__.partition(".")[0]
LINE = "line"  # a picture: from point a of one body to point b of another
ANY = ("any",)  # integrators


class FamilyError(Exception):
    """A family, or a law of it, does not state all that is asked of it."""


class _Missing:
    """Stands for what is not declared."""


@dataclass(frozen=True)
class Family:
    """What a folder of laws states of itself. Raises FamilyError naming all that is missing."""

    # which question each declaration answers, as the error asks it
    entry: Any = _Missing  # what is one entry of its section called?
    follows: Any = _Missing  # which section does it follow, in decks, manuals and the build?
    law: Any = _Missing  # which Protocol says what the file of a law must provide?
    energy: Any = _Missing  # entries of the ledger, the default first: NAME_stored and _dissipated
    channels: Any = _Missing  # first word of its channels, and what they hold; None for none
    picture: Any = _Missing  # how is it drawn: LINE, or None
    uses: Any = _Missing  # of which other families may its files import?
    integrators: Any = _Missing  # by which methods can it be stepped: names, or ANY
    default: str = ""  # type of an entry that names none

    def __post_init__(self) -> None:
        missing = [f.name for f in fields(self) if getattr(self, f.name) is _Missing]
        if missing:
            raise FamilyError(
                f"a family must declare {', '.join(missing)}: see the fields of Family in "
                f"{PACKAGE}/deck/family.py for what each one answers"
            )
        provided(self.law)

    @property
    def has_rows(self) -> bool:
        """Whether its laws bring constraint rows, as joints do."""
        return "residual" in provided(self.law)

    def supports(self, integrator: str) -> bool:
        """Whether it can be stepped by a method."""
        return self.integrators == ANY or integrator in self.integrators


def provided(law: Any) -> tuple[str, ...]:
    """Functions that a law must provide, by the Protocol of its family."""
    if not getattr(law, "_is_protocol", False):
        raise FamilyError(f"a family's `law` must be a Protocol, not {law!r}")
    return tuple(n for n, v in vars(law).items() if callable(v) and not n.startswith("_"))


def check_law(folder: str, module: Any) -> None:
    """Raises FamilyError for a law that does not provide what its family promises."""
    family = families().get(folder)
    if family is None:
        return
    missing = [name for name in provided(family.law) if not hasattr(module, name)]
    if missing:
        told = [f"{name} ({_first_line(getattr(family.law, name))})" for name in missing]
        raise FamilyError(f"{module.__name__} must provide {', '.join(told)}")


def _first_line(function: Any) -> str:
    return (function.__doc__ or "").strip().partition("\n")[0].rstrip(".")


@cache
def families() -> dict[str, Family]:
    """All families by their folders. Raises FamilyError."""
    root = Path(next(iter(import_module(PACKAGE).__path__)))
    found = {}
    for path in sorted(root.glob("*/__init__.py")):
        if re.search(r"^FAMILY = ", path.read_text("utf-8"), re.MULTILINE):
            folder = path.parent.name
            try:
                found[folder] = import_module(f"{PACKAGE}.{folder}").FAMILY
            except FamilyError as error:
                raise FamilyError(f"{PACKAGE}/{folder}/__init__.py: {error}") from None
    return found


def with_families(sections: dict[str, S]) -> dict[str, S]:
    """Sections of a deck, those of families each behind the one that it follows.

    Raises: FamilyError for a family that follows none.
    """
    waiting = {name: family for name, family in families().items() if name in sections}
    order = [name for name in sections if name not in waiting]
    while waiting:
        ready = sorted((n for n, f in waiting.items() if f.follows in order), reverse=True)
        if not ready:
            name, family = next(iter(waiting.items()))
            raise FamilyError(
                f"{PACKAGE}/{name}/__init__.py: follows '{family.follows}', which is no section"
            )
        for name in ready:
            order.insert(order.index(waiting.pop(name).follows) + 1, name)
    return {name: sections[name] for name in order}
