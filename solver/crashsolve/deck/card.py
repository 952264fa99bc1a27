"""Cards: the fields of a deck, with units, bounds and meaning beside each word.

    class LinearSpring(Card):
        b: BodyName = word("body at the second end")
        stiffness: float = quantity("N/m", "slope of force over elongation", gt=0)
        normal: Card = Law("contact/normal", "law of the normal force")

A card holds SI numbers for any units of the deck. Sequences are tuples, as cards are frozen.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from os.path import isfile
from types import NoneType
from typing import Annotated, ClassVar, Self, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetCoreSchemaHandler,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from crashsolve.channels.units import UnitError
from crashsolve.deck.diagnostics import (
    Diagnostic,
    already_reported,
    diagnostics_of,
    explained,
    refuse,
    reported,
    shown,
)
from crashsolve.deck.family import FamilyError
from crashsolve.deck.fields import BOUNDS, Declared, Law, declared, in_unit, quantity, word
from crashsolve.deck.laws import UnknownType, class_name, law_module, types_in
from crashsolve.deck.numbers import Context, number, number_in
from crashsolve.deck.source import BROKEN, NAME, NAME_ADVICE

__all__ = ["Card", "Law", "Rotation", "Vec3", "quantity", "word"]
__all__ += ["BodyName", "ContactName", "CurveName", "FileName", "JointName", "LoadName"]
__all__ += ["MaterialName", "MeshName", "NewName", "PartName", "Reference", "SectionName"]
__all__ += ["SensorName", "SetName", "SpringName", "SurfaceName", "existing_file", "number_as_name"]
__all__ += ["WhereWritten", "reference_of"]

# whole numbers that every part of the program counts exactly
LARGEST_INTEGER = 2**53
Vec3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Name(str):
    """A reference to an entry of the deck, looked up once all cards are read."""

    keyword: str


@dataclass(frozen=True)
class Reference:
    """Marks text as the name of an entry under a keyword."""

    keyword: str

    def __call__(self, text: str) -> Name:
        name = Name(text)
        name.keyword = self.keyword
        return name


def plain_name(text: str) -> str:
    """A name that is part of channels and of files: letters, digits, _ and -."""
    if not NAME.fullmatch(text):
        refuse(f"{shown(text)} is not a valid name", NAME_ADVICE)
    return text


NewName = Annotated[str, AfterValidator(plain_name)]


def reference_of(annotation: object) -> str:
    """Keyword of the entries that a field, or each entry of its list, refers to; "" for none."""
    marks = getattr(annotation, "metadata", getattr(annotation, "__metadata__", ()))
    for mark in marks:
        if isinstance(getattr(mark, "func", None), Reference):
            return str(mark.func.keyword)
    inner = getattr(annotation, "annotation", None)
    parts = get_args(annotation if inner is None else inner)
    return next((keyword for part in parts if (keyword := reference_of(part))), "")


BodyName = Annotated[str, AfterValidator(Reference("bodies"))]
JointName = Annotated[str, AfterValidator(Reference("joints"))]
SpringName = Annotated[str, AfterValidator(Reference("springs"))]
SurfaceName = Annotated[str, AfterValidator(Reference("surfaces"))]
ContactName = Annotated[str, AfterValidator(Reference("contacts"))]
LoadName = Annotated[str, AfterValidator(Reference("loads"))]
CurveName = Annotated[str, AfterValidator(Reference("curves"))]
SensorName = Annotated[str, AfterValidator(Reference("sensors"))]
MaterialName = Annotated[str, AfterValidator(Reference("materials"))]
MeshName = Annotated[str, AfterValidator(Reference("meshes"))]
SectionName = Annotated[str, AfterValidator(Reference("sections"))]
PartName = Annotated[str, AfterValidator(Reference("parts"))]


def existing_file(text: str, info: ValidationInfo) -> str:
    """Path of a file named in a deck, beside the deck's file."""
    path = (info.context or Context()).folder / text
    if not isfile(path):
        refuse(f"there is no file '{path}'")
    return str(path)


FileName = Annotated[str, AfterValidator(existing_file)]


def number_as_name(value: object) -> object:
    """A whole number as text: sets of mesh files may have numbers for names."""
    return str(value) if type(value) is int else value


SetName = Annotated[str, BeforeValidator(number_as_name)]


