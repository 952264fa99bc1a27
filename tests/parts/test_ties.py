"""Claim: tied meshes move as one where linear fields allow it, and nothing is lost at the tie."""

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from bench import refusal
from command import crashsolve, gone_on

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.shells.forces import blocks
from crashsolve.foundation.point import POINT, TIE
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.model.build import build
from crashsolve.model.model import Model, State
from crashsolve.system import ties
from crashsolve.ties._faces import nearest_face

STEEL = {"type": "elastic", "density": 7850, "young": 2.1e11, "poisson": 0.3}
SHELL = {"type": "shell", "thickness": 0.002, "material": "steel"}
RANDOM = np.random.default_rng(5)


# velocities of points (n, 3) at positions (n, 3)
Field = Callable[[np.ndarray], np.ndarray]


def grid(x: float, count: int, across: int = 0, z: float = 0.0) -> dict[str, object]:
    """A plate of 0.2 by 0.2 whose side u0 is at x."""
    counts = [count, across or count]
    return {
        "type": "grid",
        "at": [x, 0, z],
        "along": [0.2, 0, 0],
        "across": [0, 0.2, 0],
        "elements": counts,
    }


def pair(coarse: int, fine: int, z: float = 0.0, **words: object) -> dict[str, Any]:
    """Two plates of so many elements a side, the second of which rides on the first."""
    return {
        "control": {"end_time": 5e-4, "estimate": "off"},
        "materials": {"steel": STEEL},
        "parts": {
            "coarse": SHELL | {"mesh": grid(0.0, coarse)} | words,
            "fine": SHELL | {"mesh": grid(0.2, fine, z=z)} | words,
        },
        "ties": {"seam": {"part": "fine", "nodes": "u0", "to": "coarse"}},
        "output": {"history": {"interval": 2.5e-5}, "states": {"interval": 5e-4}},
    }


def built(folder: Path, scene: dict[str, object]) -> tuple[Model, State]:
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(scene), "utf-8")
    return build(read_deck(path))


def solved(folder: Path, scene: Mapping[str, object], name: str) -> Result:
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(scene, sort_keys=False), "utf-8")
    done = crashsolve(path, "-o", folder / name)
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(folder / name)


def forces(
    folder: Path, scene: dict[str, object], v: Field, w: Field
) -> tuple[np.ndarray, np.ndarray]:
    """Forces and torques (n, 6) of a step of 1 s with fields of motion; and positions."""
    model, state = built(folder, scene)
    group, points = model.element_groups()[0], as_rows(state.points)
    x = state.points["r"].copy()
    points.v, points.w = v(x), w(x)
    points.r = x + points.v
    e = model.elements
    assert e is not None
    seen = SimpleNamespace(
        points=points,
        corners=e.corners,
        lanes=state.blocks,
        work=e.work,
        curves=as_rows(model.curves),
    )
    kind = import_module("crashsolve.elements.shells.forces.reduced")
    for p in as_rows(group.parameters):
        blocks.deform(kind, p, as_rows(state.clock)[0], 1.0, seen, group.materials[0][1])
    if len(e.ties):
        ties.unload_tied(points, as_rows(e.ties))
    return np.hstack([points.force, points.torque]), x


def still(x: np.ndarray) -> np.ndarray:
    return np.zeros_like(x)


SIZE = 1e-11  # of strains: what is of second order is far below what is asked


def membrane(x: np.ndarray) -> np.ndarray:
    return SIZE * x @ np.array([[1.0, 0.3, 0], [0.3, -0.4, 0], [0, 0, 0]])


def bent_across(x: np.ndarray) -> np.ndarray:
    return SIZE * np.outer(0.5 * x[:, 0] ** 2, [0, 0, 1])


def turned_across(x: np.ndarray) -> np.ndarray:
    return SIZE * np.outer(x[:, 0], [0, -1.0, 0])


def residual(folder: Path, scene: dict[str, object], v: Field, w: Field) -> float:
    """Largest force, or torque on 0.05 m, at nodes within, over the largest at the border."""
    loads, x = forces(folder, scene, v, w)
    eps = 1e-9
    outer = (x[:, 0] < eps) | (x[:, 0] > 0.4 - eps) | (x[:, 1] < eps) | (x[:, 1] > 0.2 - eps)
    loads = np.abs(np.hstack([loads[:, :3], loads[:, 3:] / 0.05]))
    return float(loads[~outer].max() / loads[outer].max())


