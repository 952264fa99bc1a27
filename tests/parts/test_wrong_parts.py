"""Claim: a beam that cannot be built is refused at the field that is wrong."""

from pathlib import Path

import pytest
from bench import refusal

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors

DECK = """title: wrong beam
control: {end_time: 1}
bodies: {hub: {mass: 1, inertia: [1, 1, 1]}}
materials: {steel: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
sections: {flat: {type: rectangle, width: 0.02, height: 0.1}}
parts:
  arm:
    type: beam
    mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}
    section: flat
    material: steel
    side: [0, 1, 0]
"""
WRONG = {
    "to: [1, 0, 0]": ("to: [0, 0, 0]", ":9:42: error: part 'arm': mesh.to: begins and ends in one"),
    "side: [0, 1, 0]": ("side: [2, 0, 0]", ":12:5: error: part 'arm': side: points along"),
    "    side: [0, 1, 0]\n": (
        "",
        ":10:14: error: part 'arm': section: this section has I_y and I_z",
    ),
    "section: flat": ("section: flit", "unknown section 'flit'; did you mean 'flat'?"),
    "material: steel": ("material: steal", "unknown material 'steal'; did you mean 'steel'?"),
    "type: elastic,": (
        "type: elastoplastic, yield_stress: 2e8,",
        "part 'arm': material: needs a material of type elastic; or use type: fibre_beam",
    ),
    "elements: 2": ("elements: 0", "elements: must be at least 1, not 0"),
    "hub:": ("arm_end:", "part 'arm': its node 'arm_end' has the name of a body; rename one"),
}


@pytest.mark.parametrize("right", list(WRONG))
def test_a_wrong_beam_is_refused(tmp_path: Path, right: str) -> None:
    wrong, message = WRONG[right]
    assert right in DECK
    assert message in refusal(tmp_path, DECK.replace(right, wrong))


def test_a_node_that_does_not_exist_is_named_with_those_that_do(tmp_path: Path) -> None:
    path = tmp_path / "beam.yaml"
    path.write_text(DECK + "joints: {clamp: {type: weld, b: arm_2, at: [0, 0, 0]}}\n", "utf-8")
    with pytest.raises(DeckErrors) as caught:
        read_deck(path)
    assert "unknown body 'arm_2'" in str(caught.value)
    assert "(bodies: hub, arm_start, arm_1, arm_end)" in str(caught.value)
