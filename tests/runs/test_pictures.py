"""Claim: what is drawn is what was computed: bodies in place, every shape, every force."""

import json
import shutil
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, datasets

from crashpost.results.result import Result
from crashsolve.model.nodes import NODE
from crashsolve.simulation import skins

HERE = Path(__file__).parent
pytestmark = pytest.mark.xdist_group("runs")


def state_at(folder: Path, time: float) -> dict[str, np.ndarray]:
    """Fields of the state at a time, by block and name."""
    for path in sorted((folder / "states").glob("*.h5")):
        with h5py.File(path) as file:
            if abs(file.attrs["time"] - time) < 1e-9:
                return datasets(path)
    raise AssertionError(f"no state at {time} s")


def channel(folder: Path, name: str, time: float) -> float:
    times, values, _ = Result(folder).series(name)
    return float(values[np.argmin(np.abs(times - time))])


@pytest.mark.long
@pytest.mark.parametrize("time", [0.05, 0.25, 0.5])
def test_bodies_and_forces_are_drawn_as_the_histories_say(
    time: float, mechanism: Path, uninterrupted: dict[Path, Path]
) -> None:
    folder = uninterrupted[mechanism]
    mesh, state = datasets(folder / "mesh.h5"), state_at(folder, time)
    centres = mesh["mass_centres/points"] + state["mass_centres/displacement"]
    for k, body in enumerate(("hammer", "bob")):
        position = [channel(folder, f"rbdout.{body}.position.{axis}", time) for axis in "xyz"]
        np.testing.assert_allclose(centres[k], position, atol=1e-6)
    force = state["contacts/force"].sum(axis=0)
    requested = [channel(folder, f"rcforc.blow.force.{axis}", time) for axis in "xyz"]
    np.testing.assert_allclose(force, requested, rtol=1e-6, atol=1e-3)
    assert (np.linalg.norm(force) > 1.0) == (time == 0.25)
    tension = channel(folder, "deforc.stay.force", time)
    np.testing.assert_allclose(state["springs/tension"], [tension], rtol=1e-6, atol=1e-6)


def test_pairs_that_come_and_go_are_drawn_in_a_block_of_one_size(
    uninterrupted: dict[Path, Path],
) -> None:
    folder = uninterrupted[HERE / "heap.yaml"]
    forces = [datasets(path)["contacts/force"] for path in (folder / "states").glob("*.h5")]
    assert len({force.shape for force in forces}) == 1
    touching = (np.linalg.norm(state_at(folder, 0.4)["contacts/force"], axis=1) > 0).sum()
    assert touching == sum(
        channel(folder, f"rcforc.{card}.touching", 0.4) for card in ("balls", "ground")
    )
    assert touching > 5


