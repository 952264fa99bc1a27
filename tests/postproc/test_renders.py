"""Claim: pictures and films show the states as they are, and whoever lacks VTK gets plain ones."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from command import crashsolve
from small_results import Command

from crashpost.errors import PostError
from crashpost.exports import pack
from crashpost.renders import camera as cameras
from crashpost.renders.appearance import Appearance
from crashpost.renders.beams import rotated
from crashpost.renders.colour_scale import ColourScale
from crashpost.renders.drawing import Scene
from crashpost.renders.painting import clock
from crashpost.renders.shapes import GREY, Surface
from crashpost.renders.sheet import Key
from crashpost.renders.tasks import film_task, strip_task
from crashpost.reports.views import reached
from crashpost.results.moments import moment, split
from crashpost.results.result import Result
from crashpost.results.states import States

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
SIDES = np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6]])
FLOOR = np.array([[-1.0, -1, 0], [2, -1, 0], [2, 2, 0], [-1, 2, 0]])
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
SHEET = np.array([[x, y, 2.0] for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)])
TIMES = (0.0, 0.1, 0.2, 0.3)


def write_states(folder: Path) -> Path:
    """A cube that moves by 1 m/s, a sheet that loses an element at the end, a contact between."""
    (folder / "states").mkdir()
    blocks = {
        "bodies": (CUBE, SIDES),
        "ground": (FLOOR, np.array([[0, 1, 2], [0, 2, 3]])),
        "mass_centres": (np.full((1, 3), 0.5), np.array([[0]])),
        "part_sheet": (SHEET, QUADS),
        "contacts": (np.zeros((1, 3)), np.array([[0]])),
    }
    with h5py.File(folder / "mesh.h5", "w") as file:
        file.attrs.update({"format": "crashsolve states", "format_version": 3})
        file.attrs["names"] = (
            '{"bodies": ["ground", "car"], "parts": ["sheet"], "contacts": ["hit"]}'
        )
        for name, (points, cells) in blocks.items():
            file[f"{name}/points"], file[f"{name}/cells"] = points, cells
        file["bodies/body"], file["ground/body"] = np.ones(4, "f4"), np.zeros(2, "f4")
        file["mass_centres/body"] = np.ones(1, "f4")
    for k, time in enumerate(TIMES):
        with h5py.File(folder / "states" / f"{k:06d}.h5", "w") as file:
            file.attrs["time"] = time
            for name, (points, _) in blocks.items():
                moved = np.zeros((len(points), 3), "f4")
                if name in ("bodies", "mass_centres"):
                    moved[:, 0] = time
                if name != "contacts":
                    file[f"{name}/displacement"] = moved
                    file[f"{name}/displacement"].attrs["unit"] = "m"
            file["part_sheet/von_mises"] = np.array([1e6, 2e8]) * time
            file["part_sheet/von_mises"].attrs["unit"] = "Pa"
            file["part_sheet/vtkGhostType"] = np.array([0, 32 * (k == 3)], "u1")
            file["contacts/points"] = np.array([[1.0 + time, 0.5, 0.5]], "f4")
            file["contacts/force"] = np.array([[-1000.0 * (k == 2), 0, 0]], "f4")
            file["contacts/contact"] = np.zeros(1, "f4")
            file["contacts/vtkGhostType"] = np.array([0 if k == 2 else 32], "u1")
    return folder


@pytest.fixture
def run(cars: Path) -> Path:
    """Two cars with states."""
    return write_states(cars)


def test_moments_are_read_in_words(run: Path) -> None:
    result = Result(run)
    assert split("0, 50ms, max:norm(a.b.x, a.b.y), end") == [
        "0",
        "50ms",
        "max:norm(a.b.x, a.b.y)",
        "end",
    ]
    assert moment(result, "50ms", 0.3).time == pytest.approx(0.05, rel=1e-12)
    assert moment(result, "end", 0.3).time == 0.3
    # force pulls back: -force is largest halfway through the half oscillation
    middle = 0.5 * (result.time[0] + result.time[-1])
    for word in (
        "max:-deforc.buffer.force",
        "min:deforc.buffer.force",
        "abs_max:deforc.buffer.force",
    ):
        assert moment(result, word, 0.3).time == pytest.approx(middle, rel=1e-9)
    for wrong in ("soon", "5 kg", "max:rcforc.none.normal", "nan", ""):
        with pytest.raises(PostError):
            moment(result, wrong, 0.3)


def test_a_picture_is_of_the_nearest_state_and_says_its_time(run: Path) -> None:
    task = strip_task(Result(run), run / "x.png", ["0.14", "end"], "")
    assert task.frames == ((1.0, "t = 100 ms"), (3.0, "t = 300 ms"))
    with pytest.raises(PostError, match=r"there are states from 0 s to 0.3 s"):
        strip_task(Result(run), run / "x.png", ["1.0"], "")
    # a deck's scene shows the end of a run that has ended before
    scene = {"at": ["0 s", "1 s", "2 s"]}
    assert reached(Result(run), scene) == ["0 s", "end"]
    # of two states two pictures, unless more are asked for
    for path in sorted((run / "states").glob("*.h5"))[1:-1]:
        path.unlink()
    for words, count in (([], 2), (["0", "0", "end"], 3)):
        assert len(strip_task(Result(run), run / "x.png", words, "").frames) == count


def test_a_film_takes_as_long_as_asked(run: Path) -> None:
    task = film_task(Result(run), run / "x.gif", "", fps=25, slow=20)
    # 0.3 s, 20 times slower, at 25 per second; both ends are shown
    assert len(task.frames) == 151
    assert task.frames[75][0] == pytest.approx(1.5)
    assert (task.frames[0][0], task.frames[-1][0]) == (0.0, 3.0)
    for wrong in ({"slow": 0.0}, {"slow": float("nan")}, {"fps": 0.0}, {"slow": 1e9}):
        with pytest.raises(PostError):
            film_task(Result(run), run / "x.gif", "", **wrong)


def test_what_moves_is_where_it_was_between_states_half_way(run: Path) -> None:
    scene = Scene(States(run), Appearance())
    assert scene.positions(2, "bodies")[:, 0].max() == pytest.approx(1.2)
    assert scene.positions(1.5, "bodies")[:, 0].max() == pytest.approx(1.15)


@pytest.mark.long
def test_magnified_displacements_are_so_many_times_as_large_and_said(
    run: Path, crashpost: Command, tmp_path: Path
) -> None:
    states = States(run)
    for number in (0, 1.5, 3):
        # the cube moves by 0.1 m from state to state
        plain = Scene(states, Appearance()).positions(number, "bodies")
        large = Scene(states, Appearance(magnify=5.0)).positions(number, "bodies")
        np.testing.assert_allclose(
            plain - CUBE, np.outer(np.ones(8), [0.1 * number, 0, 0]), atol=1e-7
        )
        np.testing.assert_allclose(
            large - CUBE, np.outer(np.ones(8), [0.5 * number, 0, 0]), atol=1e-7
        )
    assert Appearance(magnify=5.0).note == "displacements x 5"
    assert Appearance().note == ""
    picture = tmp_path / "strip.svg"
    code, _, _ = crashpost("render", run, "--magnify", "5", "-o", picture)
    assert code == 0
    # forces act where bodies are, and have no position beside magnified ones
    with pytest.raises(PostError, match="magnified"):
        Scene(states, Appearance(arrows="rcforc", magnify=5.0))
    for wrong in ("0", "-2", "nan", "inf"):
        code, _, words = crashpost("render", run, f"--magnify={wrong}", "-o", picture)
        assert (code, "magnify must be a positive number" in words) == (2, True), wrong


def test_what_turns_far_between_states_is_not_shrunk_on_the_way(run: Path) -> None:
    with h5py.File(run / "states" / "000001.h5", "r+") as file:
        # turned half round about its corner: halfway the cube would be flat
        file["bodies/displacement"][...] = CUBE @ np.diag([-1.0, -1, 1]) - CUBE
    scene = Scene(States(run), Appearance())
    np.testing.assert_allclose(scene.positions(0.4, "bodies"), CUBE)
    np.testing.assert_allclose(scene.positions(0.6, "bodies"), CUBE @ np.diag([-1.0, -1, 1]))


def test_deleted_elements_are_gone_and_do_not_count_in_the_colours(run: Path) -> None:
    scene = Scene(States(run), Appearance(color="von_mises"))
    sheets = [s for k in (2, 3) for s in scene.at(k).surfaces if s.corners.shape[1] == 4]
    assert [len(sheet.corners) for sheet in sheets] == [2, 1]
    assert scene.range(2)[1] == pytest.approx(0.2 * 2e8)
    assert scene.range(3)[1] == pytest.approx(0.3 * 1e6)


@pytest.mark.long
def test_a_part_that_is_gone_changes_nothing_of_the_others(run: Path, crashpost: Command) -> None:
    """Surfaces of two states are compared by their number, in the page that is turned by hand."""
    for path in (run / "states").glob("*.h5"):
        with h5py.File(path, "r+") as file:
            file["part_sheet/vtkGhostType"][...] = 32 * (path.stem != "000000")
    scene = Scene(States(run), Appearance())
    first, last = scene.at(0).surfaces, scene.at(3).surfaces
    assert len(first) == len(last)
    for before, after in zip(first, last, strict=True):
        assert len(before.points) == len(after.points)
    # and where nothing else is shown, empty pictures follow
    alone = Scene(States(run), Appearance(show=("sheet",)))
    assert len(alone.extent(0)) > 0
    assert len(alone.extent(3)) == 0
    for words in (["render"], ["render", "--show", "sheet"], ["render", "--color", "von_mises"]):
        assert crashpost(*words[:1], run, *words[1:], "-o", run / "x.png")[0] == 0
    pytest.importorskip("k3d")
    for words in ([], ["--show", "sheet"], ["--show", "sheet", "--color", "von_mises"]):
        assert crashpost("film", run, *words, "-o", run / "x.html")[0] == 0


def test_belts_are_shown_beside_bodies_where_named(tmp_path: Path) -> None:
    deck = Path(__file__).parents[2] / "decks" / "verification" / "belts" / "belt.yaml"
    done = crashsolve(deck, "-o", tmp_path / "out", "--set", "control.estimate=off")
    assert done.returncode == 0, done.stderr
    states = States(tmp_path / "out")
    body = states.names["bodies"][1]
    for show, drawn in (((), True), ((body,), False), ((body, "belts"), True)):
        assert bool(Scene(states, Appearance(show=show)).at(0).lines) == drawn
    with pytest.raises(PostError, match="unknown body or part 'springs'"):
        Scene(states, Appearance(show=("springs",)))


def struck_member(folder: Path, *words: str) -> Scene:
    """The beams of a structure that a bar strikes, after a millisecond."""
    deck = Path(__file__).parents[2] / "decks" / "verification" / "parts" / "struck_member.yaml"
    settings = ["parts.frame.deformation=beams", "control.end_time=0.001", *words]
    options = [word for setting in settings for word in ("--set", setting)]
    done = crashsolve(deck, "-o", folder, *options)
    assert done.returncode == 0, done.stderr
    return Scene(States(folder), Appearance())


def test_a_node_with_a_surface_has_the_colour_of_its_part(tmp_path: Path) -> None:
    scene = struck_member(tmp_path / "out", "surfaces.nose.body=frame_arm_1")
    colours, names = dict(scene.legend()), scene.states.names["bodies"]
    assert set(colours) == {"bar", "frame_foot", "frame_tip", "frame_arm"}
    node = names.index("frame_arm_1")
    assert node in scene.states.blocks["bodies"].fixed["body"]
    assert scene._body_colour(node) == colours["frame_arm"]


def test_the_outlines_of_struck_beams_do_not_cover_their_elements(tmp_path: Path) -> None:
    """A contact that names a structure gives its nodes boxes as thick as its sections."""
    scene = struck_member(tmp_path / "out")
    names, block = scene.states.names["bodies"], scene.states.blocks["bodies"]
    drawn = {names[int(k)] for k in block.fixed["body"]}
    assert drawn == {"bar", "frame_foot", "frame_tip"}


def test_states_that_hold_no_numbers_are_refused(run: Path, crashpost: Command) -> None:
    with h5py.File(run / "states" / "000002.h5", "r+") as file:
        file["bodies/displacement"][3, 1] = np.nan
    code, _, words = crashpost("render", run, "-o", run / "x.png")
    assert code == 2
    assert "000002.h5: bodies/displacement holds values that are no finite numbers" in words


def test_only_what_is_named_is_shown(run: Path) -> None:
    scene = Scene(States(run), Appearance(show=("sh*",)))
    drawn = [s for s in scene.at(0).surfaces if len(s.points) != len(FLOOR)]
    assert [len(s.points) for s in drawn] == [len(SHEET)]
    assert scene.legend() == [("sheet", scene._part_colour(0))]


@pytest.mark.parametrize(
    ("appearance", "words"),
    [
        (Appearance(show=("lorry",)), "unknown body or part 'lorry'"),
        (Appearance(color="plastic"), "unknown colour 'plastic'"),
        (Appearance(arrows="rcforc.wall"), r"unknown arrows 'rcforc.wall'.*rcforc.hit"),
        (Appearance(arrows="deforc"), "unknown arrows 'deforc'"),
    ],
)
def test_words_that_name_nothing_are_refused(run: Path, appearance: Appearance, words: str) -> None:
    with pytest.raises(PostError, match=words):
        Scene(States(run), appearance)


def test_arrows_are_the_contact_forces_where_they_act(run: Path) -> None:
    scene = Scene(States(run), Appearance(arrows="rcforc.h*"))
    ((starts, vectors),) = scene.at(2).arrows
    np.testing.assert_allclose(starts, [[1.2, 0.5, 0.5]], rtol=1e-6)
    np.testing.assert_allclose(vectors, [[-1000.0, 0, 0]])
    assert len(scene.at(1).arrows[0][0]) == 0


def test_views_look_from_where_they_say() -> None:
    up, low, high = np.array([0.0, 0, 1]), np.zeros(3), np.array([10.0, 1, 3])
    towards = {
        "side": (0, -1, 0),
        "front": (1, 0, 0),
        "rear": (-1, 0, 0),
        "top": (0, 0, 1),
        "auto": (0, -1, 0),
        "0,0,-2": (0, 0, -1),
    }
    for view, direction in towards.items():
        seen = cameras.camera(view, up, low, high)
        np.testing.assert_allclose(seen.towards, direction, atol=1e-12)
        axes = np.array([seen.right, seen.up, seen.towards])
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1.0)
    # ahead is to the right, from the side and from above
    for view in ("side", "top"):
        np.testing.assert_allclose(cameras.camera(view, up, low, high).right, [1, 0, 0], atol=1e-12)
    for wrong in ("sideways", "1,2", "0,0,0", "nan,1,1"):
        with pytest.raises(PostError):
            cameras.camera(wrong, up, low, high)


def test_everything_is_within_the_picture_and_the_scale_bar_is_true() -> None:
    points = np.array([[0.0, 0, 0], [10, 1, 3], [4, -2, 7]])
    seen = cameras.camera("iso", np.array([0.0, 0, 1]), points.min(axis=0), points.max(axis=0))
    seen = cameras.fitted(seen, points, 1.0, 2.0)
    flat = seen.flat(points)
    assert np.all(abs(flat[:, 1]) < seen.half_height)
    assert np.all(abs(flat[:, 0]) < 0.5 * seen.width)
    length, label = Key(seen, ColourScale()).scale_bar
    assert (0.1 * seen.width < length < 0.34 * seen.width, label) == (True, f"{length:g} m")


def test_sections_turn_with_their_nodes() -> None:
    """Rodrigues against a quarter turn, and no turn at all."""
    rotated_sections = rotated(np.array([[0, 0, np.pi / 2], [0, 0, 0]]))
    np.testing.assert_allclose(rotated_sections[0] @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    np.testing.assert_array_equal(rotated_sections[1], np.eye(3))


def test_times_have_a_unit_that_suits_the_run() -> None:
    assert [clock(0.05, 0.3), clock(1.5, 20.0), clock(0.25e-3, 1e-3)] == [
        "t = 50 ms",
        "t = 1.5 s",
        "t = 0.25 ms",
    ]


def pixels(path: Path) -> np.ndarray:
    from matplotlib.image import imread

    return imread(path)[:, :, :3]


def test_whose_vtk_dies_gets_a_plain_picture_and_is_reported_what_helps(
    run: Path, crashpost: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    broken = tmp_path / "broken"
    broken.mkdir()
    # as VTK does without graphics libraries
    (broken / "pyvista.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    monkeypatch.setenv("PYTHONPATH", f"{broken}:{':'.join(sys.path)}")
    path = tmp_path / "plain.png"
    code, out, err = crashpost(
        "render", run, "--at", "0,200ms", "--color", "von_mises", "--arrows", "rcforc", "-o", path
    )
    assert (code, out.strip()) == (0, str(path))
    assert "VTK died of SIGSEGV" in err and "apt-get install libgl1" in err
    picture = pixels(path)
    # bodies, colours and a red arrow are on it
    assert (abs(picture - 1.0).max(axis=2) > 0.1).mean() > 0.05
    red, green, blue = picture.reshape(-1, 3).T
    assert ((red > 0.6) & (green < 0.3) & (blue < 0.25)).sum() > 50


def test_what_is_shown_alone_fills_the_picture_with_the_forces_on_it(run: Path) -> None:
    """The ground and what is hidden do not widen it; a force 1.5 m beside the cube is left out."""
    with h5py.File(run / "mesh.h5", "r+") as file:
        file["ground/points"][...] = 100.0 * FLOOR + [0, 0, 5.0]
    alone = Scene(States(run), Appearance(show=("car",), arrows="rcforc"))
    assert np.ptp(alone.extent(0), axis=0).max() == 1.0
    assert len(alone.forces(2)[0]) == 1
    with h5py.File(run / "states" / "000002.h5", "r+") as file:
        file["contacts/points"][...] = [[2.7, 0.5, 0.5]]
    assert len(alone.forces(2)[0]) == 0
    assert len(Scene(States(run), Appearance(arrows="rcforc")).forces(2)[0]) == 1


def test_a_film_is_as_high_as_its_scene_asks() -> None:
    """Even numbers of pixels, and the picture between a sixth and three fifths of the width."""
    from crashpost.renders.sheet import film_size, film_window

    for aspect in (0.1, 0.45, 1.0, 1.7, 3.0, 14.0):
        size = film_size(aspect, 960)
        assert size[0] % 2 == size[1] % 2 == 0 and 480 <= size[0] <= 960
        _, _, width, height = film_window(size)
        assert 0.15 * 960 < height < 0.61 * 960
        if 0.9 < aspect < 6.0:
            assert abs(width / height - aspect) < 0.03 * aspect


@pytest.mark.long
def test_pyvista_paints_a_strip_and_a_film(run: Path, crashpost: Command, tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    path = tmp_path / "strip.png"
    code, _, err = crashpost("render", run, "--at", "0,end", "--view", "1,0,4", "-o", path)
    assert (code, err) == (0, ""), err
    # the sheet has the second colour and the cube the first, in more than the squares of the legend
    for colour in ([0.0, 0.447, 0.698], [0.902, 0.624, 0.0]):
        seen = abs(pixels(path) - np.array(colour)).max(axis=2) < 0.15
        assert seen.any(axis=0).sum() > 100, colour
    film = tmp_path / "film.gif"
    small = ("--size", "480x270", "--slow", "2", "--fps", "10")
    code, _, err = crashpost("film", run, *small, "--follow", "car", "-o", film)
    assert (code, err) == (0, ""), err
    from PIL import Image

    with Image.open(film) as opened:
        assert (opened.n_frames, opened.size, opened.info["duration"]) == (7, (480, 270), 100)


def test_a_result_larger_than_memory_is_read_state_by_state(tmp_path: Path, run: Path) -> None:
    """Forty states of 0.96 MB each, all looked at, take less than 12 MB more than one."""
    n = 40_000
    with h5py.File(run / "mesh.h5", "r+") as file:
        del file["part_sheet"]
        file["part_sheet/points"] = np.random.default_rng(1).random((n, 3))
        file["part_sheet/cells"] = np.arange(n).reshape(-1, 4)
    with h5py.File(run / "states" / "000000.h5", "w") as file:
        file.attrs["time"] = 0.0
        file["part_sheet/displacement"] = np.zeros((n, 3), "f4")
        file["part_sheet/velocity"] = np.zeros((n, 3), "f4")
    for k in range(1, 40):
        target = run / "states" / f"{k:06d}.h5"
        target.unlink(missing_ok=True)
        target.hardlink_to(run / "states" / "000000.h5")
    code = (
        "import resource, sys\n"
        "from crashpost.renders.drawing import Scene\n"
        "from crashpost.renders.appearance import Appearance\n"
        "from crashpost.results.states import States\n"
        "states = States(sys.argv[1])\n"
        "states.blocks = {k: v for k, v in states.blocks.items() if k == 'part_sheet'}\n"
        "scene = Scene(states, Appearance(color='velocity'))\n"
        "size = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024\n"
        "scene.range(0); scene.extent(0); before = size()\n"
        "for k in range(40): scene.range(k); scene.extent(k)\n"
        "print(size() - before)\n"
    )
    done = subprocess.run([sys.executable, "-c", code, str(run)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # all together are 38 MB
    assert float(done.stdout) < 12.0


def test_the_packed_file_says_what_the_states_say(run: Path, crashpost: Command) -> None:
    """Read back with pyvista: times, points in place, fields, what is deleted."""
    pyvista = pytest.importorskip("pyvista")
    code, out, err = crashpost("pack", run)
    assert (code, err) == (0, ""), err
    assert "4 states" in out
    # the size that was expected holds, and is checked before a file is begun
    size = (run / "states.vtkhdf").stat().st_size
    assert size <= pack._Packing(States(run)).size
    with pytest.MonkeyPatch.context() as patch:
        usage = SimpleNamespace(free=size // 2)
        patch.setattr(pack.shutil, "disk_usage", lambda folder: usage)
        code, out, err = crashpost("pack", run)
    assert code == 2 and "MB are free" in err
    reader = pyvista.get_reader(run / "states.vtkhdf").reader
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(TIMES)
    states, blocks = States(run), list(States(run).blocks)
    for k in range(len(TIMES)):
        reader.SetStep(k)
        reader.Update()
        assert reader.GetTimeValue() == TIMES[k]
        grid = pyvista.wrap(reader.GetOutput())
        positions = np.concatenate([states.positions(k, name) for name in blocks])
        np.testing.assert_allclose(grid.points, positions, atol=1e-6)
        sheet = grid.cell_data["block"] == blocks.index("part_sheet")
        wanted = states.read(k, "part_sheet", "von_mises")["von_mises"]
        np.testing.assert_allclose(grid.cell_data["von_mises"][sheet], wanted)
        ghost = grid.cell_data["vtkGhostType"][sheet]
        assert ghost.tolist() == [0, 32 if k == 3 else 0]
        force = grid.point_data["force"]
        assert np.nansum(force[:, 0]) == (-1000.0 if k == 2 else 0.0)


def test_a_plane_seen_from_behind_hides_nothing() -> None:
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = np.array([[0, 1, 2], [0, 2, 3]])
    rows = np.arange(2)
    wall = Surface(square, corners, [GREY], 0 * rows, rows, one_sided=True)
    # from outside, along its edge and from inside; a box is drawn from everywhere
    for towards, count in (([0.0, 0.6, 0.8], 2), ([1.0, 0.0, 0.0], 2), ([0.0, 0.6, -0.8], 0)):
        assert len(wall.seen_from(np.array(towards)).corners) == count
        wall_of_box = replace(wall, one_sided=False)
        assert len(wall_of_box.seen_from(np.array(towards)).corners) == 2


def test_the_start_is_seen_on_a_plane_below_it(run: Path, crashpost: Command) -> None:
    path, shade = run / "x.png", np.array([0xB9, 0xC0, 0xC6]) / 255
    words = ("--show", "car", "--view", "top", "-o", path)
    shares = []
    for time in ("0", "0.2"):
        code, _, err = crashpost("render", run, "--at", time, *words)
        assert (code, err) == (0, ""), err
        # light makes it paler by 6 of 255; the plane is 30 of 255 away
        shares.append((abs(pixels(path) - shade).max(axis=2) < 0.05).mean())
    # of a cube that has moved by a fifth of its length, a fifth is not covered by the present one
    assert shares[0] < 0.01 < 0.05 < shares[1] < 0.25
