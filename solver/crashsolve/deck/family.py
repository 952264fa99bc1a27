"""Families of laws: what a folder states of itself, so that nothing outside it need know it.

A folder of the package with `FAMILY = Family(...)` in its `__init__.py` is a family: its files are
types, and its name is a keyword of decks, or its types stand within the cards of others. What else
a scene asks of it is declared there, all of it: a declaration that is missing, or a law that does
not provide what the family promises, is one error at import, in words.
"""

import re
from dataclasses import dataclass, fields, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from crashsolve.deck.roles import Expanded, OwnRows
from crashsolve.foundation.errors import CrashsolveError

PACKAGE = __name__.partition(".")[0]
LINE = "line"  # a picture: from point a of one body to point b of another
ELEMENTS = "elements"  # as elements between nodes
MARK = "mark"  # a ball in its point, with what it has yielded
ANY = ("any",)  # integrators
DEFAULT_INTEGRATOR = "rattle"
FIRST = ""  # follows no section


class FamilyError(CrashsolveError):
    """A family, or a law of it, does not state all that is asked of it."""


class _Missing:
    """Stands for what is not declared."""


@dataclass(frozen=True)
class Family:
    """What a folder of laws states of itself. Raises FamilyError naming all that is missing."""

    # which question each declaration answers, as the error asks it
    entry: Any = _Missing  # what is one entry of its section called? None for laws within cards
    follows: Any = _Missing  # which section does it follow, in decks, manuals and the build?
    law: Any = _Missing  # which Protocol says what the file of a law must provide?
    energy: Any = _Missing  # entries of the ledger, the default first: NAME_stored and _dissipated
    channels: Any = _Missing  # first words of its channels and what they hold, the default first
    picture: Any = _Missing  # how is it drawn: LINE, ELEMENTS, MARK, or None
    uses: Any = _Missing  # of which other families may its files import?
    integrators: Any = _Missing  # by which methods can it be stepped: names, or ANY
    default: str = ""  # type of an entry that names none
    at_rest: bool = False  # do quasi-static runs take laws of it that keep more than losses?
    section: str = ""  # keyword of decks, where it is not the name of the folder
    folder: str = ""  # found by families()

    def __post_init__(self) -> None:
        missing = [f.name for f in fields(self) if getattr(self, f.name) is _Missing]
        if missing:
            raise FamilyError(
                f"a family must declare {', '.join(missing)}: see the fields of Family in "
                f"{PACKAGE}/deck/family.py for what each one answers"
            )
        if "force" in provided(self.law) and not self.energy:
            raise FamilyError("a family with forces must name an entry of the ledger under energy")

    @property
    def name(self) -> str:
        """Keyword of its entries in decks; the folder of laws that stand within cards."""
        return self.section or self.folder

    @property
    def has_rows(self) -> bool:
        """Whether its laws bring constraint rows, as joints do."""
        return "CONSTRAINTS" in constants(self.law)

    @property
    def acts(self) -> bool:
        """Whether its laws are called in the step or at samples, entry by entry."""
        return self.has_rows or not {"force", "measure"}.isdisjoint(provided(self.law))

    def supports(self, integrator: str) -> bool:
        """Whether it can be stepped by a method."""
        return self.integrators == ANY or integrator in self.integrators


@cache
def provided(law: Any) -> tuple[str, ...]:
    """Functions that a law must provide, by the Protocol of its family."""
    found = [n for part in _roles(law) for n, v in vars(part).items() if callable(v)]
    return tuple(dict.fromkeys(n for n in found if not n.startswith("_")))


def constants(law: Any) -> tuple[str, ...]:
    """Constants that a law must have, by the Protocol of its family."""
    return tuple(dict.fromkeys(n for part in _roles(law) for n in part.__annotations__))


def _roles(law: Any) -> list[Any]:
    if not getattr(law, "_is_protocol", False):
        raise FamilyError(f"a family's `law` must be a Protocol, not {law!r}")
    return [r for r in law.__mro__ if r is not Protocol and "_is_protocol" in vars(r)]


