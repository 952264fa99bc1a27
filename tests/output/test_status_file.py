"""status.json."""

import json
import os
from pathlib import Path

from crashsolve.output.status import Status, write_status


def test_status_is_valid_json_even_when_the_solution_is_not_finite(tmp_path: Path) -> None:
    path = tmp_path / "status.json"
    status = Status(
        state="failed",
        time=0.25,
        cycle=1000,
        end_time=1.0,
        step=1e-4,
        energy_balance=float("nan"),
        cpu=2.5,
        wall=3.0,
        exit_code=4,
        message="velocity of wagon_a is not finite",
    )
    write_status(path, status)
    entries = json.loads(path.read_text(), parse_constant=lambda word: word)
    assert entries["energy_balance"] is None
    assert (entries["state"], entries["time"], entries["exit_code"]) == ("failed", 0.25, 4)
    assert entries["pid"] == os.getpid()
    assert entries["host"]
    assert os.listdir(tmp_path) == ["status.json"]
