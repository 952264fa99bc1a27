"""Families of laws: the declaration of a folder, so that no code outside needs to know it.

A folder of the package with `FAMILY = Family(...)` in its `__init__.py` is a family: its files are
types, and its name is a keyword of decks, or its types stand within the cards of others. What else
a scene asks of it is declared there, all of it: a declaration that is missing, or a law that does
not provide all that its family promises, is one error at import, in words.
"""

import os
import re
import traceback
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, Protocol

from crashsolve.deck.roles import Expanded, OwnRows, StepLaw
from crashsolve.foundation.errors import CrashsolveError
from crashsolve.foundation.record import Record
from crashsolve.foundation.sources import source_files

PACKAGE = __name__.partition(".")[0]
LINE = "line"  # a picture: from point a of one body to point b of another
ROUTE = "route"  # along the points of HISTORY that a law names leave and arrive
ELEMENTS = "elements"  # as elements between nodes
MARK = "mark"  # a ball in its point, with its plastic strain
ANY = ("any",)  # integrators
DEFAULT_INTEGRATOR = "rattle"
# words of control.integrator that leave the method to the model
CHOSEN = ("auto", "default")
FIRST = ""  # follows no section


class FamilyError(CrashsolveError):
    """A family, or a law of it, lacks an attribute or function that it must have."""


# default of a declaration that is missing
MISSING: Any = object()


@dataclass(frozen=True)
class Family:
    """Declaration of a folder of laws. Raises FamilyError naming all that is missing."""

    # which question each declaration answers, as the error asks it
    entry: str | None = MISSING  # name of one entry of its section; None for laws within cards
    follows: str | None = MISSING  # which section does it follow, in decks, manuals and the build?
    law: type = MISSING  # Protocol of the file of a law
    # entries of the ledger, the default first: NAME_stored and _dissipated
    energy: tuple[str, ...] = MISSING
    # first words of its channels and their content, the default first
    channels: dict[str, str] | None = MISSING
    picture: str | None = MISSING  # how is it drawn: LINE, ROUTE, ELEMENTS, MARK, or None
    uses: tuple[str, ...] = MISSING  # of which other families may its files import?
    integrators: tuple[str, ...] = MISSING  # by which methods can it be stepped: names, or ANY
    default: str = ""  # type of an entry that names none
    at_rest: bool = False  # do quasi-static runs take laws of it that keep more than losses?
    section: str = ""  # keyword of decks, where it is not the name of the folder
    folder: str = ""  # found by families()

    def __post_init__(self) -> None:
        missing = [f.name for f in fields(self) if getattr(self, f.name) is MISSING]
        if missing:
            raise FamilyError(
                f"a family must declare {', '.join(missing)}: see the fields of Family in "
                f"{PACKAGE}/deck/family.py for their meaning"
            )
        wrong = [
            f"{name} must be {meant}, not {getattr(self, name)!r}"
            for name, is_right, meant in self._kinds()
            if not is_right
        ]
        if wrong:
            raise FamilyError("; ".join(wrong))
        if "force" in provided(self.law) and not self.energy:
            raise FamilyError("a family with forces must name an entry of the ledger under energy")
        if self.acts and "build" not in provided(self.law):
            raise FamilyError("`law` must be a Protocol with the role Built beside its others")
        if self.acts and self.entry is not None and not self.channels:
            raise FamilyError("a family whose laws act must name the first word of its channels")

    def _kinds(self) -> tuple[tuple[str, bool, str], ...]:
        """Check of each declaration, and the kind that it must be."""
        channels = self.channels or {}
        texts = list(channels.values()) if isinstance(channels, dict) else [None]
        return (
            ("entry", self.entry is None or _is_word(self.entry), "a word or None"),
            (
                "follows",
                self.entry is None or isinstance(self.follows, str),
                "the name of a section, or FIRST",
            ),
            ("energy", _are_words(self.energy), 'words in a tuple, as ("tether",)'),
            (
                "channels",
                _are_words(tuple(channels)) and all(isinstance(x, str) and x for x in texts),
                'first words and what they hold, as {"tetherout": "tension of tethers"}, or None',
            ),
            (
                "picture",
                self.picture is None or self.picture in (LINE, ROUTE, ELEMENTS, MARK),
                "LINE, ROUTE, ELEMENTS, MARK or None",
            ),
            ("uses", _are_paths(self.uses), 'families in a tuple, as ("joints",)'),
            (
                "integrators",
                bool(self.integrators) and _are_words(self.integrators),
                'ANY, or methods in a tuple, as ("rattle",)',
            ),
            ("default", self.default == "" or _is_word(self.default), "a type of it"),
            ("section", self.section == "" or _is_word(self.section), "a word"),
            ("at_rest", isinstance(self.at_rest, bool), "True or False"),
        )

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


def _is_word(value: object) -> bool:
    return isinstance(value, str) and value.isidentifier()


def _are_words(values: object) -> bool:
    """Whether these are words in a tuple, none of them twice."""
    is_tuple = isinstance(values, tuple) and all(_is_word(word) for word in values)
    return is_tuple and len(set(values)) == len(values)


