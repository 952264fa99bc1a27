"""Block after block through the elements of one kind: forces, energies, deletion.

Functions common to all kinds. A kind is a module (`reduced`, `full`, `triangle`) with

    CORNERS, POINTS       of an element: its corners, and its points in the plane
    span(p)               where its elements lie in a part
    strain, stress, push  of a block: strains of a step, stresses after it, forces on the corners
    element_energy        of an element: stored in layers and shear, hourglass, drilling [J]

and kernels are handed it as they are handed a material.
"""

from typing import NamedTuple

from crashsolve.elements.shells.damping import add_damping_to_bound, damp
from crashsolve.elements.shells.erosion import (
    add_losses,
    delete,
    diagonal,
    has_failed,
    zero_forces,
    zero_strains,
)
from crashsolve.elements.shells.forces.corners import damped_corners, gather, record_rate, scatter
from crashsolve.elements.shells.hourglass_return import reset_shear_factor
from crashsolve.elements.shells.layers import raise_frequency
from crashsolve.elements.shells.records import BLOCK
from crashsolve.foundation.kernels import apart, kernel
from crashsolve.foundation.point import LANES


class Span(NamedTuple):
    """Range of the elements of one kind in a part."""

    first: int  # index of their numbers in blocks
    corner: int  # index of their corners
    element: int  # number of the first among all elements
    stride: int  # numbers of a block
    count: int  #  elements


@kernel
def span_of_quadrilaterals(p, count):
    """The Span of `count` quadrilaterals, which come first in a part."""
    return Span(p.first, p.first_corner, p.first_element, p.stride, count)


@apart
def deform(kind, p, clock, h, scene, material):
    """Strains, stresses and forces of the elements of a kind in a part after a step of h [s].

    Writes: scene.points, lanes, work, clock.
    """
    span, done = kind.span(p), 0
    reset_shear_factor(scene.work)
    while done < span.count:
        first, corner = span.first + done // LANES * span.stride, span.corner + 4 * done
        live = min(LANES, span.count - done)
        respond(kind, p, h, first, corner, scene, material)
        if material.VON_MISES and p.erodes == 1:
            erode(kind, p, scene, first, corner, live, material)
        record_rate(clock, span.element + done, scene, first, live, kind.CORNERS)
        if p.is_damped == 1:
            damped_corners(scene, corner, p.aside, live, kind.CORNERS)
        scatter(scene.points, scene.corners, corner + p.aside, live, scene.work, kind.CORNERS)
        done += LANES


@kernel
def respond(kind, p, h, first, corner, scene, material):
    """Forces and torques of a block on its corners after a step of h [s].

    Writes: scene.lanes, work.
    """
    blocks, work, stride = scene.lanes, scene.work, kind.span(p).stride
    gather(scene.points, scene.corners, corner, work)
    kind.strain(blocks, first, work, h, p)
    if p.erodes == 1:
        zero_strains(blocks, first, work)
    kind.stress(blocks, first, stride, work, h, p, scene.curves, material)
    if p.is_damped == 1:
        damp(blocks, first, stride, work, h, p)
    kind.corner_forces(blocks, first, work, p)
    if p.large_strain == 1:
        raise_frequency(work)
    if p.is_damped == 1:
        add_damping_to_bound(blocks, first, stride, work, h, p)
    if p.erodes == 1:
        zero_forces(blocks, first, work)


@kernel
def erode(kind, p, scene, first, corner, live, material):
    """Delete the elements of a block that have failed. Writes: scene.lanes."""
    for e in range(live):
        if has_failed(scene.lanes, first + e, p, kind.POINTS):
            d, c = diagonal(scene, corner + e, 2), diagonal(scene, corner + LANES + e, 2)
            stored, hourglass, drilling = kind.element_energy(
                p, scene.lanes, first + e, d, c, material
            )
            stride = kind.span(p).stride
            delete(scene, first, stride, corner, e, kind.CORNERS, stored + hourglass + drilling)


@kernel
def add_energies(kind, p, out, scene, material):
    """Energies of the elements of a kind [J]. Writes: out."""
    span, blocks = kind.span(p), scene.lanes
    for i in range(span.count):
        lane = i % LANES
        at, corner = span.first + i // LANES * span.stride + lane, span.corner + 4 * (i - lane)
        add_losses(p, blocks, at, span.stride, out)
        if blocks[at + LANES * BLOCK.thickness] > 0.0:
            d, e = diagonal(scene, corner + lane, 2), diagonal(scene, corner + LANES + lane, 2)
            stored, hourglass, drilling = kind.element_energy(p, blocks, at, d, e, material)
            out.strain += stored
            out.hourglass += hourglass
            out.drilling += drilling
