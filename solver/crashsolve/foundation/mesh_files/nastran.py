"""Lines of Nastran bulk data: grid points, quadrilaterals, triangles and sets, by identifier.

Fields are free, small or large, in any case, with continuations. Angles and coordinate systems of
materials are passed over, as materials are the same in all directions; an offset or a thickness of
corners is refused. A property is a set of elements under its number; `SET n = ...` of the case
control and `SET1` are sets under `SET n`, of nodes if all their numbers are nodes', of elements if
all are elements'. References: MSC Nastran Quick Reference Guide, CQUAD4, CTRIA3, GRID, SET, SET1.
"""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from crashsolve.foundation.mesh_files.reading import SIDES, Lines

WIDTH = {False: 8, True: 16}
SHELLS = {"CQUAD4": "quad", "CQUADR": "quad", "CTRIA3": "triangle", "CTRIAR": "triangle"}
# its name for either
WRITTEN = {"quad": "CQUAD4", "triangle": "CTRIA3"}
LOST = {"INCLUDE", "GRDSET", "SEBULK", "GRIDB"}
SILENT = {"ENDDATA", "PARAM", "SET1"}


@dataclass
class Card:
    """A card of bulk data: the number of its first line, its name, its fields after the name."""

    line: int
    name: str
    fields: list[str]

    def __getitem__(self, at: int) -> str:
        """A field, empty where the card has ended."""
        return self.fields[at] if at < len(self.fields) else ""


def read_lines(path: Path) -> Lines:
    """The content of the file. Raises MeshFileError."""
    lines, sets = Lines(path.name), dict[str, tuple[int, str]]()
    rows = list(enumerate(path.read_text("utf-8", errors="replace").splitlines(), 1))
    starts = [i for i, (_, text) in enumerate(rows) if re.match(r"\s*BEGIN\s+BULK", text, re.I)]
    first = starts[0] + 1 if starts else 0
    if len(starts) > 1:
        raise lines.fail(rows[starts[1]][0], "a second BEGIN BULK would be ignored")
    sets |= _case_sets(rows[:first])
    cards = list(_cards(rows[first:], lines))
    for card in cards:
        if card.name == "GRID":
            _grid(card, lines)
    for card in cards:
        _take(card, lines, sets)
    _add_sets(sets, lines)
    lines.text = _text(lines)
    return lines


def _cards(rows: list[tuple[int, str]], lines: Lines) -> Iterator[Card]:
    """Cards with their continuations."""
    current: Card | None = None
    mark = ""
    for number, text in rows:
        text = text.partition("$")[0].rstrip().expandtabs(8).upper()
        if not text.strip() or text.startswith(("//", "#")):
            continue
        head, fields, next_mark = _fields(text)
        if head.startswith(("+", "*")) or not head:
            own = head.strip("+*")
            if current is None or (own and mark and own != mark):
                raise lines.fail(number, f"'{head or 'the line'}' continues no line before it")
            current.fields.extend(fields)
        else:
            if current:
                yield current
            current = Card(number, head.rstrip("*"), fields)
            if current.name == "ENDDATA":
                break
        mark = next_mark
    if current:
        yield current


def _fields(text: str) -> tuple[str, list[str], str]:
    """First field, fields of data (eight, or four large ones), and mark of the continuation."""
    if "," in text:
        head, *fields = (part.strip() for part in text.split(","))
        count = 4 if "*" in head else 8
        if fields and fields[-1].startswith("+") and not _is_real(fields[-1]):
            # a mark may follow before all fields are given
            fields = [*fields[:-1], *[""] * (count + 1 - len(fields)), fields[-1]]
    else:
        head, is_large = text[:8].strip(), "*" in text[:8]
        width, count = WIDTH[is_large], 4 if is_large else 8
        fields = [text[8 + width * k :][:width].strip() for k in range(count)]
        fields.append(text[8 + width * count :][:8].strip())
    fields += [""] * (count + 1 - len(fields))
    return head, fields[:count], fields[count].strip("+*")


def _grid(card: Card, lines: Lines) -> None:
    """A grid point, in the basic coordinate system. Writes: lines."""
    if card[1] not in ("", "0"):
        message = (
            f"GRID {card[0]} is given in coordinate system {card[1]}; write it in the basic one"
        )
        raise lines.fail(card.line, message)
    x, y, z = (_real(card, card[k], lines) for k in (2, 3, 4))
    lines.add_node(card.line, _whole(card, card[0], lines), (x, y, z))


def _take(card: Card, lines: Lines, sets: dict[str, tuple[int, str]]) -> None:
    """Read one card, refuse it, or pass it over. Writes: lines, sets."""
    name = card.name.partition(" ")[0]
    if name in LOST:
        advice = "write the mesh flat, with grid points and elements"
        raise lines.fail(card.line, f"{name} would be ignored; {advice}")
    if name in SHELLS:
        _shell(card, SHELLS[name], lines)
    elif name in _other_types():
        lines.add_element(card.line, _whole(card, card[0], lines), _other_types()[name], ())
        _add_to_property(card, lines)
    elif name == "SET1":
        label = f"SET {card[0]}"
        if label in sets:
            raise lines.fail(card.line, f"{label} is given twice, first in line {sets[label][0]}")
        sets[label] = card.line, " ".join(card.fields[1:])
    elif name not in SILENT | {"GRID"}:
        lines.skip_card(card.line, name)


