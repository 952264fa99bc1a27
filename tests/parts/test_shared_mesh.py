"""Claim: parts that share a mesh are joined at its nodes, and are parts like any other."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from bench import refusal
from command import crashsolve, gone_on

from crashpost.results.result import Result
from crashpost.results.states import States
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.study.meshes import coarser

# a yielding plate, held at one side and thrown at the other; a half of it fills two blocks
MESH = {"type": "grid", "along": [0.2, 0, 0], "across": [0, 0.4, 0], "elements": [8, 8]}
STEEL = {"type": "elastoplastic", "density": 7850, "young": 2.1e11, "poisson": 0.3}
STEEL |= {"yield_stress": 2.5e8, "hardening": 1e9}
PLATE = {"type": "shell", "thickness": 0.002, "material": "steel"}
HELD = {"supports": [{"nodes": "v0"}]}
THROWN = {"velocities": [{"nodes": "v1", "velocity": [0, 3, 20]}]}
# on the seam, at the free side, and between
TRACES = {"a": [0.1, 0.2, 0], "b": [0.1, 0.4, 0], "c": [0.03, 0.25, 0]}
LOW = {"type": "shared", "mesh": "plate", "low": [-1, -1, -1], "high": [1, 0.2, 1]}
TOP = {"type": "shared", "mesh": "plate", "low": [-1, 0.2, -1], "high": [1, 1, 1]}


def deck(parts: Mapping[str, object], **control: object) -> dict[str, Any]:
    control = {"end_time": 5e-4, "integrator": "rattle", "estimate": "off"} | control
    return {
        "control": control,
        "materials": {"steel": STEEL},
        "parts": parts,
        "output": {"history": {"interval": 5e-5}, "states": {"interval": 2.5e-4}},
    }


def traces(*names: str) -> dict[str, object]:
    return {"traces": [{"name": name, "at": TRACES[name]} for name in names]}


def one_part(**control: object) -> dict[str, Any]:
    plate = PLATE | HELD | THROWN | traces("a", "b", "c") | {"mesh": MESH}
    return deck({"plate": plate}, **control)


def two_parts(**control: object) -> dict[str, Any]:
    parts = {"low": PLATE | {"mesh": LOW} | HELD | traces("a")}
    parts["top"] = PLATE | {"mesh": TOP} | THROWN | traces("b", "c")
    return {"meshes": {"plate": MESH}} | deck(parts, **control)


def solved(folder: Path, scene: Mapping[str, object], name: str, **words: str) -> Result:
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(scene, sort_keys=False), "utf-8")
    done = crashsolve(path, "-o", folder / name, **words)
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(folder / name)


def motion(result: Result, owners: dict[str, str]) -> np.ndarray:
    quantities = [f"{q}.{k}" for q in ("position", "velocity") for k in "xyz"]
    histories = [
        result.series(f"nodout.{owners[name]}_{name}.{q}").values
        for name in TRACES
        for q in quantities
    ]
    return np.array(histories)


TWO = {"a": "low", "b": "top", "c": "top"}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Result]:
    folder = tmp_path_factory.mktemp("shared")
    return solved(folder, one_part(), "one"), solved(folder, two_parts(), "two")


def test_a_plate_of_two_parts_has_the_bits_of_one(both: tuple[Result, Result]) -> None:
    one, two = both
    first = motion(one, dict.fromkeys(TRACES, "plate"))
    assert np.ptp(first, axis=1).max() > 1e-3  # it moves
    assert np.array_equal(first, motion(two, TWO))


@pytest.mark.long
def test_energies_of_the_parts_are_those_of_the_whole(both: tuple[Result, Result]) -> None:
    one, two = both
    for word in ("kinetic", "strain", "plastic", "hourglass"):
        whole = one.series(f"matsum.plate.{word}").values
        parts = sum(two.series(f"matsum.{name}.{word}").values for name in ("low", "top"))
        # sums of a hundred numbers in another order
        assert parts == pytest.approx(whole, rel=1e-12), word


@pytest.mark.long
def test_pictures_show_each_part_with_its_own_nodes(both: tuple[Result, Result]) -> None:
    states = [States(run.folder) for run in both]
    low, top = (states[1].positions(-1, f"part_{name}") for name in ("low", "top"))
    whole = states[0].positions(-1, "part_plate")
    assert len(low) == len(top) == 45
    assert np.array_equal(np.concatenate([low, top[9:]]), whole)
    fields = [states[1].read(-1, f"part_{n}", "von_mises")["von_mises"] for n in ("low", "top")]
    assert np.array_equal(
        np.concatenate(fields), states[0].read(-1, "part_plate", "von_mises")["von_mises"]
    )
    assert np.array_equal(low[-9:], top[:9])


@pytest.mark.long
def test_elastic_parts_move_as_one_wherever_blocks_end(tmp_path: Path) -> None:
    scenes = [one_part(), two_parts()]
    for scene in scenes:
        scene["materials"]["steel"] = {k: STEEL[k] for k in ("density", "young", "poisson")}
        scene["materials"]["steel"]["type"] = "elastic"
    scenes[0]["parts"]["plate"]["mesh"] = scenes[1]["meshes"]["plate"] = MESH | {"elements": [5, 8]}
    one, two = (solved(tmp_path, scene, f"e{k}") for k, scene in enumerate(scenes))
    # a block adds to its nodes corner by corner: sums have another order
    whole = motion(one, dict.fromkeys(TRACES, "plate"))
    assert motion(two, TWO) == pytest.approx(whole, rel=1e-12, abs=1e-12)


@pytest.mark.long
def test_two_threads_have_the_bits_of_one(tmp_path: Path) -> None:
    load = {"loads": {"p": {"type": "pressure", "part": "low", "pressure": 1e5}}}
    runs = [solved(tmp_path, two_parts(threads=n) | load, f"t{n}") for n in (1, 2)]
    assert np.array_equal(*(motion(run, TWO) for run in runs))


@pytest.mark.long
def test_it_goes_on_from_a_dump_to_the_same_bits(tmp_path: Path) -> None:
    scene = two_parts()
    scene["output"] |= {"restart": {"every": 1e-4}}
    solved(tmp_path, scene, "two")
    gone_on(tmp_path / "two.yaml", tmp_path / "two", tmp_path / "again")


@pytest.mark.long
def test_implicit_steps_have_the_motion_of_one_part(tmp_path: Path) -> None:
    control = {"integrator": "generalized_alpha", "step": 2.5e-5, "end_time": 1e-4}
    one, two = (solved(tmp_path, make(**control), make.__name__) for make in (one_part, two_parts))
    first, second = motion(one, dict.fromkeys(TRACES, "plate")), motion(two, TWO)
    # Newton's iterations end below 1e-9 of a displacement of 2 mm
    assert second == pytest.approx(first, rel=1e-9, abs=1e-11)


def test_a_bar_of_two_materials_in_series_has_its_closed_form(tmp_path: Path) -> None:
    """u = F / b (L_1 / E_1 t_1 + L_2 / E_2 t_2), nu = 0."""
    E, t, F, b, L = (2e11, 7e10), (0.002, 0.003), 1000.0, 0.02, (0.12, 0.08)
    mesh = {"type": "grid", "along": [sum(L), 0, 0], "across": [0, b, 0], "elements": [10, 2]}
    parts: dict[str, Any] = {}
    boxes = ([-1, -1, -1], [L[0], 1, 1]), ([L[0], -1, -1], [1, 1, 1])
    for k, (low, high) in enumerate(boxes):
        own = {"type": "shared", "mesh": "bar", "low": low, "high": high}
        parts[f"p{k}"] = {"type": "shell", "mesh": own, "thickness": t[k], "material": f"m{k}"}
        parts[f"p{k}"]["drag"] = 5e4
    held = [{"nodes": "u0", "motions": ["x", "z", "rotation_x", "rotation_y", "rotation_z"]}]
    parts["p0"]["supports"] = [*held, {"nodes": "v0", "motions": ["y", "z"]}]
    parts["p1"]["supports"] = [{"nodes": "v0", "motions": ["y", "z"]}]
    parts["p1"]["traces"] = [{"name": "end", "at": [sum(L), b, 0]}]
    materials = {
        f"m{k}": {"type": "elastic", "young": E[k], "poisson": 0.0, "density": 7850} for k in (0, 1)
    }
    load = {"type": "nodal_force", "part": "p1", "nodes": "u1", "force": [F, 0, 0]}
    # the slowest mode is nearly critically damped, and 25 of its times long gone
    scene = {
        "control": {"end_time": 1e-3, "estimate": "off"},
        "materials": materials,
        "meshes": {"bar": mesh},
        "parts": parts,
        "loads": {"pull": load},
        "output": {"history": {"interval": 5e-4}},
    }
    result = solved(tmp_path, scene, "bar")
    displacement = result.series("nodout.p1_end.displacement.x").values[-1]
    exact = F / b * sum(length / (e * d) for length, e, d in zip(L, E, t, strict=True))
    # strains of 1e-4: the logarithm differs from the linear one by half of that
    assert displacement == pytest.approx(exact, rel=3e-4)


def test_masses_are_those_of_the_parts(tmp_path: Path) -> None:
    scene = two_parts()
    scene["parts"]["top"]["thickness"] = 0.003
    path = tmp_path / "mass.yaml"
    path.write_text(yaml.safe_dump(scene), "utf-8")
    model, state = build(read_deck(path))
    exact = 7850 * 0.2 * (0.2 * 0.002 + 0.2 * 0.003)
    assert (1.0 / state.points["mass_inv"]).sum() == pytest.approx(exact, rel=1e-12)
    assert model.total_mass() == pytest.approx(exact, rel=1e-12)


def test_the_mesh_of_all_parts_is_made_coarser_at_once(tmp_path: Path) -> None:
    path = tmp_path / "coarse.yaml"
    path.write_text(yaml.safe_dump(two_parts()), "utf-8")
    assert coarser(read_deck(path), 2).overrides == {
        "meshes.plate.elements.1": "4",
        "meshes.plate.elements.2": "4",
    }


@pytest.mark.long
def test_parts_of_a_mesh_do_not_touch_at_their_seam(tmp_path: Path) -> None:
    scene = two_parts(end_time=1e-4)
    scene["surfaces"] = {
        "nodes": {"type": "nodes", "part": "low", "radius": 0.001},
        "faces": {"type": "faces", "part": "top"},
    }
    touch = {"a": ["nodes"], "b": ["faces"], "normal": {"type": "penalty"}}
    scene["contacts"] = {"touch": touch}
    result = solved(tmp_path, scene, "touch")
    assert result.series("rcforc.touch.peak_normal").values.max() == 0.0
    del scene["surfaces"]["nodes"]["radius"]
    assert "the nodes of 'low' have no thickness of their own" in refusal(
        tmp_path, yaml.safe_dump(scene)
    )


INP = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 2, 0, 0
4, 0, 1, 0
5, 1, 1, 0
6, 2, 1, 0
*ELEMENT, TYPE=S4, ELSET=LEFT
1, 1, 2, 5, 4
*ELEMENT, TYPE=S4, ELSET=RIGHT
2, 2, 3, 6, 5
"""