def _are_paths(values: object) -> bool:
    """Whether these are words, or paths of words such as contact/normal, none of them twice."""
    is_tuple = isinstance(values, tuple) and all(isinstance(word, str) for word in values)
    return is_tuple and _are_words(tuple(word.replace("/", "_") for word in values))


@cache
def provided(law: type) -> tuple[str, ...]:
    """Functions that a law must provide, by the Protocol of its family."""
    names = [n for part in _roles(law) for n, v in vars(part).items() if callable(v)]
    return tuple(dict.fromkeys(n for n in names if not n.startswith("_")))


@cache
def constants(law: type) -> tuple[str, ...]:
    """Constants that a law must have, by the Protocol of its family."""
    return tuple(dict.fromkeys(n for part in _roles(law) for n in part.__annotations__))


def _roles(law: type) -> list[type]:
    if not getattr(law, "_is_protocol", False) or law is Protocol:
        raise FamilyError(f"a family's `law` must be a Protocol made of roles, not {law!r}")
    return [r for r in law.__mro__ if r is not Protocol and "_is_protocol" in vars(r)]


def check_law(module: ModuleType) -> None:
    """Raises FamilyError for a law that lacks a part of the Protocol of its family."""
    package, *folders, _ = module.__name__.split(".")
    folder = "/".join(folders) if package == PACKAGE else ""
    family = next((f for f in families().values() if f.folder == folder), None)
    if family is None:
        return
    law = Expanded if hasattr(module, "expand") else family.law
    wanted = {name: getattr(law, name) for name in provided(law)}
    if family.has_rows and _has_own_rows(module):
        wanted |= {name: getattr(OwnRows, name) for name in provided(OwnRows)}
    _check_provided(module, wanted, constants(law))
    _check_words(module, family)
    if family.acts and law is family.law:
        _check_records(module)
        hooks = (name for name in provided(StepLaw) if hasattr(module, name))
        wanted |= {name: getattr(StepLaw, name) for name in hooks}
    check_arguments(module, wanted)


def _check_provided(
    module: ModuleType, functions: Mapping[str, object], names: Iterable[str]
) -> None:
    """Raises FamilyError for functions or constants that a law lacks."""
    missing = [
        f"{name} ({_first_line(function)})"
        for name, function in functions.items()
        if not hasattr(module, name)
    ]
    missing += [name for name in names if not hasattr(module, name)]
    if missing:
        raise FamilyError(f"{module.__name__} must provide {', '.join(missing)}")


def _check_words(module: ModuleType, family: Family) -> None:
    """Raises FamilyError for a word of LEDGER or FAMILY that the family does not declare."""
    for constant, known in (("LEDGER", family.energy), ("FAMILY", family.channels or ())):
        if getattr(module, constant, next(iter(known), "")) not in (*known, ""):
            message = f"{constant} of {module.__name__} must be one of {', '.join(known)}"
            raise FamilyError(f"{message}, as declared in {PACKAGE}/{family.folder}/__init__.py")


def check_arguments(module: ModuleType, wanted: Mapping[str, FunctionType]) -> None:
    """Raises FamilyError for functions of a law whose arguments differ from those of the
    Protocol.
    """
    for name, function in wanted.items():
        if not isinstance(getattr(module, name), FunctionType):
            raise FamilyError(f"{module.__name__}: {name} must be a function")
        requested, given = _arguments(function)[1:], _arguments(getattr(module, name))
        least = len(requested) - len(function.__defaults__ or ())
        # a name that begins with _ is one that the law has no use for
        if not least <= len(given) <= len(requested) or any(
            g != a and g[0] != "_" for g, a in zip(given, requested, strict=False)
        ):
            message = f"{name}({', '.join(requested)}), not {name}({', '.join(given)})"
            raise FamilyError(f"{module.__name__} must provide {message}")


def _check_records(module: ModuleType) -> None:
    """Raises FamilyError for columns that a law of the step lacks, or names and has not."""
    needed = ("PARAMETERS", "OUTPUT") if hasattr(module, "force") else ("PARAMETERS",)
    missing = [name for name in needed if not hasattr(module, name)]
    if missing:
        raise FamilyError(f"{module.__name__} must provide {', '.join(missing)}: Record(...)")
    for name in ("PARAMETERS", "HISTORY", "OUTPUT"):
        if not isinstance(getattr(module, name, Record()), Record):
            raise FamilyError(f"{module.__name__}: {name} must be Record(...)")
    if hasattr(module, "TANGENTS") != hasattr(module, "tangent"):
        raise FamilyError(f"{module.__name__}: TANGENTS and tangent belong together")
    columns = [column.name for column in module.PARAMETERS.columns]
    for name in ("AMPLITUDE", "CURVES_OF_TIME", "FURTHER_NODES"):
        named = getattr(module, name, ())
        listed = (named,) if name == "AMPLITUDE" and named else named
        if not isinstance(listed, tuple) or any(word not in columns for word in listed):
            kind = "a column" if name == "AMPLITUDE" else "columns, in a tuple,"
            raise FamilyError(f"{module.__name__}: {name} must name {kind} of PARAMETERS")