def _shell(card: Card, kind: str, lines: Lines) -> None:
    """A quadrilateral or a triangle of constant thickness without an offset. Writes: lines."""
    count = SIDES[kind]
    number = _whole(card, card[0], lines)
    nodes = tuple(_whole(card, card[2 + k], lines) for k in range(count))
    offset = card[3 + count]
    if offset and (not _is_real(offset) or _number(offset) != 0.0):
        message = f"{card.name} {number} has ZOFFS {offset}, which would be lost"
        raise lines.fail(card.line, f"{message}; put its nodes on its middle surface")
    if any(card[10 + k] for k in range(count)):
        message = f"{card.name} {number} has a thickness at its corners, which would be lost"
        raise lines.fail(card.line, f"{message}; make parts of constant thickness")
    if any(card[k] for k in range(10 + count, len(card.fields))):
        raise lines.fail(card.line, f"{card.name} {number} has more fields than are known")
    lines.add_element(card.line, number, kind, nodes)
    _add_to_property(card, lines)


def _add_to_property(card: Card, lines: Lines) -> None:
    """The property is the element's own number if the field is empty. Writes: lines."""
    number = _whole(card, card[0], lines)
    own = str(_whole(card, card[1] or card[0], lines))
    members = lines.element_sets.setdefault(own, [])
    assert isinstance(members, list)
    members.append(number)


def _case_sets(rows: list[tuple[int, str]]) -> dict[str, tuple[int, str]]:
    """Sets of the case control, with their lines and texts; a line that ends in a comma is
    continued.
    """
    sets: dict[str, tuple[int, str]] = {}
    label = ""
    for number, text in rows:
        text = text.partition("$")[0].strip().upper()
        match = re.match(r"SET\s+(\d+)\s*=\s*(.*)", text)
        if match:
            label = f"SET {int(match[1])}"
            sets[label] = number, match[2]
        elif label and text:
            sets[label] = sets[label][0], f"{sets[label][1]} {text}"
        if text and not text.endswith(","):
            label = ""
    return sets


def _add_sets(sets: dict[str, tuple[int, str]], lines: Lines) -> None:
    """Sets of nodes where all numbers are nodes', of elements where all are elements'."""
    for label, (_, text) in sets.items():
        for known, sets_of_kind in (
            (lines.nodes, lines.node_sets),
            (lines.elements, lines.element_sets),
        ):
            own = _members(text, known)
            if own and all(number in known for number in own):
                sets_of_kind[label] = own


def _members(text: str, known: Iterable[int]) -> dict[int, None] | None:
    """Numbers that a list such as `1, 5 THRU 9 EXCEPT 7` names; None where it is none."""
    words = re.split(r"[\s,]+", text.strip(" ,"))
    if words == ["ALL"]:
        return dict.fromkeys(known)
    own: dict[int, None] = {}
    first, last, leaves_out = 0, -1, False
    at = 0
    while at < len(words):
        word = words[at]
        if word == "THRU" and own and at + 1 < len(words) and words[at + 1].isdecimal():
            first, last, at = next(reversed(own)), int(words[at + 1]), at + 1
            # those of a range that are not there are none
            own.pop(first)
            own |= dict.fromkeys(number for number in known if first <= number <= last)
        elif word == "EXCEPT" and last >= first:
            leaves_out = True
        elif word.isdecimal() and leaves_out and first <= int(word) <= last:
            own.pop(int(word), None)
        elif word.isdecimal():
            own[int(word)], leaves_out = None, False
        else:
            return None
        at += 1
    return own


def _text(lines: Lines) -> str:
    """Grid points, quadrilaterals and triangles in free fields, for meshio."""
    text = ["BEGIN BULK"]
    text += [f"GRID,{n},,{x!r},{y!r},{z!r}" for n, (x, y, z) in lines.nodes.items()]
    for number, (kind, nodes) in lines.elements.items():
        if kind in SIDES:
            text.append(",".join(map(str, (WRITTEN[kind], number, 1, *nodes))))
    return "\n".join([*text, "ENDDATA"]) + "\n"


def _whole(card: Card, text: str, lines: Lines) -> int:
    if not text.isdecimal():
        raise lines.fail(card.line, f"{card.name}: '{text}' is not a whole number")
    return int(text)


def _real(card: Card, text: str, lines: Lines) -> float:
    if not _is_real(text):
        raise lines.fail(card.line, f"{card.name}: '{text}' is not a number")
    return _number(text)


def _is_real(text: str) -> bool:
    try:
        return math.isfinite(_number(text))
    except ValueError:
        return False


def _number(text: str) -> float:
    """Number of a field: 7.0, .7E1, 0.7+1, 70.-1, 7.D0; nothing is 0."""
    text = text.replace("D", "E") or "0"
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", text))


def _other_types() -> dict[str, str]:
    """Kinds of elements of meshio that are no shells, by Nastran's names."""
    from meshio.nastran._nastran import nastran_to_meshio_type

    return {
        name: kind if kind not in SIDES else name
        for name, kind in nastran_to_meshio_type.items()
        if name not in SHELLS
    }
