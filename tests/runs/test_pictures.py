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


@pytest.mark.parametrize("time", [0.05, 0.25, 0.5])
def test_bodies_and_forces_are_drawn_as_the_histories_say(
    time: float, mechanism: Path, uninterrupted: dict[Path, Path]
) -> None:
    folder = uninterrupted[mechanism]
    mesh, state = datasets(folder / "mesh.h5"), state_at(folder, time)
    centres = mesh["mass_centres/points"] + state["mass_centres/displacement"]
    for k, body in enumerate(("hammer", "bob")):
        place = [channel(folder, f"rbdout.{body}.position.{axis}", time) for axis in "xyz"]
        np.testing.assert_allclose(centres[k], place, atol=1e-6)
    force = state["contacts/force"].sum(axis=0)
    asked = [channel(folder, f"rcforc.blow.force.{axis}", time) for axis in "xyz"]
    np.testing.assert_allclose(force, asked, rtol=1e-6, atol=1e-3)
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
        asked = [channel(folder, f"rcforc.{name}.force.{axis}", 2.5e-3) for axis in "xyz"]
        # single precision
        np.testing.assert_allclose(drawn.sum(axis=0), asked, rtol=1e-6, atol=1e-7)
        assert len(drawn) == channel(folder, f"rcforc.{name}.touching", 2.5e-3) == (4, 1, 4)[card]
        # on the skin, half a thickness of 10 mm from the nodes; what bends under its load is deeper
        places = state["contacts/points"][own]
        depth = channel(folder, f"rcforc.{name}.depth", 2.5e-3)
        if name == "rests":
            along = np.arctan(0.2)
            height = places @ [np.sin(along), 0.0, np.cos(along)]
        else:
            height = places[:, 2] - 5e-3
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


def test_bodies_without_surfaces_are_their_primitives_or_lines(governor: Path) -> None:
    mesh = datasets(governor / "mesh.h5")
    assert set(mesh["bodies/body"]) == {1}
    np.testing.assert_allclose(mesh["bodies/points"].min(axis=0)[2], -2.0)
    np.testing.assert_allclose(np.ptp(mesh["bodies/points"], axis=0), [0.2, 0.2, 2.0], rtol=1e-12)
    np.testing.assert_allclose(mesh["links/points"], [[3, 0, -1], [3, 0, -0.5]])
    assert set(mesh["links/body"]) == {2}


@pytest.mark.long
@pytest.mark.skipif(
    not (shutil.which("pvpython") and shutil.which("xvfb-run")),
    reason="ParaView, which draws on a display alone: apt-get install paraview xvfb xauth",
)
def test_paraview_itself_reads_what_was_written(shapes: Path, tmp_path: Path) -> None:
    """Times, blocks, places and forces by the reader of ParaView against the history."""
    script = tmp_path / "read.py"
    script.write_text(
        "import json, sys\n"
        "from paraview.simple import XDMFReader\n"
        "from paraview import servermanager\n"
        "r = XDMFReader(FileNames=[sys.argv[1]])\n"
        "r.UpdatePipelineInformation()\n"
        "r.UpdatePipeline(0.28)\n"
        "data, found = servermanager.Fetch(r), {}\n"
        "for k in range(data.GetNumberOfBlocks()):\n"
        "    block, name = data.GetBlock(k), data.GetMetaData(k).Get(data.NAME())\n"
        "    arrays = [block.GetPointData(), block.GetCellData()]\n"
        "    ranges = {a.GetArrayName(j): a.GetArray(j).GetRange(-1)\n"
        "              for a in arrays for j in range(a.GetNumberOfArrays())}\n"
        "    found[name] = [block.GetBounds(), ranges]\n"
        "print(json.dumps([list(r.TimestepValues), found]))\n"
    )
    command = ["pvpython", "--force-offscreen-rendering", str(script), str(shapes / "states.xdmf")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    times, found = json.loads(done.stdout.splitlines()[-1])
    assert len(times) == 31
    assert set(found) == {"mass_centres", "bodies", "ground", "springs", "contacts"}
    # the brick touches with two corners then, whose sum another test compares with the history
    force = np.linalg.norm(state_at(shapes, 0.28)["contacts/force"], axis=1).max()
    assert found["contacts"][1]["force"][1] == pytest.approx(force, rel=1e-6)
    assert found["contacts"][0][4] <= 0.0
    assert found["bodies"][1]["body"] == [1.0, 6.0]
    # the script opens them as well, and sees something
    picture = tmp_path / "view.png"
    command = ["pvpython", "--force-offscreen-rendering", str(shapes / "view_in_paraview.py")]
    command = ["xvfb-run", "-a", *command, str(picture), "0.28"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    from matplotlib.image import imread

    assert len(np.unique(imread(picture).reshape(-1, imread(picture).shape[2]), axis=0)) > 50
