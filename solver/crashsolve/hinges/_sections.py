"""Hinge curves from sections and materials: plastic moments and yield forces of any section.

    M_p = Y Z,   N_p = Y A

Z is the plastic modulus (sections/_plastic.py). The elastic line is that of a member of some length
under constant moment or force: k = E I / L, k = E A / L. Collapse of tubes is in _collapse.py.
Consequence to test: M_p = Y b h^2 / 4 for a rectangle, Y D^3 / 6 for a round bar.

Reference: Neal (1977), The Plastic Methods of Structural Analysis, 1.3.
"""

from typing import Any

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.foundation.curve import HOLD
from crashsolve.hinges import _collapse
from crashsolve.sections._plastic import plastic_moduli

# rad or m: further than any hinge turns or shortens
ENDLESS = 1e3
# breakpoints, coefficients, extrapolation
Points = tuple[np.ndarray, np.ndarray, int]


def material_of(card: Any, field: str, built: Columns, scene: Scene) -> tuple[float, float]:
    """Young's modulus and yield stress [Pa]."""
    module, material = scene.law("materials", card.material)
    young, stress = getattr(material, "young", None), getattr(material, "yield_stress", None)
    curve = getattr(material, "curve", None)
    if stress is None and curve is not None and curve in built:
        stress = float(built[curve][1][0, 0])
    if young is None or not stress:
        raise scene.fail(f"material '{card.material}' has no yield stress; name one", field)
    return float(young), float(stress)


def section_of(card: Any, field: str, scene: Scene) -> tuple[Any, Any, Columns]:
    """Module and card of the section, and its constants."""
    module, section = scene.law("sections", card.section)
    # kappa, which depends on Poisson's ratio, has no part in a hinge
    return module, section, module.build(section, 0.3)


def squash_load(card: Any, scene: Scene) -> float:
    """N_p of the section of a curve of moments [N]; infinite where it names none, or no yield."""
    if card.section is None:
        return float("inf")
    stress = getattr(scene.law("materials", card.material)[1], "yield_stress", None)
    if not stress:
        return float("inf")
    return float(stress) * float(section_of(card, "curve", scene)[2]["area"])


def plastic_curve(
    start: float, limit: float, until: float | None, field: str, scene: Scene
) -> Points:
    """The points of a curve from 0 to the limit at `start`, and constant beyond.

    It has no end but one that is given, since a constant limit has no range.
    """
    until = until or start + ENDLESS
    if not until > start:
        raise scene.fail(f"ends at {until:.4g}, before it yields at {start:.4g}", field)
    x = np.array([0.0, start, until])
    c = np.zeros((2, 4))
    c[0, 1], c[1, 0] = limit / start, limit
    return x, c, HOLD


def bending_curve(card: Any, field: str, built: Columns, scene: Scene) -> Points:
    """Moment over angle of a section: breakpoints, coefficients, the code of extrapolation."""
    young, stress = material_of(card, field, built, scene)
    module, section, constants = section_of(card, field, scene)
    if card.model == "given":
        second = constants["second"][0 if card.about == "y" else 1]
        return given_curve(card, young * second / card.length, field, built, scene)
    if not hasattr(module, "fibres"):
        raise scene.fail("a section without a shape has no plastic moment; give a curve", field)
    stiffness = young * constants["second"][0 if card.about == "y" else 1] / card.length
    if card.model == "kecman":
        return _collapse.curve(card, section, (young, stress, stiffness), field, scene)
    limit = stress * plastic_moduli(module, section)["yz".index(card.about)]
    return plastic_curve(limit / stiffness, limit, card.until, field, scene)


def given_curve(card: Any, stiffness: float, field: str, built: Columns, scene: Scene) -> Points:
    """M over theta = x + M / k of points M over x: breakpoints, coefficients, extrapolation."""
    if card.plastic_curve not in built:
        raise scene.fail(f"curve '{card.plastic_curve}' cannot be built", field)
    x, c, beyond = built[card.plastic_curve]
    if np.any(c[:, 2:]):
        raise scene.fail("plastic_curve: must be straight between its points", field)
    if x[0] != 0.0:
        raise scene.fail(f"plastic_curve: must begin at 0, not at {x[0]:.4g}", field)
    y = np.append(c[:, 0], c[-1, 0] + c[-1, 1] * (x[-1] - x[-2]))
    if not y[0] > 0.0:
        raise scene.fail("plastic_curve: must begin with the moment of first yield", field)
    angle, moment = np.append(0.0, x + y / stiffness), np.append(0.0, y)
    if not (np.diff(angle) > 0.0).all():
        steepest = float(-np.min(np.diff(y) / np.diff(x)))
        raise scene.fail(
            f"plastic_curve: falls by {steepest:.4g}, more steeply than the elastic stiffness "
            f"{stiffness:.4g}: the hinge would snap back; give it a smaller length",
            field,
        )
    rows = np.zeros((len(angle) - 1, 4))
    rows[:, 0], rows[:, 1] = moment[:-1], np.diff(moment) / np.diff(angle)
    return angle, rows, beyond


def axial_curve(card: Any, field: str, built: Columns, scene: Scene) -> Points:
    """Force over change of length of a section, the same."""
    young, stress = material_of(card, field, built, scene)
    _, section, constants = section_of(card, field, scene)
    stiffness, limit = young * constants["area"] / card.length, stress * constants["area"]
    if card.model == "crush":
        limit = _collapse.crush_force(section, card.flow_stress or stress, field, scene)
    return plastic_curve(limit / stiffness, limit, card.until, field, scene)
