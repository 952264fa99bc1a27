"""The commands `render`, `film` and `pack`: words turned into tasks for the painting."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from crashpost.errors import PostError
from crashpost.renders.tasks import FPS
from crashpost.results.status import Json
from crashpost.results.text import printable
from crashsolve.channels.command_line import output_path

if TYPE_CHECKING:
    from crashpost.results.result import Result

BAR = 40

# the default appearance
DEFAULTS = {
    "view": "auto",
    "show": (),
    "color": "",
    "arrows": "",
    "follow": "",
    "magnify": 1.0,
    "close_up": "",
    "cut": "",
    "ghost": True,
}

Add = Callable[[str, Callable[[argparse.Namespace], int], str], argparse.ArgumentParser]


def add_commands(add: Add) -> None:
    """Put `render`, `film` and `pack` among the commands."""
    sub = add("render", _render, "draw pictures of the run at some moments, side by side")
    sub.add_argument(
        "--at",
        default="",
        metavar="MOMENTS",
        help="0,50ms,end,max:CHANNEL,min:CHANNEL,abs_max:CHANNEL; those of the deck when absent",
    )
    sub.add_argument("--title", help="above the pictures; the deck's when absent")
    sub.add_argument(
        "--close-up",
        default="",
        metavar="NAME[:WIDTH]",
        help="a second row of pictures, close to a contact, body or part: 'buffers:1 m'",
    )
    sub.add_argument(
        "-o", "--output", type=output_path, help="png, pdf or svg; default RESULT/strip.png"
    )
    _add_appearance(sub)
    sub = add(
        "film", _film, "film the run (mp4, gif), or write it as an interactive 3-D page (html)"
    )
    sub.add_argument("--slow", type=float, metavar="N", help="N times slower than real time")
    sub.add_argument("--fps", type=float, default=FPS, help=f"frames per second, {FPS:g}")
    sub.add_argument("--from", dest="start", default="start", metavar="MOMENT", help="first moment")
    sub.add_argument("--to", dest="end", default="end", metavar="MOMENT", help="last moment")
    sub.add_argument("--title", help="above the film; the deck's when absent")
    sub.add_argument(
        "--size", metavar="WxH", help="of a frame, even numbers; 960 wide, or fitted, when absent"
    )
    sub.add_argument(
        "-o", "--output", type=output_path, help="mp4, gif or html; default RESULT/film.mp4"
    )
    _add_appearance(sub)
    _add_pack(add)


def _add_pack(add: Add) -> None:
    sub = add("pack", _pack, "merge the states into one VTKHDF file for ParaView (5.12 and later)")
    sub.add_argument("-o", "--output", type=output_path, help="default RESULT/states.vtkhdf")


def _pack(options: argparse.Namespace) -> int:
    from crashpost.exports.pack import pack
    from crashpost.results.result import Result
    from crashpost.results.states import States

    folder = Result(options.result).folder
    output = options.output or folder / "states.vtkhdf"
    _known_ending(output, (".vtkhdf", ".hdf"))
    print(printable(pack(States(folder), output, _bar(output.name))))
    return 0


def _add_appearance(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--view",
        default="auto",
        help="side, front, rear, top, bottom, iso, or towards the eye as --view=1,-1,0.5",
    )
    about = "bodies and parts, with globs; the words springs and belts"
    sub.add_argument("--show", default="", metavar="NAMES", help=about)
    sub.add_argument("--color", default="", metavar="FIELD", help="of the states: plastic_strain")
    sub.add_argument(
        "--arrows", default="", metavar="WHAT", help="rcforc, rcforc.CONTACT or velocity"
    )
    sub.add_argument(
        "--follow", default="", metavar="NAME", help="body or part that stays in place"
    )
    sub.add_argument(
        "--magnify",
        type=float,
        default=1.0,
        metavar="N",
        help="draw small displacements N times as large; the picture says so",
    )
    sub.add_argument(
        "--cut", default="", metavar="WHERE", help="a sectional view: draw only where y<0, or x>1"
    )
    sub.add_argument("--no-ghost", action="store_true", help="without a shade of the start")


def _render(options: argparse.Namespace) -> int:
    from crashpost.renders.painting import make
    from crashpost.renders.tasks import strip_task
    from crashpost.results.moments import split
    from crashpost.results.result import Result

    result = Result(options.result)
    output = options.output or result.folder / "strip.png"
    _known_ending(output, (".png", ".pdf", ".svg", ".jpg"))
    at, appearance = split(options.at), _look(options)
    if not at and appearance == DEFAULTS | {"ghost": appearance["ghost"]}:
        at, appearance = _scene(result, appearance)
    task = strip_task(result, output, at, _title(result, options), **appearance)
    make(result.folder, [task], _bar(output.name), _report)
    print(printable(str(output)))
    return 0


def _film(options: argparse.Namespace) -> int:
    from crashpost.results.result import Result

    result = Result(options.result)
    appearance = _look(options)
    is_default = appearance == DEFAULTS | {"ghost": appearance["ghost"]}
    if is_default:
        _, appearance = _scene(result, appearance)
    appearance.pop("close_up")
    output = options.output or result.folder / "film.mp4"
    _known_ending(output, (".mp4", ".gif", ".html"))
    if output.suffix == ".html":
        if is_default:
            # to be turned by hand: seen from a corner, however the pictures look at it
            appearance |= {"view": "auto", "cut": ""}
        elif appearance["cut"]:
            raise PostError("--cut is for pictures and films; a page is turned to look inside")
        from crashpost.renders.model_page import write_page

        print(printable(write_page(result, output, **appearance)))
        return 0
    from crashpost.renders.film_file import can_write_mp4
    from crashpost.renders.painting import make
    from crashpost.renders.tasks import film_task

    if output.suffix == ".mp4" and not can_write_mp4():
        if options.output:
            raise PostError(
                f"{output}: imageio_ffmpeg, which writes mp4, is missing or does not work: "
                "pip install 'crashsolve[render]', or name a .gif"
            )
        output = output.with_suffix(".gif")
        _report(
            f"writing {output.name}, as imageio_ffmpeg is missing or does not work: "
            "pip install 'crashsolve[render]'"
        )
    task = film_task(
        result,
        output,
        _title(result, options),
        fps=options.fps,
        slow=options.slow,
        span=(options.start, options.end),
        size=_size(options.size),
        **appearance,
    )
    make(result.folder, [task], _bar(output.name), _report)
    print(printable(str(output)))
    return 0


def _scene(result: "Result", appearance: Json) -> tuple[list[str], Json]:
    """Moments and look of the deck's first scene, or of the default one."""
    from crashpost.reports import views
    from crashpost.results.states import States

    requested = views.scenes_of(result.stored_json("report", dict))
    scene = requested[0] if requested else views.default_scene(result, States(result.folder))
    return views.reached(result, scene), appearance | views.appearance(scene)


def _look(options: argparse.Namespace) -> Json:
    from crashpost.reports.views import check_magnify

    check_magnify(options.magnify)
    return {
        "view": options.view,
        "show": tuple(word.strip() for word in options.show.split(",") if word.strip()),
        "color": options.color,
        "arrows": options.arrows,
        "follow": options.follow,
        "magnify": options.magnify,
        "close_up": getattr(options, "close_up", ""),
        "cut": options.cut,
        "ghost": not options.no_ghost,
    }


def _title(result: "Result", options: argparse.Namespace) -> str:
    title: str | None = options.title
    return result.title if title is None else title


def _size(text: str | None) -> tuple[int, int]:
    if text is None:
        return (960, 0)
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


def _report(text: str) -> None:
    print(printable(f"crashpost: {text}"), file=sys.stderr)


def _bar(name: str) -> Callable[[int, int], None]:
    """A progress bar on a terminal; none elsewhere."""

    def grow(done: int, total: int) -> None:
        if sys.stderr.isatty():
            full = BAR * done // total
            print(f"\r{name} |{'=' * full:{BAR}}| {done}/{total}", end="", file=sys.stderr)
            if done == total:
                print(file=sys.stderr)

    return grow
