"""Words of `render` and `film` turned into tasks for the painting."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crashpost.errors import PostError

if TYPE_CHECKING:
    from crashpost.renders.painting import Task
    from crashpost.results.result import Result
    from crashpost.results.states import States

# of a film whose speed is not asked for
SECONDS = 4.0
FPS = 25.0
# of the duration of a run: a state at an event lies up to a step or two beside it
STEP = 1e-4
# frames of a film at most: more is a slip of the keyboard
MAX_FRAMES = 20_000


def strip_task(
    result: "Result",
    output: Path,
    at: list[str],
    title: str,
    *,
    time_unit: str = "",
    **appearance: Any,
) -> "Task":
    """Pictures at moments in words, each of the nearest state; raises PostError.

    Times are in `time_unit`, or in one that suits the run.
    """
    from crashpost.renders.painting import Task, clock
    from crashpost.renders.section_lines import sections
    from crashpost.results.moments import moment
    from crashpost.results.states import States

    states = States(result.folder)
    first, last = float(states.times[0]), float(states.times[-1])
    words = at or [repr(first + k / 3 * (last - first)) for k in range(4)]
    frames = []
    for word in words:
        wanted = moment(result, word, last)
        number = _state_near(states, wanted.time, word)
        if not at and frames and frames[-1][0] == number:
            # few states: none is drawn twice
            continue
        caption = clock(float(states.times[number]), last, time_unit)
        if wanted.reason:
            caption += f"\n{wanted.reason}"
            caption += _beside(float(states.times[number]) - wanted.time, last, time_unit)
        frames.append((float(number), caption))
    return Task(str(output), title, tuple(frames), sections=sections(result), **appearance)


def _beside(lead: float, span: float, time_unit: str) -> str:
    """How far a state lies from the moment that it shows, as a line; "" within STEP of it."""
    from crashpost.renders.painting import clock

    if abs(lead) <= STEP * span:
        return ""
    distance = clock(abs(lead), span, time_unit)
    if distance == clock(0.0, span, time_unit):
        # a contact may be shorter than the last digit of the run's time
        distance = clock(abs(lead), abs(lead))
    distance = distance.removeprefix("t = ")
    return f"\nis {distance} {'earlier' if lead > 0 else 'later'}"


def film_task(
    result: "Result",
    output: Path,
    title: str,
    *,
    fps: float = FPS,
    slow: float | None = None,
    span: tuple[str, str] = ("start", "end"),
    size: tuple[int, int] = (960, 0),
    time_unit: str = "",
    **appearance: Any,
) -> "Task":
    """Frames over a span in words; raises PostError."""
    from crashpost.renders.painting import Task, clock
    from crashpost.renders.section_lines import sections
    from crashpost.results.moments import moment
    from crashpost.results.states import States

    states = States(result.folder)
    last = float(states.times[-1])
    # a run without samples yet has states
    known = {"start": float(states.times[0]), "end": last}
    first, end = (
        known[word] if word in known else moment(result, word, last).time for word in span
    )
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
    if not 2 <= count <= MAX_FRAMES:
        raise PostError(
            f"{count} frames: --slow {slow:g} and --fps {fps:g} should make 2 to {MAX_FRAMES} "
            f"of {end - first:g} s"
        )
    frames = []
    for k in range(count):
        time = min(first + k / (fps * slow), end)
        frames.append((_number(states, time), clock(time, last, time_unit)))
    if str(appearance.get("arrows", "")).startswith("rcforc"):
        _show_peak(result, states, frames, (first, fps * slow), time_unit)
    pace = f"{slow:g} times slower" if slow > 1 else f"{1 / slow:g} times faster"
    speed = "as fast as it was" if slow == 1 else f"{pace} than it was"
    film: dict[str, Any] = {"is_film": True, "fps": fps, "speed": speed, "size": size}
    return Task(str(output), title, tuple(frames), sections=sections(result), **film, **appearance)


def _show_peak(
    result: "Result",
    states: "States",
    frames: list[tuple[float, str]],
    pace: tuple[float, float],
    time_unit: str,
) -> None:
    """Let the frame nearest to the largest contact force be its state, not one beside it.

    `pace` has the time of the first frame [s] and their number for each second of the run.
    """
    from crashpost.renders.painting import clock
    from crashpost.results.moments import moment, strongest_contact

    contact = strongest_contact(result)
    if not contact:
        return
    last = float(states.times[-1])
    number = states.nearest(moment(result, f"max:{contact}", last).time)
    time = float(states.times[number])
    nearest = round((time - pace[0]) * pace[1])
    if 0 <= nearest < len(frames):
        frames[nearest] = float(number), clock(time, last, time_unit)


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
    """Number of the state before a time, and the fraction of the interval to the next."""
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
