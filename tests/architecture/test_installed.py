"""Claim: installed by wheel all is there: manual, examples, and what is missing says its name."""

import ast
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from command import crashsolve, environment

from crashsolve import examples

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
# distributions that are imported under another name, and tools that are started and not imported
IMPORTED_AS = {
    "pyyaml": "yaml",
    "salib": "SALib",
    "imageio-ffmpeg": "imageio_ffmpeg",
    "objective-rating-metrics": "objective_rating_metrics",
}
TOOLS = {"pytest-xdist", "ruff", "pyrefly", "types-pyyaml", "crashsolve"}
# extras of which solver and post-processor import what is there
ASKED = (
    "plot",
    "render",
    "mesh",
    "signal",
    "frame",
    "rating",
    "picture",
    "completion",
    "sweep",
)
OURS = {"crashsolve", "crashpost"}
# a module of another distribution, which belongs to one that is listed
PART_OF = {
    "pydantic_core": "pydantic",
    "vtk": "pyvista",
    "vtkmodules": "pyvista",
    "PIL": "matplotlib",
}


def names(requirements: list[str]) -> set[str]:
    """Modules that some requirements bring."""
    required = {re.split(r"[\[<>=!~;, ]", text)[0].lower() for text in requirements} - TOOLS
    return {IMPORTED_AS.get(name, name) for name in required}


def imported(*folders: str) -> set[str]:
    """First words of all imports below some folders, those of the standard library left out."""

    def words(path: Path) -> Iterator[str]:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module:
                yield node.module
            elif isinstance(node, ast.Call) and ast.unparse(node.func) == "pytest.importorskip":
                yield ast.literal_eval(node.args[0])

    files = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    roots = {name.split(".")[0] for path in files for name in words(path)}
    return {PART_OF.get(name, name) for name in roots} - set(sys.stdlib_module_names)


def test_what_is_listed_is_imported_and_what_is_imported_is_listed() -> None:
    extras, code = PROJECT["optional-dependencies"], imported("solver", "postproc") - OURS
    needed, requested = names(PROJECT["dependencies"]), names(sum(map(extras.get, ASKED), []))
    assert needed | requested == code
    others = imported("tests", "benchmarks", "decks")
    for extra in extras.values():
        assert names(extra) <= others | code


def test_an_example_is_printed_or_written_with_what_it_includes(tmp_path: Path) -> None:
    listed = crashsolve("example").stdout
    assert "tutorial/bouncing_ball" in listed and "A ball falls on a floor and rebounds" in listed
    # what others include is no example by itself
    assert "/shared/" not in listed and "\nshared/" not in listed
    printed = crashsolve("example", "tutorial/bouncing_ball")
    path = ROOT / "decks" / "tutorial" / "bouncing_ball.yaml"
    assert (printed.stdout, printed.stderr) == (path.read_text("utf-8"), "")
    word = "beam_impact_10_unilateral"
    assert (
        f"it needs beam_impact.yaml: crashsolve example {word} -o"
        in crashsolve("example", word).stderr
    )
    for name in (word, "verification/curves/file", "every_mesh", "placed_shapes"):
        folder = tmp_path / name
        assert crashsolve("example", name, "-o", folder).returncode == 0
        deck = folder / f"{name.rpartition('/')[2]}.yaml"
        done = crashsolve("check", deck)
        assert done.returncode == 0, done.stderr
    again = crashsolve("example", word, "-o", tmp_path / word)
    assert (again.returncode, "exists; write into another folder" in again.stderr) == (2, True)
    for wrong, reported in (("bouncing_ball", "give it in full"), ("train_tst", "'train_test'?")):
        done = crashsolve("example", wrong)
        assert (done.returncode, reported in done.stderr, done.stdout) == (2, True, "")


def test_the_manual_has_all_pages() -> None:
    known = {
        str(path.relative_to(ROOT / "solver"))[:-3] for path in (ROOT / "solver").rglob("*.md")
    }
    assert set(examples.pages()) == known
    assert crashsolve("manual", "energy").stdout.startswith("# The energy ledger\n")
    assert "KEYWORDS" in crashsolve("manual").stdout
    assert crashsolve("manual", "enrgy").returncode == 2


def test_a_missing_matplotlib_is_one_line_with_the_name_of_the_extra(tmp_path: Path) -> None:
    deck = ROOT / "decks" / "tutorial" / "bouncing_ball.yaml"
    words = ("-o", tmp_path, "--set", "control.estimate=off", "--set", "control.end_time=2e-3")
    assert crashsolve(deck, *words, CRASHSOLVE_PLAIN="1").returncode == 0
    code = (
        "import sys; sys.modules['matplotlib'] = None;"
        "from crashpost.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    for command in (["report", str(tmp_path)], ["plot", str(tmp_path), "rbdout.ball.position.z"]):
        requested = [sys.executable, "-c", code, *command]
        done = subprocess.run(requested, capture_output=True, text=True, env=environment())
        assert done.returncode == 2
        (line,) = done.stderr.splitlines()
        assert "matplotlib" in line and "pip install 'crashsolve[plot]'" in line


@pytest.mark.long
def test_a_wheel_in_an_empty_environment_has_all_a_user_needs(tmp_path: Path) -> None:
    source, folder = tmp_path / "source", tmp_path / "venv"
    ignored = shutil.ignore_patterns(".*", "build", "*.egg-info", "__pycache__", "*.results")
    shutil.copytree(ROOT, source, ignore=ignored)

    def run(*words: object) -> subprocess.CompletedProcess[str]:
        # nothing of this tree, and no settings of the tests
        given = {k: v for k, v in environment().items() if k != "PYTHONPATH"}
        cache = {"CRASHSOLVE_CACHE": str(tmp_path / "cache")}
        return subprocess.run(
            [str(word) for word in words],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env=given | cache,
        )

    pip = (sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", tmp_path, source)
    assert run(*pip).returncode == 0
    (wheel,) = tmp_path.glob("*.whl")
    assert run(sys.executable, "-m", "venv", folder).returncode == 0
    done = run(folder / "bin" / "pip", "install", "--quiet", wheel)
    assert done.returncode == 0, done.stderr
    command, post = folder / "bin" / "crashsolve", folder / "bin" / "crashpost"
    assert run(command, "keywords").stdout == (ROOT / "solver/KEYWORDS.md").read_text("utf-8")
    assert run(command, "equations").stdout == (ROOT / "solver/EQUATIONS.md").read_text("utf-8")
    page = run(command, "manual", "FILE_FORMAT").stdout
    assert page == (ROOT / "solver/FILE_FORMAT.md").read_text("utf-8")
    assert run(command, "example").stdout == crashsolve("example").stdout
    assert run(command, "example", "tutorial/bouncing_ball", "-o", "own").returncode == 0
    done = run(command, "own/bouncing_ball.yaml", "-o", "results")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "expectations met" in run(post, "expect", "results").stdout
    done = run(post, "report", "results")
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert "pip install 'crashsolve[plot]'" in done.stderr
