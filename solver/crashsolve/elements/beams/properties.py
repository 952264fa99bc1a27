"""Mass, stiffness, damping and axes of beam elements, from their sections and materials.

    1 / k_y = l^3 / (12 E I_z) + l / (kappa_y G A),   K_r = diag(G J, E I_y, E I_z) / l

Consequence to test: the stiffness of one straight element is exact.
"""

from typing import Protocol

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3
from crashsolve.elements.beams.bowing import coefficient
from crashsolve.elements.beams.frequency_bound import end_of, fastest_rates, rate_of_tension
from crashsolve.elements.damping import Damped, coefficients, mass_factors
from crashsolve.foundation.orientation import perpendicular
from crashsolve.materials import elastic


class Beam(Protocol):
    """Fields of a beam's card that its section needs."""

    @property
    def section(self) -> str: ...
    @property
    def material(self) -> str: ...
    @property
    def side(self) -> Vec3 | None: ...


def halves(
    card: Damped, section: Columns, material: Columns, length: float, scene: Scene
) -> tuple[float, np.ndarray]:
    """Mass [kg] and inertia (3, 3) [kg m^2] of half an element, axes of the section."""
    mass, factor = scaled(card, section, material, np.array([length]), scene)
    share = 0.5 * float(factor[0]) * length
    return 0.5 * float(mass[0] * factor[0]), share * rotary_inertia(section, material)


def scaled(
    card: Damped, section: Columns, material: Columns, lengths: np.ndarray, scene: Scene
) -> tuple[np.ndarray, np.ndarray]:
    """Masses of elements of these lengths [kg], and the factors by which they are heavier."""
    mass = material["density"] * section["area"] * lengths
    per_length, squares = rotary_inertia(section, material), []
    for length, m in zip(lengths, mass, strict=True):
        row, J = stiffness_row(section, material, length), 0.5 * length * per_length
        squares.append(2.0 * fastest_rates(row, (end_of(0.5 * m, J), end_of(0.5 * m, J)))[0])
    return mass, mass_factors(card, np.array(squares), scene)


def stiffness_row(section: Columns, material: Columns, length: float) -> Columns:
    """Length [m] and stiffnesses [N/m, N m] of an element, by their columns."""
    E, G, A = material["young"], material["shear"], section["area"]
    I_y, I_z = section["second"]
    shear_y, shear_z = section["shear"]
    k_y = 1.0 / (length**3 / (12.0 * E * I_z) + length / (shear_y * G * A))
    k_z = 1.0 / (length**3 / (12.0 * E * I_y) + length / (shear_z * G * A))
    bending_z, bending_y = E * I_z / length, E * I_y / length
    return {
        "length": length,
        "stiffness": (E * A / length, k_y, k_z),
        "rotational_stiffness": (G * section["torsion"] / length, bending_y, bending_z),
        "bowing": (coefficient(k_y, bending_z, length), coefficient(k_z, bending_y, length)),
    }


def damping_row(card: Damped, section: Columns, material: Columns, scene: Scene) -> Columns:
    """Damping and viscosity of an element."""
    b_1, b_2_squared = coefficients(card, scene)
    per_length = material["density"] * section["area"]
    speed = np.sqrt(material["young"] / material["density"])
    return {
        "damping": card.damping,
        "viscosity": b_1 * per_length * speed,
        "quadratic_viscosity": b_2_squared * per_length,
    }


def ends_row(
    card: Damped, row: Columns, nodes: tuple[int, int], scene: Scene, T: np.ndarray, half: float
) -> Columns:
    """Nodes of an element with half its mass each, drag on them and its bound of the step.

    T are its axes in those of the nodes, as columns.
    """
    ends: Columns = {}
    movers = []
    for node in nodes:
        share = scene.inertia_shares.get(node, 1.0)
        J = share * T.T @ scene.J[node].reshape(3, 3) @ T
        movers.append(end_of(share * scene.mass[node], J, node in scene.welded))
    rates = fastest_rates(row, (movers[0], movers[1]))
    for end, node, mover, rate in zip("ab", nodes, movers, rates, strict=True):
        ends |= {
            f"node_{end}": node,
            f"drag_{end}": card.drag * half / float(scene.mass[node]),
            f"rate_{end}": rate,
            f"tension_rate_{end}": rate_of_tension(row, mover),
        }
    shares = [ends[f"tension_rate_{end}"] / ends[f"rate_{end}"] for end in "ab"]
    ends["bow_coupling"] = np.sqrt(row["stiffness"][0] * max(shares))
    return ends


def rotary_inertia(section: Columns, material: Columns) -> np.ndarray:
    """Rotary inertia per length (3, 3), axes of the section [kg m]."""
    R_y, R_z = section["rotary" if "rotary" in section else "second"]
    return material["density"] * np.diag([R_y + R_z, R_y, R_z])


def laws(card: Beam, scene: Scene) -> tuple[Columns, Columns]:
    """Section and material of a card."""
    law, material_card = scene.law("materials", card.material)
    word = law.__name__.rpartition(".")[2]
    if not hasattr(card, "fibres") and word != "elastic":
        advice = "use type: fibre_beam, or a structure of deformation: beams, for one that yields"
        raise scene.fail(f"needs a material of type elastic; or {advice}", "material")
    if law.FIBRE is None:
        raise scene.fail(f"type {word} is for shells; strains of beams are small", "material")
    if getattr(material_card, "failure_strain", None) is not None:
        message = f"material '{card.material}' has failure_strain, which fibres do not follow"
        raise scene.fail(f"{message}; take shells for it", "material")
    # nodes are built before curves: the behaviour of fibres beyond small strain is not checked here
    material = elastic.build(material_card, scene)
    law, section_card = scene.law("sections", card.section)
    return law.build(section_card, material["poisson"]), material


def axes_of(card: Beam, along: np.ndarray, section: Columns, scene: Scene) -> np.ndarray:
    """Axes of the section of an element as columns (3, 3): along it, y, z."""
    if card.side is None:
        I_y, I_z = section["second"]
        if abs(I_y - I_z) > 1e-9 * I_z:
            message = (
                "this section has I_y and I_z that differ: give side, the direction of its y axis"
            )
            raise scene.fail(message, "section")
        side = perpendicular(along)
    else:
        side = scene.unit(card.side, "side")
        across = side - along * float(along @ side)
        if np.linalg.norm(across) < 1e-6:
            raise scene.fail("points along the beam; give a direction across it", "side")
        side = scene.unit(across, "side")
    return np.column_stack([along, side, np.cross(along, side)])
