"""Claim: sets and elements of mesh files are what the file says, or the file is refused by line."""

import random
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_meshes import meshed, refusal

from crashsolve.foundation.mesh_files.reading import MeshFileError, read_mesh_file

NODES = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 3, 0, 0
4, 6, 0
5, 0, 1, 0
6, 1, 1, 0
7, 3, 1, 0
8, 6, 1, 0
"""
# areas 1, 2 and 3: a wrong element has a wrong area
FIRST, SECOND, THIRD = "11, 1, 2, 6, 5\n", "12, 2, 3, 7, 6\n", "13, 3, 4, 8, 7\n"
S4R = "*ELEMENT, TYPE=S4R\n"
INP = NODES + S4R + FIRST + "*ELEMENT, TYPE=S4R, ELSET=MIDDLE\n" + SECOND + S4R + THIRD
BDF = """SOL 101
CEND
SET 4 = 1 THRU 6 EXCEPT 2,
 3
SET 5 = 13, 12
SET 6 = 0.5
BEGIN BULK
GRID    1               0.      0.      0.
GRID*   2                               1.              0.
*       0.
GRID,3,,3.,0.,0.
grid,4,,60.-1,0.,0.
GRID,5,0,0.,1.,0.
GRID,6,,1.,1.
GRID,7,,3.,1.,0.,
GRID,8,,6.,1.,0.
PSHELL,1,1,.01
CORD2R,9,,0.,0.,0.,0.,0.,1.
+,1.,0.,0.
CQUAD4  11      7       1       2       6       5       30.
CQUAD4,12,9,2,3,7,6,,+A
+A,,0
CQUAD4,13,,3,4,8,7,9,0.
SET1,8,11,THRU,12
"""
MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "left"
2 2 "plate"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 3 0 0
4 6 0 0
5 0 1 0
6 1 1 0
7 3 1 0
8 6 1 0
$EndNodes
$Elements
4
1 1 2 1 1 1 5
2 3 2 2 1 1 2 6 5
3 2 2 7 1 2 3 7
4 2 2 7 1 2 7 6
$EndElements
"""


def areas(folder: Path, text: str, elements: Any = "", name: str = "plate.inp") -> Any:
    (folder / name).write_text(text, "utf-8")
    mesh = {"type": "file", "file": name} | ({"elements": elements} if elements else {})
    return meshed(folder, mesh)


@pytest.mark.parametrize(
    ("cards", "area"),
    [
        ("", 2),
        ("*ELSET, ELSET=Middle\n13\n", 5),
        ("*elset, elset=SOME\n13, 12\n", 5),
        ("*ELSET, ELSET=SOME, GENERATE\n12, 13, 1\n", 5),
        ("*ELSET, ELSET=SOME, GENERATE\n11, 12\n", 3),
        ("*ELSET, ELSET=LAST\n13\n*ELSET, ELSET=SOME\nmiddle, LAST, 11\n", 6),
        ("*ELSET,\n ELSET=SOME\n** a remark\n11,\n\n12\n", 3),
    ],
)
def test_a_set_has_its_elements_whatever_their_blocks(
    tmp_path: Path, cards: str, area: float
) -> None:
    name = "SOME" if "SOME" in cards else "MIDDLE"
    assert areas(tmp_path, INP + cards, name).area.sum() == pytest.approx(area, rel=1e-12)
    assert areas(tmp_path, INP + cards).area.sum() == pytest.approx(6, rel=1e-12)


