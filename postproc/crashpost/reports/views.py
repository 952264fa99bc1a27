"""What the report shows of a run: its scenes as pictures, a film, and the run to turn in 3-D.

The deck asks for scenes under `output: report: scenes:`; without any, four moments are shown, with
contact forces where there are contacts and plastic strain where something yields.
"""

from __future__ import annotations

import base64
import sys
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from crashpost.errors import PostError, unknown
from crashpost.figures.page import details, escape
from crashpost.results.moments import moment, strongest_contact
from crashpost.results.result import Result
from crashpost.results.states import States
from crashpost.results.status import Json

if TYPE_CHECKING:
    from crashpost.renders.painting import Task

CHOICES = ("all", "strips", "none")
WORDS = ("view", "color", "arrows", "follow", "close_up", "cut")
FIELDS = ("title", "at", "show", "magnify", *WORDS)
# of the film [pixels], its height as the scene asks; a page needs no full size
SIZE = (720, 0)
# the run in 3-D is left out where even two states would take this much [numbers]
MAX_POINTS = 1_000_000


def views(
    result: Result, described: object, choice: str = "all", time_unit: str = ""
) -> tuple[str, str]:
    """The HTML of all pictures, times in this unit, and why there is no film where it failed; ""
    for a run without states. Raises PostError.
    """
    if choice == "none" or not any((result.folder / "states").glob("[0-9]*.h5")):
        return "", ""
    states = States(result.folder)
    if choice not in CHOICES:
        raise unknown("choice of pictures", choice, CHOICES)
    scenes = scenes_of(described) or [default_scene(result, states)]
    with TemporaryDirectory() as folder:
        with_film = choice == "all" and _moves(states)
        tasks = _tasks(result, Path(folder), scenes, time_unit, with_film=with_film)
        tasks, problem = _made(result, tasks, with_film=with_film)
        parts = [_embedded(Path(task.output), task.title) for task in tasks]
    if choice == "all" and _moves(states):
        parts.append(_rotated(result, states, scenes[0]))
    return "".join(parts), problem


def _made(result: Result, tasks: list[Task], *, with_film: bool) -> tuple[list[Task], str]:
    """The tasks that were painted, and why the film at their end was not; raises PostError."""
    from crashpost.renders.painting import make

    try:
        make(result.folder, tasks, lambda done, total: None, _report)
    except PostError as reason:
        if not with_film:
            raise
        make(result.folder, tasks[:-1], lambda done, total: None, _report)
        # without the folder that is gone
        return tasks[:-1], str(reason).replace(f"{Path(tasks[-1].output).parent}/", "")
    return tasks, ""


def scenes_of(described: Any) -> list[Json]:
    """The scenes of a result's `report` attribute; raises PostError for any other content."""
    entries = (described or {}).get("scenes") or []
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise PostError("the report's scenes must be a list of fields")
    for entry in entries:
        for name in entry:
            if name not in FIELDS:
                raise unknown("field", str(name), FIELDS, whole="scene")
        texts = [entry.get(name, "") for name in ("title", *WORDS)]
        lists = [entry.get(name, []) for name in ("at", "show")]
        check_magnify(entry.get("magnify", 1.0))
        if not all(isinstance(t, str) for t in texts) or not all(
            isinstance(x, list) for x in lists
        ):
            raise PostError(f"scene '{entry.get('title', '')}': texts and lists do not fit")
    return entries


def default_scene(result: Result, states: States) -> Json:
    """Four moments of the run, one of them that of the largest contact force."""
    first, last = float(states.times[0]), float(states.times[-1])
    at: list[float | str] = [first + k / 3 * (last - first) for k in range(4)]
    defaults: Json = {"title": "The run", "at": at}
    if "contacts" in states.blocks:
        defaults["arrows"] = "rcforc"
        strongest = strongest_contact(result)
        if strongest:
            at[1] = f"max:{strongest}"
            # moments in order, without two of one state
            defaults["at"] = _in_order(result, states, at)
    fields = {field for block in states.blocks for field in states.fields(block)}
    if any(field.startswith("plastic_strain") for field in fields):
        defaults["color"] = "plastic_strain"
    return defaults


