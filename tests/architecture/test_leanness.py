"""Claim: a run imports only what its deck needs."""

import subprocess
import sys
from pathlib import Path

from command import environment

ROOT = Path(__file__).resolve().parents[2]
BALL = ROOT / "decks" / "tutorial" / "bouncing_ball.yaml"
FOREIGN = {"meshio", "matplotlib", "pyvista", "vtk", "vtkmodules", "pint", "pandas", "PIL"}


def imported(*words: object, **changes: str) -> set[str]:
    """Names of all modules a command imports."""
    return set(in_order(*words, **changes))


def in_order(*words: object, **changes: str) -> list[str]:
    """The same names, each once its module is complete."""
    done = subprocess.run(
        [sys.executable, "-X", "importtime", *map(str, words)],
        capture_output=True,
        text=True,
        env=environment(**changes),
    )
    assert done.returncode == 0, done.stderr[-2000:]
    lines = [line for line in done.stderr.splitlines() if line.startswith("import time:")]
    return [line.rpartition("|")[2].strip() for line in lines]


def test_a_rigid_run_imports_no_modules_of_elements(tmp_path: Path) -> None:
    modules = imported("-m", "crashsolve", BALL, "-o", tmp_path)
    assert not {name.split(".")[0] for name in modules} & FOREIGN
    # the compiler works in a process of its own
    assert not [name for name in modules if name.startswith("crashsolve.compiler.translation")]
    assert "scipy" not in {name.split(".")[0] for name in modules}
    # what a family states of itself is known to every run, its laws to those that use them
    laws = ("crashsolve.springs.", "crashsolve.joints.", "crashsolve.sensors.")
    assert not [name for name in modules if name.startswith(laws)]
    # nor what shells are made of, or settings of studies
    others = {"crashsolve.elements.shells.layout", "crashsolve.study.settings"}
    others |= {"crashsolve.elements.shells.section_cut", "crashsolve.foundation.sparse.bordered"}
    assert not modules & others
    assert not [name for name in modules if name.startswith("crashsolve.meshes.")]
    # nor threads, contact of meshes, roads, hinges
    others = {"threads.sharing", "model.contact.node_to_surface", "model.partition", "ties._faces"}
    others |= {"simulation.drawn_roads", "simulation.hinge_marks"}
    assert not modules & {f"crashsolve.{name}" for name in others}
    # what np.unique loads, and the widest of other searches in arrays
    assert "numpy.ma" not in modules


def test_a_start_imports_nothing_of_the_end_of_a_run(tmp_path: Path) -> None:
    """The benchmark stops where the first step begins."""
    script = ROOT / "benchmarks" / "first_step.py"
    modules = imported(script, BALL, tmp_path / "results")
    late = {"system.gain", "system.joint_balance", "simulation.belts", "simulation.ending"}
    late |= {"simulation.self_penetration", "estimate.runner", "channels.expression"}
    assert not modules & {f"crashsolve.{name}" for name in late}
    # statistics are listed without being imported; the deck asks for two
    prefix = "crashsolve.channels.statistics."
    statistics = {name.removeprefix(prefix) for name in modules if name.startswith(prefix)}
    assert statistics <= {"max", "final", "_top"}


def test_a_run_loads_llvm_before_its_deck_and_model(tmp_path: Path) -> None:
    # 40 MB for a moment, which would add to what these take
    modules = in_order("-m", "crashsolve", BALL, "-o", tmp_path)
    assert modules.index("llvmlite.binding.ffi") < modules.index("crashsolve.deck.reading.deck")


def test_a_run_without_estimates_imports_nothing_for_them(tmp_path: Path) -> None:
    modules = imported("-m", "crashsolve", BALL, "-o", tmp_path, "--set", "control.estimate=off")
    estimates = ("crashsolve.estimate", "crashsolve.study", "crashsolve.sweep")
    assert not [name for name in modules if name.startswith(estimates)]


def test_a_check_writes_no_results_and_loads_no_hdf5() -> None:
    modules = imported("-m", "crashsolve", "check", BALL)
    assert "h5py" not in modules
    assert not {name.split(".")[0] for name in modules} & FOREIGN


def test_asking_for_the_version_loads_neither_numpy_nor_llvm() -> None:
    assert not imported("-m", "crashsolve", "--version") & {"numpy", "llvmlite", "pydantic", "h5py"}


def test_the_matrices_of_numpy_start_no_threads() -> None:
    script = (
        "import os\nfrom crashsolve.cli import main\n"
        f"main(['check', {str(BALL)!r}])\nprint(len(os.listdir('/proc/self/task')))"
    )
    own = {k: v for k, v in environment().items() if not k.endswith("NUM_THREADS")}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=own)
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.splitlines()[-1] == "1"
