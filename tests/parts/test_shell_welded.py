"""Claims of shells that are part of other bodies: mass goes over whole, errors are refused."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.model import Model, State

DECK = """
title: a plate on a hub
control: {end_time: 1}
materials: {nylon: {type: elastic, young: 2e9, poisson: 0.3, density: 1000}}
sections: {rod: {type: circle, radius: 0.01}}
bodies:
  hub: {mass: 0.3, inertia: [3e-4, 4e-4, 5e-4], position: [-0.1, 0, 0], rotation: {axis: [1, 2, 3], angle: 0.7}}
parts:
  plate:
    type: shell
    mesh: {type: grid, along: [0.2, 0, 0], across: [0, 0.1, 0], elements: [2, 1]}
    thickness: 3e-3
    material: nylon
    welded: [{nodes: u0, to: hub}, {nodes: u1, part: rib}]
  rib:
    type: beam
    mesh: {shape: line, from: [0.2, 0, 0], to: [0.2, 0.1, 0], elements: 1}
    section: rod
    material: nylon
"""  # noqa: E501


def attached(model: Model) -> np.ndarray:
    """Points that are part of bodies."""
    assert model.elements is not None
    return model.elements.attached_points


def model_of(folder: Path, text: str = DECK) -> tuple[Model, State]:
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    return build(read_deck(path))


def totals(model: Model, state: State) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, mass centre and inertia about the origin of all that moves."""
    nodes, points = state.nodes[1:], state.points[state.points["fixed"] < 64]
    m = np.concatenate([1.0 / nodes["mass_inv"], 1.0 / points["mass_inv"]])
    x = np.concatenate([nodes["r"], points["r"]])
    A = nodes["A"].reshape(-1, 3, 3)
    J = (A @ nodes["J"].reshape(-1, 3, 3) @ A.transpose(0, 2, 1)).sum(0)
    J = J + (1.0 / points["J_inv"]).sum() * np.eye(3)
    for mass, s in zip(m, x, strict=True):
        J += mass * (s @ s * np.eye(3) - np.outer(s, s))
    return float(m.sum()), m @ x / m.sum(), J


def test_welding_changes_neither_mass_nor_its_centre_nor_its_inertia(tmp_path: Path) -> None:
    free = DECK.replace("welded: [{nodes: u0, to: hub}, {nodes: u1, part: rib}]", "welded: []")
    before, after = totals(*model_of(tmp_path, free)), totals(*model_of(tmp_path))
    for old, new in zip(before, after, strict=True):
        np.testing.assert_allclose(new, old, rtol=1e-12, atol=1e-15)


def test_points_ride_where_they_are_and_on_the_nearest_node(tmp_path: Path) -> None:
    model, state = model_of(tmp_path)
    assert len(attached(model)) == 4
    for attached_point in attached(model):
        node, point = state.nodes[attached_point["node"]], state.points[attached_point["point"]]
        position = node["r"] + node["A"].reshape(3, 3) @ attached_point["spot"]
        np.testing.assert_allclose(position, point["r"], atol=1e-15)
        if point["r"][0] > 0.1:
            wanted = "rib_start" if point["r"][1] < 0.05 else "rib_end"
            assert model.bodies[attached_point["node"]] == wanted


def test_sides_with_a_common_corner_are_welded_to_one_body(tmp_path: Path) -> None:
    text = DECK.replace(
        "welded: [{nodes: u0, to: hub}, {nodes: u1, part: rib}]",
        "welded: [{nodes: u0, to: hub}, {nodes: v0, to: hub}]",
    )
    before, after = totals(*model_of(tmp_path)), totals(*model_of(tmp_path, text))
    for old, new in zip(before, after, strict=True):
        np.testing.assert_allclose(new, old, rtol=1e-12, atol=1e-15)
    model, state = model_of(tmp_path, text)
    corner = [a for a in attached(model) if np.abs(state.points[a["point"]]["r"]).max() < 1e-12]
    assert len(corner) == 1


