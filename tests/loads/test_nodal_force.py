"""Forces on sets of nodes: the shares of the nodes, their sum, and what is refused."""

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build

GRID = {"type": "grid", "along": [2, 0, 0], "across": [0, 1, 0], "elements": [4, 2]}
STEEL = {"type": "elastic", "young": 1, "poisson": 0, "density": 1}


def loaded(folder: Path, *loads: Mapping[str, object], **words: object) -> tuple[Any, Any, Any]:
    """Points, ground and outputs after a step of 0.1 s at 1 m/s in y, from factor 3 to 1."""
    part = {"type": "shell", "thickness": 0.1, "material": "m", "mesh": GRID} | words
    force = {"type": "nodal_force", "part": "s", "nodes": "u1", "force": [0, 8, 4]}
    deck: dict[str, object] = {
        "control": {"end_time": 1},
        "materials": {"m": STEEL},
        "parts": {"s": part},
    }
    deck["loads"] = {f"q{k}": {**force, **own} for k, own in enumerate(loads)}
    path = folder / "plate.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    model, state = build(read_deck(path))
    group = next(g for g in model.groups if g.keyword == "loads")
    points, nodes = as_rows(state.points), as_rows(state.nodes)
    points.v[:] = [0, 1, 0]
    outputs = as_rows(group.output)
    scene = SimpleNamespace(points=points)
    curves = as_rows(model.curves)
    for k, p in enumerate(as_rows(group.parameters)):
        old, new = as_rows(group.history)[:, k]
        old.factor = 3.0
        words_ = (p, old, new, outputs[k], 0.0, 0.1, nodes)
        group.module.force(*words_, None, curves)
        group.module.force_on_points(*words_, curves, scene, group.members)
    return points, nodes[0], outputs


def test_the_ends_of_a_line_take_half_of_what_those_between_do(tmp_path: Path) -> None:
    points, ground, outputs = loaded(tmp_path, {})
    edge = points[np.isclose(points.r[:, 0], 2.0)]
    np.testing.assert_allclose(edge.force[:, 1], [2, 4, 2], rtol=1e-12)
    np.testing.assert_allclose(points.force.sum(axis=0), [0, 8, 4], rtol=1e-12)
    moment = np.cross(points.r, points.force).sum(axis=0)
    np.testing.assert_allclose(ground.external, [0, 8, 4, *moment], rtol=1e-12, atol=1e-12)
    # the mean factor is 2, the way 0.1 m
    assert outputs[0].loss == pytest.approx(2 * 8 * 0.1, rel=1e-12)


def test_equal_shares_and_several_loads(tmp_path: Path) -> None:
    other = {"nodes": "u0", "share": "equal", "force": [3, 0, 0]}
    points, _, outputs = loaded(tmp_path, {}, other)
    np.testing.assert_allclose(points[np.isclose(points.r[:, 0], 0.0)].force[:, 0], 1.0)
    np.testing.assert_allclose(points.force.sum(axis=0), [3, 8, 4], rtol=1e-12)
    np.testing.assert_allclose(outputs.force, [[0, 8, 4], [3, 0, 0]])


def test_nodes_that_are_held_and_such_that_are_bodies_are_loaded(tmp_path: Path) -> None:
    supports = [{"nodes": "v0", "motions": ["x", "y"]}]
    tip = [{"name": "tip", "at": [2, 1, 0]}]
    points, _, _ = loaded(tmp_path, {}, supports=supports, nodes=tip)
    np.testing.assert_allclose(points.force.sum(axis=0), [0, 8, 4], rtol=1e-12)
    with pytest.raises(DeckErrors) as caught:
        loaded(tmp_path, {}, supports=[{"nodes": "u1", "motions": ["x"]}], nodes=tip)
    assert "load it in its other directions by a nodal_force" in str(caught.value)


def test_a_set_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors) as caught:
        loaded(tmp_path, {"nodes": "edge"})
    reported = str(caught.value)
    assert (
        "load 'q0': nodes: the mesh has no set of nodes 'edge' (sets: u0, u1, v0, v1)" in reported
    )
    assert reported.count("load 'q0'") == 1
