"""The folder tree as the registry of laws: the deck's `type: word` is the file `<folder>/word.py`.

Types are found by looking at files; only the modules a deck uses are imported.
"""

import importlib
import re
from collections.abc import Iterable
from difflib import get_close_matches
from functools import cache
from os.path import isfile
from pathlib import Path
from typing import TYPE_CHECKING

from crashsolve.deck.family import FamilyError, check_law, imported
from crashsolve.deck.renamed import RENAMED

if TYPE_CHECKING:
    from crashsolve.deck.card import Card

# how much a wrong word must be like a type to be a misspelling of it, 1 for the same
ALIKE = 0.75
# letters of a word that a message quotes
LONGEST = 80
PACKAGE = __name__.partition(".")[0]


class UnknownType(Exception):
    """A `type:` word without a file; `near` is the type it misspells, or ""."""

    def __init__(self, message: str, advice: str, near: str = "") -> None:
        self.message = message
        self.advice = advice
        self.near = near
        super().__init__(message, advice)


def shortened(word: str) -> str:
    """A word as a message quotes it: of a long one its beginning."""
    return word if len(word) <= LONGEST else f"{word[:LONGEST]}..."


def class_name(word: str) -> str:
    """Name of the card in the file of this type: linear_spring -> LinearSpring."""
    return "".join(part.capitalize() for part in word.split("_"))


def package_folder() -> Path:
    """Root folder of the package that holds the families."""
    return Path(next(iter(importlib.import_module(PACKAGE).__path__)))


@cache
def types_in(folder: str) -> dict[str, Path]:
    """Type words of a family folder and their files, sorted; files without a card are left out."""
    root = package_folder() / folder
    return {
        path.stem: path
        for path in sorted(root.glob("[!_]*.py"))
        if re.search(rf"^class {class_name(path.stem)}\(", path.read_text("utf-8"), re.MULTILINE)
    }


def law_class(folder: str, word: object) -> "type[Card]":
    """Card class of a type, its module imported now; raises UnknownType."""
    types = types_in(folder)
    if not isinstance(word, str) or word not in types:
        near = get_close_matches(str(word), list(types), n=1, cutoff=ALIKE)
        advice = choices(word, types, "types")
        if isinstance(word, str) and word.isidentifier() and word[0] != "_":
            file = Path(folder) / f"{word}.py"
            # asked of the system, a name longer than it allows would be an error
            if isfile(package_folder() / file):
                location = f"{PACKAGE}/{file.as_posix()}"
                advice = f"{location} has no `class {class_name(word)}(...)`, its card"
        raise UnknownType(f"unknown type '{shortened(str(word))}'", advice, "".join(near))
    module = imported(f"{PACKAGE}.{folder.replace('/', '.')}.{word}", types[word])
    check_law(module)
    card: type[Card] = getattr(module, class_name(word))
    if not hasattr(card, "model_validate"):
        raise FamilyError(f"{module.__name__}: {card.__name__} must be a Card")
    return card


def type_word(card: "Card") -> str:
    """Type word of a card of a family: the name of its file."""
    return type(card).__module__.rpartition(".")[2]


# fields by the symbols and words that other codes and textbooks have for them
SYMBOLS = {
    "E": ("young", "young_a"),
    **dict.fromkeys(("youngs_modulus", "modulus", "elastic_modulus"), ("young", "young_a")),
    **dict.fromkeys(("nu", "pr", "poissons_ratio"), ("poisson", "poisson_a")),
    **dict.fromkeys(("rho", "ro", "rho0"), ("density", "density_a")),
    **dict.fromkeys(("yield", "sigma_y", "sigy", "fy", "Y", "sy"), ("yield_stress", "yield_force")),
    **dict.fromkeys(("etan", "Et", "tangent_modulus"), ("tangent", "hardening")),
    **dict.fromkeys(
        ("mu", "friction_coefficient"), ("coefficient", "dynamic", "friction_coefficient")
    ),
    **dict.fromkeys(("mu_s", "mu_static"), ("static",)),
    **dict.fromkeys(("mu_k", "mu_d", "mu_dynamic"), ("dynamic",)),
    **dict.fromkeys(("e", "cor", "epsilon"), ("restitution", "exponent")),
    "g": ("acceleration", "gravity"),
    **dict.fromkeys(("k", "K"), ("stiffness",)),
    **dict.fromkeys(("c", "d"), ("damping",)),
    **dict.fromkeys(("zeta", "xi"), ("damping_ratio", "damping")),
    "t": ("thickness", "end_time", "during"),
    **dict.fromkeys(("h", "dt"), ("step", "interval", "thickness", "height")),
    **dict.fromkeys(("tend", "t_end", "T", "duration"), ("end_time", "torque")),
    "m": ("mass", "softening"),
    **dict.fromkeys(("I", "J"), ("inertia", "torsion")),
    **dict.fromkeys(("v", "v0", "vel"), ("velocity", "speed")),
    **dict.fromkeys(("w", "omega", "omega0", "spin"), ("angular_velocity", "width")),
    **dict.fromkeys(("x", "x0", "pos", "r0"), ("position", "at")),
    **dict.fromkeys(("q", "quat"), ("quaternion", "rotation")),
    **dict.fromkeys(("r", "R"), ("radius",)),
    **dict.fromkeys(("l", "L"), ("length",)),
    "b": ("width", "kinematic"),
    "n": ("exponent", "elements", "normal"),
    "p": ("pressure",),
    "F": ("force",),
    "M": ("torque",),
    "A": ("area", "yield_stress"),
    "B": ("hardening",),
    "C": ("rate",),
    "H": ("hardening",),
    "alpha": ("drag",),
    "beta": ("kinematic", "damping"),
}


def nearest(word: object, known: Iterable[str]) -> str:
    """Question about a wrong word: the right one most like it, if any is."""
    names = list(known)
    if RENAMED.get(str(word)) in names:
        return f"it is called '{RENAMED[str(word)]}' now"
    near = get_close_matches(str(word), names, n=1)
    return f"did you mean '{near[0]}'?" if near else ""


def nearest_field(word: object, known: Iterable[str]) -> str:
    """The same for a field of a card, which may be known by its symbol."""
    names, text = list(known), str(word)
    for meant in (*SYMBOLS.get(text, ()), text.lower()):
        if meant in names:
            return f"did you mean '{meant}'?"
    return nearest(word, names)


def choices(word: object, known: Iterable[str], what: str) -> str:
    """Advice on a wrong word: the right one most like it, and the list of all."""
    names = list(known)
    listed = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    question = nearest_field(word, names) if what == "fields" else nearest(word, names)
    return f"{question} ({what}: {listed or 'none'})".lstrip()
