"""Claim: every shape alone on the ground, and scenes of 1 : 50, are drawn, in 3-D too."""

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import h5py
import numpy as np
import pytest
from quick import first_quick
from small_results import two_cars, write_result, write_status

from crashpost.errors import PostError
from crashpost.renders import model_page, painting, sheet
from crashpost.renders.borders import are_edge_on, borders
from crashpost.renders.camera import camera
from crashpost.renders.colour_scale import ColourScale
from crashpost.renders.paint_plain import Painter
from crashpost.renders.sheet import Key
from crashpost.renders.tasks import film_task, strip_task
from crashpost.reports.build import report
from crashpost.results.result import Result
from crashpost.results.states import Block, States
from crashsolve.output import shapes

GROUNDS = {
    "sphere": shapes.sphere(1.0),
    "box": shapes.box(0.5, 0.5, 0.5),
    "cylinder": shapes.cylinder(0.3, 0.5),
    "plane": (
        np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
    ),
}


def drawn_run(
    folder: Path,
    ground: tuple[np.ndarray, np.ndarray] | None,
    size: tuple[float, float],
    *,
    origin: float = 0.0,
    displacement: float = 0.01,
) -> Path:
    """A strip of 20 elements, across x and along z, that moves; a thing of the ground beside it."""
    write_result(folder, two_cars(), title=r"friction \mu = 0.3 $x_1$ <b>")
    write_status(folder)
    (folder / "states").mkdir()
    width, height = size
    points = np.array([[width * i, 0.0, height * j / 20] for j in range(21) for i in range(2)])
    cells = np.array([[2 * j, 2 * j + 1, 2 * j + 3, 2 * j + 2] for j in range(20)])
    points += origin
    with h5py.File(folder / "mesh.h5", "w") as file:
        file.attrs.update({"format": "crashsolve states", "format_version": 3})
        file.attrs["names"] = '{"bodies": ["ground"], "parts": ["post"], "contacts": ["hit"]}'
        file["part_post/points"], file["part_post/cells"] = points, cells
        file["contacts/points"], file["contacts/cells"] = np.zeros((1, 3)), np.array([[0]])
        if ground is not None:
            file["ground/points"], file["ground/cells"] = ground
    for k in range(3):
        with h5py.File(folder / "states" / f"{k:06d}.h5", "w") as file:
            file.attrs["time"] = 0.1 * k
            file["part_post/displacement"] = np.full((len(points), 3), displacement * k, "f4")
            file["part_post/plastic_strain"] = np.linspace(0.0, 0.1 * k, len(cells))
            file["contacts/points"] = np.array([[0.0, 0.0, 0.5 * height]]) + origin
            file["contacts/force"] = np.array([[0.0, 1e3 * k, 0.0]], "f4")
            file["contacts/contact"] = np.zeros(1, "f4")
    return folder


@pytest.mark.parametrize("shape", GROUNDS)
def test_every_shape_alone_on_the_ground_is_in_the_page(tmp_path: Path, shape: str) -> None:
    """What a browser is given has points: it draws nothing more after an object without any."""
    k3d = pytest.importorskip("k3d")
    folder = drawn_run(tmp_path / "x.results", GROUNDS[shape], (1.0, 2.0))
    shown: list[object] = []
    whole = model_page._put

    def put(k3d: ModuleType, plot: "k3d.Plot", *rest: object) -> None:
        whole(k3d, plot, *rest)
        shown.extend(plot.objects)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(model_page, "_put", put)
        text, _ = model_page.page(Result(folder), arrows="rcforc")
    assert shown and k3d
    for item in shown:
        vertices = item.vertices if hasattr(item, "vertices") else item.positions
        frames = vertices.values() if isinstance(vertices, dict) else [vertices]
        assert all(np.size(one) > 0 for one in frames), item
    # a title is text, in HTML as everywhere
    assert r"<title>friction \mu = 0.3 $x_1$ &lt;b&gt;</title>" in text


@pytest.mark.parametrize(("origin", "size"), [(0.0, 1e-5), (0.0, 1e-3), (1e8, 1.0)])
def test_the_page_draws_small_and_distant_scenes_alike(
    tmp_path: Path, origin: float, size: float
) -> None:
    """The drawing library refuses lines below 1e-7, and single precision has seven digits."""
    k3d = pytest.importorskip("k3d")
    folder = drawn_run(
        tmp_path / "x.results", None, (size, size), origin=origin, displacement=0.01 * size
    )
    drawn: dict[str, np.ndarray] = {}
    separate = model_page._field_mesh

    def field_mesh(*arguments: object) -> "k3d.objects.Mesh":
        mesh = separate(*arguments)
        drawn.update(mesh.vertices)
        return mesh

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(model_page, "_field_mesh", field_mesh)
        model_page.page(Result(folder), arrows="rcforc", color="plastic_strain")
    spans = np.ptp(next(iter(drawn.values())), axis=0)
    # a picture of half height 1 holds the square, with its margins, whatever its size is
    assert 0.5 < spans[0] < 2.0 and spans[2] == pytest.approx(spans[0], rel=1e-5)


