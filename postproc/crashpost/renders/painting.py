"""Strips and films of a run, painted in a child process: VTK may take its process with it.

The parent states the task (`Task`), looks up moments and follows the progress. Where the child
cannot paint, the parent reports the cause and the remedy, and matplotlib paints a plain picture
instead.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

import numpy as np

from crashpost.errors import PostError, memory_limit
from crashpost.renders import camera as cameras
from crashpost.renders import close_up as close_ups
from crashpost.renders.appearance import Appearance
from crashpost.renders.arrows import arrows_of, unit_length
from crashpost.renders.colour_scale import ColourScale
from crashpost.renders.drawing import Scene
from crashpost.renders.section_lines import Section
from crashpost.renders.shapes import Drawing
from crashpost.results.states import States
from crashsolve.channels.display import factor, readable

PACKAGES = "libgl1 libegl1 libgl1-mesa-dri libxrender1 libxext6"
INSTALL = "pip install 'crashsolve[render]'"
# of pictures in a strip; arrows of small close-ups are so many times as thick
NARROW, WIDEST = 0.45, 14.0
NEARER = 2.5
# of arrows, share of their length that lies along the line of sight, above which they are dots
HEAD_ON = 0.8
# height of the picture of a film at least, and of a film that is small [pixels]
LOWEST, SMALL = 16, 400
# arrows of less, in N or m/s, are round-off
NOTHING = 1e-9

if TYPE_CHECKING:
    import subprocess

    from crashpost.renders import paint_plain, paint_vtk
    from crashpost.renders.sheet import Key, Margins

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Task:
    """A strip (png, pdf, svg, ...) or film (mp4, gif) to be made."""

    output: str
    title: str
    frames: tuple[tuple[float, str], ...]  # number of the state, with a fraction; caption
    view: str = "auto"
    show: tuple[str, ...] = ()
    color: str = ""
    arrows: str = ""
    ghost: bool = True
    magnify: float = 1.0
    follow: str = ""
    close_up: str = ""  # of a strip
    cut: str = ""
    sections: tuple[Section, ...] = ()
    is_film: bool = False
    fps: float = 25.0
    speed: str = ""
    # of a film; where the height is 0 it is chosen by the visible parts
    size: tuple[int, int] = (960, 0)


def make(
    folder: Path, tasks: Sequence[Task], progress: Progress, print_line: Callable[[str], None]
) -> bool:
    """Make all; whether the pictures are those of pyvista. Raises PostError.

    What cannot be met, such as a colour that no block has, is found before a child is started.
    """
    states = States(folder)
    for task in tasks:
        scene = Scene(states, appearance_of(task))
        if task.follow:
            scene.position(0, task.follow)
        if task.close_up:
            close_ups.read(task.close_up)
        cameras.camera(task.view, states.up, np.zeros(3), np.ones(3))
    reason = _in_child(folder, tasks, progress)
    if not reason:
        return True
    print_line(reason)
    from crashpost.renders.paint_plain import Painter

    for task in tasks:
        render_task(states, task, Painter, progress)
    return False


def appearance_of(task: Task) -> Appearance:
    appearance = Appearance(task.show, task.color, task.arrows, task.ghost, task.magnify)
    return replace(appearance, cut=task.cut, sections=task.sections)


def render_task(
    states: States,
    task: Task,
    painter: type[paint_plain.Painter] | type[paint_vtk.Painter],
    progress: Progress,
) -> None:
    """Make one strip or film."""
    # matplotlib takes a quarter of a second, which a wrong word need not
    from crashpost.renders import sheet as compose
    from crashpost.renders import strip as strips

    scene = Scene(states, appearance_of(task))
    numbers = [number for number, _ in task.frames]
    shift = _shifts(scene, task)
    view = View(scene, task, numbers, shift)
    fitted_camera, arrow = view.camera((NARROW, WIDEST))
    key = compose.Key(
        fitted_camera,
        _colour_scale(scene, numbers),
        scene.legend(),
        arrow,
        scene.arrow_unit,
        view.largest if arrow else 0.0,
        scene.appearance.note,
    )
    captions = [caption for _, caption in task.frames]
    if task.is_film:
        size, position = _film_size(task, key)
        window = compose.film_window(size, position.below)
        aspect = window[2] / window[3]
        fitted_camera, arrow = view.camera((aspect, aspect))
        key = replace(key, camera=fitted_camera, arrow=arrow)
    sizes = compose.with_footer(compose.layout(captions, fitted_camera.aspect, task.title), key)
    width, height = window[2:] if task.is_film else sizes.pixels
    sheet = compose.Sheet(task.title, key, size, task.speed, position) if task.is_film else None
    placed = [_moved(fitted_camera, one) for one in shift]
    pictures = _painted(scene, task, placed, key, painter(width, height), progress)
    if sheet is None:
        content = strips.Content(task.title, captions, list(pictures))
        if task.close_up:
            close = close_ups.close_up(scene, task.close_up, numbers, placed)
            sizes = strips.with_close_ups(sizes, len(numbers))
            # an arrow is as long as in the pictures above
            share = close.width / sizes.closer[0] * sizes.panel[0] / fitted_camera.width
            nearer = replace(key, arrow=key.arrow * share)
            window = painter(*sizes.closer_pixels)
            alone = replace(task, ghost=False)
            closer = _painted(scene, alone, close.cameras, nearer, window, progress, NEARER)
            content = replace(content, close_up=close, closer=list(closer))
        strips.strip(Path(task.output), content, key, sizes)
    else:
        frames = (sheet.frame(p, c) for p, c in zip(pictures, captions, strict=True))
        from crashpost.renders.film_file import write_film

        write_film(Path(task.output), frames, task.fps, size)


def _painted(
    scene: Scene,
    task: Task,
    placed: Sequence[cameras.Camera],
    key: Key,
    plotter: paint_plain.Painter | paint_vtk.Painter,
    progress: Progress,
    thickness: float = 1.0,
) -> Iterator[np.ndarray]:
    """The pictures of a task, each from its camera; the painter is closed after the last."""
    start = scene.ghost() if task.ghost else Drawing()
    for k, ((number, _), camera) in enumerate(zip(task.frames, placed, strict=True)):
        drawing = scene.at(number)
        # the start would be hidden by what lies below it
        floors = drawing.take_floors()
        layers = [floors, start, drawing, arrows_of(drawing, camera, key.arrow, thickness)]
        yield plotter.paint(layers, camera, key.colour_scale)
        progress(k + 1, len(task.frames))
    plotter.close()


def _film_size(task: Task, key: Key) -> tuple[tuple[int, int], Margins]:
    """Width and height of a film [pixels], and the room below its picture."""
    from crashpost.renders import sheet as compose

    has_more = bool(key.colour_scale.name or key.names)
    least = compose.narrowest(has_arrows=bool(key.arrow_size), has_more=has_more)
    width = task.size[0]
    if not task.size[1]:
        aspect = key.camera.aspect
        width = compose.film_size(aspect, width, least)[0]
    elif width < least:
        raise PostError(f"--size: a film with arrows and a legend is {least} pixels wide or more")
    inches = width / compose.DPI
    # players lay their controls over the lower edge; who asks for a small film has no room there
    is_played = task.output.endswith(".mp4") and not 0 < task.size[1] < SMALL
    bottom_margin = compose.CONTROLS if is_played else 0.0
    below = key.footer(inches, inches) + bottom_margin
    position = compose.Margins(below, bottom_margin)
    if not task.size[1]:
        return compose.film_size(key.camera.aspect, task.size[0], least, below), position
    if task.size[1] < (compose.FILM_HEAD + below) * compose.DPI + LOWEST:
        raise PostError(f"--size: {task.size[1]} pixels of height leave none for the picture")
    return task.size, position


def _shifts(scene: Scene, task: Task) -> list[np.ndarray]:
    """Displacement of the followed object since the first picture [m]."""
    if not task.follow:
        return [np.zeros(3)] * len(task.frames)
    positions = [scene.position(number, task.follow) for number, _ in task.frames]
    return [position - positions[0] for position in positions]


def _moved(fitted_camera: cameras.Camera, shift: np.ndarray) -> cameras.Camera:
    return replace(fitted_camera, middle=fitted_camera.middle + shift)


class View:
    """Content that pictures at some states must show: points of the model, and arrows."""

    def __init__(
        self, scene: Scene, task: Task, numbers: Sequence[float], shift: Sequence[np.ndarray]
    ) -> None:
        self.scene, self.task = scene, task
        near = [scene.extent(number) - moved for number, moved in zip(numbers, shift, strict=True)]
        if task.ghost:
            near.append(scene.extent(0) - shift[0])
        points = np.concatenate(near)
        if not len(points) and task.cut:
            raise PostError(f"nothing to draw: no body or part reaches to {task.cut}")
        if not len(points) and "ground" in scene.drawn:
            points = scene.positions(0, "ground")
        if not len(points):
            raise PostError("nothing to draw: no body or part is shown")
        self.points = np.concatenate([points, scene.footprints(points)])
        scene.reach = self.points
        if task.follow:
            scene.reach = np.concatenate([self.points + moved for moved in shift])
        starts, vectors = [np.empty((0, 3))], [np.empty((0, 3))]
        for number, moved in zip(numbers, shift, strict=True):
            if task.arrows:
                at, along = scene.forces(number)
                starts.append(at - moved)
                vectors.append(along)
        self.starts, self.vectors = np.concatenate(starts), np.concatenate(vectors)
        self.largest = float(np.linalg.norm(self.vectors, axis=1).max(initial=0.0))

    def camera(self, limits: tuple[float, float]) -> tuple[cameras.Camera, float]:
        """The camera that holds all within limits of its aspect; length of arrows, m a unit."""
        up, view = self.scene.states.up, self.task.view
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        first = cameras.camera(view, up, low, high)
        if view == "auto" and self.scene.shells_are_edge_on(first.towards):
            first = cameras.camera("iso", up, low, high)
        if self.largest <= NOTHING:
            return cameras.fitted(first, self.points, *limits), 0.0
        if view == "auto" and _point_at_the_eye(self.vectors, first):
            first = cameras.camera("iso", up, low, high)
        arrow = unit_length(self.vectors, cameras.fitted(first, self.points, *limits))
        tips = self.starts + arrow * self.vectors
        return cameras.fitted(first, np.concatenate([self.points, tips]), *limits), arrow


def _point_at_the_eye(vectors: np.ndarray, fitted_camera: cameras.Camera) -> bool:
    """Whether arrows would look like dots."""
    sizes = np.linalg.norm(vectors, axis=1)
    return bool(np.abs(vectors @ fitted_camera.towards).sum() > HEAD_ON * sizes.sum())


def _colour_scale(scene: Scene, numbers: Sequence[float]) -> ColourScale:
    if not scene.appearance.color:
        return ColourScale()
    ranges = [scene.range(number) for number in sorted({int(number) for number in numbers})]
    low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
    return ColourScale.of(scene.appearance.color, scene.color_unit, low, high)


def _in_child(folder: Path, tasks: Sequence[Task], progress: Progress) -> str:
    """Paint by pyvista in a child process; returns why that failed.

    Raises PostError of the child.
    """
    job = json.dumps({"folder": str(folder), "tasks": [asdict(task) for task in tasks]})
    command = [sys.executable, "-m", "crashpost.renders.painting"]
    pipe = subprocess.PIPE
    with (
        TemporaryFile("w+") as errors,
        subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=errors, text=True) as child,
    ):
        assert child.stdin and child.stdout
        _send(child, job)
        failure = ""
        for line in child.stdout:
            word, _, rest = line.strip().partition(" ")
            if word == "frame":
                done, total = map(int, rest.split())
                progress(done, total)
            elif word == "error":
                failure = json.loads(rest)
        code = child.wait()
        errors.seek(0)
        words = errors.read().strip().splitlines()
    if failure:
        raise PostError(failure)
    return "" if code == 0 else _reason(code, words)


def _send(child: subprocess.Popen[str], job: str) -> None:
    try:
        assert child.stdin is not None
        child.stdin.write(job)
        child.stdin.close()
    except BrokenPipeError:
        # it ended before it read: its exit code states the cause
        return


def _reason(code: int, words: list[str]) -> str:
    last = words[-1] if words else ""
    if "ModuleNotFoundError" in last and "'" in last:
        return f"painted a simple picture, as {last.split(chr(39))[1]} is missing: {INSTALL}"
    if code > 0 and "libGL" not in last and "ImportError" not in last:
        return f"painted a simple picture, as pyvista could not paint it ({last or code})"
    died = f"died of {signal.Signals(-code).name}" if code < 0 else f"failed ({last})"
    if limit := memory_limit():
        return f"painted a simple picture, as VTK {died}; {limit}"
    return (
        f"painted a simple picture, as VTK {died}. It needs graphics libraries, "
        f"also without a screen: apt-get install {PACKAGES}"
    )


def clock(time: float, span: float, unit: str = "") -> str:
    """A time in a unit, or the one that suits a run: `t = 48.0 ms`."""
    unit = unit or readable("s", span)
    value, whole = time * factor("s", unit), span * factor("s", unit)
    digits = max(0, 3 - int(np.floor(np.log10(whole or 1.0))) - 1)
    return f"t = {value:.{digits}f} {unit}"


def main() -> int:
    """The child: paint the tasks of standard input, report the progress on standard output."""
    job = json.loads(sys.stdin.read())
    from crashpost.renders.paint_vtk import Painter

    def progress(done: int, total: int) -> None:
        print(f"frame {done} {total}", flush=True)

    try:
        states = States(Path(job["folder"]))
        for entry in job["tasks"]:
            frames = tuple((number, caption) for number, caption in entry.pop("frames"))
            entry |= {name: tuple(entry[name]) for name in ("show", "size")}
            entry["sections"] = tuple(Section(*one) for one in entry["sections"])
            render_task(states, Task(frames=frames, **entry), Painter, progress)
    except PostError as error:
        print(f"error {json.dumps(str(error))}", flush=True)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
