"""Declaring the fields of a card, each with its unit, bounds and meaning."""

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, Field, JsonValue
from pydantic.fields import FieldInfo

from crashsolve.channels.units import parse_unit

REQUIRED: object = ...
BOUNDS = {
    "gt": (operator.gt, "greater than"),
    "ge": (operator.ge, "at least"),
    "lt": (operator.lt, "less than"),
    "le": (operator.le, "at most"),
}


def quantity(
    unit: str,
    meaning: str,
    default: object = REQUIRED,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:
    """Field of a number, or of nested tuples of numbers, in SI; bounds hold for each number.

    A unit may depend on fields declared before: "N/m^{exponent}". "any" takes every unit.
    Raises: UnitError for an unknown unit, ValueError for none.
    """
    if not unit or not meaning:
        raise ValueError("a quantity has a unit ('1' for a pure number) and a meaning")
    if unit != "any" and "{" not in unit:
        parse_unit(unit)
    return _noted(default, {"gt": gt, "ge": ge, "lt": lt, "le": le}, unit=unit, meaning=meaning)


def word(
    meaning: str,
    default: object = REQUIRED,
    *,
    default_factory: Callable[[], object] | None = None,
    ge: float | None = None,
    le: float | None = None,
) -> Any:
    """Field of anything without a unit: text, name, choice, true or false, whole number, card."""
    default = default_factory() if default_factory else default
    return _noted(default, {"ge": ge, "le": le}, meaning=meaning)


def Law(folder: str, meaning: str = "", default: object = REQUIRED) -> Any:
    """Field of a nested law, written `{type: word, ...}`; the types are the files of the folder."""
    return _noted(default, {}, law=folder, meaning=meaning)


def _noted(default: object, bounds: Mapping[str, float | None], **notes: str) -> object:
    given: dict[str, JsonValue] = {
        name: bound for name, bound in bounds.items() if bound is not None
    }
    return Field(default=default, json_schema_extra={**notes, "bounds": given})


@dataclass(frozen=True)
class Declared:
    """Declaration of a field, in the form that messages and manuals need."""

    info: FieldInfo
    unit: str = ""
    meaning: str = ""
    law: str = ""
    bounds: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def parts(self) -> tuple[object, ...]:
        """Members of the annotation, a union taken apart and without None."""
        return tuple(part for part in _members(self.info.annotation) if part is not NoneType)

    @cached_property
    def optional(self) -> bool:
        """Whether the field may be left empty."""
        return NoneType in _members(self.info.annotation)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The words a user may choose from, if any."""
        choices = (get_args(part) for part in self.parts if get_origin(part) is Literal)
        return tuple(word for group in choices for word in group)

    @cached_property
    def length(self) -> int | None:
        """Number of values of a vector; None for a scalar or a list of any length."""
        for part in self.parts:
            if get_origin(part) is tuple and Ellipsis not in get_args(part):
                return len(get_args(part))
        return None

    def list_in(self, unit: str, depth: int = 0) -> str:
        """The list that the field wants, or that one so many lists deep, in words."""
        inner: object = next((part for part in self.parts if get_origin(part) is tuple), None)
        for _ in range(depth):
            inner = get_args(inner)[0] if get_origin(inner) is tuple else None
        members = get_args(inner) if get_origin(inner) is tuple else ()
        if not members or Ellipsis in members:
            return "a list"
        kind = "numbers" if set(members) <= {int, float} else "values"
        return f"a list of {len(members)} {kind}{in_unit(unit)}"


def _members(annotation: object) -> tuple[object, ...]:
    if get_origin(annotation) in (Union, UnionType):
        return get_args(annotation)
    return (annotation,)


@cache
def declared(card: type[BaseModel], name: str) -> Declared:
    """Declaration of a field of a card, by its name in Python."""
    info = card.model_fields[name]
    notes: Any = info.json_schema_extra or {}
    return Declared(info, **notes)


@cache
def deck_words(card: type[BaseModel]) -> dict[str, str]:
    """Words a user writes in a card, each with the name of its field in Python."""
    return {info.alias or name: name for name, info in card.model_fields.items()}


def in_unit(unit: str) -> str:
    """ " in N/m" for messages; "" for a pure number."""
    return "" if unit in ("", "1", "any") or "{" in unit else f" in {unit}"