class Card(BaseModel):
    """The fields that a user may write in one location of a deck. A trailing "_" of a field is not
    written.

    A bare text stands for the field named by `shorthand`, if any. `curve_axes` has the units of x
    and y of the curves that fields name.
    """

    shorthand: ClassVar[str] = ""
    curve_axes: ClassVar[dict[str, tuple[str, str]]] = {}

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        validate_by_name=True,
        validate_by_alias=True,
        defer_build=True,
        alias_generator=lambda name: name.removesuffix("_"),
    )

    @classmethod
    def __pydantic_init_subclass__(cls, **_: object) -> None:
        """Raises TypeError for fields without a declaration: manual and reader ask it for all."""
        plain = [name for name, info in cls.model_fields.items() if not info.json_schema_extra]
        if plain:
            reported = f"{', '.join(plain)} of {cls.__name__} must be declared"
            raise TypeError(f"{reported}: quantity(unit, meaning), word(meaning) or Law(folder)")

    @field_validator("*", mode="wrap")
    @classmethod
    def _read(
        cls, value: object, handler: ValidatorFunctionWrapHandler, info: ValidationInfo
    ) -> object:
        """Bring a value to SI, or open a nested law; then check type and bounds."""
        field = declared(cls, str(info.field_name))
        context = info.context or Context()
        if value is BROKEN:
            already_reported()
        if field.law:
            return handler(_open_law(value, field.law, context))
        given = _as_tuple(value)
        unit = _unit(field, info.data) if field.unit else ""
        if unit:
            given = _to_si(given, field, unit, context)
        result = handler(given)
        _check_bounds(result, value, field, unit)
        return result

    @model_validator(mode="wrap")
    @classmethod
    def _with_plain_messages(cls, value: object, handler: ModelWrapValidatorHandler[Self]) -> Self:
        if cls.shorthand and isinstance(value, str):
            value = {cls.shorthand: value}
        try:
            return handler(value)
        except ValidationError as error:
            raise explained(cls, error) from None


def law_class(folder: str, word: object) -> type[Card]:
    """Card of a type of a family, its module imported now; raises UnknownType."""
    module = law_module(folder, word)
    card = getattr(module, class_name(str(word)))
    if not issubclass(card, Card):
        raise FamilyError(f"{module.__name__}: {card.__name__} must be a Card")
    return card


def _as_tuple(value: object) -> object:
    return tuple(_as_tuple(part) for part in value) if isinstance(value, list) else value


def _open_law(value: object, folder: str, context: Context) -> object:
    """Card of a nested law written `{type: word, ...}`."""
    if value is None or isinstance(value, Card):
        return value
    types = ", ".join(types_in(folder)) or "none"
    if not isinstance(value, Mapping):
        refuse(f"must be a table of fields with a type, not {shown(value)}", f"(types: {types})")
    if "type" not in value:
        refuse("missing field 'type'", f"(types: {types})", within=("type",), key=True)
    fields = {name: part for name, part in value.items() if name != "type"}
    try:
        law = law_class(folder, value["type"])
    except UnknownType as error:
        first = Diagnostic(("type",), error.message, error.advice)
        raise reported(
            [first, *_further_diagnostics(folder, error.near, fields, context)]
        ) from None
    return law.model_validate(fields, context=context)


def _further_diagnostics(
    folder: str, near: str, fields: Mapping[str, object], context: Context
) -> list[Diagnostic]:
    """Further errors of a card with a mistyped type, if the one most like it is meant."""
    if not near:
        return []
    law = law_class(folder, near)
    try:
        law.model_validate(fields, context=context)
    except ValidationError as error:
        return [
            diagnostic for diagnostic in diagnostics_of(law, error) if not diagnostic.is_missing
        ]
    return []


def _unit(field: Declared, earlier: Mapping[str, object]) -> str:
    """Unit of a field, which may depend on fields declared before it."""
    try:
        return field.unit.format(**earlier)
    except KeyError:
        already_reported()