def _has_own_rows(module: ModuleType) -> bool:
    """Whether a joint has rows that none of its basic constraints brings.

    Raises FamilyError where their number is not that of all its rows.
    """
    basic = sum(len(part.ANGULAR) for part in getattr(module, "CONSTRAINTS", ()))
    rows, missing = getattr(module, "ROWS", basic), len(getattr(module, "ANGULAR", ()))
    if rows != missing or rows < basic:
        count = f"{basic} of CONSTRAINTS, {missing} of ANGULAR"
        raise FamilyError(f"{module.__name__}: ROWS is {rows}, beside {count}")
    return bool(rows > basic)


def _arguments(function: FunctionType) -> tuple[str, ...]:
    code = function.__code__
    return tuple(code.co_varnames[: code.co_argcount])


def _first_line(function: object) -> str:
    return (function.__doc__ or "").strip().partition("\n")[0].rstrip(".")


@cache
def families() -> dict[str, Family]:
    """All families: by the section of decks, then those within cards by folder.

    Sections stand each behind the one that it follows. Raises: FamilyError, also for a family that
    follows none, or takes a name that another has.
    """
    root = _root()
    declared = []
    files = source_files(str(root))
    for file in sorted(at for at in files if at.endswith(f"{os.sep}__init__.py")):
        with open(file, encoding="utf-8") as source:
            text = source.read()
        if re.search(r"^FAMILY\b.*=", text, re.MULTILINE):
            path = Path(file)
            folder = path.parent.relative_to(root).as_posix()
            family = imported(f"{PACKAGE}.{folder.replace('/', '.')}", path).FAMILY
            if not isinstance(family, Family):
                raise FamilyError(f"{PACKAGE}/{folder}/__init__.py: FAMILY must be Family(...)")
            declared.append(replace(family, folder=folder))
    _refuse_clashes(declared)
    return _in_order({f.name: f for f in declared if f.entry is not None}) | {
        f.name: f for f in declared if f.entry is None
    }


@cache
def integrators() -> tuple[str, ...]:
    """Methods that decks may name, the default first: the files of integrators/ say so."""
    files = sorted((_root() / "integrators").glob("[!_]*.py"))
    named = [path.stem for path in files if "IN_DECKS = False" not in path.read_text()]
    return tuple(sorted(named, key=lambda name: name != DEFAULT_INTEGRATOR))


def _root() -> Path:
    """Folder of the package."""
    return Path(next(iter(import_module(PACKAGE).__path__)))


def imported(name: str, path: Path) -> ModuleType:
    """The module of a file.

    Raises FamilyError with file and line for any exception at its import.
    """
    location = name.replace(".", "/") + ("/__init__.py" if path.stem == "__init__" else ".py")
    try:
        return import_module(name)
    except FamilyError as error:
        if str(error).startswith(f"{PACKAGE}/"):
            raise
        raise FamilyError(f"{location}: {error}") from None
    except CrashsolveError:
        raise
    except Exception as error:
        raise FamilyError(_import_message(error, location, path)) from error


def _import_message(error: Exception, location: str, path: Path) -> str:
    """File, line and reason of an error of an import, in one line."""
    trace = traceback.extract_tb(error.__traceback__)
    lines = [step.lineno for step in trace if step.filename == str(path)]
    # after the first line of pydantic's message there is a link to its manual
    reason = str(error).partition("\n")[0]
    if isinstance(error, SyntaxError) and error.filename == str(path):
        lines, reason = [error.lineno], error.msg
    line = f"{lines[-1]}:" if lines else ""
    return f"{location}:{line} {type(error).__name__}: {reason}"


def _refuse_clashes(families_of_folders: list[Family]) -> None:
    """Raises FamilyError for names that two families have, and for names of no family."""
    owners: dict[tuple[str, str], str] = {("channels", "glstat"): "the whole model"}
    for family in families_of_folders:
        location = f"{PACKAGE}/{family.folder}/__init__.py"
        names = [("section", family.name)] if family.entry is not None else []
        names += [("energy", word) for word in family.energy]
        names += [("channels", word) for word in family.channels or ()]
        for name in names:
            if name in owners:
                raise FamilyError(f"{location}: {name[0]} '{name[1]}' is that of {owners[name]}")
            owners[name] = f"{PACKAGE}/{family.folder}"
        known = {f.name for f in families_of_folders}
        for what, words, right in (
            ("uses", family.uses, known),
            ("integrators", () if family.integrators == ANY else family.integrators, integrators()),
        ):
            unknown = [word for word in words if word not in right]
            if unknown:
                missing = f"{location}: {what} names '{unknown[0]}', which is none of "
                raise FamilyError(missing + ", ".join(sorted(right)))
        if family.default and not (_root() / family.folder / f"{family.default}.py").is_file():
            raise FamilyError(f"{location}: default '{family.default}' has no file in its folder")


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
            order.insert(order.index(waiting.pop(name).follows or FIRST) + 1, name)
    return {name: sections[name] for name in order[1:]}
