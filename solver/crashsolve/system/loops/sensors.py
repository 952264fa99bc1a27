"""Readings of all sensors at a sample."""

from crashsolve.elements.shells import section_cut
from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system import points
from crashsolve.system.placeholders import CUTS, ELEMENTS, SENSORS


@kernel
def measure(time, nodes, rows, curves, scene):
    """Readings of all sensors. Writes: outputs."""
    if ELEMENTS:
        points.sum_momenta(scene.points, scene.motion[0])
    if CUTS:
        cut_elements(scene)
    for group in SENSORS:
        p, out = group.parameters, group.output
        for i in range(p.shape[0]):
            group.law.measure(p[i], out[i], time, nodes, rows, curves)


@stage
def cut_elements(scene):
    """Evaluate the blocks of the elements of sections again, one after the other. Writes:
    scene.cuts.
    """
    section_cut.open_cuts(scene)
    before = -1
    for k in range(scene.element_cuts.shape[0]):
        element_cut = scene.element_cuts[k]
        if element_cut.first != before:
            for group in ELEMENTS:
                p = group.parameters[element_cut.part]
                for law, material in group.materials:
                    if p.law == law:
                        for number, kind in group.numbered_kinds:
                            if element_cut.kind == number:
                                at, corner = element_cut.first, element_cut.corner
                                group.blocks.respond(kind, p, 0.0, at, corner, scene, material)
        before = element_cut.first
        section_cut.add_cut_element(element_cut, scene)
    section_cut.close_cuts(scene)
