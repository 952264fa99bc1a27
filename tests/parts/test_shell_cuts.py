"""Claim: the force of a section is all that its front gets from behind, and so is its moment."""

from pathlib import Path

import numpy as np
import pytest
from shells import KINDS, PATCH, Elements

from crashsolve.elements.shells import section_cut
from crashsolve.elements.shells.forces import blocks
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.rows import as_rows

CUTS = [
    {"name": "across", "at": [0.1, 0, 0], "normal": [1, 0, 0]},
    {"name": "aslant", "at": [0.1, 0.06, 0], "normal": [-1, 3, 0]},
]


@pytest.mark.parametrize("kind", KINDS)
def test_a_section_hands_on_all_force_and_moment(kind: str, tmp_path: Path) -> None:
    shell = Elements(tmp_path, PATCH, 0.01, element=kind, section_cuts=CUTS)
    start, rng = shell.points.r.copy(), np.random.default_rng(3)
    shell.move(1e-3 * rng.normal(size=(8, 6)))
    wrench = shell.move(1e-3 * rng.normal(size=(8, 6)))
    cuts = measured(shell)
    for cut, card in zip(cuts, CUTS, strict=True):
        front = (start - card["at"]) @ np.array(card["normal"], float) > 0.0
        force, torque = wrench[front, :3], wrench[front, 3:]
        x = shell.points.r[front] - cut["position"]
        moment = (torque + np.cross(x, force)).sum(0)
        # round-off of the forces of single elements, which inside the front add up to nothing
        size = np.abs(wrench).max()
        np.testing.assert_allclose(cut["force"], force.sum(0), atol=1e-13 * size)
        np.testing.assert_allclose(cut["moment"], moment, atol=1e-13 * size)
        assert np.linalg.norm(cut["force"]) > 1e-3 * size


def measured(shell: Elements) -> np.ndarray:
    """The sections, as a sample computes them."""
    scene, before = shell.scene, -1
    scene.element_cuts, scene.cuts = as_rows(shell.element_cuts), as_rows(shell.cuts)
    modules = dict(zip(shell.module.KINDS.values(), range(3), strict=True))
    kinds = {modules[kind.__name__.rpartition(".")[2]]: kind for kind in shell.kinds}
    section_cut.open_cuts(scene)
    for element_cut in scene.element_cuts:
        if element_cut.first != before:
            position = (element_cut.first, element_cut.corner, scene, shell.material)
            blocks.respond(kinds[int(element_cut.kind)], shell.p, 0.0, *position)
        before = element_cut.first
        section_cut.add_cut_element(element_cut, scene)
    section_cut.close_cuts(scene)
    return shell.cuts


def test_a_plane_beside_the_part_is_refused(tmp_path: Path) -> None:
    beside = [{"name": "beside", "at": [9, 0, 0], "normal": [1, 0, 0]}]
    with pytest.raises(DeckErrors, match="plane of 'beside' cuts no element"):
        Elements(tmp_path, PATCH, section_cuts=beside)
