"""Claim: whatever stands in a deck or a result file, there is an answer or one clear error.

No traceback, no signal, nothing that takes 20 s. A small part belongs to the suite, the large one,
20,000 checks, 500 runs, 400 compiled ones and 1,000 looks at damaged results, to `make long`. Every
case follows from its seed (fuzz.py).
"""

import subprocess
import sys
from pathlib import Path

import pytest
from command import environment

SMALL = [("checks", 1, 20), ("runs", 2, 2), ("compiled", 4, 4), ("looks", 3, 3)]
LARGE = [("checks", seed, 2000) for seed in range(100, 110)]
LARGE += [("runs", seed, 50) for seed in range(200, 210)]
LARGE += [("compiled", seed, 100) for seed in range(400, 404)]
LARGE += [("looks", seed, 250) for seed in range(300, 304)]


@pytest.mark.parametrize(
    ("kind", "seed", "count"),
    [*SMALL, *(pytest.param(*case, marks=pytest.mark.long) for case in LARGE)],
)
def test_nothing_ends_in_a_traceback(kind: str, seed: int, count: int, tmp_path: Path) -> None:
    done = subprocess.run(
        [
            sys.executable,
            Path(__file__).parent / "fuzz.py",
            kind,
            *map(str, (seed, count, tmp_path)),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=environment(**({} if kind == "compiled" else {"CRASHSOLVE_PLAIN": "1"})),
    )
    assert done.returncode == 0, done.stdout[-6000:]
    assert done.stdout.endswith(f"{kind}: 0 faults in {count}\n")
