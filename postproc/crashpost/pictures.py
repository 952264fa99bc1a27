"""The commands `render`, `film` and `pack`: words turned into tasks for the studio."""

import argparse
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crashpost.errors import PostError
from crashpost.text import printable

if TYPE_CHECKING:
    from crashpost.result import Result
    from crashpost.states import States
    from crashpost.studio import Task

# of a film whose speed is not asked for
SECONDS = 4.0
FPS = 25.0
BAR = 40
# frames of a film at most: more is a slip of the keyboard
MOST_FRAMES = 20_000

# the look of who says nothing of it
UNSAID = {"view": "auto", "show": (), "color": "", "arrows": "", "follow": "", "ghost": True}

Add = Callable[[str, Callable[[argparse.Namespace], int], str], argparse.ArgumentParser]


def add_commands(add: Add) -> None:
    """Put `render`, `film` and `pack` among the commands."""
    sub = add("render", _render, "draw the run at some moments, side by side")
    sub.add_argument(
        "--at",
        default="",
        metavar="MOMENTS",
        help="0,50ms,end,max:CHANNEL,min:CHANNEL,abs_max:CHANNEL; those of the deck when absent",
    )
    sub.add_argument("--title", help="above the pictures; the deck's when absent")
    sub.add_argument("-o", "--output", type=Path, help="png, pdf or svg; default RESULT/strip.png")
    _add_look(sub)
    sub = add("film", _film, "film the run (mp4, gif), or write it as a page to turn it (html)")
    sub.add_argument("--slow", type=float, metavar="N", help="N times slower than it was")
    sub.add_argument("--fps", type=float, default=FPS, help=f"frames per second, {FPS:g}")
    sub.add_argument("--from", dest="start", default="start", metavar="MOMENT", help="first moment")
    sub.add_argument("--to", dest="end", default="end", metavar="MOMENT", help="last moment")
    sub.add_argument("--title", help="above the film; the deck's when absent")
    sub.add_argument("--size", default="960x540", metavar="WxH", help="of a frame, even numbers")
    sub.add_argument("-o", "--output", type=Path, help="mp4, gif or html; default RESULT/film.mp4")
    _add_look(sub)
    _add_pack(add)


def _add_pack(add: Add) -> None:
    sub = add("pack", _pack, "merge the states into one VTKHDF file for ParaView (5.12 and later)")
    sub.add_argument("-o", "--output", type=Path, help="default RESULT/states.vtkhdf")


def _pack(options: argparse.Namespace) -> int:
    from crashpost.pack import pack
    from crashpost.result import Result
    from crashpost.states import States

    folder = Result(options.result).folder
    output = options.output or folder / "states.vtkhdf"
    _known_ending(output, (".vtkhdf", ".hdf"))
    print(printable(pack(States(folder), output, _bar(output.name))))
    return 0


def _add_look(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--view",
        default="auto",
        help="side, front, rear, top, bottom, iso, or towards the eye as --view=1,-1,0.5",
    )
    sub.add_argument("--show", default="", metavar="NAMES", help="bodies and parts, with globs")
    sub.add_argument("--color", default="", metavar="FIELD", help="of the states: plastic_strain")
    sub.add_argument(
        "--arrows", default="", metavar="WHAT", help="rcforc, rcforc.CONTACT or velocity"
    )
    sub.add_argument(
        "--follow", default="", metavar="NAME", help="body or part that stays in place"
    )
    sub.add_argument("--no-ghost", action="store_true", help="without a shade of the start")


def _render(options: argparse.Namespace) -> int:
    from crashpost.moments import split
    from crashpost.result import Result
    from crashpost.studio import make

    result = Result(options.result)
    output = options.output or result.folder / "strip.png"
    _known_ending(output, (".png", ".pdf", ".svg", ".jpg"))
    at, look = split(options.at), _look(options)
    if not at and look == UNSAID | {"ghost": look["ghost"]}:
        at, look = _scene(result, look)
    task = strip_task(result, output, at, _title(result, options), **look)
    make(result.folder, [task], _bar(output.name), _tell)
    print(printable(str(output)))
    return 0


def _film(options: argparse.Namespace) -> int:
    from crashpost.result import Result

    result = Result(options.result)
    look = _look(options)
    if look == UNSAID | {"ghost": look["ghost"]}:
        _, look = _scene(result, look)
    output = options.output or result.folder / "film.mp4"
    _known_ending(output, (".mp4", ".gif", ".html"))
    if output.suffix == ".html":
        from crashpost.model_page import write_page

        print(printable(write_page(result, output, **look)))
        return 0
    from crashpost.reel import can_write_mp4
    from crashpost.studio import make

    if output.suffix == ".mp4" and not can_write_mp4():
        output = output.with_suffix(".gif")
        _tell("a gif, for imageio_ffmpeg is missing: pip install 'crashsolve[render]'")
    task = film_task(
        result,
        output,
        _title(result, options),
        fps=options.fps,
        slow=options.slow,
        span=(options.start, options.end),
        size=_size(options.size),
        **look,
    )
    make(result.folder, [task], _bar(output.name), _tell)
    print(printable(str(output)))
    return 0


def _scene(result: "Result", look: dict[str, Any]) -> tuple[list[str], dict[str, Any]]:
    """Moments and look of the deck's first scene, or of the default one."""
    from crashpost import sights
    from crashpost.states import States

    asked = sights.scenes_of(result.stored_json("report", dict))
    scene = asked[0] if asked else sights.default_scene(result, States(result.folder))
    return [str(word) for word in scene.get("at", [])], look | sights.look(scene)


