"""status.json: where a run stands, for the user, the queue and the post-processor."""

import json
import math
import os
import socket
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal

from crashsolve.output.files import replace_text

State = Literal["running", "finished", "stopped", "failed"]


@dataclass
class Status:
    """One look at a run; times in s, energy balance in %, `cpu_steps` the part of cpu in steps."""

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
    pid: int = field(default_factory=os.getpid)
    host: str = field(default_factory=socket.gethostname)


def write_status(path: Path | str, status: Status) -> None:
    """Replace status.json; JSON has no NaN or infinity, such numbers become null."""
    entries = {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in asdict(status).items()
    }
    replace_text(Path(path), json.dumps(entries, indent=1) + "\n")