# width and height [m]
SIZES = ((1e-3, 50.0), (0.02, 1.0), (1.0, 0.02))


@pytest.mark.parametrize("size", first_quick([[size] for size in SIZES]))
def test_tall_and_flat_scenes_are_drawn_with_colours_and_arrows(
    tmp_path: Path, size: tuple[float, float]
) -> None:
    folder = drawn_run(tmp_path / "x.results", None, size)
    result, appearance = Result(folder), {"color": "plastic_strain", "arrows": "rcforc"}
    strip = strip_task(result, tmp_path / "x.png", [], result.title, **appearance)
    film = film_task(result, tmp_path / "x.gif", result.title, slow=5.0, fps=5.0, **appearance)
    for task in (strip, film):
        painting.render_task(States(folder), task, Painter, lambda done, total: None)
        assert Path(task.output).stat().st_size > 0
    small = film_task(result, tmp_path / "y.gif", "", size=(480, 270), **appearance)
    with pytest.raises(PostError, match="720 pixels wide"):
        painting.render_task(States(folder), small, Painter, lambda done, total: None)


def test_the_arrow_of_the_legend_is_as_long_as_one_of_the_picture() -> None:
    up = np.array([0.0, 0, 1])
    seen = camera("side", up, np.zeros(3), np.ones(3))
    for arrow, size in ((1e-3, 120.0), (2e-6, 3.3e5), (0.4, 0.7)):
        key = Key(seen, ColourScale(), arrow=arrow, arrow_unit="N", arrow_size=size)
        length, label = key.arrow_bar(2.0)
        value, unit = label.split()
        newtons = float(value) * {"N": 1.0, "kN": 1e3, "mN": 1e-3, "MN": 1e6}[unit]
        # metres for a newton, inches for a metre
        assert length == pytest.approx(newtons * arrow * 2.0 / seen.width, rel=1e-9)
        assert 0 < length <= 1.0 and newtons <= size * (1 + 1e-9)


def test_sheets_seen_from_their_edges_have_borders_and_another_view() -> None:
    points = np.array([[x, 0.0, z] for z in (0.0, 1.0, 2.0) for x in (0.0, 1.0)])
    corners = np.array([[0, 1, 3, 2], [2, 3, 5, 4]])
    edges, owners = borders(Block("part_x", points, [(np.arange(2), corners)]))
    # six edges around two quadrilaterals; the one between them is no border
    assert {frozenset(edge) for edge in edges.tolist()} == {
        frozenset(pair) for pair in ((0, 1), (1, 3), (3, 5), (5, 4), (4, 2), (2, 0))
    }
    assert sorted(owners.tolist()) == [0, 0, 0, 1, 1, 1]
    assert are_edge_on(points, corners, np.array([1.0, 0, 0]))
    assert not are_edge_on(points, corners, np.array([0.0, -1, 0]))


def test_many_names_take_more_lines_and_no_room_of_the_picture() -> None:
    names = [(f"wagon_{k}", "#000000") for k in range(16)]
    lines, columns = sheet.name_grid(names, 3.0)
    assert lines * columns >= 16 and columns * 0.8 <= 3.0
    seen = camera("side", np.array([0.0, 0, 1]), np.zeros(3), np.ones(3))
    few, many = Key(seen, ColourScale(), names[:3]), Key(seen, ColourScale(), names)
    assert many.footer(4.8, 4.0) > few.footer(4.8, 4.0) == sheet.FOOTER


def test_an_mp4_that_was_asked_for_is_one_or_an_error(tmp_path: Path) -> None:
    folder = drawn_run(tmp_path / "x.results", None, (1.0, 1.0))
    code = (
        "import sys\nsys.modules['imageio_ffmpeg'] = None\n"
        "import crashpost.renders.film_file as f\nf.can_write_mp4 = lambda: False\n"
        "from crashpost.cli import main\nsys.exit(main(sys.argv[1:]))"
    )
    path = tmp_path / "x.mp4"
    command = [sys.executable, "-c", code, "film", str(folder), "-o", str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2 and "imageio_ffmpeg" in done.stderr
    assert not path.exists() and not path.with_suffix(".gif").exists()


def test_a_report_keeps_its_pictures_where_the_film_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("imageio_ffmpeg")
    folder = drawn_run(tmp_path / "x.results", None, (1.0, 1.0))
    # a program that is there and encodes nothing
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", "/bin/false")
    page, problems = report(Result(folder))
    assert "data:image/png" in page and "data:video" not in page
    assert len(problems) == 1
    assert problems[0].startswith("pictures: film.mp4: the encoder failed after")
