"""Lines of Abaqus .inp files: nodes, elements and sets, by their identifiers.

Keywords may be in any case and continue after lines that end in a comma; a set may be given in
several cards, which unite, by numbers, by ranges, by other sets, or as the nodes of a set of
elements. Keywords that would move or make nodes or elements elsewhere are refused; others are
passed over.
References: Abaqus Keywords Reference Manual, *ELEMENT, *ELGEN, *ELSET,
*INSTANCE, *NGEN, *NODE, *NSET.
"""

import math
from collections.abc import Container, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crashsolve.foundation.mesh_files.reading import SIDES, Lines

# keywords that define nodes and elements, beside *NODE and *ELEMENT
LOST = {
    "SYSTEM",
    "TRANSFORM",
    "NCOPY",
    "ELCOPY",
    "NFILL",
    "NMAP",
    "INCLUDE",
    "IMPORT",
    "MODEL CHANGE",
    "PARAMETER",
}
# one part that is one instance: its numbers are those of the file
FRAME = {"PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE"}
PARAMETERS = {
    "NODE": {"NSET", "SYSTEM"},
    "NGEN": {"NSET"},
    "ELGEN": {"ELSET"},
    "ELEMENT": {"TYPE", "ELSET"},
    "NSET": {"NSET", "ELSET", "GENERATE", "UNSORTED", "INTERNAL", "INSTANCE"},
    "ELSET": {"ELSET", "GENERATE", "UNSORTED", "INTERNAL", "INSTANCE"},
}
# quadrilaterals and triangles that meshio does not know
FURTHER = {"R3D4": "quad", "M3D4": "quad", "M3D4R": "quad", "M3D3": "triangle"}
# its name for either
WRITTEN = {"quad": "S4", "triangle": "S3"}
SILENT = {"HEADING", "PREPRINT"}
# numbers that one line may generate: a gigabyte of nodes
MOST = 10_000_000
# offsets of shells with the effect of none
MIDDLE = {"0", "0.", "0.0", "MID", "MIDDLE"}


class Row(NamedTuple):
    """A line of data: its number and its fields."""

    line: int
    fields: list[str]


class Keyword(NamedTuple):
    """A keyword with its parameters, None for those without a value, and its lines of data."""

    line: int
    word: str
    parameters: dict[str, str | None]
    rows: list[Row]


def read_lines(path: Path) -> Lines:
    """The content of the file. Raises MeshFileError."""
    reader = _Reader(Lines(path.name))
    for keyword in _keywords(path, reader.lines):
        reader.take(keyword)
    return reader.finished()


def _keywords(path: Path, lines: Lines) -> Iterator[Keyword]:
    """All keywords of a file, with the lines that belong to each."""
    current: Keyword | None = None
    head, start = "", 0
    for number, text in enumerate(path.read_text("utf-8", errors="replace").splitlines(), 1):
        text = text.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*") or head:
            head, start = head + text, start or number
            if head.endswith(","):
                continue
            if current:
                yield current
            current = _keyword(start, head, lines)
            head, start = "", 0
        elif current:
            current.rows.append(Row(number, [part.strip() for part in text.split(",")]))
        else:
            raise lines.fail(number, "is before the first keyword")
    if head:
        raise lines.fail(start, "the keyword is not complete: it ends in a comma")
    if current:
        yield current


def _keyword(line: int, text: str, lines: Lines) -> Keyword:
    word, *rest = text.lstrip("*").split(",")
    parameters: dict[str, str | None] = {}
    for part in rest:
        name, equals, value = part.partition("=")
        name = " ".join(name.split()).upper()
        if name in parameters:
            raise lines.fail(line, f"{name} is given twice")
        if name:
            parameters[name] = value.strip().strip('"') if equals else None
    return Keyword(line, " ".join(word.split()).upper(), parameters, [])


def _positions(count: int, rows: int, layers: int) -> Iterator[tuple[int, int, int]]:
    """All positions of *ELGEN, one by one: the first that has no nodes ends it."""
    for i in range(count):
        for j in range(rows):
            for k in range(layers):
                yield i, j, k


