"""Claims of frames: a straight bar is the beam; wrong ones are refused."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.model import Model, State

DECK = """title: frames
control: {end_time: 1}
materials: {steel: {type: elastic, young: 2e9, poisson: 0.3, density: 7850}}
sections: {flat: {type: rectangle, width: 0.02, height: 0.05}}
parts:
  line:
    type: beam
    mesh: {shape: line, from: [0, 0, 0], to: [0.6, 0.8, 0], elements: 3}
    <<: &alike {section: flat, material: steel, side: [0, 0, 1], damping: 1e-3}
  bar:
    type: frame
    points: [[0, 0, 0], [0.6, 0.8, 0]]
    bars: [[1, 2]]
    elements: 3
    <<: *alike
"""
LINE = ["line_start", "line_1", "line_2", "line_end"]
BAR = ["bar_1", "bar_bar1_1", "bar_bar1_2", "bar_2"]


def scene(folder: Path, text: str = DECK) -> tuple[Model, State]:
    path = folder / "frame.yaml"
    path.write_text(text, "utf-8")
    return build(read_deck(path))


def test_a_straight_bar_has_the_masses_forces_and_rates_of_the_beam(tmp_path: Path) -> None:
    model, state = scene(tmp_path)
    line, bar = ([model.bodies.index(name) for name in names] for names in (LINE, BAR))  # type: ignore[attr-defined]
    nodes = state.nodes.view(np.recarray)  # type: ignore[attr-defined]
    np.testing.assert_allclose(nodes.mass_inv[bar], nodes.mass_inv[line], rtol=1e-14)
    rng = np.random.default_rng(4)
    moved = rng.normal(0.0, 0.05, (4, 3))
    v, w = rng.normal(size=(4, 3)), rng.normal(size=(4, 3))
    for at in (line, bar):
        nodes.r[at] += moved
        nodes.v[at], nodes.w[at] = v, w
    rotations = [rotation(x) for x in rng.normal(0.0, 0.3, (4, 3))]
    for at in (line, bar):
        for i, q in zip(at, rotations, strict=True):
            nodes.q[i] = product(q, nodes.q[i])
    for g in model.groups:  # type: ignore[attr-defined]
        p, out = g.parameters.view(np.recarray), g.output.view(np.recarray)
        for i in range(len(p)):
            force = g.module.force
            old, new = g.history[:, i].view(np.recarray)
            force(p[i], old, new, out[i], 0.0, 0.0, nodes, None, None)
    scale = np.abs(nodes.force[line]).max()
    np.testing.assert_allclose(nodes.force[bar], nodes.force[line], atol=1e-12 * scale)
    np.testing.assert_allclose(nodes.torque[bar], nodes.torque[line], atol=1e-12 * scale)
    # roots of a matrix whose entries span six decades
    np.testing.assert_allclose(nodes.stiffness[bar], nodes.stiffness[line], rtol=1e-9)


def rotation(x: np.ndarray) -> np.ndarray:
    """Unit quaternion of a rotation vector."""
    angle = float(np.linalg.norm(x))
    return np.array([np.cos(0.5 * angle), *(np.sin(0.5 * angle) / angle * x)])


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of two quaternions."""
    w = p[0] * q[0] - p[1:] @ q[1:]
    return np.array([w, *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


WRONG = {
    "missing": ("[[1, 2]]", "[[1, 3]]", "bars: bar 1 joins [1, 3], but points are 1 to 2"),
    "short": (
        "[[0, 0, 0], [0.6, 0.8, 0]]",
        "[[0, 0, 0], [0, 0, 0]]",
        "begins and ends in one point",
    ),
    "twice": ("[[1, 2]]", "[[1, 2], [2, 1]]", "bars: bar 2 is given twice"),
    "loose": ("[0.6, 0.8, 0]]", "[0.6, 0.8, 0], [1, 0, 0]]", "points: point 3 has no bar"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_frame_is_refused(case: str, tmp_path: Path) -> None:
    old, new, message = WRONG[case]
    assert old in DECK
    with pytest.raises(DeckErrors) as caught:
        scene(tmp_path, DECK.replace(old, new))
    assert message in str(caught.value)


ENDS = {
    "no bar": ("{bar: 2, point: 1}", "ends: bar 2 does not end in point 1"),
    "no point": ("{bar: 1, point: 3}", "ends: bar 1 does not end in point 3"),
    "twice": ("{bar: 1, point: 2}, {bar: 1, point: 2}", "ends: bar 1 at point 2 is given twice"),
    "massless": (
        "{bar: 1, point: 2, free: [rotation_y]}",
        "every bar at point 2 has an end of its own",
    ),
}


@pytest.mark.parametrize("case", ENDS)
def test_wrong_ends_are_refused(case: str, tmp_path: Path) -> None:
    ends, message = ENDS[case]
    with pytest.raises(DeckErrors) as caught:
        scene(tmp_path, DECK.replace("bars: [[1, 2]]", f"bars: [[1, 2]]\n    ends: [{ends}]"))
    assert message in str(caught.value)


def test_a_joint_named_like_that_of_an_end_is_refused(tmp_path: Path) -> None:
    text = DECK.replace("[0.6, 0.8, 0]]", "[0.6, 0.8, 0], [1, 0, 0]]").replace(
        "bars: [[1, 2]]", "bars: [[1, 2], [2, 3]]\n    ends: [{bar: 2, point: 2}]"
    )
    model, _ = scene(tmp_path, text)
    assert [joint.name for joint in model.joints] == ["bar_bar2_start"]  # type: ignore[attr-defined]
    joint = "joints: {bar_bar2_start: {type: spherical, b: line_start, at: [0, 0, 0]}}\n"
    with pytest.raises(DeckErrors) as caught:
        scene(tmp_path, text + joint)
    assert "its joint 'bar_bar2_start' has a name that is already in use" in str(caught.value)