@pytest.mark.parametrize(
    ("v", "w"), [(membrane, still), (bent_across, turned_across)], ids=["membrane", "bending"]
)
def test_a_patch_passes_where_nodes_of_the_faces_have_tied_ones(
    tmp_path: Path, v: Field, w: Field
) -> None:
    # what a plate of one mesh has as well: terms of second order, 2e-8 at these strains
    assert residual(tmp_path, pair(2, 4), v, w) < 1e-6
    assert residual(tmp_path, pair(3, 3), v, w) < 1e-6
    # else a ninth of the force of a side goes to the neighbouring node, and back
    assert residual(tmp_path, pair(4, 6), v, w) == pytest.approx(1 / 9, rel=1e-6)


def row(height: float, triangle: bool = False) -> tuple[Rows, Rows]:
    """A tie on a warped face, with weights that reach beside it, and its points."""
    table, points = np.zeros(1, TIE.dtype), np.zeros(5, POINT.dtype)
    points["r"][:4] = np.array([[0, 0, 0], [1.1, 0.1, 0], [1, 0.9, 0.1], [-0.1, 1, 0.0]])
    for name in ("v", "w"):
        points[name][:4] = RANDOM.normal(size=(4, 3))
    N = np.array([0.45, 0.3, 0.31, -0.06])
    corners = [0, 1, 2, 3]
    if triangle:
        N, corners = np.array([0.5, 0.3, 0.2, 0.0]), [0, 1, 2, 2]
    table[0]["point"], table[0]["corner"], table[0]["weight"] = 4, corners, N
    table[0]["height"] = height
    return as_rows(table), as_rows(points)


CASES = [(0.0, False), (0.2, False), (-0.1, True)]


@pytest.mark.parametrize(("height", "triangle"), CASES)
def test_forces_keep_their_sum_moment_and_power(height: float, triangle: bool) -> None:
    tie, points = row(height, triangle)
    ties.carry_tied(0.0, points, tie)
    f, t = RANDOM.normal(size=3), RANDOM.normal(size=3)
    points.force[4], points.torque[4] = f, t
    r, v, w = (np.array(points[name][4]) for name in ("r", "v", "w"))
    ties.unload_tied(points, tie)
    force, torque = np.array(points.force), np.array(points.torque)
    assert force.sum(axis=0) == pytest.approx(f, abs=1e-14)
    moment = np.cross(points.r, force).sum(axis=0) + torque.sum(axis=0)
    assert moment == pytest.approx(np.cross(r, f) + t, abs=1e-14)
    power = (force * points.v)[:4].sum() + (torque * points.w)[:4].sum()
    assert power == pytest.approx(f @ v + t @ w, abs=1e-14)


