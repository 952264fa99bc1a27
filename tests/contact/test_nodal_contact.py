"""Claim: a node of a beam strikes every shape with its own mass and speed, as a ball would."""

from math import pi
from pathlib import Path
from typing import Any

import pytest
import yaml
from quick import first_quick
from small_runs import last, run

# so soft that the rest of the beam is nothing to its node, which is 0.1 mm above the shape's top
SCENE = """
materials: {jelly: {type: elastic, young: 1e-3, poisson: 0.3, density: 1000}}
sections: {rod: {type: circle, radius: 0.02}}
parts:
  rod:
    type: beam
    mesh: {shape: line, from: [0, 0, 1e-4], to: [0, 5, 1e-4], elements: 1}
    section: rod
    material: jelly
    velocity: [0, 0, -1]
contacts:
  hit: {a: [node], b: [shape], normal: {type: kelvin_voigt, stiffness: 1e6, restitution: 0.5}}
"""
TOP = "[0, 0, -0.2]"
SHAPES = {
    "sphere": f"type: sphere, at: {TOP}, radius: 0.2",
    "plane": "type: plane",
    "ellipsoid": f"type: ellipsoid, at: {TOP}, semi_axes: [0.3, 0.4, 0.2]",
    "cylinder": f"type: cylinder, at: {TOP}, axis: [1, 0, 0], radius: 0.2, length: 1",
    "box": f"type: box, at: {TOP}, size: [0.5, 0.5, 0.4]",
    "mesh": "type: mesh, vertices: [[-1, -1, 0], [1, -1, 0], [0, 2, 0]], faces: [[0, 1, 2]],"
    " thickness: 0.1",
}
MASS = 1000.0 * pi * 0.02**2 * 2.5  # of the node, half of the rod's


def scene(shape: str) -> dict[str, Any]:
    node = "type: point_set, body: rod_start, points: [[0, 0, 0]]"
    surfaces = f"surfaces:\n  node: {{{node}}}\n  shape: {{{SHAPES[shape]}}}\n"
    return dict(yaml.safe_load(SCENE + surfaces))


@pytest.mark.parametrize("shape", first_quick(SHAPES, 3))
def test_a_node_rebounds_from_every_shape_by_its_own_mass(shape: str, tmp_path: Path) -> None:
    # half a period of the spring is 5.6 ms
    result = run(tmp_path, scene(shape), 8e-3, 4e-5, plain=True)
    assert last(result, "rcforc.hit.touching") == 0.0
    assert last(result, "rcforc.hit.onsets") == 1.0
    # 150 steps in the contact leave 1e-3 of a method of order 2
    assert last(result, "rbdout.rod_start.velocity.z") == pytest.approx(0.5, rel=1e-3)
    assert last(result, "rcforc.hit.impulse.z") == pytest.approx(1.5 * MASS, rel=1e-3)
    assert last(result, "rbdout.rod_end.velocity.z") == pytest.approx(-1.0, rel=1e-6)
