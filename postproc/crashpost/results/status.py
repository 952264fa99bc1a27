"""State of a run in status.json, checked against the processes of this machine.

An entry of another kind than FILE_FORMAT.md has it is as good as absent.
"""

import json
import math
import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

from crashpost.results.text import plain_text

# a table of a JSON file
Json = dict[str, Any]

UNKNOWN = {"state": "unknown"}
# the largest number of a process
MAX_PID = 2**31 - 1


def read_status(path: Path) -> Json:
    """The entries of status.json; state "unknown" without one, "killed" for a run that vanished."""
    try:
        content = json.loads(plain_text(path) or "")
    except (ValueError, RecursionError):
        return UNKNOWN
    if not isinstance(content, dict) or not isinstance(content.get("state"), str):
        return UNKNOWN
    status = {name: part for name, part in content.items() if KINDS.get(name, _any)(part)}
    is_local = status.get("host") == socket.gethostname()
    if status["state"] == "running" and is_local and not _alive(status.get("pid")):
        return {**status, "state": "killed", "message": "the process of this run is gone"}
    return status


def unfinished(status: Json) -> str:
    """Remark beside numbers and pictures of a run that did not end; "" of one that did."""
    state = status["state"]
    if state in ("finished", "unknown"):
        return ""
    time = status.get("time")
    until = "" if time is None else f" at t = {time:g} s"
    return f"the run is not finished ({state}{until}): these are its results so far"


def _alive(pid: object) -> bool:
    """Whether a process with this number exists; true when that cannot be determined."""
    if not isinstance(pid, int) or not 0 < pid <= MAX_PID:
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _any(_: object) -> bool:
    return True


def _text(part: object) -> bool:
    return isinstance(part, str)


def _number(part: object) -> bool:
    if isinstance(part, bool) or not isinstance(part, int | float):
        return False
    # a whole number may have more digits than a float holds
    return abs(part) < 1e300 and math.isfinite(part)


def _maybe_number(part: object) -> bool:
    return part is None or _number(part)


def _numbers(part: object) -> bool:
    return isinstance(part, dict) and all(map(_maybe_number, part.values()))


def _watched(part: object) -> bool:
    return isinstance(part, list) and all(map(_entry, part))


def _entry(part: object) -> bool:
    """Whether this is a watched channel with its estimate."""
    return isinstance(part, dict) and all(
        known(part[name]) for name, known in ENTRY.items() if part.get(name) is not None
    )


def _window(part: object) -> bool:
    return isinstance(part, list) and (not part or len(part) == 2 and all(map(_number, part)))


Known = Callable[[object], bool]
ENTRY: dict[str, Known] = {
    **dict.fromkeys(("channel", "statistic", "unit", "how"), _text),
    **dict.fromkeys(("value", "error", "scale"), _number),
    "during": _window,
}
KINDS: dict[str, Known] = {
    **dict.fromkeys(("state", "message", "host"), _text),
    **dict.fromkeys(("time", "end_time", "step", "energy_balance", "cpu", "wall"), _maybe_number),
    **dict.fromkeys(("cycle", "rejected", "cpu_steps", "real_time_factor"), _maybe_number),
    **dict.fromkeys(("constraint_position", "constraint_velocity", "exit_code"), _maybe_number),
    **dict.fromkeys(("average_step", "cpu_stages"), _numbers),
    "watched": _watched,
}