@pytest.mark.parametrize(("height", "triangle"), CASES)
def test_velocity_is_the_rate_of_the_position(height: float, triangle: bool) -> None:
    tie, points = row(height, triangle)
    h = 1e-6
    points.r += 0.5 * h * points.v
    ties.carry_tied(h, points, tie)
    mean, after = np.array(points.v[4]), np.array(points.r[4])
    points.r -= 0.5 * h * points.v
    ties.carry_tied(0.0, points, tie)
    # centred difference: of second order in h
    assert points.v[4] == pytest.approx(mean, rel=1e-9, abs=1e-9)
    points.r -= 0.5 * h * points.v
    ties.carry_tied(0.0, points, tie)
    assert (after - points.r[4]) / h == pytest.approx(mean, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize(("height", "triangle"), CASES)
def test_bounds_of_stiffness_hold_at_the_corners(height: float, triangle: bool) -> None:
    """L |v|^2 <= sum L_i |v_i|^2, and the same of spins, whatever the corners do."""
    for _ in range(50):
        tie, points = row(height, triangle)
        ties.carry_tied(0.0, points, tie)
        points.load[4], points.spin_load[4] = 3.0, 2.0
        v, w = np.array(points.v), np.array(points.w)
        ties.unload_tied(points, tie)
        assert 3.0 * v[4] @ v[4] <= (points.load[:4] * (v[:4] ** 2).sum(axis=1)).sum()
        assert 2.0 * w[4] @ w[4] <= (points.spin_load[:4] * (w[:4] ** 2).sum(axis=1)).sum()


@pytest.mark.parametrize("shape", ["warped", "triangle"])
def test_a_node_stays_exactly_where_it_is(shape: str) -> None:
    corners = np.array([[0, 0, 0], [1.1, 0.1, 0], [1, 0.9, 0.2], [-0.1, 1, 0.0], [2, 0, 0.3]])
    quads = np.array([[1, 4, 2, 2], [0, 1, 2, 3]] if shape == "warped" else [[1, 4, 2, 2]])
    x = np.array([0.4, 0.6, 0.3]) if shape == "warped" else np.array([1.3, 0.3, 0.2])
    face = nearest_face(x, corners, quads)
    assert face is not None
    assert face.face == len(quads) - 1
    own = corners[quads[face.face]]
    n = np.cross(own[2] - own[0], own[3] - own[1])
    back = face.weights @ own + face.height * n / np.linalg.norm(n)
    assert back == pytest.approx(x, abs=1e-14)
    assert face.weights.sum() == pytest.approx(1.0, abs=1e-14)


@pytest.mark.long
def test_free_flight_turns_both_without_strain(tmp_path: Path) -> None:
    """A second plate half a thickness above the first, both turning and moving."""
    scene = pair(3, 5, z=0.001)
    w = np.array([5.0, 2.0, 3.0])
    scene["control"]["end_time"] = 2e-3
    for name, x in (("coarse", np.zeros(3)), ("fine", np.array([0.2, 0, 0.001]))):
        v = np.array([1.0, 2.0, 3.0]) + np.cross(w, x)
        scene["parts"][name] |= {"velocity": v.tolist(), "angular_velocity": w.tolist()}
    result = solved(tmp_path, scene, "flight")
    for word in ("momentum_error", "angular_momentum_error"):
        assert result.series(f"glstat.model.{word}").values.max() < 1e-14  # round-off of sums
    assert np.abs(result.series("glstat.model.balance").values).max() < 1e-6  # of 100
    # centrifugal strain alone: sigma = rho w^2 L^2 / 2 = 2.4e4 Pa, sigma^2 / 2 E of 1.6e-4 m^3
    strain = sum(result.series(f"matsum.{n}.strain").values.max() for n in ("coarse", "fine"))
    assert strain < (7850 * w @ w * 0.4**2 / 2) ** 2 / (2 * 2.1e11) * 1.6e-4
    kinetic = result.series("glstat.model.energy.kinetic").values
    assert kinetic[-1] == pytest.approx(kinetic[0], rel=1e-6)


def pressed(parts: dict[str, Any], **words: object) -> dict[str, Any]:
    """Thick plates of 0.4 by 0.2 held at both ends, under pressure, over half a period."""
    scene = pair(2, 2) | {
        "parts": {name: part | {"thickness": 0.02} for name, part in parts.items()}
    }
    parts = scene["parts"]
    scene["control"]["end_time"] = 1e-3
    loads = {f"p_{n}": {"type": "pressure", "part": n, "pressure": 2e3} for n in parts}
    scene |= {"loads": loads} | words
    first, last = min(parts), max(parts)
    parts[first]["supports"] = [{"nodes": "u0"}]
    parts[last]["supports"] = [*parts[last].get("supports", []), {"nodes": "u1"}]
    parts[first]["traces"] = [{"name": "mid", "at": [0.2, 0.1, 0]}]
    return scene


def middle(folder: Path, coarse: int, fine: int) -> float:
    scene = pressed(pair(coarse, fine)["parts"])
    result = solved(folder, scene, f"tied{coarse}")
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.5  # of 100
    return float(result.series("nodout.coarse_mid.displacement.z").values[-1])


@pytest.mark.long
def test_the_middle_of_tied_plates_converges_as_that_of_one(tmp_path: Path) -> None:
    """Sides of 2 to 3, none of whose inner nodes meet but the middle one."""
    deflections = [middle(tmp_path, n, 3 * n // 2) for n in (4, 8, 16)]
    steps = np.diff(deflections)
    # linear elements under bending: order 2, approached from below on coarse meshes
    assert np.log2(steps[0] / steps[1]) > 1.6
    scene = pressed({"plate": SHELL | {"mesh": grid(0.0, 32, 16) | {"along": [0.4, 0, 0]}}})
    del scene["ties"]
    one = solved(tmp_path, scene, "one").series("nodout.plate_mid.displacement.z").values[-1]
    # errors of both meshes by the mesh itself: 1.2 and 0.8 %
    assert deflections[-1] == pytest.approx(one, rel=5e-3)


@pytest.mark.long
def test_threads_and_restarts_keep_the_bits(tmp_path: Path) -> None:
    scene = pressed(pair(2, 3)["parts"])
    scene["control"]["end_time"] = 2e-4
    scene["output"] = {"history": {"interval": 2e-5}, "restart": {"every": 4e-5}}
    results = []
    for threads in (1, 2):
        scene["control"]["threads"] = threads
        result = solved(tmp_path, scene, f"t{threads}")
        results.append(result.series("nodout.coarse_mid.position.z").values)
    assert np.array_equal(*results)
    gone_on(tmp_path / "t1.yaml", tmp_path / "t1", tmp_path / "again")


@pytest.mark.long
def test_a_tie_shortens_no_step_of_equal_elements(tmp_path: Path) -> None:
    """The bound of the frequency at a corner is a mean of those of its own and of tied nodes."""
    steps = []
    for ties_of in ({}, pair(2, 4)["ties"]):
        scene = pair(2, 4) | {"ties": ties_of}
        result = solved(tmp_path, scene, f"s{len(steps)}")
        steps.append(result.series("glstat.model.step").values[-1])
    assert steps[1] >= steps[0]


WRONG: dict[str, tuple[dict[str, object], str]] = {
    "far": ({"mesh": grid(0.203, 3)}, "0.003 m from the nearest face of 'coarse', more than 0.002"),
    "beside": ({"mesh": grid(0.3, 3)}, "lies beside all faces of 'coarse'; leave it out"),
    "held": (
        {"supports": [{"nodes": "v0"}]},
        "(0.2, 0, 0) m is supported, named, welded or tied alr",
    ),
    "named": (
        {"nodes": [{"name": "n", "at": [0.2, 0, 0]}]},
        "is supported, named, welded or tied alr",
    ),
    "fast": (
        {"velocity": [0, 0, 1]},
        "nodes begin 1 m/s and 0 rad/s faster than their faces; give",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_tied_is_refused(tmp_path: Path, name: str) -> None:
    words, message = WRONG[name]
    scene = pair(2, 3)
    scene["parts"]["fine"] |= words
    said = refusal(tmp_path, yaml.safe_dump(scene, sort_keys=False))
    assert message in said
    assert "tie 'seam': nodes" in said


def test_ties_are_refused_where_they_meet_or_cannot_act(tmp_path: Path) -> None:
    def said(change: Callable[[dict[str, Any]], object]) -> str:
        scene = pair(2, 3)
        change(scene)
        return refusal(tmp_path, yaml.safe_dump(scene, sort_keys=False))

    back = {"part": "coarse", "nodes": "u1", "to": "fine"}
    assert "is tied itself" in said(lambda s: s["ties"].update(back=back))
    assert "tied already" in said(lambda s: s["ties"].update(again=dict(s["ties"]["seam"])))
    own = {"part": "fine", "nodes": "u0", "to": "fine"}
    assert "is tied itself" in said(lambda s: s["ties"].update(seam=own))
    method = {"integrator": "generalized_alpha", "step": 1e-5}
    assert "integrator generalized_alpha has none" in said(lambda s: s["control"].update(method))
    weak = STEEL | {"type": "elastoplastic", "yield_stress": 2e8, "failure_strain": 0.1}
    assert "may be deleted" in said(lambda s: s["materials"].update(steel=weak))
    assert "no set of nodes 'x'" in said(lambda s: s["ties"]["seam"].update(nodes="x"))
    assert "unknown part 'coarser'" in said(lambda s: s["ties"]["seam"].update(to="coarser"))


def test_mass_and_momentum_of_impulses_go_to_the_faces(tmp_path: Path) -> None:
    scene = pair(2, 3)
    impulse = {"low": [0.2, -1, -1], "high": [1, 1, 1], "speed": 3.0}
    scene["parts"]["fine"]["impulses"] = [impulse]
    model, state = built(tmp_path, scene)
    free = state.points["fixed"] == 0
    mass = 1.0 / state.points["mass_inv"][free]
    half = 7850 * 0.002 * 0.04
    assert mass.sum() == pytest.approx(2 * half, rel=1e-12)
    assert model.total_mass() == pytest.approx(2 * half, rel=1e-12)
    assert mass @ state.points["v"][free, 2] == pytest.approx(3.0 * half, rel=1e-12)
