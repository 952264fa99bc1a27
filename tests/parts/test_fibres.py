"""Claims of fibre beams: elastic they are the beam; beyond yield closed forms hold."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from bench import Bench, Law
from command import crashsolve
from test_beam import KINDS, is_plastic, load, on_its_way, shift, whole_tangent

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.beams import fibres
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.parts.fibre_beam import IMPLICIT

DECK = """
title: one fibre beam
control: {end_time: 1}
materials:
  soft: {type: elastoplastic, young: 2000, poisson: 0.3, density: 3, YIELD}
  hooke: {type: elastic, young: 2000, poisson: 0.3, density: 3}
  rubber: {type: neo_hookean, young: 2000, poisson: 0.3, density: 3}
sections: {s: {SECTION}}
curves: {flow: {points: [[0, 4], [1, 24], [5, 24]]}}
parts:
  s: &s
    type: fibre_beam
    mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 1}
    section: s
    material: soft
    side: [0, 1, 0]
    fibres: [GRID]
    WORDS
"""
RECTANGLE = "type: rectangle, width: 0.5, height: 0.8"
SHAPES = {
    RECTANGLE: "4, 16",
    "type: circle, radius: 0.4": "4, 16",
    "type: tube, radius: 0.4, thickness: 0.05": "1, 64",
    "type: rectangular_tube, width: 0.5, height: 0.8, thickness: 0.02": "16, 16",
    "type: i_section, width: 0.5, height: 0.8, flange: 0.03, web: 0.02": "16, 32",
}
STIFF = "yield_stress: 1e9"
PERFECT = "yield_stress: 4"


def text(flow: str = STIFF, section: str = RECTANGLE, grid: str = "4, 16", words: str = "") -> str:
    deck = DECK
    for word, value in (("YIELD", flow), ("SECTION", section), ("GRID", grid), ("WORDS", words)):
        deck = deck.replace(word, value)
    return deck


def element(folder: Path, *words: str) -> Law:
    return Bench(folder, "", text(*words)).law("parts", "s_1")


def act(law: Law) -> Any:
    """The element's output after a step to where the nodes are."""
    return law.force(h=1.0)


def bend(law: Law, angle: float, axis: int = 1, stretch: float = 0.0) -> Any:
    """Both ends turned against each other by an angle, on the arc of a circle."""
    rotation = 0.5 * angle * np.eye(3)[axis]
    nodes = law.bench.nodes
    q = [[1.0, 0.0, 0.0, 0.0]] * 2
    for node, sign in ((1, -1.0), (2, 1.0)):
        law.bench.move(node, q=q[node - 1])
        law.bench.rotation(node, sign * rotation)
    # the chord of an arc of this length, as elements have it
    chord = (1.0 + stretch) / (1.0 + angle**2 / 24.0)
    law.bench.move(2, r=nodes[1].r + [chord, 0.0, 0.0])
    return act(law)


@pytest.mark.parametrize("section", SHAPES)
def test_below_yield_it_is_the_beam(tmp_path: Path, section: str) -> None:
    words = text(STIFF, section, SHAPES[section], "damping: 0.1\n    drag: 2")
    fibrous = Bench(tmp_path, "", words).law("parts", "s_1")
    plain_beam = words.replace("type: fibre_beam", "type: beam").replace(
        "material: soft", "material: hooke"
    )
    beam = Bench(tmp_path, "", plain_beam.replace(f"fibres: [{SHAPES[section]}]", "")).law(
        "parts", "s_1"
    )
    fibrous.bench.shake(3, 1.0, 0.4)
    beam.bench.nodes[:] = fibrous.bench.nodes
    here, there = act(fibrous), beam.force()
    # round-off of sums over fibres
    for name in ("force", "moment_a", "moment_b"):
        size = np.abs(there[name]).max()
        np.testing.assert_allclose(here[name], there[name], atol=1e-12 * size)
    for name in ("stored", "power"):
        assert float(here[name]) == pytest.approx(float(there[name]), rel=1e-12)
    n, m = fibrous.bench.nodes, beam.bench.nodes
    np.testing.assert_allclose(n.stiffness, m.stiffness, rtol=1e-12)


@pytest.mark.parametrize("ratio", [1.5, 3.0, 10.0])
def test_the_moment_of_a_rectangle_beyond_yield(tmp_path: Path, ratio: float) -> None:
    """M = M_p (1 - (kappa_Y / kappa)^2 / 3) at kappa = ratio kappa_Y."""
    law = element(tmp_path, PERFECT, RECTANGLE, "2, 32")
    limit = 4.0 * 0.5 * 0.8**2 / 4.0
    at_yield = 4.0 / 2000 / 0.4
    out = bend(law, ratio * at_yield)
    wanted = limit * (1.0 - 1.0 / (3.0 * ratio**2))
    # fibres as high as 1/32 of the section yield one by one
    assert float(out.moment_a[1]) == pytest.approx(wanted, rel=3e-3)


