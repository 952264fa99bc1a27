"""Claim: close-ups show where they say, cuts keep what they say, sections move with their nodes."""

from pathlib import Path

import numpy as np
import pytest
from test_odd_scenes import drawn_run

from crashpost.errors import PostError
from crashpost.renders import close_up as close_ups
from crashpost.renders import painting, sheet
from crashpost.renders.appearance import Appearance
from crashpost.renders.camera import camera, fitted
from crashpost.renders.cutting import clamped, cut, half_space
from crashpost.renders.drawing import Scene
from crashpost.renders.groups import labels
from crashpost.renders.paint_plain import Painter
from crashpost.renders.painting import View
from crashpost.renders.section_lines import Section, lines, weights
from crashpost.renders.shapes import Dots, Drawing, Lines, Surface
from crashpost.renders.tasks import strip_task
from crashpost.results.result import Result
from crashpost.results.states import States

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A strip 1 m high and 0.1 m wide; the contact is at half its height, from the second state."""
    return drawn_run(tmp_path_factory.mktemp("close") / "x.results", None, (0.1, 1.0))


def test_a_window_lies_where_the_contact_acts(run: Path) -> None:
    scene = Scene(States(run), Appearance())
    seen = fitted(camera("side", np.array([0.0, 0, 1]), *np.eye(3)[:2]), scene.extent(0), 0.4, 9)
    window = close_ups.close_up(scene, "hit:20 mm", [0.0, 1.0, 2.0], [seen] * 3)
    assert window.width == pytest.approx(0.02)
    for own in window.cameras:
        # in the first state nothing touches: the window waits where it will
        assert own.middle == pytest.approx([0.0, 0.0, 0.5])
    left, bottom, width, height = window.frame(1)
    x, y, _ = seen.flat(window.cameras[1].middle[None])[0]
    assert (left + width / 2 - 0.5) * seen.width == pytest.approx(x)
    assert (bottom + height / 2 - 0.5) * 2 * seen.half_height == pytest.approx(y)
    # without a width it is as wide as the model is high, or a quarter of the picture
    assert close_ups.close_up(scene, "post", [0.0], [seen]).width <= 0.25 * seen.width * (1 + 1e-9)
    for text, words in {
        "hut": "unknown contact, body or part 'hut'; did you mean 'hit'",
        "hit:2": "such as 'buffers:1 m'",
        "hit:-2 m": "such as 'buffers:1 m'",
    }.items():
        with pytest.raises(PostError, match=words):
            close_ups.close_up(scene, text, [0.0], [seen])
    with pytest.raises(PostError, match="touches at none of these moments"):
        close_ups.close_up(scene, "hit", [0.0], [seen])


def test_close_ups_add_a_row_to_the_strip(run: Path, tmp_path: Path) -> None:
    heights = []
    for words in ({}, {"close_up": "hit"}):
        task = strip_task(Result(run), tmp_path / "x.png", ["0", "0.1", "0.2"], "", **words)
        painting.render_task(States(run), task, Painter, lambda done, total: None)
        from PIL import Image

        with Image.open(task.output) as image:
            heights.append(image.height)
    assert heights[1] > heights[0] + 0.5 * sheet.DPI


def area(surface: Surface) -> float:
    """Of all polygons, by triangles around their first corners."""
    total = 0.0
    for corners in surface.points[surface.corners]:
        for k in range(1, len(corners) - 1):
            one, other = corners[k] - corners[0], corners[k + 1] - corners[0]
            total += 0.5 * float(np.linalg.norm(np.cross(one, other)))
    return total


@pytest.mark.parametrize("edges", [True, False])
@pytest.mark.parametrize(
    ("text", "left"),
    [("x<0.25", 0.25), ("x > 250 mm", 0.75), ("y<1", 1.0), ("y<0", 0.0), ("z<1", 1.0)],
)
def test_a_cut_keeps_the_area_on_its_side(text: str, left: float, *, edges: bool) -> None:
    row = np.zeros(1, int)
    surface = Surface(SQUARE, np.array([[0, 1, 2, 3]]), ["#000000"], row, row, edges=edges)
    ends = np.array([[[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]]])
    drawing = Drawing([surface], [Lines(ends, "#000000")], [Dots(SQUARE)], [(SQUARE, SQUARE)])
    half = half_space(text)
    kept = cut(drawing, half)
    assert sum(map(area, kept.surfaces)) == pytest.approx(left)
    length = sum(float(np.linalg.norm(e[1] - e[0])) for one in kept.lines for e in one.ends)
    assert length == pytest.approx({"y<0": 0.0}.get(text, left))
    normal, offset = half
    for points in (kept.dots[0].points, kept.arrows[0][0], clamped(SQUARE, half)):
        assert np.all(points @ normal <= offset + 1e-12)


@pytest.mark.parametrize("text", ["w<0", "y=0", "y<1 kg", "y<--", "0<y"])
def test_a_cut_that_says_nothing_is_refused(text: str) -> None:
    with pytest.raises(PostError, match="write what is kept, such as"):
        half_space(text)


def test_a_section_crosses_its_elements_and_moves_with_them(run: Path) -> None:
    block = States(run).blocks["part_post"]
    level = Section("post", "middle", (0.0, 0.0, 0.52), (0.0, 0.0, 1.0))
    edges, shares = weights(block, level)
    crossings = lines(block.points, edges, shares)
    assert crossings.shape == (1, 2, 3) and crossings[..., 2] == pytest.approx(0.52)
    assert sorted(crossings[0, :, 0]) == pytest.approx([0.0, 0.1])
    # twice as far apart, the nodes have the section at twice the height
    assert lines(2 * block.points, edges, shares) == pytest.approx(2 * crossings)
    scene = Scene(States(run), Appearance(sections=(level,)))
    assert ("section cut", "#000000") in scene.legend()
    # a field has no colours of parts, and the section keeps its name
    coloured = Scene(States(run), Appearance(sections=(level,), color="plastic_strain"))
    assert coloured.legend() == [("section cut", "#000000")]
    drawn = [one.ends for one in scene.at(1).lines]
    # this state lies 10 mm further in all directions
    assert any(
        np.allclose(ends, crossings + 0.01) for ends in drawn if ends.shape == crossings.shape
    )


def test_names_are_shortened_to_what_groups_share() -> None:
    few = ["chassis", "wheel_front_left", "wheel_rear_left"]
    assert labels(few, 3) == few
    wheels = [f"wheel_{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
    assert labels(["chassis", *wheels, "arm_front_left", "arm_front_right"], 4) == [
        *("chassis", *["wheel"] * 4),
        *["arm_front"] * 2,
    ]
    # where the first words are one, more of them count; where none help, neighbours share one
    assert set(labels([f"car_{k}_{end}" for k in "12" for end in "ab"], 3)) == {"car_1", "car_2"}
    many = [f"body{k}" for k in range(9)]
    three = ["body0 to body2", "body3 to body5", "body6 to body8"]
    assert labels(many, 4) == [three[k // 3] for k in range(9)]
    pallets = [f"pallet_low_{k}" for k in range(4)]
    assert labels(pallets, 2) == [*["pallet_low_0 to 1"] * 2, *["pallet_low_2 to 3"] * 2]
    assert labels(many[:5], 4) == [*["body0 to body1"] * 2, *["body2 to body3"] * 2, "body4"]


def test_long_names_keep_what_distinguishes_them() -> None:
    names = ["upper_arm_front", "lower_arm_front", "upper_arm_rear"]
    assert len({sheet.fitted(name, 10) for name in names}) == 3
    assert all(len(sheet.fitted(name, 10)) == 10 for name in names)


def test_a_cut_that_leaves_nothing_is_refused(run: Path) -> None:
    task = strip_task(Result(run), run / "x.png", ["0", "end"], "", cut="z>1e9")
    scene = Scene(States(run), Appearance(cut="z>1e9"))
    with pytest.raises(PostError, match="no body or part reaches to z>1e9"):
        View(scene, task, [0.0, 1.0], [np.zeros(3)] * 2)
