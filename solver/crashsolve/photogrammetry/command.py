"""The command `crashsolve posture`: from pictures to the card of a posture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from crashsolve.channels.command_line import output_path
from crashsolve.foundation.errors import DeckError, DeckErrors, ExitCode
from crashsolve.foundation.streams import printable

if TYPE_CHECKING:
    from crashsolve.photogrammetry.points import Measured
    from crashsolve.photogrammetry.request import Requested


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the words of the command."""
    parser.set_defaults(act=_act)
    parser.add_argument(
        "request", type=Path, help="request (YAML), see crashsolve manual theory/posture"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output_path,
        metavar="DIR",
        help="results folder; default REQUEST.posture",
    )


def _act(options: argparse.Namespace) -> int:
    try:
        import scipy  # noqa: F401
    except ImportError:
        advice = "pip install 'crashsolve[signal]'"
        raise DeckError("posture", None, None, "", "needs scipy", advice) from None
    name = options.request.name.removesuffix(".yaml").removesuffix(".posture")
    folder = options.output or Path(f"{name}.posture")
    for line in posture(options.request, folder):
        print(printable(line))
    return int(ExitCode.NORMAL)


def posture(path: Path, folder: Path) -> list[str]:
    """Fit a posture and write its files; returns its report. Raises DeckErrors."""
    from crashsolve.photogrammetry import report
    from crashsolve.photogrammetry.chain_fit import FitError
    from crashsolve.photogrammetry.motion import rates
    from crashsolve.photogrammetry.occupant import chain_of
    from crashsolve.photogrammetry.points import measured
    from crashsolve.photogrammetry.request import read_request
    from crashsolve.photogrammetry.segments import fitted

    requested = read_request(path)
    chain, scene = chain_of(requested)
    measurements = measured(requested)
    fits = fitted(requested, chain, measurements)
    at = _start(requested, measurements)
    try:
        moving = rates(chain, fits, at, requested.card.window)
    except FitError as error:
        raise DeckErrors([requested.error(("window",), str(error), error.advice)]) from None
    files = {
        "posture.yaml": report.card(requested, chain, scene.offset[chain.root], fits[at], moving),
        "points.csv": report.points_table(measurements),
        "joints.csv": report.joints_table(chain, fits),
    }
    lines = report.summary(requested, chain, measurements, fits, moving).splitlines()
    return [*lines, "", *(str(written) for written in report.write(folder, files))]


def _start(requested: Requested, frames: Measured) -> int:
    """The frame at the start. Raises DeckErrors."""
    times = [frame.time for frame in frames.frames]
    if requested.card.start is None:
        return 0
    if requested.card.start not in times:
        near = min(times, key=lambda time: abs(time - requested.card.start))
        message = f"there is no frame at {requested.card.start:.6g} s"
        advice = f"{len(times)} frames from {times[0]:.6g} to {times[-1]:.6g} s, next {near:.6g} s"
        raise DeckErrors([requested.error(("start",), message, advice)])
    return times.index(requested.card.start)
