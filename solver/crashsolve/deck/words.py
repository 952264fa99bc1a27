"""Advice on a word that a deck has wrong: the right one most like it, and those that there are."""

from collections.abc import Iterable

from crashsolve.deck.renamed import RENAMED

# letters of a word that a message quotes
LONGEST = 80
# names that other codes have for the ground
FIXED = ("world", "fixed", "earth", "inertial", "reference", "base", "0")
# fields by the symbols and words that other codes and textbooks have for them
SYMBOLS = {
    "E": ("young", "young_a"),
    **dict.fromkeys(("youngs_modulus", "modulus", "elastic_modulus"), ("young", "young_a")),
    **dict.fromkeys(("nu", "pr", "poissons_ratio"), ("poisson", "poisson_a")),
    **dict.fromkeys(("rho", "ro", "rho0"), ("density", "density_a")),
    **dict.fromkeys(("yield", "sigma_y", "sigy", "fy", "Y", "sy"), ("yield_stress", "yield_force")),
    **dict.fromkeys(("etan", "Et", "tangent_modulus"), ("tangent", "hardening")),
    **dict.fromkeys(("mu", "friction_coefficient"), ("friction_coefficient", "dynamic")),
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
    meant = _meant(str(word), names)
    if meant and meant == RENAMED.get(str(word)):
        return f"it is called '{meant}' now"
    return f"did you mean '{meant}'?" if meant else ""


def _meant(word: str, names: list[str]) -> str:
    """The name most like a word, or its present one; "" where none is."""
    if RENAMED.get(word) in names:
        return RENAMED[word]
    from difflib import get_close_matches

    return next(iter(get_close_matches(word, names, n=1)), "")


def meant_field(word: object, known: Iterable[str]) -> str:
    """The field that is most like a wrong one, also by its symbol; "" where none is."""
    names, text = list(known), str(word)
    symbols = (*SYMBOLS.get(text, ()), text.lower())
    return next((name for name in symbols if name in names), "") or _meant(text, names)


def nearest_field(word: object, known: Iterable[str]) -> str:
    """Question about a wrong field of a card: the right one most like it, also by its symbol."""
    names = list(known)
    meant = meant_field(word, names)
    is_like = meant and meant != RENAMED.get(str(word))
    return f"did you mean '{meant}'?" if is_like else nearest(word, names)


def choices(word: object, known: Iterable[str], what: str) -> str:
    """Advice on a wrong word: the right one most like it, and the list of all."""
    names = list(known)
    if what == "bodies" and str(word).lower() in FIXED:
        return "what never moves is called 'ground'"
    question = nearest_field(word, names) if what == "fields" else nearest(word, names)
    return f"{question} ({what}: {listed(names)})".lstrip()


def listed(known: Iterable[str]) -> str:
    """The first of the names that there are."""
    names = list(known)
    return ", ".join(names[:12]) + (", ..." if len(names) > 12 else "") or "none"


def shortened(word: str) -> str:
    """A word as a message quotes it: of a long one its beginning."""
    return word if len(word) <= LONGEST else f"{word[:LONGEST]}..."