def check_law(module: Any) -> None:
    """Raises FamilyError for a law that does not provide what its family promises."""
    package, *folders, _ = module.__name__.split(".")
    folder = "/".join(folders) if package == PACKAGE else ""
    family = next((f for f in families().values() if f.folder == folder), None)
    if family is None:
        return
    law = Expanded if hasattr(module, "expand") else family.law
    wanted = {name: getattr(law, name) for name in provided(law)}
    if family.has_rows and _has_own_rows(module):
        wanted |= {name: getattr(OwnRows, name) for name in provided(OwnRows)}
    told = [f"{name} ({_first_line(wanted[name])})" for name in wanted if not hasattr(module, name)]
    told += [name for name in constants(law) if not hasattr(module, name)]
    if told:
        raise FamilyError(f"{module.__name__} must provide {', '.join(told)}")
    for constant, known in (("LEDGER", family.energy), ("FAMILY", family.channels or ())):
        if getattr(module, constant, next(iter(known), "")) not in (*known, ""):
            message = f"{constant} of {module.__name__} must be one of {', '.join(known)}"
            raise FamilyError(f"{message}, as declared in {PACKAGE}/{folder}/__init__.py")
    for name, function in wanted.items():
        asked, given = _arguments(function)[1:], _arguments(getattr(module, name))
        # a name that begins with _ is one that the law has no use for
        if len(given) != len(asked) or any(
            g != a and g[0] != "_" for g, a in zip(given, asked, strict=True)
        ):
            message = f"{name}({', '.join(asked)}), not {name}({', '.join(given)})"
            raise FamilyError(f"{module.__name__} must provide {message}")


def _has_own_rows(module: Any) -> bool:
    """Whether a joint has rows that none of its basic constraints brings.

    Raises FamilyError where their number is not that of all its rows.
    """
    basic = sum(len(part.ANGULAR) for part in getattr(module, "CONSTRAINTS", ()))
    rows, told = getattr(module, "ROWS", basic), len(getattr(module, "ANGULAR", ()))
    if rows != told or rows < basic:
        count = f"{basic} of CONSTRAINTS, {told} of ANGULAR"
        raise FamilyError(f"{module.__name__}: ROWS is {rows}, beside {count}")
    return bool(rows > basic)


def _arguments(function: Any) -> tuple[str, ...]:
    code = function.__code__
    return tuple(code.co_varnames[: code.co_argcount])


def _first_line(function: Any) -> str:
    return (function.__doc__ or "").strip().partition("\n")[0].rstrip(".")


@cache
def families() -> dict[str, Family]:
    """All families: by the section of decks, then those within cards by folder.

    Sections stand each behind the one that it follows. Raises: FamilyError, also for a family that
    follows none.
    """
    root = Path(next(iter(import_module(PACKAGE).__path__)))
    found = []
    for path in sorted(root.glob("**/__init__.py")):
        if re.search(r"^FAMILY = ", path.read_text("utf-8"), re.MULTILINE):
            folder = path.parent.relative_to(root).as_posix()
            try:
                family = import_module(f"{PACKAGE}.{folder.replace('/', '.')}").FAMILY
            except FamilyError as error:
                raise FamilyError(f"{PACKAGE}/{folder}/__init__.py: {error}") from None
            found.append(replace(family, folder=folder))
    return _in_order({f.name: f for f in found if f.entry is not None}) | {
        f.name: f for f in found if f.entry is None
    }


@cache
def integrators() -> tuple[str, ...]:
    """Methods that decks may name, the default first: the files of integrators/ say so."""
    root = Path(next(iter(import_module(PACKAGE).__path__))) / "integrators"
    named = [
        p.stem for p in sorted(root.glob("[!_]*.py")) if "IN_DECKS = False" not in p.read_text()
    ]
    return tuple(sorted(named, key=lambda name: name != DEFAULT_INTEGRATOR))


def _in_order(waiting: dict[str, Family]) -> dict[str, Family]:
    """Sections, each behind the one that it follows. Raises FamilyError. Writes: waiting."""
    sections, order = dict(waiting), [FIRST]
    while waiting:
        ready = sorted((n for n, f in waiting.items() if f.follows in order), reverse=True)
        if not ready:
            family = next(iter(waiting.values()))
            raise FamilyError(
                f"{PACKAGE}/{family.folder}/__init__.py: follows '{family.follows}', "
                "which is no section"
            )
        for name in ready:
            order.insert(order.index(waiting.pop(name).follows) + 1, name)
    return {name: sections[name] for name in order[1:]}
