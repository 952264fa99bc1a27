"""Decks with something changed at random, and results with something broken; from a seed."""

import copy
import random
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import yaml

DECKS = Path(__file__).resolve().parents[2] / "decks"
Route = tuple[str | int, ...]

QUANTITY = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?( [^ ].*)?")
NUMBERS = (0, 1, -1, 2, 3, 0.5, -0.5, 10**6, 10**12, 10**350, 5e-324, 1e-300, 1e-200, 1e-150)
NUMBERS += (1e-30, 1e-12, 1e-9, 1e9, 1e12, 1e30, 1e150, 1e200, 1e300, 1e308, -1e308)
FACTORS = (-1.0, 0.1, 10.0, 100.0, 1e3, 1e6, 1e-6)
WORDS = (None, True, [], {}, "", "ground", "x", "a b", "é", [1, 2], [[]], {"type": "linear"})
WORDS += ("\0", "\x1b[2J", "a\nwarning: forged", "a\u2028b", "../../etc/passwd", "x" * 5000)
WORDS += ("${", "${1/0}", "${10**400}", "${" + "9" * 400 + "}", "1 m", "-3 kN/mm", "9" * 400)


class Decks:
    """The decks of the project in a folder of their own, with the files they name."""

    def __init__(self, folder: Path) -> None:
        shutil.copytree(DECKS, folder)
        paths = [p for p in sorted(folder.rglob("*.yaml")) if not p.name.endswith(".plan.yaml")]
        self.data = {path: yaml.safe_load(path.read_text("utf-8")) for path in paths}

    def changed(self, rng: random.Random, numbers_alone: bool) -> Path:
        """A deck beside its original with one to three things changed."""
        path = rng.choice(list(self.data))
        data = copy.deepcopy(self.data[path])
        for _ in range(rng.choice((1, 1, 2, 3))):
            if numbers_alone or rng.random() < 0.6:
                change_number(data, rng)
            else:
                change_anything(data, rng)
        changed = path.parent / "changed.yaml"
        text = yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
        changed.write_bytes(text.encode("utf-8", "replace"))
        return changed


def routes(value: Any, route: Route = ()) -> Iterator[Route]:
    """Paths of all values."""
    for step, part in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*route, step)
        if isinstance(part, dict | list):
            yield from routes(part, (*route, step))


def holder(data: Any, route: Route) -> Any:
    """The table or list in which the value at the end of a route stands."""
    for step in route[:-1]:
        data = data[step]
    return data


def change_number(data: object, rng: random.Random) -> None:
    """Another number in place of one, with its unit."""
    routes_of_numbers = [
        route
        for route in routes(data)
        if not isinstance(value := holder(data, route)[route[-1]], bool | None)
        and not isinstance(value, dict | list)
        and QUANTITY.fullmatch(str(value))
    ]
    if not routes_of_numbers:
        return
    route = rng.choice(routes_of_numbers)
    old = holder(data, route)[route[-1]]
    unit = (QUANTITY.fullmatch(str(old)) or [""] * 4)[3] or ""
    text = str(old).removesuffix(unit)
    new = rng.choice(NUMBERS) if rng.random() < 0.6 else float(text) * rng.choice(FACTORS)
    if text.isdigit() and isinstance(new, float) and new.is_integer() and abs(new) < 1e18:
        new = int(new)
    holder(data, route)[route[-1]] = f"{new}{unit}" if unit else new


def change_anything(data: object, rng: random.Random) -> None:
    """A value replaced, left out, or put into the position of another."""
    all_routes = list(routes(data))
    # earlier changes may have left nothing
    if not all_routes:
        return
    route = rng.choice(all_routes)
    table, direction = holder(data, route), rng.random()
    if direction < 0.3 and isinstance(table, dict):
        del table[route[-1]]
    elif direction < 0.6:
        other = rng.choice(all_routes)
        table[route[-1]] = copy.deepcopy(holder(data, other)[other[-1]])
    elif direction < 0.7 and isinstance(table, dict):
        table[str(rng.choice(WORDS))] = table.pop(route[-1])
    else:
        table[route[-1]] = copy.deepcopy(rng.choice(WORDS))


