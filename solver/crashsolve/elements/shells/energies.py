"""Energies of the elements of shells: of layers, transverse shear, hourglass, drilling, motion."""

from crashsolve.elements.shells.forces.quadrilateral import (
    DRILLING,
    hourglass_stiffness,
    plane_axes,
)
from crashsolve.elements.shells.records import (
    BLOCK,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import ATTACHED, LANES, OWN
from crashsolve.foundation.vec3 import dot, vec


@kernel
def kinetic_energy(p, points):
    """Kinetic energy [J] of the nodes of a part that are not bodies of the deck."""
    total = 0.0
    for i in range(p.first_point, p.first_point + p.point_count):
        b = points[i]
        if b.fixed < ATTACHED or b.fixed >= OWN:
            v, w = vec(b.v), vec(b.w)
            total += 0.5 * dot(v, v) / b.mass_inv + 0.5 * dot(w, w) / b.J_inv
    return total


@kernel
def in_plane(blocks, at, d, e):
    """Thickness of an element, its diagonals in its axes, its area."""
    shape = at + LANES * BLOCK.inverse
    G = (blocks[shape], blocks[shape + LANES], blocks[shape + 2 * LANES], blocks[shape + 3 * LANES])
    _, flat, area = plane_axes(d, e, G)
    return blocks[at + LANES * BLOCK.thickness], flat, area


@kernel
def twist_energy(p, blocks, at, t, flat, area):
    """Energy of the change of transverse shear across the element [J]."""
    _, k = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
    q = at + LANES * (BLOCK.hourglass_plane + 4)
    x, y = blocks[q], blocks[q + LANES]
    return 0.5 * x * x / k[0] + 0.5 * y * y / k[1]


@kernel
def drilling_energy(p, blocks, at, t, area):
    """Energy of the spins about the normal against the rotation of the plane [J]."""
    x = blocks[at + LANES * BLOCK.drilling]
    return 0.5 * x * x / (DRILLING * p.shear * t * area)


@kernel
def layer_energy(p, blocks, at, material):
    """Elastic energy per volume of the layers at a point of the plane [J/m^3]."""
    total = 0.0
    for k in range(p.layers):
        row = at + LANES * p.layer_rows * k
        total += 0.5 * p.weight[k] * material.energy(p.material, blocks, row)
    return total


@kernel
def shear_energy(p, blocks, at):
    """Energy per volume of the transverse shear in the middle [J/m^3]."""
    x, y = blocks[at + LANES * BLOCK.shear], blocks[at + LANES * (BLOCK.shear + 1)]
    return 0.6 * (x * x + y * y) / p.shear