def _whole_rows(rows: list[Row], count: int) -> Iterator[Row]:
    """Rows joined with those that continue after a comma, unless they have `count` fields."""
    start, fields = 0, list[str]()
    for line, more in rows:
        start, fields = (start, fields + more) if fields else (line, more)
        goes_on = not fields[-1]
        fields = [text for text in fields if text]
        if not goes_on or len(fields) == count:
            yield Row(start, fields)
            fields = []
    if fields:
        # a comma at the end of the last line
        yield Row(start, fields)


class _Reader:
    """Collects nodes, elements and sets, keyword by keyword."""

    def __init__(self, lines: Lines) -> None:
        self.lines = lines
        self.sets: dict[str, dict[str, dict[int, None]]] = {"NSET": {}, "ELSET": {}}
        self.written: dict[tuple[str, str], str] = {}  # names as first written
        self.known = _known_types()
        self.framed: dict[str, str] = {}

    def take(self, keyword: Keyword) -> None:
        """Read one keyword, refuse it, or pass it over."""
        line, word, parameters, _ = keyword
        if word in FRAME:
            self.frame(keyword)
            return
        if word in LOST:
            advice = "write the mesh flat, with nodes and elements"
            raise self.lines.fail(line, f"*{word} would be ignored; {advice}")
        if "SECTION" in word and (parameters.get("OFFSET") or "0").upper() not in MIDDLE:
            message = f"*{word}, OFFSET={parameters['OFFSET']} would be ignored"
            raise self.lines.fail(line, f"{message}: nodes lie in the middle of the thickness")
        if word not in PARAMETERS:
            if word not in SILENT:
                self.lines.skip_card(line, f"*{word}")
            return
        is_round = (parameters.get("SYSTEM") or "R").upper() != "R"
        if is_round or not parameters.keys() <= PARAMETERS[word]:
            pairs = parameters.items()
            reason = [name if value is None else f"{name}={value.upper()}" for name, value in pairs]
            message = f"*{', '.join([word, *reason])} would be ignored"
            raise self.lines.fail(line, f"{message}; write the mesh flat")
        readers = {"NODE": self.nodes, "ELEMENT": self.elements, "NSET": self.nset}
        readers |= {"ELSET": self.elset, "NGEN": self.ngen, "ELGEN": self.elgen}
        readers[word](keyword)

    def frame(self, keyword: Keyword) -> None:
        """One part and one instance of it, which may be moved; more would number nodes alike."""
        word = keyword.word
        if word in ("PART", "INSTANCE") and word in self.framed:
            message = f"a second *{word} numbers its nodes anew"
            raise self.lines.fail(keyword.line, f"{message}; write the mesh flat")
        self.framed[word] = (keyword.parameters.get("NAME") or "").upper()
        part = (keyword.parameters.get("PART") or "").upper()
        if word == "INSTANCE" and part != self.framed.get("PART"):
            message = f"there is no *PART '{keyword.parameters.get('PART') or ''}' before this line"
            raise self.lines.fail(keyword.line, message)
        if word == "INSTANCE" and keyword.rows:
            self.move(keyword)

    def move(self, keyword: Keyword) -> None:
        """Translate the nodes given so far by the first line, then rotate them by the second one:
        about the axis from one point to another, in degrees.
        """
        given = [(line, [self.real(line, x) for x in fields]) for line, fields in keyword.rows]
        if any(len(x) != n for (_, x), n in zip(given, (3, 7), strict=False)) or len(given) > 2:
            message = "*INSTANCE needs a translation, and then two points of an axis and an angle"
            raise self.lines.fail(keyword.line, message)
        points = np.array(list(self.lines.nodes.values())) + given[0][1]
        for line, numbers in given[1:]:
            start, end, angle = np.array(numbers[:3]), np.array(numbers[3:6]), numbers[6]
            length = float(np.linalg.norm(end - start))
            if not length > 0.0:
                raise self.lines.fail(line, "the two points of the axis are one")
            u, arms, phi = (end - start) / length, points - start, math.radians(angle)
            along = (arms @ u)[:, None] * u
            points = start + along + math.cos(phi) * (arms - along)
            points += math.sin(phi) * np.cross(u, arms)
        positions = map(tuple, points.tolist())
        self.lines.nodes.update(zip(self.lines.nodes, positions, strict=True))

    def nodes(self, keyword: Keyword) -> None:
        own: dict[int, None] = {}
        for line, fields in keyword.rows:
            while fields and not fields[-1]:
                fields.pop()
            if not 1 < len(fields) < 5:
                raise self.lines.fail(line, "a node has a number and up to three coordinates")
            position = [self.real(line, text) for text in fields[1:]] + [0.0, 0.0]
            number = self.whole(line, fields[0])
            self.lines.add_node(line, number, (position[0], position[1], position[2]))
            own[number] = None
        self.unite("NSET", keyword.parameters.get("NSET"), own)

    def elements(self, keyword: Keyword) -> None:
        given = (keyword.parameters.get("TYPE") or "").upper()
        if not given:
            raise self.lines.fail(keyword.line, "*ELEMENT needs a TYPE")
        kind = FURTHER.get(given) or self.known.get(given, given)
        own: dict[int, None] = {}
        for line, fields in _whole_rows(keyword.rows, SIDES.get(kind, 0) + 1):
            numbers = [self.whole(line, text) for text in fields]
            if kind in SIDES and len(numbers) != SIDES[kind] + 1:
                reason = f"{len(numbers) - 1} nodes follow, not {SIDES[kind]}"
                raise self.lines.fail(
                    line, f"element {numbers[0]} is of type {given}, but {reason}"
                )
            nodes = tuple(numbers[1:]) if kind in SIDES else ()
            self.lines.add_element(line, numbers[0], kind, nodes)
            own[numbers[0]] = None
        self.unite("ELSET", keyword.parameters.get("ELSET"), own)

    def ngen(self, keyword: Keyword) -> None:
        """Nodes at equal distances between two that are given: first, last, increment."""
        own: dict[int, None] = {}
        for line, fields in keyword.rows:
            numbers = self.generated(line, [text for text in fields if text], "*NGEN")
            ends = numbers[0], numbers[-1]
            if missing := [n for n in ends if n not in self.lines.nodes]:
                raise self.lines.fail(line, f"node {missing[0]} is not given before this line")
            first, last = (self.lines.nodes[n] for n in ends)
            for k, number in enumerate(numbers[1:-1], 1):
                share = k / (len(numbers) - 1)
                x, y, z = (a + share * (b - a) for a, b in zip(first, last, strict=True))
                self.lines.add_node(line, number, (x, y, z))
            own |= dict.fromkeys(numbers)
        self.unite("NSET", keyword.parameters.get("NSET"), own)

    def elgen(self, keyword: Keyword) -> None:
        """Copies of an element along a row, in rows and in layers: count, of nodes, of elements."""
        own: dict[int, None] = {}
        for line, fields in keyword.rows:
            master, *given = [self.whole(line, text) if text else 1 for text in fields]
            if master not in self.lines.elements:
                raise self.lines.fail(line, f"element {master} is not given before this line")
            if not given or len(given) > 9 or min(given) < 1:
                message = "needs an element, and up to three times a count and two increments"
                raise self.lines.fail(line, f"*ELGEN {message}, of nodes and of elements")
            kind, nodes = self.lines.elements[master]
            if kind not in SIDES:
                message = f"element {master} is of type {kind}, whose nodes are not read"
                raise self.lines.fail(line, message)
            given += [1] * (9 - len(given))
            own[master] = None
            for i, j, k in _positions(*given[::3]):
                of_nodes, of_elements = (
                    i * given[at] + j * given[3 + at] + k * given[6 + at] for at in (1, 2)
                )
                if of_elements:
                    number = master + of_elements
                    self.lines.add_element(line, number, kind, tuple(n + of_nodes for n in nodes))
                    own[number] = None
        self.unite("ELSET", keyword.parameters.get("ELSET"), own)

    def nset(self, keyword: Keyword) -> None:
        own = self.members("NSET", keyword, self.lines.nodes)
        of_elements = keyword.parameters.get("ELSET")
        if of_elements is not None:
            for number in self.named("ELSET", of_elements, keyword.line):
                kind, nodes = self.lines.elements[number]
                if kind not in SIDES:
                    message = f"*NSET, ELSET={of_elements}: element {number} is of type {kind}"
                    raise self.lines.fail(keyword.line, f"{message}, whose nodes are not read")
                own |= dict.fromkeys(nodes)
        self.unite("NSET", self.name_of(keyword), own)

    def elset(self, keyword: Keyword) -> None:
        own = self.members("ELSET", keyword, self.lines.elements)
        self.unite("ELSET", self.name_of(keyword), own)

    def name_of(self, keyword: Keyword) -> str:
        name = keyword.parameters.get(keyword.word)
        if not name:
            message = f"*{keyword.word} needs a name: {keyword.word}=NAME"
            raise self.lines.fail(keyword.line, message)
        instance = keyword.parameters.get("INSTANCE")
        if instance is not None and instance.upper() != self.framed.get("INSTANCE"):
            message = f"there is no *INSTANCE '{instance}' before this line"
            raise self.lines.fail(keyword.line, message)
        return name

    def members(self, family: str, keyword: Keyword, known: Container[int]) -> dict[int, None]:
        """Identifiers that the lines of a set name."""
        own: dict[int, None] = {}
        what = {"NSET": "node", "ELSET": "element"}[family]
        for line, fields in keyword.rows:
            fields = [text for text in fields if text]
            if "GENERATE" in keyword.parameters:
                numbers: Iterable[int] = self.generated(line, fields)
            else:
                numbers = []
                for text in fields:
                    is_name = not text.lstrip("+-").isdecimal()
                    numbers += self.named(family, text, line) if is_name else [int(text)]
            for number in numbers:
                if number not in known:
                    message = f"{what} {number} of the set is not given before this line"
                    raise self.lines.fail(line, message)
                own[number] = None
        return own

    def generated(self, line: int, fields: list[str], word: str = "GENERATE") -> range:
        """Numbers from first to last, by an increment."""
        numbers = [self.whole(line, text) for text in fields] + [1] * (len(fields) == 2)
        if len(numbers) != 3 or numbers[2] < 1 or numbers[1] < numbers[0]:
            raise self.lines.fail(line, f"{word} needs first, last and increment, in this order")
        if (numbers[1] - numbers[0]) % numbers[2]:
            raise self.lines.fail(line, f"no number of steps of {numbers[2]} leads to the last one")
        if numbers[1] - numbers[0] > MOST * numbers[2]:
            raise self.lines.fail(line, f"{word} makes more than {MOST} numbers")
        return range(numbers[0], numbers[1] + 1, numbers[2])

    def named(self, family: str, name: str, line: int) -> dict[int, None]:
        """Members of a set given before."""
        key = name.strip('"').upper()
        if key not in self.sets[family]:
            raise self.lines.fail(line, f"there is no *{family} '{name}' before this line")
        return self.sets[family][key]

    def unite(self, family: str, name: str | None, own: dict[int, None]) -> None:
        """Add members to a set; names do not depend on case. Writes: self.sets."""
        if name:
            self.written.setdefault((family, name.upper()), name)
            self.sets[family].setdefault(name.upper(), {}).update(own)

    def whole(self, line: int, text: str) -> int:
        try:
            return int(text)
        except ValueError:
            raise self.lines.fail(line, f"'{text}' is not a whole number") from None

    def real(self, line: int, text: str) -> float:
        try:
            value = float(text.upper().replace("D", "E") or 0.0)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.lines.fail(line, f"'{text}' is not a number")
        return value

    def finished(self) -> Lines:
        """The lines, with a text of nodes and elements alone and with all sets."""
        lines = self.lines
        text = ["*NODE"]
        text += [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in lines.nodes.items()]
        before = ""
        for number, (kind, nodes) in lines.elements.items():
            if kind not in SIDES:
                continue
            text += [f"*ELEMENT, TYPE={WRITTEN[kind]}"] * (kind != before)
            text.append(", ".join(map(str, (number, *nodes))))
            before = kind
        lines.text = "\n".join(text) + "\n"
        for family, sets in (("NSET", lines.node_sets), ("ELSET", lines.element_sets)):
            for key, own in self.sets[family].items():
                sets[self.written[family, key]] = own
        return lines


def _known_types() -> dict[str, str]:
    """Kinds of elements of meshio by Abaqus's types."""
    from meshio.abaqus._abaqus import abaqus_to_meshio_type

    return dict(abaqus_to_meshio_type)
