"""What status.json says about a run, checked against the processes of this machine."""

import json
import os
import socket
from pathlib import Path
from typing import Any

UNKNOWN = {"state": "unknown"}


def read_status(path: Path) -> dict[str, Any]:
    """The entries of status.json; state "unknown" without one, "killed" for a run that vanished."""
    try:
        status = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return UNKNOWN
    if not isinstance(status, dict) or "state" not in status:
        return UNKNOWN
    here = status.get("host") == socket.gethostname()
    if status["state"] == "running" and here and not _alive(status.get("pid")):
        return {**status, "state": "killed", "message": "the process of this run is gone"}
    return status


def _alive(pid: object) -> bool:
    """Whether a process with this number exists; true when that cannot be told."""
    if not isinstance(pid, int) or pid <= 0:
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
