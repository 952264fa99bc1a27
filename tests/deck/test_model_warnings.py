"""Claims: what a deck may ask for, but hardly means, is a warning of `check`; the rest is none."""

from pathlib import Path

import pytest
from command import crashsolve

STRIP = """
title: A strip of shells
control: {{end_time: 1e-4}}
materials: {{steel: {{type: elastic, young: 2.1e11, poisson: 0.3, density: 7850}}}}
parts:
  strip:
    type: shell
    mesh: {{type: grid, along: [0.5, 0, 0], across: [0, 0.1, 0], elements: [4, 1]}}
    thickness: 0.005
    layers: {layers}
    material: steel
    supports: [{{nodes: u0}}]
"""
BALL = """
title: A ball over a floor
control: {{end_time: 1e-3}}
bodies: {{ball: {{mass: 1, primitive: {{shape: sphere, radius: 0.1}}, position: [0, 0, 0.2]}}}}
surfaces:
  skin: {{type: sphere, body: ball, radius: 0.1}}
  floor: {{type: plane}}
  same: {{type: plane}}
  lower: {{type: plane, at: [0, 0, -1]}}
contacts:
  first: {{a: [skin], b: [floor], normal: {{type: hertz, stiffness: 1e6}}}}
{second}
loads:
  weight: {{type: gravity}}
{further}
"""
SECOND = "  second: {a: [skin], b: [floor], normal: {type: hertz, stiffness: 1e6}}"
FURTHER = "  again: {type: gravity}"


def said_of(folder: Path, text: str) -> str:
    deck = folder / "deck.yaml"
    deck.write_text(text, "utf-8")
    done = crashsolve("check", deck)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.mark.parametrize(("layers", "is_warned"), [(1, True), (2, False), (5, False)])
def test_one_layer_is_a_membrane(tmp_path: Path, layers: int, is_warned: bool) -> None:
    said = said_of(tmp_path, STRIP.format(layers=layers))
    assert ("layers" in said) == is_warned


@pytest.mark.parametrize("is_double", [True, False])
def test_a_pair_in_two_contacts(tmp_path: Path, is_double: bool) -> None:
    said = said_of(tmp_path, BALL.format(second=SECOND if is_double else "", further=""))
    assert ("the forces add up" in said) == is_double


@pytest.mark.parametrize(("other", "is_double"), [("same", True), ("lower", False)])
def test_equal_surfaces_on_one_side(tmp_path: Path, other: str, is_double: bool) -> None:
    text = BALL.format(second="", further="").replace("b: [floor]", f"b: [floor, {other}]")
    assert ("the forces add up" in said_of(tmp_path, text)) == is_double


@pytest.mark.parametrize(("other", "is_double"), [("same", True), ("lower", False)])
def test_equal_surfaces_are_one(tmp_path: Path, other: str, is_double: bool) -> None:
    second = SECOND.replace("floor", other)
    said = said_of(tmp_path, BALL.format(second=second, further=""))
    assert ("the forces add up" in said) == is_double


@pytest.mark.parametrize("is_double", [True, False])
def test_two_weights(tmp_path: Path, is_double: bool) -> None:
    said = said_of(tmp_path, BALL.format(second="", further=FURTHER if is_double else ""))
    assert ("gravity" in said) == is_double
