"""Claim: where shells are left with the default of control.safety, check and the log say so."""

from pathlib import Path

import pytest
from command import crashsolve

DECK = """
control: {{end_time: 1.0e-5, estimate: off{words}}}
materials: {{m: {{type: elastic, young: 210e9, poisson: 0.3, density: 7850}}}}
parts:
  p:
    type: {part}
    material: m
"""
SHELL = """    mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [2, 2]}
    thickness: 0.01
"""
BEAM = """    mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}
    section: s
sections: {s: {type: circle, radius: 0.01}}
"""
REMARK = "shells set the step, 0.9 is stable too"


@pytest.mark.parametrize(
    ("part", "words", "is_reported"),
    [
        ("shell", "", True),
        ("shell", ", safety: 0.9", False),
        ("shell", ", step: 1.0e-6", False),
        ("shell", ", integrator: generalized_alpha", False),
        ("beam", "", False),
    ],
)
def test_the_default_is_named_where_shells_depend_on_it(
    part: str, words: str, is_reported: bool, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    text = DECK.format(part=part, words=words) + (SHELL if part == "shell" else BEAM)
    deck.write_text(text, "utf-8")
    done = crashsolve("check", deck)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (REMARK in done.stdout) == is_reported