def test_forces_on_nodes_of_shells_are_drawn_where_they_act(tmp_path: Path) -> None:
    """Nodes on faces, a ball on faces, nodes on a shape, all with friction."""
    deck = HERE.parents[1] / "decks" / "verification" / "contact" / "faces_friction.yaml"
    short = ("control.end_time=2.5e-3", "control.estimate=off", "output.states.interval=2.5e-3")
    words = [word for setting in short for word in ("--set", setting)]
    done = crashsolve(deck, "-o", tmp_path / "out", *words, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "out"
    mesh, state = datasets(folder / "mesh.h5"), state_at(folder, 2.5e-3)
    for card, name in enumerate(("thrown", "ball", "rests")):
        own = (state["contacts/contact"] == card) & (state["contacts/vtkGhostType"] == 0)
        drawn = state["contacts/force"][own]
        requested = [channel(folder, f"rcforc.{name}.force.{axis}", 2.5e-3) for axis in "xyz"]
        # single precision
        np.testing.assert_allclose(drawn.sum(axis=0), requested, rtol=1e-6, atol=1e-7)
        assert len(drawn) == channel(folder, f"rcforc.{name}.touching", 2.5e-3) == (4, 1, 4)[card]
        # on the skin, half a thickness of 10 mm from the nodes; what bends under its load is deeper
        positions = state["contacts/points"][own]
        depth = channel(folder, f"rcforc.{name}.depth", 2.5e-3)
        if name == "rests":
            along = np.arctan(0.2)
            height = positions @ [np.sin(along), 0.0, np.cos(along)]
        else:
            height = positions[:, 2] - 5e-3
        assert np.all((-1.01 * depth <= height) & (height < 0.0)), (name, height, depth)
    assert mesh["contacts/displacement"].shape == state["contacts/points"].shape


@pytest.fixture(scope="module")
def shapes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shapes")
    done = crashsolve(HERE / "shapes.yaml", "-o", folder, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    return folder


def test_every_shape_is_drawn_above_the_floor(shapes: Path) -> None:
    mesh = datasets(shapes / "mesh.h5")
    blocks = {name.split("/")[0] for name in mesh}
    assert blocks == {"mass_centres", "bodies", "ground", "springs", "contacts"}
    state = state_at(shapes, 0.28)
    points = mesh["bodies/points"] + state["bodies/displacement"]
    assert set(mesh["bodies/body"]) == {1, 2, 3, 4, 5, 6}
    # the brick is deepest then, on a corner of its own
    deepest = channel(shapes, "rcforc.fall.depth", 0.28)
    assert points[:, 2].min() == pytest.approx(-deepest, abs=1e-6)
    np.testing.assert_array_equal(mesh["ground/points"][:, 2], 0.0)


def test_pyvista_reads_the_states(shapes: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    reader = pyvista.get_reader(shapes / "states.xdmf")
    assert len(reader.time_values) == 31
    reader.set_active_time_value(reader.time_values[28])
    scene = reader.read()
    moved = scene["bodies"].warp_by_vector("displacement")
    deepest = channel(shapes, "rcforc.fall.depth", 0.28)
    assert moved.bounds[4] == pytest.approx(-deepest, abs=1e-6)
    arrows = scene["contacts"].warp_by_vector("displacement").glyph(orient="force", scale="force")
    assert arrows.n_points > 0


def test_numbers_in_pictures_have_names_and_planes_end_near_the_model(shapes: Path) -> None:
    mesh = datasets(shapes / "mesh.h5")
    with h5py.File(shapes / "mesh.h5") as file:
        names, up = json.loads(file.attrs["names"]), json.loads(file.attrs["up"])
    assert [names["bodies"][int(k)] for k in sorted(set(mesh["bodies/body"]))] == [
        family for family in Result(shapes).families["rbdout"].ids
    ]
    assert (names["contacts"], up) == (["fall"], [0.0, 0.0, 1.0])
    drawn, floor = mesh["bodies/points"], mesh["ground/points"]
    for axis in (0, 1):
        low, high = np.ptp(drawn[:, axis]), np.ptp(drawn, axis=0).max()
        # 15 % of the largest width on either side, and the lines of springs
        assert low < np.ptp(floor[:, axis]) < low + 0.31 * high


def test_contact_points_are_where_they_act_at_each_time(shapes: Path) -> None:
    state = state_at(shapes, 0.28)
    acts = np.any(state["contacts/force"], axis=1)
    # those that do not act are hidden; one that does lies between floor and the deepest point
    assert ((state["contacts/vtkGhostType"] == 0) == acts).all()
    deepest = channel(shapes, "rcforc.fall.depth", 0.28)
    assert acts.any()
    assert np.all(state["contacts/points"][acts, 2] >= -deepest - 1e-6)
    assert np.all(state["contacts/points"][acts, 2] <= 1e-6)


def test_drawn_points_move_with_their_bodies(monkeypatch: pytest.MonkeyPatch) -> None:
    # several groups of pieces, and pieces of one body that follow each other and that do not
    monkeypatch.setattr(skins, "TOGETHER", 40)
    random = np.random.default_rng(3)
    start, now = (np.zeros(4, NODE.dtype) for _ in range(2))
    for nodes in (start, now):
        for node in nodes:
            node["A"] = np.linalg.qr(random.normal(size=(3, 3)))[0].ravel()
            for name in "rvw":
                node[name] = random.normal(size=3)
    triangles = np.array([[0, 1, 2]])
    pieces = [(n, random.normal(size=(12, 3)), triangles) for n in (1, 1, 2, 3, 3, 3, 1, 2)]
    drawn = skins.Skin(pieces, start)
    fields, first = drawn.fields(skins.motion_of(now)), 0
    for n, points, _ in pieces:
        own = slice(first, first := first + 12)
        arms = points @ now[n]["A"].reshape(3, 3).T
        moved = now[n]["r"] + arms - drawn.points[own]
        # single precision
        np.testing.assert_allclose(fields["displacement"][own], moved, rtol=1e-6, atol=1e-6)
        velocity = now[n]["v"] + np.cross(now[n]["w"], arms)
        np.testing.assert_allclose(fields["velocity"][own], velocity, rtol=1e-6, atol=1e-6)


@pytest.fixture(scope="module")
def governor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rod by its primitive, hinged to the ground, and a mass without a shape on a spring."""
    folder = tmp_path_factory.mktemp("governor")
    deck = folder / "deck.yaml"
    deck.write_text(
        """
title: A rod and a mass
control: {end_time: 1e-2}
bodies:
  rod: {mass: 1, primitive: {shape: cylinder, radius: 0.1, length: 2}, position: [0, 0, -1]}
  mass: {mass: 1, inertia: [1, 1, 1], position: [3, 0, -1]}
joints:
  hinge: {type: revolute, b: rod, at: [0, 0, 0], axis: [0, 1, 0]}
springs:
  stay: {type: linear, b: mass, at_b: [0, 0, 0.5], stiffness: 100, length: 1}
""",
        "utf-8",
    )
    done = crashsolve(deck, "-o", folder / "out", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.mark.long
def test_bodies_without_surfaces_are_their_primitives_or_lines(governor: Path) -> None:
    mesh = datasets(governor / "mesh.h5")
    assert set(mesh["bodies/body"]) == {1}
    np.testing.assert_allclose(mesh["bodies/points"].min(axis=0)[2], -2.0)
    np.testing.assert_allclose(np.ptp(mesh["bodies/points"], axis=0), [0.2, 0.2, 2.0], rtol=1e-12)
    np.testing.assert_allclose(mesh["links/points"], [[3, 0, -1], [3, 0, -0.5]])
    assert set(mesh["links/body"]) == {2}


DECKS = HERE.parents[1] / "decks"
HAS_PARAVIEW = bool(shutil.which("pvpython") and shutil.which("xvfb-run"))
# what ParaView's reader of states gives at each time, and the box and ranges of each block
READ = """
import json, sys
from paraview import servermanager
from paraview.simple import XDMFReader
r = XDMFReader(FileNames=[sys.argv[1]])
r.UpdatePipelineInformation()
shown = []
for time in r.TimestepValues:
    r.UpdatePipeline(time)
    data, blocks = servermanager.Fetch(r), {}
    for k in range(data.GetNumberOfBlocks()):
        block, name = data.GetBlock(k), data.GetMetaData(k).Get(data.NAME())
        here = {"points": [block.GetPoint(i) for i in range(block.GetNumberOfPoints())]}
        for arrays in (block.GetPointData(), block.GetCellData()):
            for j in range(arrays.GetNumberOfArrays()):
                a = arrays.GetArray(j)
                here[arrays.GetArrayName(j)] = [a.GetTuple(i) for i in range(a.GetNumberOfTuples())]
        blocks[name] = here
    shown.append([time, blocks])
json.dump(shown, open(sys.argv[2], "w"))
"""


@pytest.mark.long
@pytest.mark.skipif(
    not HAS_PARAVIEW,
    reason="ParaView, which draws on a display alone: apt-get install paraview xvfb xauth",
)
@pytest.mark.parametrize(
    ("deck", "settings"),
    [
        (HERE / "shapes.yaml", ()),
        (DECKS / "tutorial" / "bouncing_ball.yaml", ()),
        (DECKS / "scenes" / "train_test.yaml", ("output.states.interval=0.05",)),
        # a coarse tube, as far as its first fold
        (
            DECKS / "benchmark" / "tube_crush.yaml",
            ("across=8", "along=48", "control.end_time=4e-3"),
        ),
        # fibre beams, drawn as tubes
        (DECKS / "scenes" / "beam_impact_4_continuous.yaml", ()),
    ],
    ids=lambda value: value.stem if isinstance(value, Path) else "",
)
def test_paraview_itself_reads_and_shows_what_was_written(
    deck: Path, settings: tuple[str, ...], tmp_path: Path
) -> None:
    """Times, blocks, values and ranges by the reader of ParaView against history and states."""
    folder = tmp_path / "out"
    words = [word for setting in (*settings, "control.estimate=off") for word in ("--set", setting)]
    done = crashsolve(deck, "-o", folder, *words)
    assert done.returncode == 0, done.stderr
    script, answer = tmp_path / "read.py", tmp_path / "found.json"
    script.write_text(READ)
    command = ["pvpython", str(script), str(folder / "states.xdmf"), str(answer)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    shown = json.loads(answer.read_text())
    paths = sorted((folder / "states").glob("*.h5"))
    assert len(shown) == len(paths) > 2
    with h5py.File(folder / "mesh.h5") as file:
        names = json.loads(file.attrs["names"])
        assert set(shown[0][1]) == set(file)
    mesh = datasets(folder / "mesh.h5")
    for (time, blocks), path in zip(shown, paths, strict=True):
        with h5py.File(path) as file:
            assert time == file.attrs["time"]
        # every number of every array, in single precision as it was written
        for name, written in datasets(path).items():
            block, field = name.split("/")
            np.testing.assert_allclose(
                np.squeeze(blocks[block][field]), np.squeeze(written), rtol=1e-6, err_msg=name
            )
        for name, written in mesh.items():
            block, field = name.split("/")
            if field in blocks[block] and name not in datasets(path):
                np.testing.assert_allclose(
                    np.squeeze(blocks[block][field]), np.squeeze(written), rtol=1e-6, err_msg=name
                )
        # bodies are where the history says, single precision of some metres of travel
        centres = blocks["mass_centres"]
        positions = np.array(centres["points"]) + np.array(centres["displacement"])
        for row, body in zip(positions, names["bodies"][1:], strict=True):
            if body in Result(folder).families["rbdout"].ids:
                requested = [
                    channel(folder, f"rbdout.{body}.position.{axis}", time) for axis in "xyz"
                ]
                np.testing.assert_allclose(row, requested, atol=2e-6, err_msg=f"{body} at {time}")
    # the script sees the model, whole: the first view is neither empty nor cut
    picture = tmp_path / "view.png"
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset", "pvpython"]
    command += [str(folder / "view_in_paraview.py"), str(picture)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    from matplotlib.image import imread

    pixels = imread(picture)[:, :, :3]
    painted = np.any(pixels < 0.99, axis=2)
    # without legends, right, and axes, left below
    middle = painted[:, 220:1000]
    assert 0.01 < middle.mean() < 0.6
    assert len(np.unique(pixels[:, 220:1000].reshape(-1, 3), axis=0)) > 50
    assert not painted[[0, -1]].any()
    assert not painted[:, [0, -1]].any()


@pytest.mark.parametrize(
    ("lower", "upper"),
    [("type: cylinder, axis: [0, 1, 0], radius: 0.1, length: 1", "type: box, size: [1, 1, 1]")]
    + [("type: box, size: [1, 1, 1]", "type: cylinder, axis: [0, 1, 0], radius: 0.1, length: 1")],
)
def test_forces_of_states_act_on_side_a_whichever_shape_it_has(
    lower: str, upper: str, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        f"""
control: {{end_time: 1e-3}}
output: {{states: {{interval: 1e-3}}}}
bodies: {{crate: {{mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.599], velocity: [0, 0, -1]}}}}
surfaces:
  lower: {{{lower}}}
  upper: {{body: crate, {upper}}}
contacts:
  hit:
    a: [upper]
    b: [lower]
    normal: {{type: kelvin_voigt, stiffness: 1e5, restitution: 1}}
""",
        "utf-8",
    )
    done = crashsolve(deck, "-o", tmp_path / "out", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    for time in (0.0, 1e-3):
        force = state_at(tmp_path / "out", time)["contacts/force"].sum(axis=0)
        expected = channel(tmp_path / "out", "rcforc.hit.force.z", time)
        assert expected > 0.0
        # single precision
        assert force[2] == pytest.approx(expected, rel=1e-6)
