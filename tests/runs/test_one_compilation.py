"""Claim: many runs that start together on one empty cache compile their scene once; what serves all
scenes is compiled while the model is built, and once as well.
"""

import os
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from command import arguments, crashsolve, environment

WAGON = Path(__file__).resolve().parents[2] / "decks" / "queue" / "wagon.yaml"
TOGETHER = 16
# in every process of Python: the compiler's state which file they are to make
TELL = """
import os, sys
if "crashsolve.compiler.process" in sys.orig_argv:
    at = sys.orig_argv.index("crashsolve.compiler.process")
    with open(os.environ["COMPILED"], "a") as file:
        file.write(sys.orig_argv[at + 2] + "\\n")
"""

BALL = WAGON.parents[1] / "tutorial" / "bouncing_ball.yaml"


def counting(folder: Path) -> dict[str, str]:
    """What makes runs use a cache of their own, and report every compilation."""
    (folder / "sitecustomize.py").write_text(TELL, "utf-8")
    search = os.pathsep.join(filter(None, (str(folder), os.environ.get("PYTHONPATH", ""))))
    cache, reported = folder / "cache", folder / "compiled.txt"
    return {"PYTHONPATH": search, "CRASHSOLVE_CACHE": str(cache), "COMPILED": str(reported)}


def compilations(folder: Path) -> Counter[str]:
    return Counter((folder / "compiled.txt").read_text("utf-8").split())


def test_the_loop_of_samples_is_compiled_while_the_model_is_built(tmp_path: Path) -> None:
    changes = counting(tmp_path)
    done = subprocess.run(
        arguments(BALL, "-o", tmp_path / "out", "--set", "control.estimate=off"),
        capture_output=True,
        env=environment(**changes),
    )
    assert done.returncode == 0, done.stderr
    first, second = (tmp_path / "compiled.txt").read_text("utf-8").split()
    # for a layout of tables that those of the run have: there is no other
    assert Path(first).name.startswith("march.") and not Path(second).name.startswith("march.")
    assert not [*(tmp_path / "cache").rglob("*.lock")]


@pytest.mark.long
def test_runs_that_start_together_compile_once(tmp_path: Path) -> None:
    changes = counting(tmp_path)
    runs = [
        subprocess.Popen(
            arguments(WAGON, "-o", tmp_path / f"{k}", "--set", "control.estimate=off"),
            stdout=subprocess.DEVNULL,
            env=environment(**changes),
        )
        for k in range(TOGETHER)
    ]
    assert [run.wait(1800) for run in runs] == [0] * TOGETHER
    counts = compilations(tmp_path)
    assert counts and set(counts.values()) == {1}, counts


@pytest.mark.long
def test_the_runs_of_a_sweep_compile_once(tmp_path: Path) -> None:
    plan = tmp_path / "plan.yaml"
    speeds = ", ".join(f'"{5 + k} km/h"' for k in range(TOGETHER))
    plan.write_text(
        f"deck: {os.path.relpath(WAGON, tmp_path)}\ndesign: list\nvary: {{speed: [{speeds}]}}\n"
        'set: {control.estimate: "off"}\n'
        "measure: [{name: peak, channel: rcforc.buffer.normal, statistic: max}]\n",
        "utf-8",
    )
    words = ("sweep", plan, "-o", tmp_path / "out", "--jobs", TOGETHER)
    done = crashsolve(*words, **counting(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    counts = compilations(tmp_path)
    assert counts and set(counts.values()) == {1}, counts