def reached(result: Result, scene: Json) -> list[str]:
    """The moments of a scene; the end in place of those that a run which ended before has not."""
    at, last = [str(word) for word in scene.get("at", [])], float(States(result.folder).times[-1])
    end = float(result.time[-1]) if len(result.time) else last
    shown = [word if moment(result, word, last).time <= max(end, last) else "end" for word in at]
    return [word for k, word in enumerate(shown) if word != "end" or word not in shown[:k]]


def _in_order(result: Result, states: States, at: Sequence[object]) -> list[object]:
    last = float(states.times[-1])
    numbers = {states.nearest(moment(result, str(word), last).time): word for word in at[::-1]}
    return [numbers[number] for number in sorted(numbers)]


def _tasks(
    result: Result, folder: Path, scenes: Sequence[Json], time_unit: str, *, with_film: bool
) -> list[Task]:
    from crashpost.renders.film_file import can_write_mp4
    from crashpost.renders.tasks import film_task, strip_task

    tasks = []
    for k, scene in enumerate(scenes):
        at = reached(result, scene)
        title = scene.get("title", "")
        words = appearance(scene) | {"time_unit": time_unit}
        tasks.append(strip_task(result, folder / f"{k}.png", at, title, **words))
    if with_film:
        name = "film.mp4" if can_write_mp4() else "film.gif"
        fitted_camera = {
            word: value for word, value in appearance(scenes[0]).items() if word != "close_up"
        }
        tasks.append(
            film_task(result, folder / name, "", size=SIZE, time_unit=time_unit, **fitted_camera)
        )
    return tasks


def appearance(scene: Json) -> Json:
    """Fields of a scene for the camera and colours."""
    words = {name: scene[name] for name in WORDS if scene.get(name)}
    if scene.get("magnify", 1.0) != 1.0:
        words["magnify"] = float(scene["magnify"])
    return {"show": tuple(scene.get("show") or ()), **words}


def check_magnify(value: object) -> None:
    """Raises PostError for a value that is no factor of displacements."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not (isfinite(value) and value > 0):
        raise PostError(f"magnify must be a positive number, not {value}")


def _moves(states: States) -> bool:
    return len(states.times) > 2


def _embedded(path: Path, title: str) -> str:
    """A picture or film within the page."""
    data = base64.b64encode(path.read_bytes()).decode()
    if path.suffix == ".mp4":
        return (
            '<video class="sight" controls loop muted playsinline '
            f'src="data:video/mp4;base64,{data}"></video>'
        )
    kind = path.suffix.removeprefix(".")
    words = escape(title or "Film of the run")
    return f'<img class="sight" alt="{words}" src="data:image/{kind};base64,{data}">'


def _rotated(result: Result, states: States, scene: Json) -> str:
    """The run in 3-D, which a browser loads when it is unfolded; nothing without k3d."""
    from importlib.util import find_spec

    if find_spec("k3d") is None:
        return ""
    if sum(3 * len(block.points) for block in states.blocks.values()) > MAX_POINTS:
        return ""
    from crashpost.renders.model_page import page

    # to be turned by hand: seen from a corner, however the pictures look at it
    fixed = ("follow", "close_up", "cut")
    fitted_camera = {k: v for k, v in appearance(scene).items() if k not in fixed} | {
        "view": "auto"
    }
    text, words = page(result, **fitted_camera)
    frame = f'<iframe class="turn" loading="lazy" title="3-D" srcdoc="{escape(text)}"></iframe>'
    return details(f"Rotate it in 3-D ({words})", frame)


def _report(text: str) -> None:
    print(f"crashpost: {text}", file=sys.stderr)
