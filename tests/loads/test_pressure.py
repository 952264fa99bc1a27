"""Pressure on shells: a closed body of triangles and a quadrilateral, and what it does to each."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np
import pytest
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.model.build import build

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

# a pyramid whose base faces down; its triangles come first in the deck
NODES = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.3, 0.4, 2]]
FACES = [[1, 2, 5, 5], [2, 3, 5, 5], [3, 4, 5, 5], [4, 1, 5, 5], [1, 4, 3, 2]]


def pressed(folder: Path, **words: object) -> tuple[Rows, RowOfTable]:
    """Points of the pyramid under a pressure of 12 Pa, and the output of the load."""
    steel = {"type": "elastoplastic", "young": 1, "poisson": 0, "density": 1, "yield_stress": 1}
    part = {"type": "shell", "thickness": 0.1, "material": "m"}
    part["mesh"] = {"type": "listed", "nodes": NODES, "quads": FACES}
    deck = {"control": {"end_time": 1}, "materials": {"m": steel | words}, "parts": {"s": part}}
    deck["loads"] = {"q": {"type": "pressure", "part": "s", "pressure": 12}}
    path = folder / "pyramid.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    model, state = build(read_deck(path))
    group = next(g for g in model.groups if g.keyword == "loads")
    p, out = as_rows(group.parameters)[0], as_rows(group.output)[0]
    old, new = as_rows(group.history)[:, 0]
    points, nodes = as_rows(state.points), as_rows(state.nodes)
    assert model.elements is not None
    elements = model.elements
    sums = as_rows(elements.block_sums)
    scene = SimpleNamespace(
        points=points, corners=elements.corners, work=elements.work, block_sums=sums
    )
    curves = as_rows(model.curves)
    group.module.force(p, old, new, out, 0.0, 0.0, nodes, None, curves)
    group.module.load_elements(p, old, out, 0.0, scene)
    group.module.add_up(p, out, 0.0, nodes, sums)
    return points, out


def test_a_closed_body_is_in_balance_under_pressure(tmp_path: Path) -> None:
    points, out = pressed(tmp_path)
    np.testing.assert_allclose(out.force, 0.0, atol=1e-14)
    np.testing.assert_allclose(points.force.sum(axis=0), 0.0, atol=1e-14)
    # a quarter of the base, a third of each triangle: the tip has the horizontal parts of all
    tip = -12.0 / 6.0 * sum(_twice_area(a, b, c) for a, b, c, _ in FACES[:4])
    np.testing.assert_allclose(points.force[4], tip, rtol=1e-12)


def _twice_area(a: int, b: int, c: int) -> np.ndarray:
    x = np.asarray(NODES, float)
    return np.cross(x[b - 1] - x[a - 1], x[c - 1] - x[a - 1])


def test_pressure_on_elements_that_may_be_deleted_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match="may be deleted"):
        pressed(tmp_path, failure_strain=0.1)