LIMITS = {
    RECTANGLE: 0.5 * 0.8**2 / 4,
    "type: circle, radius: 0.4": 4 * 0.4**3 / 3,
    "type: tube, radius: 0.4, thickness: 0.05": 4 * (0.4**3 - 0.35**3) / 3,
    "type: rectangular_tube, width: 0.5, height: 0.8, thickness: 0.02": 0.02 * 0.78 * (0.48 + 0.39),
    "type: i_section, width: 0.5, height: 0.8, flange: 0.03, web: 0.02": (
        0.5 * 0.03 * 0.77 + 0.02 * 0.74**2 / 4
    ),
}


@pytest.mark.parametrize("section", SHAPES)
def test_limit_moments_about_y(tmp_path: Path, section: str) -> None:
    out = bend(element(tmp_path, PERFECT, section, SHAPES[section]), 1.0)
    # few fibres over the height: 1/(2 n^2) for their second moment, and sectors as chords
    assert float(out.moment_a[1]) == pytest.approx(4.0 * LIMITS[section], rel=0.012)


def test_a_fibre_hardens_along_its_curve_and_by_the_rate(tmp_path: Path) -> None:
    law = element(tmp_path, "curve: flow, rate_D: 40, rate_q: 2")
    # the velocity of the end is no part of it
    law.bench.move(2, r=[1.1, 0, 0], v=[-3, 0, 0])
    out = law.force(h=0.01)
    stress = float(out.force[0]) / (0.5 * 0.8)
    plastic = 0.1 - stress / 2000
    assert float(out.plastic_strain) == pytest.approx(plastic, rel=1e-12)
    factor = 1 + np.sqrt(plastic / 0.01 / 40)
    assert stress == pytest.approx((4 + 20 * plastic) * factor, rel=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_work_of_a_cycle_is_stored_or_lost(tmp_path: Path, share: float) -> None:
    law = element(tmp_path, f"yield_stress: 4, hardening: 300, kinematic: {share}")
    work, before, lost, stored = 0.0, None, 0.0, 0.0
    for angle in [*np.linspace(0, 0.2, 21), *np.linspace(0.2, -0.2, 41)]:
        out = bend(law, angle)
        moment = 0.5 * float(out.moment_a[1] + out.moment_b[1])
        if before is not None:
            work += 0.5 * (moment + before[1]) * (angle - before[0])
        before, stored = (angle, moment), float(out.stored)
        lost += float(out.loss)
        law.accept()
    assert lost > 0.0
    assert work == pytest.approx(stored + lost, rel=1e-12)
    assert float(law.out.plastic_work) == pytest.approx(lost, rel=1e-12)


def test_a_sample_changes_nothing(tmp_path: Path) -> None:
    law = element(tmp_path, PERFECT)
    bend(law, 0.3)
    law.accept()
    first = act(law).moment_a.copy()
    law.accept()
    out = law.force(h=0.0)
    np.testing.assert_allclose(out.moment_a, first, rtol=1e-13)
    assert float(out.loss) == 0.0


@pytest.mark.parametrize("kind", [k for k in KINDS if is_plastic(k) and "perfect" not in k])
def test_corrections_fall_quadratically_beyond_yield(tmp_path: Path, kind: str) -> None:
    """Newton's method for the second node, back to where it is held by the load it had there."""
    law = on_its_way(tmp_path, kind, 5, 0.0, 0.8)
    wanted, sizes = load(law)[6:], []
    away = np.append(np.zeros(6), 0.05 * np.random.default_rng(1).normal(size=6))
    shift(law, law.bench.state(), away, np.zeros(12), 1.0)
    for _ in range(8):
        missing = load(law)[6:] - wanted
        direction = np.linalg.solve(whole_tangent(law, 0)[6:, 6:], missing)
        shift(law, law.bench.state(), np.append(np.zeros(6), direction), np.zeros(12), 1.0)
        sizes.append(np.abs(direction).max())
    near = [k for k in range(7) if 1e-9 < sizes[k] < 1e-1]
    assert len(near) >= 2
    for k in near:
        # round-off of forces of some hundreds over a stiffness of some hundreds
        assert sizes[k + 1] < 20.0 * sizes[k] ** 2 + 1e-13


CYCLE = """
control: {end_time: 0.4, tolerance: 1e-5, estimate: "off"}
materials:
  m: {type: elastoplastic, young: 1e4, poisson: 0.3, density: 1, yield_stress: 100, hardening: 3000,
  kinematic: 0.5}
sections: {s: {type: rectangle, width: 1, height: 0.5}}
bodies: {mass: {mass: 1, inertia: [1, 1, 1], position: [1, 0.1, 0.3]}}
parts:
  p: {type: fibre_beam, mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 4},
    section: s, material: m, fibres: [4, 8], side: [0, 1, 0]}
curves:
  blow: {type: formula, expression: "100*sin(157.0796326794897*x)**2", from: 0, to: 0.02,
    extrapolate: hold}
joints:
  root: {type: weld, b: p_start, at: [0, 0, 0]}
  tip: {type: weld, a: mass, b: p_end, at: [1, 0, 0]}
loads: {blow: {type: force, body: mass, force: [5, 2, 3], curve: blow}}
"""


@pytest.mark.long
@pytest.mark.xdist_group("implicit fibres")
def test_implicit_steps_go_through_cycles_of_yield_as_explicit_ones_do(tmp_path: Path) -> None:
    path, positions, steps = tmp_path / "deck.yaml", {}, {}
    path.write_text(CYCLE, "utf-8")
    # of equal steps the error is 5e-8 here, by halving them
    for method, words in (("rattle", ["control.step=8e-6"]), *((m, []) for m in IMPLICIT)):
        sets = [w for word in (f"control.integrator={method}", *words) for w in ("--set", word)]
        done = crashsolve(path, "-o", tmp_path / method, *sets)
        assert done.returncode == 0, done.stdout + done.stderr
        result = Result(tmp_path / method)
        steps[method] = int(result.status["cycle"])
        positions[method] = [result.series(f"rbdout.mass.position.{c}").values[-1] for c in "xyz"]
    # tolerance: of a step, and errors add up; a fibre that yields within a step costs an order
    for method, tolerance in (("generalized_alpha", 1e-4), ("radau_iia_5", 1e-5)):
        np.testing.assert_allclose(positions[method], positions["rattle"], rtol=0, atol=tolerance)
        assert steps[method] < 0.1 * steps["rattle"]


REFUSED = {
    "rubber": (
        "material: soft",
        "material: rubber",
        "type neo_hookean is for shells; strains of beams are small",
    ),
    "beam": ("type: fibre_beam", "type: beam", "fibres"),
    "many": ("fibres: [4, 16]", "fibres: [9, 16]", "makes 144 fibres of this section; at most 64"),
    "huge": ("fibres: [4, 16]", "fibres: [1000000000000, 16]", "at most 64 fibres in all"),
    "line": ("fibres: [4, 16]", "fibres: [1, 16]", "fibres on one line do not resist bending"),
    "general": (
        RECTANGLE,
        "type: general, area: 1, I_y: 1, I_z: 1, torsion: 1, shear_y: 1, shear_z: 1",
        "this section has no fibres",
    ),
    "stages": (
        "control: {",
        "control: {integrator: dormand_prince_5, ",
        "set integrator: rattle or generalized_alpha or radau_iia_5",
    ),
    "welded at rest": (
        "control: {",
        "bodies: {hub: {mass: 1, inertia: [1, 1, 1], welded: [s_start]}}\n"
        "control: {solution: quasi_static, ",
        "a quasi-static solution with shells or fibre beams has no welded nodes; take a joint",
    ),
    "aside": (
        RECTANGLE,
        "type: fibres, fibres: [[0, 1, 1], [1, 2, 1]], torsion: 1, shear_y: 1, shear_z: 1",
        "their mass centre must be the origin",
    ),
    "failure": (
        "type: elastoplastic,",
        "type: elastoplastic, failure_strain: 0.1,",
        "material 'soft' has failure_strain, which fibres do not follow",
    ),
    "an error elsewhere": (
        "control: {",
        "joints: {foot: {type: revolute, b: s_start, at: [0, 0, 0], axis: [0, 0, 0]}}\ncontrol: {",
        "joint 'foot': axis: a direction needs a length",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_yield_is_refused(tmp_path: Path, case: str) -> None:
    old, new, message = REFUSED[case]
    path = tmp_path / "deck.yaml"
    assert old in text()
    path.write_text(text().replace(old, new), "utf-8")
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    assert message in str(caught.value)


def test_a_section_of_listed_fibres_is_a_sandwich(tmp_path: Path) -> None:
    flanges = "[[0.1, 0.5, 0.2], [-0.1, 0.5, 0.2], [0.1, -0.5, 0.2], [-0.1, -0.5, 0.2]]"
    section = f"type: fibres, fibres: {flanges}, torsion: 1, shear_y: 1, shear_z: 1"
    out = bend(element(tmp_path, PERFECT, section), 0.1)
    assert float(out.moment_a[1]) == pytest.approx(4.0 * 0.4 * 1.0, rel=1e-12)


def test_a_law_that_stiffens_states_the_step() -> None:
    # sigma = E (eps + c eps^3) has the slope E (1 + 3 c eps^2)
    E, c = 2e11, 1e7
    section = SimpleNamespace(
        count=2, y=[0.0, 0.0], z=[0.01, -0.01], material=SimpleNamespace(young=E)
    )
    law = SimpleNamespace(
        fibre_tangent=lambda m, old, i, eps, rate, curves: (0.0, -3.0 * E * c * eps**2, 0.0)
    )
    # stretched by 1e-3 and bent: fibres at 2e-3 and 0
    bound = fibres.stiffening(section, None, None, (1e-3, 0.1, 0.0), (0.0, 0.0, 0.0), law)
    assert bound == pytest.approx(3.0 * c * 4e-6)
