"""The request of `crashsolve posture`: a YAML file beside the tables of digitised points.

deck: occupant.yaml
root: person_lower_torso
targets: targets.csv
calibration: calibration.csv
frames: frames.csv
landmarks: landmarks.csv
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import ValidationError, field_validator

from crashsolve.channels.units import SI
from crashsolve.deck.card import BodyName, Card, FileName, NewName, Rotation, Vec3, quantity, word
from crashsolve.deck.diagnostics import Diagnostic, diagnostics_of, refuse, shown
from crashsolve.deck.numbers import Context, number
from crashsolve.deck.source import Position, Table, locate, read_yaml
from crashsolve.foundation.errors import DeckError, DeckErrors


class World(Card):
    """Position and orientation, in the world of the deck, of the axes in which targets are
    measured.
    """

    position: Vec3 = quantity("m", "of their origin", (0.0, 0.0, 0.0))
    rotation: Rotation = word("of them, to the world", default_factory=Rotation.model_construct)


class Request(Card):
    """Cameras, digitised points, and the chain of bodies that is fitted to them."""

    title: str = word("heading of what is printed", "")
    name: NewName = word("of the posture card that is written", "posture")
    deck: FileName = word("deck with bodies and joints in the zero posture")
    occupant: str = word("text in place of <who> in the landmarks' bodies", "")
    root: BodyName = word("body from which the others are placed")
    targets: FileName = word("table of known points: target, x, y, z")
    calibration: FileName = word("table of their images: camera, target, u, v")
    frames: FileName = word("table of digitised points: time, camera, point, u, v")
    landmarks: FileName = word("table of points on the bodies, in their axes: point, body, x, y, z")
    method: Literal["normalised", "least_squares"] = word(
        "calibration of the cameras", "normalised"
    )
    image_error: float | None = quantity(
        "1", "standard deviation of u and v; estimated from the residuals when absent", None, gt=0
    )
    landmark_error: float = quantity(
        "m", "standard deviation of where a person has a landmark, along each axis", 0.0, ge=0
    )
    spread: dict[str, float] = word(
        "joints known to be near the zero posture, each with a standard deviation in rad", {}
    )
    world: World = word("axes of the targets in the world of the deck", default_factory=World)
    start: float | None = quantity("s", "time of the frame that is the start; the first", None)
    window: int = word("frames about the start through which velocities are found", 3, ge=1, le=99)

    @field_validator("spread", mode="before")
    @classmethod
    def _angles(cls, given: object) -> object:
        if not isinstance(given, dict):
            refuse(f"must be a table of joints, not {shown(given)}")
        angles = {}
        for name, value in given.items():
            try:
                angles[name] = number(value, "rad", SI)
            except (ValueError, TypeError):
                refuse(f"must be an angle, not {shown(value)}", within=(name,))
            if not angles[name] > 0.0:
                refuse("must be greater than 0", within=(name,))
        return angles


@dataclass(frozen=True)
class Requested:
    """A request without errors, and where its fields stand."""

    path: Path
    card: Request
    table: Table

    def error(self, field: tuple[str, ...], message: str, advice: str = "") -> DeckError:
        """An error found after reading, at a field."""
        where = locate(Position(str(self.path), 1, 1), self.table, field, False)
        return DeckError(*where, ".".join(field), message, advice)


def read_request(path: Path) -> Requested:
    """The request in a file. Raises DeckErrors with all its errors."""
    errors: list[DeckError] = []
    table = read_yaml(path, errors)
    if table is None:
        raise DeckErrors(errors)
    diagnostics: list[Diagnostic] = []
    try:
        card = Request.model_validate(table, context=Context(folder=path.parent))
    except ValidationError as error:
        diagnostics += diagnostics_of(Request, error)
    start = Position(str(path), 1, 1)
    for one in diagnostics:
        words = " ".join(str(step) for step in (one.path[:-1] if one.key else one.path))
        where = locate(start, table, one.path, one.key)
        errors.append(DeckError(*where, words, one.message, one.advice))
    if errors:
        raise DeckErrors(sorted(errors, key=lambda one: one.line or 0))
    return Requested(path, card, table)
