"""status.json: where a run stands, for the user, the queue and the post-processor."""

import json
import math
import os
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from crashsolve.output.files import Json, replace_text

# a thread may report how long something lasts; a second interrupt, that all is over
_writing = threading.RLock()
State = Literal["running", "finished", "stopped", "failed"]


@dataclass
class Status:
    """Status of a run; times in s, energy balance in %, `cpu_steps` the part of cpu in steps.

    `left` is the wall time the run still needs. What begins with `rejected` is known at the end.
    """

    state: State
    time: float
    cycle: int
    end_time: float
    step: float
    energy_balance: float
    cpu: float
    wall: float
    exit_code: int | None = None
    message: str = ""
    cpu_steps: float = 0.0
    step_set_by: str = ""
    left: float | None = None
    rejected: int = 0
    average_step: dict[str, float | None] = field(default_factory=dict)
    constraint_position: float = 0.0
    constraint_velocity: float = 0.0
    cpu_stages: dict[str, float] = field(default_factory=dict)
    real_time_factor: float | None = None
    watched: list[Json] = field(default_factory=list)
    untouched: list[str] = field(default_factory=list)
    below_floor: list[str] = field(default_factory=list)
    undeformed: list[str] = field(default_factory=list)
    undetermined: list[str] = field(default_factory=list)
    severity: list[str] = field(default_factory=list)
    unfiltered: list[str] = field(default_factory=list)
    deleted: dict[str, Json] = field(default_factory=dict)
    pid: int = field(default_factory=os.getpid)
    host: str = field(default_factory=lambda: os.uname().nodename)


def write_status(path: Path | str, status: Status) -> None:
    """Replace status.json; JSON has no NaN or infinity, such numbers become null."""
    text = json.dumps(_finite(vars(status)), indent=1) + "\n"
    with _writing:
        replace_text(Path(path), text)


def _finite(value: object) -> object:
    if isinstance(value, dict):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