ATTRIBUTES: tuple[object, ...] = (1, b"\xff\xfe", "{", "[1]", "null", '{"figures": 5}', "[[1]]")
ATTRIBUTES += ('[{"channel": 1}]', np.zeros(3), "[]", "\x1b[2J", np.nan, "[" * 5000, "9" * 5000)
ATTRIBUTES += ('{"figures": [{"y": [{}]}]}', '{"figures": [1]}')
ATTRIBUTES += ('[{"channel": "a", "statistic": "max", "value": "x", "tolerance": []}]',)
STATUSES = (b"", b"{", b"\xff", b"[" * 100_000, b'{"state": 5}', b"9" * 10_000)
STATUSES += (b'{"state": "finished", "time": "x", "watched": [{"channel": 1, "during": 5}]}',)
STATUSES += (b'{"state": "finished", "end_time": {}, "cpu": NaN, "average_step": {"a": "b"}}',)
STATUSES += (b'{"state": "finished", "time": 1e400, "cycle": ' + b"9" * 4000 + b"}",)
STATUSES += (b'{"state": "finished", "message": "\\u001b[2J\\nforged", "cpu_stages": 3}',)


def damage(folder: Path, rng: random.Random) -> str:
    """Break something in a results folder; returns what."""
    direction = rng.random()
    if direction < 0.45:
        return _damage_structure(folder / "history.h5", rng)
    return (
        _damage_bytes(folder / "history.h5", rng) if direction < 0.8 else _damage_text(folder, rng)
    )


def _damage_structure(path: Path, rng: random.Random) -> str:
    """Another kind, shape or value of a dataset or attribute."""
    with h5py.File(path, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        name = rng.choice([name for name in names if name in file])
        holder_name, _, last = name.rpartition("/")
        group = file[holder_name] if holder_name else file
        direction = rng.randrange(12)
        if direction < 3:
            attributes = (file if direction < 2 else file[name]).attrs
            if not attributes:
                return "nothing"
            key = rng.choice(list(attributes))
            if direction == 0:
                del attributes[key]
            else:
                attributes[key] = rng.choice(ATTRIBUTES)
            return f"attribute {key} of {name if direction == 2 else '/'}"
        if direction == 3 and isinstance(file[name], h5py.Dataset) and file[name].dtype.kind == "f":
            file[name][...] = rng.choice((np.nan, np.inf, 1e308))
            return f"values of {name}"
        del file[name]
        new: tuple[object, ...] = (np.zeros((3, 3, 3)), "text", np.array([b"a", b"b"]))
        new += (np.full(5, 1j), h5py.SoftLink("/"), h5py.ExternalLink("/etc/passwd", "/"))
        if direction == 4:
            group.create_dataset(last, shape=(10**12,), chunks=(1024,), dtype="f8")
        elif direction == 5:
            group.create_dataset(last, shape=(0,), dtype="f8")
        elif direction == 6:
            group.create_group(last)
        elif direction > 7:
            group[last] = rng.choice(new)
        return f"{name}, {direction}"


def _damage_bytes(path: Path, rng: random.Random) -> str:
    """A part missing, bytes or bits changed, mostly where HDF5 keeps its own."""
    content = bytearray(path.read_bytes())
    if rng.random() < 0.3:
        size = rng.randrange(len(content))
        path.write_bytes(content[:size])
        return f"cut to {size}"
    count = rng.choice((1, 4, 64, 1024))
    zone = rng.choice((len(content), min(len(content), 8192)))
    for _ in range(count):
        content[rng.randrange(zone)] ^= 1 << rng.randrange(8)
    path.write_bytes(content)
    return f"{count} bits of the first {zone} bytes"


def _damage_text(folder: Path, rng: random.Random) -> str:
    """status.json or log.txt of another kind."""
    path = folder / rng.choice(("status.json", "log.txt"))
    path.unlink()
    if rng.random() < 0.2:
        path.mkdir()
        return f"{path.name} a folder"
    path.write_bytes(rng.choice((*STATUSES, b"\x1b[2J\nwarnings: 1\n     1 x  \x1b[31m")))
    return path.name
