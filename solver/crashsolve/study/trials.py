"""The runs of a study: ordinary commands in folders of their own, side by side on the cores.

A run that fails is a trial with its exit code and message. A run that is there already, of the same
deck text and the same version, is not repeated.
"""

import json
import subprocess
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from math import nan
from pathlib import Path

import crashsolve
from crashsolve.deck.reading.several import Several
from crashsolve.foundation.errors import CrashsolveError, ExitCode
from crashsolve.output.files import Json
from crashsolve.study.child_runs import reason, start, status_of
from crashsolve.study.settings import Series, Setting

# runs that would end the same way again
COMPLETE = {ExitCode.NORMAL, ExitCode.SOLVER}


@dataclass
class Trial:
    """One setting after its run: average step and CPU times [s], an answer per watched channel."""

    setting: Setting
    folder: Path
    code: int
    message: str = ""
    cycles: int = 0
    step: float = nan
    cpu_steps: float = nan
    cpu: float = nan
    was_reused: bool = False
    # whether it took the same steps as the trial before it
    is_same: bool = False
    answers: list[Json] = field(default_factory=list)

    @property
    def has_finished(self) -> bool:
        """Whether it reached its end."""
        return self.code == ExitCode.NORMAL


Report = Callable[[Trial], None]


def run_all(
    deck: Path,
    settings: list[Setting],
    overrides: Mapping[str, str],
    folder: Path,
    jobs: int,
    report: Report,
) -> list[Trial]:
    """All trials in the order of their settings; `report` is called with each as it ends."""

    def run(setting: Setting) -> Trial:
        trial = _trial(
            deck, setting, {**overrides, **setting.overrides}, folder / setting.folder, jobs
        )
        report(trial)
        return trial

    # the first of each method compiles for the others; then the most expensive first, to end
    # together
    first = list({setting.series.method: setting for setting in reversed(settings)}.values())
    others = [setting for setting in reversed(settings) if setting not in first]
    done: dict[str, Trial] = {}
    with ThreadPoolExecutor(jobs) as pool:
        for batch in (first, others):
            done |= {trial.setting.folder: trial for trial in pool.map(run, batch)}
    trials = [done[setting.folder] for setting in settings]
    _mark_equal_steps(trials)
    return trials


def _trial(
    deck: Path, setting: Setting, overrides: Mapping[str, str], folder: Path, jobs: int
) -> Trial:
    """Run one setting, unless its results are there."""
    try:
        own, overrides = Several().read(deck, overrides)
    except CrashsolveError as error:
        return Trial(setting, folder, int(error.exit_code), str(error).splitlines()[0])
    status = status_of(folder)
    if status.get("exit_code") in COMPLETE and _is_of(folder, own.text):
        return _finished(setting, folder, int(status["exit_code"]), "", was_reused=True)
    with start(deck, folder, overrides, False, subprocess.PIPE, jobs) as run:
        _, errors = run.communicate()
    return _finished(setting, folder, run.returncode, errors)


def _finished(
    setting: Setting, folder: Path, code: int, errors: str, was_reused: bool = False
) -> Trial:
    """The trial of a run that has ended, from its files."""
    status = status_of(folder)
    trial = Trial(setting, folder, code, was_reused=was_reused)
    if code in COMPLETE:
        trial.cycles = int(status["cycle"])
        trial.cpu, trial.cpu_steps = float(status["cpu"]), float(status.get("cpu_steps", nan))
        trial.message = str(status["message"])
    else:
        trial.message = reason(code, "", errors)
    return trial


def _is_of(folder: Path, text: str) -> bool:
    """Whether the results in a folder are of this deck text and of this version."""
    import h5py

    try:
        with h5py.File(folder / "history.h5") as file:
            versions = json.loads(file.attrs["versions"])
            is_same = file.attrs["deck_text"] == text
    except (OSError, KeyError, ValueError):
        return False
    return bool(is_same and versions.get("crashsolve") == crashsolve.__version__)


def _mark_equal_steps(trials: list[Trial]) -> None:
    """Find trials whose steps samples or other bounds made those of the trial before."""
    before: dict[Series, int] = {}
    for trial in trials:
        series = trial.setting.series
        if trial.has_finished and trial.cycles == before.get(series):
            trial.is_same = True
            trial.message = "same steps as before: bound by samples, not by the setting"
        elif trial.has_finished:
            before[series] = trial.cycles
