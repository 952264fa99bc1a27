"""Materials: how a solid answers to strain, and how heavy it is.

A material is one file: its card, the history of a point, its stress after a strain, and how
that changes with the strain. Elements use only this interface. LAYER names the rows of a layer of a
shell, which begin with its stress (xx, yy, xy); FIBRE the columns of a fibre of a beam; SOLID those
of a point in three dimensions (xx, yy, zz, xy, yz, zx). Kernels get `m`, the row of PARAMETERS. A
law is general, and says `update` and so on, or is that of a metal that yields by von Mises' stress,
and defines its yield stress by plastic strain, rate and temperature: elements then return
all their stresses to it together (_von_mises.py).
"""

from typing import Any, Protocol

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card
from crashsolve.deck.family import ANY, FIRST, Family
from crashsolve.foundation.record import Record


class MaterialLaw(Protocol):
    """Attributes and functions of every material's file, beside its card."""

    PARAMETERS: Record  # with the columns of elastic.py: young, poisson, shear, density, ...
    LAYER: Any  # rows of a layer, from rows_of()
    FIBRE: Record | None  # columns of a fibre; None where beams cannot be made of it
    SOLID: Record  # columns of a point in three dimensions, its stress among them
    VON_MISES: bool  # whether it is a law of _von_mises.py
    LARGE_STRAIN: bool  # whether strain across the thickness is logarithmic, and stiffness grows
    DISSIPATES: bool  # whether some of the work on it is lost

    def build(self, card: Any, scene: Scene) -> Columns:
        """Columns of PARAMETERS."""

    def layer_rows(self, card: Card) -> int:
        """Rows of a layer of this card."""

    def initial_layer(self, card: Card, scene: Scene) -> np.ndarray:
        """Their values at the start."""

    def stored(self, card: Card, layer: np.ndarray) -> np.ndarray:
        """Elastic energy per volume [J/m^3] of layers (..., rows), for pictures."""

    def plastic_strain(self, card: Card, layer: np.ndarray) -> np.ndarray:
        """Equivalent plastic strain of layers (..., rows), for pictures."""

    def update(self, m, blocks, at, d, h, curves):
        """Stress of a layer after the strains d (xx, yy, twice xy) of a step of h.

        Returns the stress (3), strain across [1], dissipation [J/m^3], and the stiffness over that
        without strain. In a step of no length d is 0. Writes: blocks.
        """

    def energy(self, m, blocks, at):
        """Elastic energy of a layer per volume [J/m^3]."""

    def solid(self, m, old, new, d, h, curves, material):
        """Stress (6) of a point after the strains d (xx, yy, zz, twice xy, yz, zx) of a step of h.

        Returns the stress and the dissipation [J/m^3]; `material` is the module of the law. Its
        axes turn with the material. Writes: new.
        """

    def solid_energy(self, m, new):
        """Elastic energy of a point per volume [J/m^3]."""


class GeneralLaw(MaterialLaw, Protocol):
    """Further functions of a material with a stress update of its own."""

    def tangent(self, m, blocks_before, blocks, at, d, direction, h, curves):
        """Changes of the stress (3) and of the strain across for a change `direction` of d.

        `blocks_before` holds the layer before the step, blocks the layer after it.
        """

    def fibre(self, m, old, new, i, strain, rate, h, curves):
        """Stress [Pa], stored and lost energy [J/m^3] of fibre i. Writes: new."""

    def fibre_tangent(self, m, old, i, strain, rate, curves):
        """Strain less stress / E; E less the slope of the stress; its slope by the rate."""


class VonMisesLaw(MaterialLaw, Protocol):
    """Further functions of a metal that yields by the von Mises criterion."""

    HEATS: bool  # whether FIBRE has a temperature
    SMOOTH: bool  # whether Y bends, and is followed by its tangents; or goes from line to line

    def flow(self, m, e, curves):
        """Y at the plastic strain e, without factors, and its slope [Pa]; concave in e."""

    def strain_of_rise(self, m, rise):
        """Plastic strain at which Y is higher than at none by `rise` [Pa]; where SMOOTH."""

    def line(self, m, e, curves):
        """Line of Y at e: value at no strain, slope, where it ends; where not SMOOTH."""

    def rate_factor(self, m, rate):
        """Factor on Y at a rate of strain [1/s], at least 1; called where m.rated is 1."""

    def rate_slopes(self, m, rate, factor):
        """Its slope by a rate above 0 [s], where it is `factor`, and the slope of that [s^2]."""

    def rate_of(self, m, factor):
        """Rate at which it is `factor`, above 1; any above that where it is nowhere so much."""

    def heat_factor(self, m, temperature):
        """Factor on Y at a temperature, at most 1; called where m.heating is above 0."""


FAMILY = Family(
    entry="material",
    follows=FIRST,
    law=MaterialLaw,
    energy=(),
    channels=None,
    picture=None,
    uses=(),
    integrators=ANY,
)
