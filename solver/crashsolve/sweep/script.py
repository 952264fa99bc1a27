"""A job array for Slurm, as a script that a user can read and change.

Each task is one run of the sweep. A task that reaches the end of its time gets SIGUSR1, stops its
run with a dump, is requeued, and continues from the dump. One that is cancelled gets SIGTERM, stops
with a dump as well, and is not requeued.
"""

import shlex
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from crashsolve.foundation.errors import DeckError
from crashsolve.output.errors import OutputError
from crashsolve.output.files import replace_text

NAME = "sweep.sbatch"
TEXT = """#!/bin/bash
# the runs of a sweep that were left when this was written: {folder}
#SBATCH --job-name={job}
#SBATCH --array={array}
#SBATCH --time={time}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --signal=B:USR1@{warning_time}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={logs}/%4a.txt
{options}
task="${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
out_of_time=no
trap 'out_of_time=yes; kill -TERM "$run"' USR1
trap 'kill -TERM "$run"' TERM

{python} -m crashsolve sweep {folder} --run "$SLURM_ARRAY_TASK_ID" &
run=$!
# the signal came before the run had started
[ "$out_of_time" = no ] || kill -TERM "$run"
wait "$run"; code=$?
# a trap ends the wait, not the run
while kill -0 "$run" 2>/dev/null; do wait "$run"; code=$?; done

# 3: stopped on request, with a dump to continue from; 143: stopped before it began, nothing is lost
if [ "$out_of_time" = yes ] && {{ [ "$code" -eq 3 ] || [ "$code" -eq 143 ]; }}; then
    scontrol requeue "$task" && exit 0
fi
exit "$code"
"""


@dataclass(frozen=True)
class Queue:
    """A job array: tasks at once, time of each, and seconds before its end when SIGUSR1 comes."""

    at_once: int = 16
    time: str = "01:00:00"
    warning_time: int = 60
    options: Sequence[str] = ()
    submits: bool = False


def write_script(folder: Path, numbers: Sequence[int], queue: Queue) -> Path:
    """Write the script of the tasks with these numbers. Raises OutputError."""
    path, logs = folder / NAME, folder.resolve() / "queue"
    text = TEXT.format(
        folder=shlex.quote(str(folder.resolve())),
        job=folder.resolve().name.replace(" ", "_"),
        array=f"{_ranges(numbers)}%{queue.at_once}",
        time=queue.time,
        warning_time=queue.warning_time,
        logs=logs,
        python=shlex.quote(sys.executable),
        options="".join(f"#SBATCH {option}\n" for option in queue.options),
    )
    try:
        logs.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(logs, error.strerror or str(error)) from error
    replace_text(path, text)
    return path


def _ranges(numbers: Sequence[int]) -> str:
    """Numbers as Slurm lists them: 1-3,7."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in ranges)


def submit(path: Path) -> str:
    """Hand the script to sbatch; returns its answer. Raises DeckError when it refuses."""
    try:
        done = subprocess.run(["sbatch", str(path)], capture_output=True, text=True)
    except FileNotFoundError:
        advice = "submit the script where Slurm is"
        raise DeckError("--submit", None, None, "", "there is no sbatch here", advice) from None
    if done.returncode:
        message = " ".join(done.stderr.split()) or f"code {done.returncode}"
        raise DeckError(
            str(path), None, None, "", f"sbatch refuses it: {message}", "see its options"
        )
    return done.stdout.strip()
