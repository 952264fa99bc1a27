"""Claim: the shells of a structure touch themselves where the deck asks, in one word."""

from pathlib import Path

import pytest
from command import crashsolve
from quick import first_quick

from crashpost.results.result import Result

DECK = """
control: {{end_time: 0.5e-3, safety: 0.8, estimate: off}}
materials:
  steel: {{type: elastoplastic, young: 2.1e+11, poisson: 0.3, density: 7850, yield_stress: 3.0e+8}}
sections: {{tube: {{type: rectangular_tube, width: 50 mm, height: 50 mm, thickness: 2 mm}}}}
parts:
  frame:
    type: structure
    points: [{{name: foot, at: [0, 0, 0]}}, {{name: tip, at: [0, 0, 0.3]}}]
    members: [{{name: post, from: foot, to: tip}}]
    section: tube
    material: steel
    side: [0, 1, 0]
    across: 4
    self_contact: true
    deformation: {description}
    velocity: [0, 0, 1]
"""


@pytest.mark.parametrize(
    "description", first_quick(["hinges", "rigid", "segments", "beams", "shells"])
)
def test_every_description_takes_the_word(description: str, tmp_path: Path) -> None:
    deck, folder = tmp_path / "post.yaml", tmp_path / "out"
    deck.write_text(DECK.format(description=description), "utf-8")
    done = crashsolve(deck, "-o", folder)
    assert done.returncode == 0, done.stderr
    contacts = Result(folder).families.get("rcforc")
    names = list(contacts.ids) if contacts else []
    assert names == (["frame_post_folds"] if description == "shells" else [])