WRONG = {
    "set": ("nodes: u0", "nodes: rim", "the mesh has no set of nodes 'rim' (sets: "),
    "ground": ("to: hub", "to: ground", "the ground holds nodes by `supports`"),
    "twice": ("nodes: u0", "nodes: u1", "supported, welded or named already"),
    "twice to one body": (
        "welded: [{nodes: u0, to: hub}",
        "welded: [{nodes: u0, to: hub}, {nodes: u0, to: hub}",
        "supported, welded or named already",
    ),
    "corner of two bodies": (
        "welded: [{nodes: u0, to: hub}",
        "welded: [{nodes: u0, to: hub}, {nodes: v0, part: rib}",
        "supported, welded or named already",
    ),
    "within": (
        "to: hub",
        "to: hub, within: 1",
        "within: is for part; a body named by to holds nodes",
    ),
    "both": ("to: hub", "to: hub, part: rib", "needs either to or part"),
    "itself": ("part: rib", "part: plate", "needs a part whose nodes are bodies"),
    "faster": ("position: [", "velocity: [0, 0, 3], position: [", "nodes begin 3 m/s faster"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_weld_is_refused(tmp_path: Path, case: str) -> None:
    old, new, message = WRONG[case]
    assert old in DECK
    with pytest.raises(DeckErrors) as caught:
        model_of(tmp_path, DECK.replace(old, new, 1))
    assert message in str(caught.value)


FAR = DECK.replace(
    "from: [0.2, 0, 0], to: [0.2, 0.1, 0]", "from: [0.2, 0, {z}], to: [0.2, 0.1, {z}]"
)


def test_a_weld_reaches_no_farther_than_an_element_or_what_the_card_allows(tmp_path: Path) -> None:
    # sides of 0.1 m
    assert len(attached(model_of(tmp_path, FAR.replace("{z}", "0.0999"))[0])) == 4
    with pytest.raises(DeckErrors) as caught:
        model_of(tmp_path, FAR.replace("{z}", "0.3"))
    reported = str(caught.value)
    assert "welded: the node at (0.2, 0, 0) m is 0.3 m from the nearest node of 'rib'" in reported
    assert "more than 0.1 m (the longest side of its elements)" in reported
    assert "allow the distance by within" in reported
    near = "{nodes: u1, part: rib, within: 4 cm}"
    with pytest.raises(DeckErrors) as caught:
        model_of(tmp_path, FAR.replace("{nodes: u1, part: rib}", near).replace("{z}", "0.05"))
    assert (
        "is 0.05 m from the nearest node of 'rib' that is a body, more than 0.04 m (within)"
        in str(caught.value)
    )
    far = FAR.replace("{nodes: u1, part: rib}", "{nodes: u1, part: rib, within: 0.5}")
    assert len(attached(model_of(tmp_path, far.replace("{z}", "0.3"))[0])) == 4


def test_a_shell_is_welded_to_the_named_nodes_of_a_shell(tmp_path: Path) -> None:
    flap = """  flap:
    type: shell
    mesh: {type: grid, at: [0.2, 0, 0], along: [0, 0, 0.1], across: [0, 0.1, 0], elements: [1, 1]}
    thickness: 3e-3
    material: nylon
    nodes: [{name: a, at: [0.2, 0, 0]}, {name: b, at: [0.2, 0.1, 0]}]
"""
    text = DECK.replace("part: rib}", "part: flap}") + flap
    apart = text.replace(", {nodes: u1, part: flap}", "")
    before, after = totals(*model_of(tmp_path, apart)), totals(*model_of(tmp_path, text))
    for old, new in zip(before, after, strict=True):
        np.testing.assert_allclose(new, old, rtol=1e-12, atol=1e-15)
    with pytest.raises(DeckErrors) as caught:
        model_of(tmp_path, text.replace("    nodes: [{name: a", "    traces: [{name: a"))
    assert "needs a part whose nodes are bodies, other than itself" in str(caught.value)