def test_element_sets_of_a_file_become_parts(tmp_path: Path) -> None:
    (tmp_path / "two.inp").write_text(INP)
    scene = deck({})
    scene["meshes"] = {"all": {"type": "file", "file": "two.inp"}}
    scene["parts"] = {
        name: PLATE | {"mesh": {"type": "shared", "mesh": "all", "elements": name.upper()}}
        for name in ("left", "right")
    }
    path = tmp_path / "file.yaml"
    path.write_text(yaml.safe_dump(scene), "utf-8")
    model, state = build(read_deck(path))
    assert len(state.points) == 6
    counts = np.sort(np.round(1.0 / state.points["mass_inv"] / (7850 * 0.002 * 0.25)))
    assert counts.tolist() == [1, 1, 1, 1, 2, 2]


WRONG = {
    "twice": (("top", "mesh", TOP | {"low": [-1, 0.1, -1]}), "is in part 'low' already"),
    "unknown": (("top", "mesh", TOP | {"mesh": "plat"}), "unknown mesh 'plat'; did you mean"),
    "set": (
        ("top", "mesh", {"type": "shared", "mesh": "plate", "elements": "x"}),
        "mesh 'plate' has no element set 'x'",
    ),
    "empty": (("top", "mesh", TOP | {"low": [5, 5, 5], "high": [6, 6, 6]}), "has no element of"),
    "half": (("top", "mesh", {**TOP, "high": None}), "low and high belong together"),
    "drag": (("top", "drag", 3.0), "nodes of 'low' have another drag"),
    "speed": (("top", "velocity", [1, 0, 0]), "begins with another velocity in 'low'"),
    "named": (("top", "nodes", [{"name": "n", "at": [0.1, 0.2, 0]}]), "in 'low'; state it in one"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_is_refused(tmp_path: Path, name: str) -> None:
    (part, field, value), message = WRONG[name]
    scene = two_parts()
    if name == "named":
        scene["parts"]["low"]["nodes"] = [{"name": "m", "at": [0.1, 0.2, 0]}]
    scene["parts"][part][field] = value
    said = refusal(tmp_path, yaml.safe_dump(scene, sort_keys=False))
    assert message in said and f"part '{part}'" in said


def test_elements_in_no_part_are_reported(tmp_path: Path) -> None:
    scene = two_parts()
    scene["parts"]["top"]["mesh"] = TOP | {"low": [-1, 0.25, -1]}
    path = tmp_path / "some.yaml"
    path.write_text(yaml.safe_dump(scene), "utf-8")
    model, _ = build(read_deck(path))
    assert any(
        "8 elements are in no part and left out (33, 34, 35, ...)" in w for w in model.warnings
    )


def test_a_mesh_in_a_mesh_and_one_without_parts(tmp_path: Path) -> None:
    scene = two_parts()
    scene["meshes"]["other"] = {"type": "shared", "mesh": "plate"}
    assert "has no nodes of its own" in refusal(tmp_path, yaml.safe_dump(scene))
    scene["meshes"]["other"] = MESH
    path = tmp_path / "spare.yaml"
    path.write_text(yaml.safe_dump(scene), "utf-8")
    model, _ = build(read_deck(path))
    assert "mesh 'other' is named by no part and left out" in model.warnings
