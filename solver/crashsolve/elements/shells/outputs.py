"""Outputs of the elements of shells, for pictures and gauges.

N = t/2 sum w sigma and so on, means of the points of a plane where there are several.
"""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from crashsolve.elements.shells.cards import ShellCard
from crashsolve.elements.shells.geometry import blocks_of
from crashsolve.elements.shells.records import (
    BLOCK,
    EROSION,
    VISCOUS,
)
from crashsolve.foundation.point import LANES

if TYPE_CHECKING:
    from numpy.typing import DTypeLike

# elements worked on at a time where memory counts
PIECE = 1024
# of the elements in pictures: unit and components; resultants along the element's axes
FIELDS = {
    "thickness": ("m", 1),
    "membrane_force": ("N/m", 3),  # xx, yy, xy
    "moment": ("N", 3),  # xx, yy, xy
    "shear_force_xz": ("N/m", 1),
    "shear_force_yz": ("N/m", 1),
    "von_mises": ("Pa", 1),  # largest of the layers and points
    "elastic_energy_density": ("J/m^3", 1),
    "plastic_energy_density": ("J/m^3", 1),  # over the volume at the start
    "plastic_strain_top": ("1", 1),  # of the outermost layers and the middle one
    "plastic_strain_mid": ("1", 1),
    "plastic_strain_bottom": ("1", 1),
}


class Part(Protocol):
    """Attributes of a shell part that outputs need."""

    card: ShellCard
    law: ModuleType  # module of its material
    material: Any  # card of it
    rule: tuple[np.ndarray, np.ndarray]  # positions and weights of the layers
    layer_rows: int
    is_damped: bool
    can_fail: bool

    def sections(self) -> list[tuple[slice, int]]: ...
    def stride_of(self, points: int) -> int: ...


def values_of(
    part: Part, blocks: np.ndarray, row: np.void, wanted: np.ndarray, kind: DTypeLike = float
) -> dict[str, np.ndarray]:
    """Values of FIELDS of some elements (n, ...), in their units, from the blocks of all parts."""
    start = int(row["first"])
    shapes = {name: (len(wanted), n)[: 1 + (n > 1)] for name, (_, n) in FIELDS.items()}
    values_of_fields = {name: np.zeros(shape, kind) for name, shape in shapes.items()}
    for own, points in part.sections():
        count, stride = blocks_of(own), part.stride_of(points)
        table = blocks[start : start + count * stride].reshape(count, stride // LANES, LANES)
        inside = np.flatnonzero((wanted >= own.start) & (wanted < own.stop))
        for some in (inside[k : k + PIECE] for k in range(0, len(inside), PIECE)):
            for name, values in fields(part, _rows(table, wanted[some] - own.start)).items():
                values_of_fields[name][some] = values
        start += count * stride
    return values_of_fields


def _rows(table: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Rows of elements (m, rows), from blocks of them side by side (blocks, rows, LANES)."""
    if np.any(np.diff(positions) != 1):
        return table[positions // LANES, :, positions % LANES]
    # elements side by side are rotated at once
    first, last = int(positions[0]), int(positions[-1]) + 1
    begun = first // LANES
    rotated = table[begun : -(-last // LANES)].transpose(0, 2, 1).reshape(-1, table.shape[1])
    return rotated[first - begun * LANES : last - begun * LANES]


def fields(part: Part, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Values of FIELDS from the rows of elements (m, rows): means over the points of the plane."""
    count = part.card.layers
    end = rows.shape[1] - VISCOUS.SIZE * part.is_damped - EROSION.SIZE * part.can_fail
    layers = rows[:, BLOCK.SIZE : end].reshape(len(rows), -1, count, part.layer_rows)
    t, shear = rows[:, BLOCK.thickness], rows[:, BLOCK.shear : BLOCK.shear + 2]
    mean = _mean(layers)
    zeta, weight = part.rule
    share = 0.5 * t[:, None] * weight
    arm = 0.5 * t[:, None] * zeta
    x, y, s = np.moveaxis(layers[..., :3], 3, 0)
    plastic = part.law.plastic_strain(part.material, mean)
    E, nu = part.material.young, part.material.poisson
    elastic = part.law.stored(part.material, layers)
    density = 0.5 * _mean(elastic) @ weight + 1.2 * (1.0 + nu) / E * (shear**2).sum(1)
    volume = rows[:, BLOCK.mass] / part.material.density
    return {
        "thickness": t,
        "membrane_force": np.einsum("ek,ekc->ec", share, mean[:, :, :3]),
        "moment": np.einsum("ek,ekc->ec", share * arm, mean[:, :, :3]),
        "shear_force_xz": shear[:, 0] * t,
        "shear_force_yz": shear[:, 1] * t,
        "von_mises": np.sqrt(x * x + y * y - x * y + 3.0 * s * s).max(axis=(1, 2)),
        "elastic_energy_density": density,
        "plastic_energy_density": rows[:, BLOCK.plastic_work] / volume,
        "plastic_strain_top": plastic[:, -1],
        "plastic_strain_mid": plastic[:, (count - 1) // 2],
        "plastic_strain_bottom": plastic[:, 0],
    }


def _mean(points: np.ndarray) -> np.ndarray:
    """Mean over the points of the plane, of (m, points, ...)."""
    mean: np.ndarray = points[:, 0] if points.shape[1] == 1 else points.mean(axis=1)
    return mean