def _to_si(
    value: object, field: Declared, unit: str, context: Context, at: tuple[int, ...] = ()
) -> object:
    """Numbers and texts such as "54 km/h", alone or in nested tuples, as numbers in SI."""
    if isinstance(value, tuple):
        parts = enumerate(value)
        return tuple(_to_si(part, field, unit, context, (*at, i)) for i, part in parts)
    if value is BROKEN:
        already_reported()
    if (value is None and field.optional and not at) or value in field.words:
        return value
    if unit == "any":
        return number_in(value, None, context, at)[0]
    kinds = f"a number{in_unit(unit)}" + "".join(f" or '{word}'" for word in field.words)
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        refuse(f"must be {kinds}, not {shown(value)}", within=at)
    try:
        return number(value, unit, context.units)
    except UnitError as error:
        if field.length and not at and len(field.parts) == 1:
            refuse(f"must be {field.list_in(unit)}, not {shown(value)}")
        refuse(f"must be {kinds}", str(error), within=at)


def _check_bounds(
    result: object, written: object, field: Declared, unit: str, at: tuple[int, ...] = ()
) -> None:
    if isinstance(result, tuple) and isinstance(written, list | tuple):
        for i, (part, text) in enumerate(zip(result, written, strict=True)):
            _check_bounds(part, text, field, unit, (*at, i))
    if isinstance(result, bool) or not isinstance(result, int | float):
        return
    if isinstance(result, int) and abs(result) > LARGEST_INTEGER:
        refuse(f"must be at most {LARGEST_INTEGER:g}", within=at)
    for bound, limit in field.bounds.items():
        holds, words = BOUNDS[bound]
        if not holds(result, limit):
            shown_unit = "" if unit in ("", "1", "any") else f" {unit}"
            refuse(f"must be {words} {limit:g}{shown_unit}, not {shown(written)}", within=at)


class WhereWritten:
    """Marks an optional card whose validator is made only for decks that write the card."""

    def __get_pydantic_core_schema__(self, source: object, _: GetCoreSchemaHandler) -> CoreSchema:
        card = next(part for part in get_args(source) if part is not NoneType)

        def opened(value: object, info: ValidationInfo) -> object:
            return value if value is None else card.model_validate(value, context=info.context)

        return core_schema.with_info_plain_validator_function(opened)


class Rotation(Card):
    """Orientation of a body in the world: axis and angle, quaternion, or Euler angles; or none."""

    axis: Vec3 | None = quantity("1", "direction of the axis of rotation, of any length", None)
    angle: float | None = quantity("rad", "angle about the axis, right-handed", None)
    quaternion_: Quaternion | None = quantity("1", "unit quaternion, scalar first", None)
    euler: Vec3 | None = quantity(
        "rad", "angles about the body's own axes, one after another", None
    )
    sequence: str = word("axes of the Euler angles, in order", "xyz")

    @model_validator(mode="after")
    def _one_direction(self) -> "Rotation":
        given = [self.axis is not None, self.quaternion_ is not None, self.euler is not None]
        if sum(given) > 1:
            raise ValueError("give only one of: axis and angle, quaternion, euler")
        if (self.axis is None) != (self.angle is None):
            raise ValueError("axis and angle belong together")
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis: has no length")
        if self.quaternion_ is not None and abs(math.hypot(*self.quaternion_) - 1.0) > 1e-6:
            raise ValueError("quaternion: must have length 1 within 1e-6")
        if len(self.sequence) != 3 or not set(self.sequence) <= set("xyz"):
            raise ValueError("sequence: must be three letters of x, y, z, such as 'zxz'")
        if self.sequence[1] in (self.sequence[0], self.sequence[2]):
            raise ValueError("sequence: must not name one axis twice in a row")
        return self

    def quaternion(self) -> tuple[float, float, float, float]:
        """Unit quaternion (w, x, y, z) that takes body components to the world."""
        q: Quaternion = (1.0, 0.0, 0.0, 0.0)
        if self.quaternion_ is not None:
            q = self.quaternion_
        elif self.euler is not None:
            for letter, angle in zip(self.sequence, self.euler, strict=True):
                q = _product(q, _about(_AXES[letter], angle))
        elif self.axis is not None and self.angle is not None:
            q = _about(self.axis, self.angle)
        length = math.hypot(*q)
        return q[0] / length, q[1] / length, q[2] / length, q[3] / length


_AXES: dict[str, Vec3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def _about(axis: Vec3, angle: float) -> Quaternion:
    length, sine = math.hypot(*axis), math.sin(angle / 2.0)
    # 1 / length overflows where components are as small as a number can be
    x, y, z = (component / length for component in axis)
    return math.cos(angle / 2.0), sine * x, sine * y, sine * z


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
        a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
    )
