"""Claim: tension holds beams sideways by its whole work along the bent line, however long elements.

Stiffness and frequencies come from the element's tangent, which test_beam.py proves, without steps.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from bench import Bench
from command import crashsolve
from quick import first_quick
from test_beam import DECK, STEP, acceleration, load, shift

from crashpost.results.result import Result

E, SIDE, LENGTH = 1e9, 0.01, 1.0
BENDING = E * SIDE**4 / 12.0
EULER = np.pi**2 * BENDING / (4.0 * LENGTH**2)
STEEL: dict[str, dict[str, object]] = {
    "beam": {"type": "elastic"},
    "fibre_beam": {"type": "elastoplastic", "yield_stress": 1e9, "hardening": 1e8},
}
# E I = 1, E A = 1e8, rho A = 1, L = 1
CHAIN = """
title: chain
control: {end_time: 1}
materials: {m: {type: elastic, young: 1e8, poisson: 0, density: 1}}
sections: {s: {type: general, area: 1, I_y: 1e-8, I_z: 1e-8, torsion: 1e-8, shear_y: 1, shear_z: 1}}
parts:
  p: {type: beam, mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: COUNT}, section: s, material: m}
"""  # noqa: E501


def chain(folder: Path, count: int, tension: float) -> tuple[np.ndarray, np.ndarray]:
    """K and the masses of ways and turns in one plane, under a tension."""
    bench = Bench(folder, "", CHAIN.replace("COUNT", str(count)))
    (group,) = [g for g in bench.model.groups if g.keyword == "parts"]
    nodes = bench.nodes
    nodes.r[1:] *= 1.0 + tension / 1e8
    K, size = np.zeros((6 * count + 6, 6 * count + 6)), 6 * count + 6
    for k, forces in enumerate(group.module.forces_by_motions(group.parameters, None, nodes, None)):
        at = slice(6 * k, 6 * k + 12)
        K[at, at] -= forces
    J = nodes.J[1:].reshape(-1, 3, 3)[:, [0, 1, 2], [0, 1, 2]]
    M = np.hstack([np.repeat(1.0 / nodes.mass_inv[1:], 3).reshape(-1, 3), J]).ravel()
    plane = np.sort(np.r_[1:size:6, 5:size:6])
    return K[np.ix_(plane, plane)], M[plane]


def test_a_tension_adds_the_consistent_geometric_stiffness(tmp_path: Path) -> None:
    # Przemieniecki (1968), 15.2, of a straight slender element of length 1
    wanted = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / 30.0
    N = 1e3
    added = (chain(tmp_path, 1, N)[0] - chain(tmp_path, 1, 0.0)[0]) / N
    # the stretch N / E A = 1e-5, times the 12 E I = 0.012 N of bending too
    np.testing.assert_allclose(added, wanted, atol=3e-5)


@pytest.mark.parametrize("ratio", [0.1, 10.0, 1e4])
def test_a_taut_string_vibrates_as_it_should(tmp_path: Path, ratio: float) -> None:
    """omega = pi / L sqrt((N + pi^2 E I / L^2) / rho A) between hinges, N l^2 = 12 E I ratio."""
    errors = []
    for count in (4, 8):
        # strings of one tension: that of 8 elements has the ratio
        N = 12.0 * ratio * 8**2
        K, M = chain(tmp_path, count, N)
        free = [k for k in range(len(M)) if k not in (0, len(M) - 2)]
        K, M = K[np.ix_(free, free)], np.sqrt(M[free])
        square = np.linalg.eigvalsh(K / np.outer(M, M))[0]
        # mass and length are those before the stretch
        exact = np.pi**2 * (N / (1.0 + N / 1e8) + np.pi**2)
        errors.append(float(np.sqrt(square / exact)) - 1.0)
    # lumped masses and an even kink per node: order 2
    assert abs(errors[1]) < 2e-3
    assert abs(errors[1]) < 0.3 * abs(errors[0])


@pytest.mark.parametrize(("count", "share"), [(1, 1.00752), (2, 1.00051), (4, 1.00003)])
def test_columns_buckle_at_the_critical_load(tmp_path: Path, count: int, share: float) -> None:
    """Of pi^2 E I / 4 L^2; shares of cubic elements, by their matrices."""
    signs = []
    for factor in (share - 1e-4, share + 1e-4):
        K, _ = chain(tmp_path, count, -factor * np.pi**2 / 4.0)
        signs.append(np.linalg.eigvalsh(K[2:, 2:])[0] > 0.0)
    assert signs == [True, False]


SECTIONS = {
    "stocky": "{type: rectangle, width: 0.5, height: 0.8}",
    "wire": "{type: circle, radius: 0.0005}",
}


@pytest.mark.parametrize("stretch", [1e-6, 1e-3, 0.1])
@pytest.mark.parametrize("bend", [0.0, 0.01, 0.3])
@pytest.mark.parametrize("section", SECTIONS)
def test_the_bound_of_the_step_grows_with_tension_and_bow(
    tmp_path: Path, section: str, bend: float, stretch: float
) -> None:
    """2 max_i stiffness_i is not below the largest eigenvalue of M^-1 K (system.timestep)."""
    text = DECK.replace("DAMPING", "0").replace(SECTIONS["stocky"], SECTIONS[section])
    law = Bench(tmp_path, "", text).law("parts", "s_1")
    nodes = law.bench.nodes
    direction = nodes.r[2] - nodes.r[1]
    law.bench.move(2, r=nodes.r[1] + (1.0 + stretch) * direction)
    rotations = np.random.default_rng(3).uniform(-bend, bend, 12)
    shift(law, law.bench.state(), rotations, np.zeros(12), 1.0)
    load(law)
    bound = 2.0 * nodes.stiffness[1:].max()
    start, columns = law.bench.state(), []
    for motion in np.eye(12):
        ends = []
        for side in (-0.1 * STEP, 0.1 * STEP):
            shift(law, start, motion, np.zeros(12), side)
            ends.append(acceleration(law))
        columns.append((ends[1] - ends[0]) / (0.2 * STEP))
    highest = np.linalg.eigvals(-np.array(columns).T).real.max()
    # nor is it so far above that steps are wasted; rows grow by eta^4 and the square of the stretch
    assert 0.4 * bound < highest <= bound


def solved(folder: Path, kind: str, parts: dict[str, tuple[int, float]]) -> Any:
    """Cantilevers of so many elements, with forces along them at their ends, at rest."""
    steel = {"young": E, "poisson": 0, "density": 1000} | STEEL[kind]
    deck: dict[str, Any] = {
        "control": {"end_time": 1, "solution": "quasi_static", "steps": 1, "tolerance": 1e-9},
        "materials": {"steel": steel},
        "sections": {"bar": {"type": "rectangle", "width": SIDE, "height": SIDE}},
        "curves": {"rise": {"points": [[0, 0], [1, 1]]}},
        **{word: {} for word in ("parts", "joints", "loads")},
    }
    for k, (name, (count, force)) in enumerate(parts.items()):
        mesh = {"shape": "line", "from": [0, k, 0], "to": [LENGTH, k, 0], "elements": count}
        card = {"type": kind, "mesh": mesh, "section": "bar", "material": "steel"}
        more = {"fibres": [2, 2]} if kind == "fibre_beam" else {}
        deck["parts"][name] = card | {"side": [0, 1, 0]} | more
        deck["joints"][name] = {"type": "weld", "b": f"{name}_start", "at": [0, k, 0]}
        load = {"type": "force", "body": f"{name}_end", "force": [force, 0, 0], "curve": "rise"}
        deck["loads"][name] = load
    (folder / "deck.yaml").write_text(yaml.safe_dump(deck))
    return crashsolve(folder / "deck.yaml", "-o", folder, CRASHSOLVE_PLAIN="1")


@pytest.mark.parametrize("kind", first_quick(["beam", "fibre_beam"], 0))
def test_a_column_buckles_beside_a_long_element_in_tension(kind: str, tmp_path: Path) -> None:
    # the bar bears 108 E I / l^2; 4 elements leave 3e-5 of the column's load
    for factor, code in ((0.99, 0), (1.01, 4)):
        done = solved(tmp_path, kind, {"bar": (1, 90.0), "column": (4, -factor * EULER)})
        assert done.returncode == code, done.stdout + done.stderr
        assert code == 0 or "'column_" in done.stdout + done.stderr
        if code == 0:
            end = Result(tmp_path).series("rbdout.bar_end.position.x").values[-1]
            # of the stretch, which the tolerance of the run is over
            assert end - LENGTH == pytest.approx(90.0 * LENGTH / (E * SIDE**2), rel=1e-6)
