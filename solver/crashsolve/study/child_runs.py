"""Ordinary runs in processes of their own, and the results in their folders: for studies and
sweeps.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import IO

from crashsolve.deck.run_cards.control import CORES_GIVEN
from crashsolve.output.files import Json


def start(
    deck: Path,
    folder: Path,
    overrides: Mapping[str, str],
    restart: bool,
    errors: int | IO[str],
    jobs: int,
) -> subprocess.Popen[str]:
    """Start a run, one of `jobs` at a time; its standard error goes to the file `errors`."""
    words = [word for name, value in overrides.items() for word in ("--set", f"{name}={value}")]
    words += ["--restart"] * restart
    return subprocess.Popen(
        [sys.executable, "-m", "crashsolve", "run", str(deck), "-o", str(folder), *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=errors,
        text=True,
        errors="replace",
        # runs side by side share the cores that a job was given
        env=os.environ | ({CORES_GIVEN: "1"} if jobs > 1 else {}),
    )


def status_of(folder: Path) -> Json:
    """status.json of a run; empty when there is none."""
    return table_in(folder / "status.json")


def table_in(path: Path) -> Json:
    """The table in a JSON file; empty when there is none."""
    try:
        content = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def reason(code: int, message: str, errors: str) -> str:
    """Reason why a run ended with a code: the message of its status, its last line of errors, or
    the signal.
    """
    if code < 0:
        return f"killed by signal {-code}"
    return message or next(iter(reversed(errors.strip().splitlines())), "")


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