def test_triangles_and_quadrilaterals_in_one_set_have_the_mass_of_both(tmp_path: Path) -> None:
    third = "*element, type=s3r, elset=ALL\n13, 3, 4, 8\n14, 3, 8, 7\n"
    text = NODES + "*ELEMENT, TYPE=S4R, ELSET=ALL\n" + FIRST + SECOND + third
    part = areas(tmp_path, text, "ALL")
    assert (part.quad_count, len(part.area)) == (2, 4)
    # density 1, thickness 0.01
    assert part.mass.sum() == pytest.approx(0.06, rel=1e-12)
    one = areas(tmp_path, text + "*ELSET, ELSET=ONE\n14, 12\n", "ONE")
    np.testing.assert_allclose(sorted(one.area), [1.5, 2.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("cards", "nodes"),
    [
        ("*NSET, NSET=A\n1, 5\n*NSET, NSET=A\n2\n", [1, 2, 5]),
        ("*NSET, NSET=A, GENERATE\n1, 5, 2\n6, 7\n", [1, 3, 5, 6, 7]),
        ("*NSET, NSET=A, ELSET=MIDDLE\n", [2, 3, 6, 7]),
        ("*NSET, NSET=B\n8\n*NSET, NSET=a\nb, 1\n*NSET, NSET=A\n2\n", [1, 2, 8]),
    ],
)
def test_a_set_of_nodes_unites_what_its_cards_name(
    tmp_path: Path, cards: str, nodes: list[int]
) -> None:
    part = areas(tmp_path, INP + cards)
    own = part.mesh.sets.get("A", part.mesh.sets.get("a"))
    assert sorted(own + 1) == nodes


def test_nodes_may_be_put_in_a_set_where_they_are_given(tmp_path: Path) -> None:
    text = INP.replace("*NODE\n", "*NODE, NSET=ALL\n")
    assert len(areas(tmp_path, text, "MIDDLE").mesh.sets["ALL"]) == 4


GENERATED = """
*Heading
*Part, name=Plate
*NODE
1, 0, 0
5, 4, 0
11, 0, 2
15, 4, 2
21, 0, 4
25, 4, 4
*NGEN, NSET=LOWER
1, 5
*NGEN
11, 15, 1
21, 25
*ELEMENT, TYPE=S4R
1, 1, 2, 12, 11
*ELGEN, ELSET=ALL
1, 4, 1, 1, 2, 10, 10
*End Part
*Assembly, name=A
*Instance, name=Plate-1, part=Plate
*End Instance
*NSET, NSET=CORNER, INSTANCE=Plate-1
25
*End Assembly
"""


def test_nodes_and_elements_are_generated_in_a_part_that_is_one_instance(tmp_path: Path) -> None:
    part = areas(tmp_path, GENERATED, "ALL")
    # eight rectangles of 1 by 2
    np.testing.assert_allclose(part.area, 2.0, rtol=1e-12)
    assert len(part.area) == 8
    assert len(part.mesh.sets["LOWER"]) == 5
    (corner,) = part.mesh.sets["CORNER"]
    np.testing.assert_allclose(part.mesh.points[corner], [4.0, 4.0, 0.0])


def test_an_instance_is_translated_and_then_rotated(tmp_path: Path) -> None:
    moved = "part=Plate\n1, 0, 0\n1, 0, 0, 1, 0, 2, 90\n"
    text = GENERATED.replace("part=Plate\n", moved)
    part = areas(tmp_path, text, "ALL")
    (corner,) = part.mesh.sets["CORNER"]
    # (4, 4) to (5, 4), which lies 4 and 4 from the axis at x = 1
    np.testing.assert_allclose(part.mesh.points[corner], [-3.0, 4.0, 0.0], atol=1e-15)


WRONG = {
    "node of a set": ("*NSET, NSET=A\n1, 99\n", "line 17: node 99 of the set is not given before"),
    "element of a set": ("*ELSET, ELSET=A\n99\n", "line 17: element 99 of the set is not given"),
    "set of a set": ("*NSET, NSET=A\nB\n", "line 17: there is no *NSET 'B' before this line"),
    "set of elements": ("*NSET, NSET=A, ELSET=B\n", "line 16: there is no *ELSET 'B'"),
    "steps": ("*NSET, NSET=A, GENERATE\n1, 4, 2\n", "line 17: no number of steps of 2 leads"),
    "node twice": ("*NODE\n8, 9, 9, 9\n", "line 17: node 8 is given twice"),
    "element twice": (S4R + THIRD, "line 17: element 13 is given twice"),
    "corner": (S4R + "14, 1, 2, 3, 99\n", "line 17: element 14 names node 99"),
    "corners": (S4R + "14, 1, 2, 3\n", "line 17: element 14 is of type S4R, but 3 nodes follow"),
    "part": ("*Part, name=P\n*End Part\n*Part, name=Q\n", "line 18: a second *PART numbers its"),
    "instance of nothing": ("*Instance, name=P-1, part=P\n", "line 16: there is no *PART 'P'"),
    "half a move": (
        "*Part, name=P\n*Instance, name=P-1, part=P\n0, 0, 1\n0, 0, 0\n",
        "line 17: *INSTANCE needs a translation, and then two points",
    ),
    "no axis": (
        "*Part, name=P\n*Instance, name=P-1, part=P\n0, 0, 1\n1, 1, 1, 1, 1, 1, 90\n",
        "line 19: the two points of the axis are one",
    ),
    "too many nodes": (
        "*NODE\n900000001, 9, 9, 9\n*NGEN\n1, 900000001\n",
        "line 19: *NGEN makes more than 10000000 numbers",
    ),
    "too many layers": ("*ELGEN\n11, 1, 1, 1, 1, 1, 1, 1000000000, 1, 100\n", "names node"),
    "nodes between": ("*NGEN\n1, 99, 1\n", "line 17: node 99 is not given before this line"),
    "steps between": ("*NGEN\n1, 4, 2\n", "line 17: no number of steps of 2 leads"),
    "arc of nodes": ("*NGEN, LINE=C\n1, 4\n", "line 16: *NGEN, LINE=C would be ignored"),
    "copies of none": ("*ELGEN\n99, 2\n", "line 17: element 99 is not given before this line"),
    "no copies": ("*ELGEN\n11, 0\n", "line 17: *ELGEN needs an element"),
    "copies without nodes": ("*ELGEN\n11, 9, 1, 100\n", "names node"),
    "section offset": (
        "*SHELL SECTION, ELSET=A, MATERIAL=M, OFFSET=SPOS\n1.5\n",
        "line 16: *SHELL SECTION, OFFSET=SPOS would be ignored: nodes lie in the middle",
    ),
    "include": ("*INCLUDE, INPUT=x.inp\n", "line 16: *INCLUDE would be ignored"),
    "instance": (
        "*NSET, NSET=A, INSTANCE=P-1\n1\n",
        "line 16: there is no *INSTANCE 'P-1' before this line",
    ),
    "offset of elements": (
        "*ELEMENT, TYPE=S4, OFFSET=9\n",
        "line 16: *ELEMENT, TYPE=S4, OFFSET=9 would be ignored",
    ),
    "number": ("*NODE\n9, x, 0, 0\n", "line 17: 'x' is not a number"),
    "not finite": ("*NODE\n9, nan, 0, 0\n", "line 17: 'nan' is not a number"),
    "unfinished": ("*NSET,\n", "line 16: the keyword is not complete: it ends in a comma"),
    "second order": (
        "*ELEMENT, TYPE=S8R\n14, 1, 2, 3, 4, 5, 6, 7, 8\n",
        "1 elements are of type quad8",
    ),
    "unknown to meshio": (
        "*ELEMENT, TYPE=MASS\n14, 1\n",
        "1 elements are of type MASS; shells are",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_an_inp_file_gets_wrong_is_refused_by_line(tmp_path: Path, case: str) -> None:
    cards, message = WRONG[case]
    (tmp_path / "plate.inp").write_text(INP + cards, "utf-8")
    assert message in refusal(tmp_path, {"type": "file", "file": "plate.inp"})


def test_elements_of_other_kinds_do_not_hinder_a_set_without_them(tmp_path: Path) -> None:
    text = INP + "*ELEMENT, TYPE=MASS, ELSET=LUMP\n14, 1\n*ELSET, ELSET=BOTH\nLUMP, MIDDLE\n"
    assert areas(tmp_path, text, "MIDDLE").area.sum() == pytest.approx(2, rel=1e-12)
    mesh = {"type": "file", "file": "plate.inp", "elements": "BOTH"}
    assert "1 elements are of type MASS" in refusal(tmp_path, mesh)
    assert "(plate.inp, line 17)" in refusal(tmp_path, mesh)


@pytest.mark.parametrize("field", ["supports", "welded", "velocities"])
def test_an_empty_set_is_refused_where_it_is_used(tmp_path: Path, field: str) -> None:
    (tmp_path / "plate.inp").write_text(INP + "*NSET, NSET=NONE\n*NSET, NSET=LEFT\n1, 5\n", "utf-8")
    mesh = {"type": "file", "file": "plate.inp", "elements": "MIDDLE"}
    meshed(tmp_path, mesh)
    for name in ("NONE", "LEFT"):
        words = {"nodes": name} | ({"part": "s"} if field == "welded" else {})
        reported = refusal(tmp_path, mesh, **{field: [words]})
        assert f"{field}.nodes: set '{name}' has no node of these elements" in reported


def test_what_is_passed_over_is_reported(tmp_path: Path) -> None:
    (tmp_path / "plate.inp").write_text(INP + "*MATERIAL, NAME=A\n*TIE\n", "utf-8")
    assert read_mesh_file(tmp_path / "plate.inp").passed_over == [
        "*MATERIAL (line 16)",
        "*TIE (line 17)",
    ]  # fmt: skip


def test_nastran_cards_in_all_forms_give_properties_and_sets(tmp_path: Path) -> None:
    for elements, area in (("", 6), (7, 1), ("9", 2), (13, 3), ("SET 5", 5), ("SET 8", 3)):
        part = areas(tmp_path, BDF, elements, "plate.bdf")
        assert part.area.sum() == pytest.approx(area, rel=1e-12)
    sets = areas(tmp_path, BDF, name="plate.bdf").mesh.sets
    # SET 5 are elements, SET 6 are frequencies
    assert {name: sorted(own + 1) for name, own in sets.items()} == {"SET 4": [1, 4, 5, 6]}


WRONG_BDF = {
    "offset": (
        "CQUAD4,13,,3,4,8,7,9,0.",
        "CQUAD4,13,,3,4,8,7,9,.1",
        "line 23: CQUAD4 13 has ZOFFS .1",
    ),
    "thickness": (
        "+A,,0",
        "+A,,0,.1,.1,.1,.1",
        "line 21: CQUAD4 12 has a thickness at its corners",
    ),
    "system": ("GRID,5,0,", "GRID,5,9,", "line 13: GRID 5 is given in coordinate system 9"),
    "continuation": ("+A,,0", "+B,,0", "line 22: '+B' continues no line before it"),
    "include": ("SET1,8", "INCLUDE 'x'\nSET1,8", "line 24: INCLUDE would be ignored"),
    "grid twice": ("GRID,8", "GRID,7", "line 16: node 7 is given twice"),
    "no such grid": ("3,4,8,7,9", "3,4,8,99,9", "line 23: element 13 names node 99"),
    "second order": (
        "SET1,8",
        "CTRIA6,14,1,1,2,3,4,5,6\nSET1,8",
        "1 elements are of type triangle6",
    ),
    "panel": ("SET1,8", "CSHEAR,14,1,1,2,6,5\nSET1,8", "1 elements are of type CSHEAR"),
}


@pytest.mark.parametrize("case", WRONG_BDF)
def test_what_a_bdf_file_gets_wrong_is_refused_by_line(tmp_path: Path, case: str) -> None:
    old, new, message = WRONG_BDF[case]
    assert old in BDF
    (tmp_path / "plate.bdf").write_text(BDF.replace(old, new, 1), "utf-8")
    assert message in refusal(tmp_path, {"type": "file", "file": "plate.bdf"})


@pytest.mark.parametrize("wrong", [-1, 9])
@pytest.mark.parametrize("suffix", ["vtu", "vtk"])
def test_an_element_of_points_that_are_not_there_is_refused(
    tmp_path: Path, wrong: int, suffix: str
) -> None:
    import meshio

    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    mesh = meshio.Mesh(points, [("quad", np.array([[0, 1, 2, 3]]))])
    mesh.cells[0].data[0, 3] = wrong
    meshio.write(tmp_path / f"plate.{suffix}", mesh)
    reported = refusal(tmp_path, {"type": "file", "file": f"plate.{suffix}"})
    assert f"element 0 names point {wrong}; there are points 0 to 3" in reported


def test_groups_of_gmsh_have_names_or_numbers_and_outlines_are_sets_of_nodes(
    tmp_path: Path,
) -> None:
    for elements, area in (("", 3), ("plate", 1), (7, 2), (2, 1)):
        part = areas(tmp_path, MSH, elements, "plate.msh")
        assert part.area.sum() == pytest.approx(area, rel=1e-12)
    assert sorted(areas(tmp_path, MSH, name="plate.msh").mesh.sets["left"] + 1) == [1, 4]
    mesh = {"type": "file", "file": "plate.msh", "elements": "left"}
    assert "no element set 'left' (sets: 2, 7, plate)" in refusal(tmp_path, mesh)
    # numbers count in each dimension for themselves
    both = MSH.replace("1 1 2 1 1 1 5", "1 1 2 7 1 1 5")
    mesh["elements"] = "7"
    (tmp_path / "plate.msh").write_text(both, "utf-8")
    assert "no element set '7'" in refusal(tmp_path, mesh)


def test_of_several_groups_of_an_area_meshio_states_one_so_numbers_are_no_names(
    tmp_path: Path,
) -> None:
    entities = (
        "$Entities\n0 0 1 0\n1 0 0 0 6 1 0 {groups} 0\n$EndEntities\n"
        "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
        "$Elements\n1 1 1 1\n2 1 3 1\n1 1 2 3 4\n$EndElements\n"
    )
    head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    one = head + entities.format(groups="1 7")
    assert areas(tmp_path, one, 7, "plate.msh").area.sum() == pytest.approx(1)
    two = head + entities.format(groups="2 7 8")
    (tmp_path / "plate.msh").write_text(two, "utf-8")
    mesh = {"type": "file", "file": "plate.msh", "elements": 7}
    assert "no element set '7' (sets: none)" in refusal(tmp_path, mesh)


def test_files_without_nodes_are_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.inp").write_text("*HEADING\nnothing\n", "utf-8")
    with pytest.raises(MeshFileError, match="holds no nodes"):
        read_mesh_file(tmp_path / "empty.inp")


def test_sets_of_a_listed_mesh_may_have_numbers(tmp_path: Path) -> None:
    square = {
        "type": "listed",
        "nodes": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
        "quads": [[1, 2, 3, 4]],
        "sets": [{"name": 3, "nodes": [1, 2]}],
    }
    part = meshed(tmp_path, square, supports=[{"nodes": 3, "motions": ["x"]}])
    assert list(part.fixed) == [1, 1, 0, 0]


def test_no_mutated_file_ends_in_anything_but_a_mesh_or_a_refusal(tmp_path: Path) -> None:
    rng = random.Random(7)
    files = {"m.inp": INP + "*NSET, NSET=A, ELSET=MIDDLE\n", "m.bdf": BDF, "m.msh": MSH}
    bits = [
        "-1",
        "²",
        "nan",
        "1e400",
        "9" * 30,
        "*",
        "+",
        ",",
        "THRU",
        "=",
        "\n",
        "1.5",
        "$",
        '"',
        "",
    ]
    for _ in range(150):
        name = rng.choice(list(files))
        text = files[name]
        for _ in range(rng.randint(1, 3)):
            i = rng.randrange(len(text))
            text = text[:i] + rng.choice(bits) + text[i + rng.randrange(3) :]
        (tmp_path / name).write_text(text, "utf-8")
        with suppress(MeshFileError):
            mesh_file = read_mesh_file(tmp_path / name)
            assert mesh_file.corners.max(initial=-1) < len(mesh_file.points)
            for own in mesh_file.element_sets.values():
                assert own.max(initial=-1) < len(mesh_file.corners)
