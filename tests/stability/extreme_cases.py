"""The stability matrix: what matrix.yaml says, and what no channel can say of its cases."""

from collections.abc import Iterator
from math import exp
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from long_chains import chain, loop
from sweeps import ALL, EXPLICIT, RATTLE, STIFF, Sweep

from crashpost.results.result import Result
from crashsolve.deck.reading.expressions import Expression

SETS = {"all": ALL, "explicit": EXPLICIT, "stiff": STIFF}


def damping_factors(e: float, weak: float) -> dict[str, float]:
    """chi(e) of the laws of restitution, as published (solver/theory/contact.md)."""
    return {
        "flores": 8 * (1 - e) / (5 * e),
        "gonthier": (1 - e * e) / e,
        "hu_guo": 3 * (1 - e) / (2 * e),
        "herbert": 6 * (1 - weak) / ((2 * weak - 1) ** 2 + 3),
        "hunt": 3 * (1 - weak) / 2,
        "lankarani": 3 * (1 - weak * weak) / 4,
        "lee": 3 * (1 - weak) / 4,
    }


def returned(chi: float) -> float:
    """Root x of chi (1 + x) = ln((1 + chi)/(1 - chi x)), by bisection."""
    low, high = 0.0, min(1.0, 1.0 / chi) if chi > 0 else 1.0
    for _ in range(100 if chi > 0 else 0):
        x = 0.5 * (low + high)
        over = (1 + chi) * exp(-chi * (1 + x)) - (1 - chi * x)
        low, high = (x, high) if over < 0 else (low, x)
    return high


def restitutions(result: Result, settings: dict[str, str]) -> Iterator[tuple[str, float, float]]:
    """What every law returns, against the exact relation of its damping factor."""
    given = result.stored_json("parameters")
    for law, chi in damping_factors(given["e"], given["e_weak"]).items():
        x = result.series(f"rbdout.{law}.velocity.z").values[-1] / given["v"]
        # second order: as for the law whose restitution is known in the deck
        yield f"restitution of {law}", abs(x - returned(chi)), 2e-3


def flips(result: Result, settings: dict[str, str]) -> Iterator[tuple[str, float, float]]:
    """How often the nut has turned over: twice in every period."""
    w, x, y, z = (result.series(f"rbdout.nut.quaternion.{c}").values for c in "wxyz")
    given = result.stored_json("parameters")
    momentum = given["w1"], 2.0 * given["w2"], 3.0 * given["w3"]
    axis = 2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)
    along = sum(a * m for a, m in zip(axis, momentum, strict=True))
    changes = np.count_nonzero(np.diff(np.sign(along)))
    yield "flips", abs(changes - 2 * given["periods"]), 0.0


def emptied(result: Result, settings: dict[str, str]) -> Iterator[tuple[str, float, float]]:
    """That a retractor which ran out of webbing is said to have."""
    log = (result.folder / "log.txt").read_text("utf-8")
    yield "warnings that are missing", float("ran out of webbing" not in log), 0.0


LOOKS = {"restitutions": restitutions, "flips": flips, "emptied": emptied}
MAKES = {"chain": chain, "loop": loop}


def number(word: Any) -> Any:
    """A number as YAML has it, or the value of an expression."""
    return Expression(word).value({}) if isinstance(word, str) else word


def sweep(words: dict[str, Any]) -> Sweep:
    """A case of matrix.yaml."""
    given = {"deck": "", **words}
    given |= {name: tuple(map(number, given.get(name, ()))) for name in ("values", "quick")}
    methods = given.get("integrators", RATTLE)
    listed = [methods] if isinstance(methods, str) else methods
    given["integrators"] = tuple(m for word in listed for m in SETS.get(word, (word,)))
    given["also"] = {name: str(value) for name, value in given.get("also", {}).items()}
    for name, known in (("look", LOOKS), ("make", MAKES)):
        if name in words:
            given[name] = known[words[name]]
    return Sweep(**given)


TABLE = Path(__file__).parent / "matrix.yaml"
MATRIX = tuple(map(sweep, yaml.safe_load(TABLE.read_text("utf-8"))))
