"""Claim: what is set from outside the deck and changes nothing is refused; the rest is not."""

from pathlib import Path

import pytest

from crashsolve.cli import main
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.reading.several import Several
from crashsolve.foundation.errors import DeckErrors

TEXT = """\
title: at ${speed} m/s
include: brought.yaml
parameters:
  speed: 3
  named: 1
  gap: 2
  twice: "${half}"
  half: 4
  fine: 2
  loose: 7
control: {end_time: 1, integrator: rattle, tolerance: "${loose*1e-7}"}
bodies:
  ball: {mass: "${twice}", inertia: [1, 1, 1], velocity: [1, 0, 0]}
materials:
  steel: {type: elastic, young: 2e11, poisson: 0.3, density: 7800}
  spare: {type: elastic, young: 2e11, poisson: 0.3, density: 7800}
sections: {tube: {type: rectangular_tube, width: 0.05, height: 0.05, thickness: 0.002}}
parts:
  frame:
    type: structure
    deformation: beams
    section: tube
    material: steel
    across: "${fine}"
    points: [{name: a, at: [0, 0, 1]}, {name: b, at: [1, 0, 1]}, {name: c, at: [1, 1, 1]}]
    members: [{from: a, to: b}, {from: b, to: c, deformation: rigid, divisions: 3}]
watch: ["rbdout.ball.velocity.x*${named}"]
"""


def deck_of(folder: Path, refuses: bool = True, **overrides: str) -> Deck:
    path = folder / "deck.yaml"
    path.write_text(TEXT, "utf-8")
    (folder / "brought.yaml").write_text("parameters: {brought: 1}\n", "utf-8")
    return read_deck(path, {n.replace("__", "."): t for n, t in overrides.items()}, refuses)


@pytest.mark.parametrize(
    ("word", "reported"),
    [
        # the title has no part in the run
        ("speed=4", "deck.yaml:4) is read by no card, so that the run would be the same"),
        ("parameters.gap=4", "parameter 'gap' ("),
        ("brought=4", "brought.yaml:1) is read by no card"),
        (
            "fine=4",
            "read only by part 'frame', where it has no effect: its members are beams and rigid",
        ),
        ("loose=4", "read only by control, where it has no effect: steps of rattle"),
        ("parts.frame.across=4", "part 'frame': its members are beams and rigid; leave it out"),
        ("parts.frame.hinge_stress=4", "part 'frame': its members are beams and rigid"),
        ("parts.frame.members.2.divisions=4", "part 'frame': the member is rigid"),
        ("control.tolerance=1e-6", "control: steps of rattle are chosen by safety"),
        ("control.steps=4", "control: it belongs to solution quasi_static"),
        ("control.spectral_radius=0.1", "control: it belongs to integrator generalized_alpha"),
        ("materials.spare.young=1e11", "material 'spare': no card names it; leave it out"),
    ],
)
def test_an_ineffective_setting_is_refused_with_its_location(
    word: str, reported: str, tmp_path: Path
) -> None:
    name, _, text = word.partition("=")
    with pytest.raises(DeckErrors) as caught:
        deck_of(tmp_path, **{name: text})
    assert str(caught.value).startswith(f"--set {word.removeprefix('parameters.')}: error: ")
    assert reported in str(caught.value)
    assert len(caught.value.errors) == 1


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("half", "5"),
        ("twice", "5"),
        ("named", "2"),
        ("parts.frame.divisions", "5"),
        ("parts.frame.members.1.divisions", "5"),
        ("materials.steel.young", "1e11"),
        ("title", "other"),
    ],
)
def test_what_changes_the_deck_changes_its_text(name: str, text: str, tmp_path: Path) -> None:
    before = deck_of(tmp_path).text
    changed = [line for line in deck_of(tmp_path, **{name: text}).text.splitlines()]
    own = set(changed) - set(before.splitlines())
    # more than the line that states the parameter
    assert [line for line in own if not line.startswith(f"  {name}:")]


def test_a_parameter_that_another_one_read_is_idle_when_that_is_set(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match="'half' .* is read by no card"):
        deck_of(tmp_path, half="5", twice="6")


def test_a_parameter_is_set_once(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match="parameter 'half' is set twice, to '5' and this"):
        deck_of(tmp_path, half="5", parameters__half="6")


def test_declared_parameters_need_no_reader(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deck = deck_of(tmp_path)
    # of its own file; an included one may bring more than is needed
    assert [text.split("'")[1] for text in deck.unread] == ["speed", "gap", "fine", "loose"]
    main(["check", str(tmp_path / "deck.yaml")])
    assert "warning: parameter 'gap' (" in capsys.readouterr().out


def test_a_run_of_several_has_the_parameters_that_it_uses(tmp_path: Path) -> None:
    deck_of(tmp_path)
    several, path = Several(), tmp_path / "deck.yaml"
    given = {"parts.frame.across": "3", "gap": "1", "half": "8"}
    _, beams = several.read(path, given)
    assert (beams, {*(several.ineffective or ())}) == ({"half": "8"}, {"parts.frame.across", "gap"})
    choice = {"parts.frame.deformation": "shells", "parts.frame.members.2.deformation": "beams"}
    deck, shells = several.read(path, given | choice)
    assert shells == {"parts.frame.across": "3", "half": "8"} | choice
    assert {*(several.ineffective or ())} == {"gap"}
    assert deck.text == read_deck(path, shells).text