def strip_task(result: "Result", output: Path, at: list[str], title: str, **look: Any) -> "Task":
    """Pictures at moments in words, each of the nearest state; raises PostError."""
    from crashpost.moments import moment
    from crashpost.states import States
    from crashpost.studio import Task, clock

    states = States(result.folder)
    first, last = float(states.times[0]), float(states.times[-1])
    words = at or [repr(first + k / 3 * (last - first)) for k in range(4)]
    frames = []
    for word in words:
        wanted = moment(result, word, last)
        number = _state_near(states, wanted.time, word)
        caption = clock(float(states.times[number]), last)
        frames.append((float(number), f"{caption}\n{wanted.why}" if wanted.why else caption))
    return Task(str(output), title, tuple(frames), **look)


def film_task(
    result: "Result",
    output: Path,
    title: str,
    *,
    fps: float = FPS,
    slow: float | None = None,
    span: tuple[str, str] = ("start", "end"),
    size: tuple[int, int] = (960, 540),
    **look: Any,
) -> "Task":
    """Frames over a span in words; raises PostError."""
    from crashpost.moments import moment
    from crashpost.states import States
    from crashpost.studio import Task, clock

    states = States(result.folder)
    last = float(states.times[-1])
    first, end = (moment(result, word, last).time for word in span)
    for time, word in zip((first, end), span, strict=True):
        _state_near(states, time, word)
    if not end > first:
        raise PostError(f"a film from {first:g} s to {end:g} s has no length")
    if not (math.isfinite(fps) and 0 < fps <= 120):
        raise PostError(f"--fps must be above 0 and at most 120, not {fps:g}")
    if slow is not None and not (math.isfinite(slow) and slow > 0):
        raise PostError(f"--slow must be positive, not {slow:g}")
    slow = slow or _round(SECONDS / (end - first))
    count = math.floor((end - first) * slow * fps) + 1
    if not 2 <= count <= MOST_FRAMES:
        raise PostError(
            f"{count} frames: --slow {slow:g} and --fps {fps:g} should make 2 to {MOST_FRAMES} "
            f"of {end - first:g} s"
        )
    frames = []
    for k in range(count):
        time = min(first + k / (fps * slow), end)
        frames.append((_number(states, time), clock(time, last)))
    pace = f"{slow:g} times slower" if slow > 1 else f"{1 / slow:g} times faster"
    speed = "as fast as it was" if slow == 1 else f"{pace} than it was"
    return Task(
        str(output), title, tuple(frames), is_film=True, fps=fps, speed=speed, size=size, **look
    )


def _state_near(states: "States", time: float, word: str) -> int:
    """Number of the state nearest to a time of the run; PostError for a time outside."""
    first, last = float(states.times[0]), float(states.times[-1])
    slack = 1e-9 * max(abs(first), abs(last), last - first)
    # between the last state and the end of the history no state lies
    spacing = (last - first) / max(len(states.times) - 1, 1)
    if not first - slack <= time <= last + slack + spacing:
        raise PostError(f"'{word}' is {time:g} s; there are states from {first:g} s to {last:g} s")
    return states.nearest(time)


def _number(states: "States", time: float) -> float:
    """Number of the state before a time, and the way from there to the next."""
    times = states.times
    after = int((times <= time).sum())
    if after == 0 or after == len(times):
        return float(max(after - 1, 0))
    before = times[after - 1]
    return float(after - 1 + (time - before) / (times[after] - before))


def _round(value: float) -> float:
    """The nearest of 1, 2, 3, 5 or 10 times a power of ten, below or at a value."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{max(s * power for s in (1, 2, 3, 5) if s * power <= value * (1 + 1e-9)):.6g}")


def _look(options: argparse.Namespace) -> dict[str, Any]:
    return {
        "view": options.view,
        "show": tuple(word.strip() for word in options.show.split(",") if word.strip()),
        "color": options.color,
        "arrows": options.arrows,
        "follow": options.follow,
        "ghost": not options.no_ghost,
    }


def _title(result: "Result", options: argparse.Namespace) -> str:
    title: str | None = options.title
    return result.title if title is None else title


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = map(int, text.lower().split("x"))
    except ValueError:
        raise PostError(f"--size takes WIDTHxHEIGHT in pixels, not '{text}'") from None
    if not (480 <= width <= 3840 and 270 <= height <= 2160 and width % 2 == height % 2 == 0):
        raise PostError(f"--size {text}: even numbers from 480x270 to 3840x2160")
    return width, height


def _known_ending(path: Path, endings: tuple[str, ...]) -> None:
    if path.suffix not in endings:
        raise PostError(f"{path}: must end in {', '.join(endings)}")
    if not path.absolute().parent.is_dir():
        raise PostError(f"{path}: no such folder")


def _tell(text: str) -> None:
    print(printable(f"crashpost: {text}"), file=sys.stderr)


def _bar(name: str) -> Callable[[int, int], None]:
    """A bar that grows on a terminal; nothing elsewhere."""

    def grow(done: int, total: int) -> None:
        if sys.stderr.isatty():
            full = BAR * done // total
            print(f"\r{name} |{'=' * full:{BAR}}| {done}/{total}", end="", file=sys.stderr)
            if done == total:
                print(file=sys.stderr)

    return grow
