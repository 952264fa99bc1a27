"""Claims of the quasi-static solution: quadratic convergence, work of loads, clear refusals."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.read import read_deck
from crashsolve.foundation.errors import DeckErrors, SolverError
from crashsolve.model import ledger
from crashsolve.model.build import build
from crashsolve.system import equilibrium

DECK = """
title: cantilever at rest
control: {end_time: 1, solution: quasi_static}
materials: {soft: {type: elastic, young: 1e3, poisson: 0, density: 1}}
sections: {s: {type: general, area: 1, I_y: 1e-3, I_z: 1e-3, torsion: 2e-3, shear_y: 1, shear_z: 1}}
curves: {rise: {points: [[0, 0], [1, 1]]}}
parts:
  p: {type: beam, mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 4}, section: s, material: soft}
joints: {clamp: {type: weld, b: p_start, at: [0, 0, 0]}}
loads: {tip: {type: force, body: p_end, force: [0, 1, 1], curve: rise}}
"""  # noqa: E501
# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("quasi_static")


def engine(folder: Path, text: str = DECK) -> equilibrium.StaticEngine:
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    found = equilibrium.StaticEngine(*build(read_deck(path)), None)
    found.start()
    return found


def test_corrections_fall_quadratically_to_round_off(tmp_path: Path) -> None:
    found, sizes = engine(tmp_path), []
    for _ in range(8):
        way = found._correction(0.3)
        sizes.append(float(np.abs(way).max()))
        found._shift(found.state.nodes, way)
    # each is the square of the one before, then a share: differences over 1e-7 of the size see
    # the stretch of what they turn, and round-off of 1e-16 / 1e-7
    near = [k for k in range(7) if sizes[k] < 0.01]
    assert len(near) >= 2
    for k in near:
        assert sizes[k + 1] < 20.0 * sizes[k] ** 2 + 1e-3 * sizes[k] + 1e-13
    assert sizes[-1] < 1e-11


def test_work_of_loads_is_stored_to_second_order_in_the_load_step(tmp_path: Path) -> None:
    found, missing = engine(tmp_path), []
    start = {g.word: g.history.copy() for g in found.model.groups}
    nodes, clock = found.state.nodes.copy(), found.state.clock.copy()
    for steps in (4, 8):
        found.state.nodes[:], found.state.clock[:] = nodes, clock
        for g in found.model.groups:
            g.history[:] = start[g.word]
        for k in range(steps):
            found.reach((k + 1) / steps)
        found.sample()
        missing.append(abs(found.ledger[ledger.IMBALANCE]))
    assert missing[1] < 1e-2 * found.ledger[ledger.ELASTIC]
    assert np.log2(missing[0] / missing[1]) == pytest.approx(2.0, abs=0.3)


def test_where_no_equilibrium_is_found_the_run_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = engine(tmp_path)
    before = found.state.nodes.copy()
    monkeypatch.setattr(equilibrium, "PASSES", 1)
    with pytest.raises(SolverError, match="no equilibrium found behind this one"):
        found.reach(1.0)
    # what failed has left no trace
    np.testing.assert_array_equal(found.state.nodes["r"], before["r"])


SHELL = """  q:
    type: shell
    mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [1, 1]}
    thickness: 0.1
    material: soft
"""
REFUSED = {
    "integrator": ("solution:", "integrator: radau_iia_5, solution:", "integrator: solution quasi"),
    "drag": ("joints:", f"{SHELL}    drag: 2\njoints:", "and solution quasi_static takes none"),
    "welded": (
        "parts:",
        f"bodies: {{hub: {{mass: 1, inertia: [1, 1, 1], welded: [p_2]}}}}\nparts:\n{SHELL}",
        "a quasi-static solution with shells or fibre beams has no welded nodes",
    ),
    "driver": (
        "joints: {",
        "joints: {pull: {type: point_driver, body: p_end, axis: [0, 1, 0], curve: rise}, ",
        "a quasi-static solution has no drivers yet",
    ),
    "memory": (
        "loads:",
        "springs: {s: {type: elastoplastic, a: ground, b: p_end, stiffness: 1, yield_force: 1}}\n"
        "loads:",
        "a quasi-static solution has no laws that remember yet",
    ),
    "contact": (
        "loads:",
        "surfaces: {a: {type: nodes, part: p}, b: {type: plane, at: [0, 0, -1]}}\n"
        "contacts: {c: {a: [a], b: [b], normal: {type: hertz, stiffness: 1}}}\nloads:",
        "a quasi-static solution has no contacts yet",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_needs_the_course_of_time_is_refused(case: str, tmp_path: Path) -> None:
    old, new, message = REFUSED[case]
    path = tmp_path / "deck.yaml"
    assert old in DECK
    path.write_text(DECK.replace(old, new, 1), "utf-8")
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    assert message in str(caught.value)
