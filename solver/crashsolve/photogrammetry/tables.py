"""Tables of digitised points: CSV files with headings, each row with its line for messages.

Headings may state a unit, `x [mm]`; without one numbers are in SI, and images in any unit of length
of the pictures, such as pixels.
"""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

from crashsolve.channels.units import UnitError, to_si
from crashsolve.foundation.errors import DeckError, DeckErrors

Key = tuple[str | float, ...]


@dataclass(frozen=True)
class Columns:
    """Columns of a table: of names, and of numbers with their units ("" for images)."""

    names: tuple[str, ...]
    numbers: dict[str, str]
    keys: tuple[str, ...]  # no two rows agree in all of these


@dataclass(frozen=True)
class Row:
    """One row: its names and numbers by column, numbers in SI."""

    line: int
    names: dict[str, str]
    numbers: dict[str, float]

    def key(self, columns: tuple[str, ...]) -> Key:
        """Key that no two rows may share."""
        return tuple(self.names.get(name, self.numbers.get(name, 0.0)) for name in columns)


TARGETS = Columns(("target",), {"x": "m", "y": "m", "z": "m"}, ("target",))
CALIBRATION = Columns(("camera", "target"), {"u": "", "v": ""}, ("camera", "target"))
FRAMES = Columns(
    ("camera", "point"), {"time": "s", "u": "", "v": ""}, ("time", "camera", "point")
)  # fmt: skip
LANDMARKS = Columns(("point", "body"), {"x": "m", "y": "m", "z": "m"}, ("point",))


def read_table(path: str, columns: Columns) -> list[Row]:
    """All rows of a table. Raises DeckErrors with all that is wrong in it."""
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise DeckErrors([DeckError(path, None, None, "", f"cannot be read: {error}")]) from None
    reader = csv.reader(text.splitlines())
    lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    lines = [(n, cells) for n, cells in lines if any(cells) and not cells[0].startswith("#")]
    if not lines:
        raise DeckErrors([DeckError(path, None, None, "", "holds no rows")])
    units = _headings(path, lines[0], columns)
    errors: list[DeckError] = []
    rows: list[Row] = []
    first: dict[Key, int] = {}
    for line, cells in lines[1:]:
        try:
            row = _row(path, line, cells, units, columns)
        except DeckError as error:
            errors.append(error)
            continue
        earlier = first.setdefault(row.key(columns.keys), line)
        if earlier != line:
            what = ", ".join(str(value) for value in row.key(columns.keys))
            errors.append(DeckError(path, line, None, what, f"is given in line {earlier} already"))
        rows.append(row)
    if not rows and not errors:
        errors.append(DeckError(path, lines[0][0], None, "", "holds no rows below its headings"))
    if errors:
        raise DeckErrors(errors)
    return rows


def _headings(path: str, first: tuple[int, list[str]], columns: Columns) -> dict[str, str]:
    """The unit of each column, in the order of the columns."""
    line, cells = first
    units: dict[str, str] = {}
    for cell in cells:
        name, bracket, rest = cell.partition("[")
        units[name.strip()] = rest.rstrip("] ") if bracket else ""
    wanted = [*columns.names, *columns.numbers]
    if sorted(units) != sorted(wanted) or len(cells) != len(wanted):
        message = f"the headings are {', '.join(cells)}"
        advice = f"they must be {', '.join(wanted)}, in any order"
        raise DeckErrors([DeckError(path, line, None, "", message, advice)])
    for name, unit in units.items():
        wanted_unit = columns.numbers.get(name, "")
        try:
            if unit and not wanted_unit:
                raise UnitError("this column has no unit")
            if unit:
                to_si(f"1 {unit}", wanted_unit)
        except UnitError as error:
            raise DeckErrors([DeckError(path, line, None, name, str(error))]) from None
    return units


def _row(path: str, line: int, cells: list[str], units: dict[str, str], columns: Columns) -> Row:
    if len(cells) != len(units):
        message = f"has {len(cells)} cells, not {len(units)}"
        raise DeckError(path, line, None, "", message)
    names, numbers = {}, {}
    for (name, unit), cell in zip(units.items(), cells, strict=True):
        if name in columns.names:
            if not cell:
                raise DeckError(path, line, None, name, "is empty")
            names[name] = cell
            continue
        try:
            value = float(cell)
        except ValueError:
            raise DeckError(path, line, None, name, f"'{cell}' is not a number") from None
        if not math.isfinite(value) or abs(value) > 1e9:
            message = f"'{cell}' is no measurement"
            raise DeckError(path, line, None, name, message, "leave the row out if it is missing")
        factor = to_si(f"1 {unit}", columns.numbers[name]) if unit else 1.0
        numbers[name] = value * factor
    return Row(line, names, numbers)
