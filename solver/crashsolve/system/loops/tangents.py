"""Tangents of laws and elements, for implicit methods."""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system.implicit import global_matrix, stiffness
from crashsolve.system.loops.contact_tangents import contact_tangents
from crashsolve.system.placeholders import ELEMENTS, TANGENT_CONTACTS, TANGENTS


@kernel
def tangents(clock, nodes, curves, compliant, scene):
    """Tangents of all springs and contacts. Writes: compliant."""
    for k, group in enumerate(TANGENTS):
        p, history = group.parameters, group.history
        first = scene.tangents[k].first
        for i in range(p.shape[0]):
            at = first + group.tangent_rows * i
            old = history[clock.current, i]
            if group.materials:
                for number, material in group.materials:
                    if p[i].law == number:
                        group.fibre_law.tangent(p[i], old, nodes, curves, compliant, at, material)
            else:
                group.law.tangent(p[i], old, nodes, curves, compliant, at)
    for k, pairs in enumerate(TANGENT_CONTACTS, len(TANGENTS)):
        first = scene.tangents[k].first
        contact_tangents(pairs, first, clock, nodes, curves, compliant, scene)


@kernel
def assemble_stiffness(h, clock, nodes, curves, matrix, scene):
    """Tangents of shells after a step of h; geometric stiffness of others. Writes: matrix."""
    global_matrix.clear_matrix(nodes, matrix)
    if ELEMENTS:
        add_element_stiffness(h, nodes, matrix, scene)
    for k, group in enumerate(TANGENTS):
        if hasattr(group.law, "tangent_blocks"):
            p, history, out = group.parameters, group.history, group.output
            first = scene.tangents[k].first
            for i in range(p.shape[0]):
                slot = matrix.slots[first + group.tangent_rows * i]
                old = history[clock.current, i]
                if group.materials:
                    for number, material in group.materials:
                        if p[i].law == number:
                            group.fibre_law.tangent_blocks(
                                p[i], old, h, nodes, curves, slot, matrix.blocks, material
                            )
                else:
                    group.law.tangent_blocks(p[i], old, nodes, curves, slot, matrix.blocks)
        if hasattr(group.law, "geometric_stiffness"):
            p, out = group.parameters, group.output
            first = scene.tangents[k].first
            for i in range(p.shape[0]):
                slot = matrix.slots[first + group.tangent_rows * i]
                group.law.geometric_stiffness(p[i], out[i], nodes, slot, matrix.blocks)


@stage
def add_element_stiffness(h, nodes, matrix, scene):
    """Stiffness of shells after a step of h. Writes: matrix."""
    stiffness.restore_elements(h, scene)
    stiffness.update_arms(nodes, scene)
    for group in ELEMENTS:
        p = group.parameters
        for i in range(p.shape[0]):
            for number, material in group.materials:
                if p[i].law == number:
                    for kind in group.tangent_kinds:
                        group.slopes.tangent(kind, p[i], h, scene, matrix, material)


@kernel
def update_tangents(h, clock, nodes, compliant, matrix, t, tt, scene):
    """Renew all tangents and the factor, at the present position. Writes: matrix, compliant."""
    rows, curves = scene.rows, scene.curves
    tangents(clock, nodes, curves, compliant, scene)
    assemble_stiffness(h, clock, nodes, curves, matrix, scene)
    global_matrix.linearise(rows, compliant, nodes, t, tt)
    global_matrix.factor_compliant(matrix, compliant, rows.shape[0], tt, t)
