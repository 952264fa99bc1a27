"""Meshes: area, orientation, sets, files; what is wrong with one is said, with its position."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build

DECK: dict[str, Any] = {
    "control": {"end_time": 1},
    "materials": {"m": {"type": "elastic", "young": 1e5, "poisson": 0.3, "density": 1.0}},
}
GRID = {"type": "grid", "along": [2, 0, 0], "across": [0, 1, 0], "elements": [4, 3]}
TUBE = {"type": "tube", "width": 0.6, "height": 0.4, "length": 2, "elements": [3, 2, 8]}
MESHES = {
    "grid": (GRID, 2.0, 20),
    # chords of a circle
    "cylinder": (
        {"type": "cylinder", "radius": 1, "length": 2, "elements": [8, 3]},
        2 * 8 * 2 * np.sin(np.pi / 8),
        32,
    ),
    "tube": (TUBE, 4.0, 90),
    "box": ({"type": "box", "size": [1, 2, 3], "elements": [2, 2, 3]}, 22.0, 34),
    "sphere": (
        {"type": "sphere", "radius": 1, "elements": 1},
        # a square has a top, the middles of two edges, and the middle of an eighth
        8
        * 1.5
        * np.linalg.norm(np.cross([3**-0.5 - 1, 3**-0.5, 3**-0.5], [0, -(2**-0.5), 2**-0.5])),
        26,
    ),
    # a Z of three sides
    "folded": (
        {"type": "folded", "line": [[0, 0, 0], [1, 0, 0], [1, 2, 0], [2, 2, 0]]}
        | {"along": [0, 0, 3], "elements": [1, 2, 1, 3]},
        12.0,
        20,
    ),
    "listed": (
        {
            "type": "listed",
            "nodes": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
            "quads": [[1, 2, 3, 4]],
        },
        1.0,
        4,
    ),
}
INP = """*HEADING
two squares
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 2, 0, 0
4, 0, 1, 0
5, 1, 1, 0
6, 2, 1, 0
*ELEMENT, TYPE=S4, ELSET=PLATE
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*NSET, NSET=LEFT
1, 4
"""


def meshed(folder: Path, mesh: Mapping[str, object], **words: object) -> Any:
    part = {"type": "shell", "mesh": mesh, "thickness": 0.01, "material": "m"} | words
    path = folder / "mesh.yaml"
    path.write_text(yaml.safe_dump(DECK | {"parts": {"s": part}}), "utf-8")
    model, _ = build(read_deck(path))
    assert model.elements is not None
    return model.elements.parts["s"]


def refusal(folder: Path, mesh: Mapping[str, object], **words: object) -> str:
    with pytest.raises(DeckErrors) as caught:
        meshed(folder, mesh, **words)
    return str(caught.value)


@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_has_the_area_and_the_nodes_of_its_shape(tmp_path: Path, name: str) -> None:
    mesh, area, nodes = MESHES[name]
    part = meshed(tmp_path, mesh)
    assert part.area.sum() == pytest.approx(area, rel=1e-12)
    assert len(part.mesh.points) == nodes
    assert part.mass.sum() == pytest.approx(0.01 * area, rel=1e-12)


@pytest.mark.parametrize("name", ["cylinder", "tube", "box", "sphere"])
def test_normals_of_a_hollow_mesh_point_outwards(tmp_path: Path, name: str) -> None:
    part = meshed(tmp_path, MESHES[name][0])
    x = part.mesh.points[part.mesh.quads]
    middle = part.mesh.points.mean(axis=0)
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    assert ((x.mean(axis=1) - middle) * normal).sum(axis=1).min() > 0.0


@pytest.mark.parametrize("half, sides", [("eighth", "xyz"), ("half", "z"), ("whole", "")])
def test_a_part_of_a_sphere_ends_on_its_planes(tmp_path: Path, half: str, sides: str) -> None:
    mesh = {"type": "sphere", "radius": 2, "centre": [1, 0, 0], "elements": 4, "part": half}
    part = meshed(tmp_path, mesh)
    x = part.mesh.points - [1, 0, 0]
    np.testing.assert_allclose(np.linalg.norm(x, axis=1), 2.0, rtol=1e-12)
    assert set(part.mesh.sets) == {f"{axis}0" for axis in sides}
    for axis in sides:
        own = part.mesh.sets[f"{axis}0"]
        assert len(own) == (9 if half == "eighth" else 32)
        assert np.abs(x[own, "xyz".index(axis)]).max() == 0.0


def test_a_blow_gives_the_elements_of_a_box_their_momentum(tmp_path: Path) -> None:
    box = {"low": [0.5, 0, -1], "high": [2, 3, 1], "speed": 3}
    part = meshed(tmp_path, GRID, impulses=[box])
    middle = part.mesh.points[part.mesh.quads].mean(axis=1)
    hit = (middle[:, 0] > 0.5) & (middle[:, 0] < 2)
    total = (part.mass[:, None] * part.velocities()).sum(axis=0)
    np.testing.assert_allclose(total, [0, 0, 3 * part.weight[hit].sum()], atol=1e-15)
    assert "no element has its middle in the box" in refusal(
        tmp_path, GRID, impulses=[box | {"low": [0.5, 0, 0.5]}]
    )


def test_a_folded_plate_needs_a_number_for_each_piece(tmp_path: Path) -> None:
    mesh = {"type": "folded", "line": [[0, 0, 0], [1, 0, 0]], "along": [0, 0, 1], "elements": [2]}
    assert "a line of 2 corners has 1 pieces" in refusal(tmp_path, mesh)


def test_a_dent_pushes_two_sides_in_and_two_out(tmp_path: Path) -> None:
    dent = {"depth": 0.01, "from": 0.5, "to": 1.5}
    plain = meshed(tmp_path, TUBE | {"elements": [2, 2, 8]}).mesh.points
    direction = meshed(tmp_path, TUBE | {"elements": [2, 2, 8], "dent": dent}).mesh.points - plain
    middle = np.isclose(plain[:, 2], 1.0)
    across, up = middle & (abs(plain[:, 0]) < 1e-9), middle & (abs(plain[:, 1]) < 1e-9)
    np.testing.assert_allclose(direction[across][:, 1] * np.sign(plain[across][:, 1]), 0.01)
    np.testing.assert_allclose(direction[up][:, 0] * np.sign(plain[up][:, 0]), -0.01)
    assert np.count_nonzero(np.abs(direction).max(axis=1) > 1e-9) == 4 * 3


def test_a_file_gives_its_elements_and_its_sets(tmp_path: Path) -> None:
    (tmp_path / "plate.inp").write_text(INP, "utf-8")
    part = meshed(tmp_path, {"type": "file", "file": "plate.inp", "unit": 0.001})
    assert part.area.sum() == pytest.approx(2e-6, rel=1e-12)
    assert sorted(part.mesh.sets["LEFT"]) == [0, 3]


def test_what_meshio_passes_over_is_refused_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "plate.inp").write_text(INP + "*NCOPY, OLD SET=A, CHANGE NUMBER=9\n", "utf-8")
    reported = refusal(tmp_path, {"type": "file", "file": "plate.inp"})
    ignored = "*NCOPY would be ignored; write the mesh flat, with nodes and elements"
    assert f"plate.inp, line 15: {ignored}" in reported


def test_nodes_in_round_coordinates_are_refused(tmp_path: Path) -> None:
    text = INP.replace("*NODE", "*Node, nset=all, system=C")
    (tmp_path / "plate.inp").write_text(text, "utf-8")
    reported = refusal(tmp_path, {"type": "file", "file": "plate.inp"})
    assert "plate.inp, line 3: *NODE, NSET=ALL, SYSTEM=C would be ignored" in reported


@pytest.mark.parametrize("kind", ["quad", "triangle"])
@pytest.mark.parametrize("suffix", ["inp", "bdf", "vtu", "stl"])
def test_a_mesh_written_and_read_is_the_same(kind: str, suffix: str, tmp_path: Path) -> None:
    import meshio

    if suffix == "stl" and kind == "quad":
        pytest.skip("STL has triangles only")
    cells = [[0, 1, 4, 3], [1, 2, 5, 4]]
    if kind == "triangle":
        cells = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0.25], [2, 1, 0]])
    mesh = meshio.Mesh(points, [(kind, np.array(cells))])
    # meshio sees whether an STL file is text by a sum that overflows
    meshio.write(
        tmp_path / f"plate.{suffix}", mesh, **({"binary": True} if suffix == "stl" else {})
    )
    part = meshed(tmp_path, {"type": "file", "file": f"plate.{suffix}"})
    # a file may number its nodes anew
    wanted = sorted(sorted(map(tuple, points[cell])) for cell in cells)
    corners = [dict.fromkeys(q) for q in part.mesh.quads]
    corners_read = sorted(sorted(map(tuple, part.mesh.points[list(q)])) for q in corners)
    np.testing.assert_allclose(corners_read, wanted, atol=1e-12)


BDF = """BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,3.,0.,0.
GRID,4,,0.,1.,0.
GRID,5,,1.,1.,0.
GRID,6,,3.,1.,0.
CQUAD4,1,7,1,2,5,4
CQUAD4,2,9,2,3,6,5
ENDDATA
"""


def test_elements_of_a_property_are_a_set(tmp_path: Path) -> None:
    (tmp_path / "plate.bdf").write_text(BDF, "utf-8")
    for number, area in (("7", 1.0), ("9", 2.0), ("", 3.0)):
        part = meshed(tmp_path, {"type": "file", "file": "plate.bdf", "elements": number})
        assert part.area.sum() == pytest.approx(area, rel=1e-12)
    reported = refusal(tmp_path, {"type": "file", "file": "plate.bdf", "elements": "8"})
    assert "no element set '8' (sets: 7, 9)" in reported


def test_triangles_of_a_file_come_after_its_quadrilaterals(tmp_path: Path) -> None:
    first = "*ELEMENT, TYPE=S3, ELSET=CORNER\n3, 1, 2, 5\n4, 1, 5, 4\n"
    text = INP.replace("*ELEMENT", first + "*ELEMENT", 1).replace("1, 1, 2, 5, 4\n", "")
    (tmp_path / "plate.inp").write_text(text, "utf-8")
    part = meshed(tmp_path, {"type": "file", "file": "plate.inp", "unit": 0.001})
    assert part.quad_count == 1
    np.testing.assert_allclose(part.area, [1e-6, 0.5e-6, 0.5e-6], rtol=1e-12)
    # a third of each triangle, a quarter of each quadrilateral
    assert part.mass.sum() == pytest.approx((part.weight).sum(), rel=1e-12)
    assert part.mass.max() == pytest.approx(part.weight[0] * (0.25 + 1 / 3), rel=1e-12)


def test_files_of_other_elements_or_none_are_refused(tmp_path: Path) -> None:
    text = (
        INP.replace("TYPE=S4", "TYPE=T3D2").replace("2, 5, 4\n", "2\n").replace("3, 6, 5\n", "3\n")
    )
    (tmp_path / "plate.inp").write_text(text, "utf-8")
    reported = refusal(tmp_path, {"type": "file", "file": "plate.inp"})
    assert "2 elements are of type line; shells are of type quad or triangle" in reported
    (tmp_path / "plate.inp").write_text(INP, "utf-8")
    reported = refusal(tmp_path, {"type": "file", "file": "plate.inp", "elements": "ROOF"})
    assert "no element set 'ROOF' (sets: PLATE)" in reported
    reported = refusal(tmp_path, {"type": "file", "file": "mesh.yaml"})
    assert "meshio" in reported


def listed(nodes: list[list[float]], quads: list[list[int]]) -> dict[str, Any]:
    return {"type": "listed", "nodes": nodes, "quads": quads}


SIX: list[list[float]] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
WRONG = {
    "duplicate": (
        listed([*SIX, [1, 0, 0], [1, 1, 0]], [[1, 2, 5, 4], [7, 3, 6, 8]]),
        "nodes 2 and 7 are both at (1, 0, 0) m; merge them",
    ),
    "inverted": (
        listed(SIX, [[1, 2, 5, 4], [2, 5, 6, 3]]),
        "elements 1 and 2 have opposite normals",
    ),
    "junction": (
        listed([*SIX, [1, 0, 1], [1, 1, 1]], [[1, 2, 5, 4], [2, 3, 6, 5], [5, 8, 7, 2]]),
        "elements 1, 2 and 3 share the side of nodes 2 and 5, a T-junction: a side of a shell",
    ),
    "unconnected": (
        listed([*SIX, [5, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0]], [[1, 2, 5, 4], [7, 8, 9, 10]]),
        "node 3 belongs to no element",
    ),
    "disjoint": (
        listed(
            [SIX[0], SIX[1], SIX[4], SIX[3], [5, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0]],
            [[1, 2, 3, 4], [5, 6, 7, 8]],
        ),
        "is disjoint, in 2 parts: no elements connect node 1 with node 5; make two parts of it",
    ),
    "crossed": (
        listed([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[1, 2, 3, 4]]),
        "element 1 is degenerate or folded over at its corner",
    ),
    "flat": (
        listed([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], [[1, 2, 3, 4]]),
        "element 1 is degenerate",
    ),
    "no such node": (listed(SIX, [[1, 2, 5, 9]]), "there is no node 9; 6 are listed"),
    "parallel": (GRID | {"across": [1, 0, 0]}, "needs two sides that are not parallel"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_mesh_that_cannot_serve_is_refused(tmp_path: Path, name: str) -> None:
    mesh, message = WRONG[name]
    assert message in refusal(tmp_path, mesh)


def test_a_set_that_does_not_exist_is_named_with_those_that_do(tmp_path: Path) -> None:
    reported = refusal(tmp_path, GRID, supports=[{"nodes": "left"}])
    assert "mesh.yaml" in reported
    assert "supports.nodes: the mesh has no set of nodes 'left' (sets: u0, u1, v0, v1)" in reported


def test_other_methods_than_rattle_are_refused(tmp_path: Path) -> None:
    DECK["control"]["integrator"] = "dormand_prince_5"
    try:
        assert "set integrator: rattle" in refusal(tmp_path, GRID)
    finally:
        del DECK["control"]["integrator"]
