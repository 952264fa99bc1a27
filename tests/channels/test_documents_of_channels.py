"""Claim: what the pages on channels and on Python show is what happens."""

import doctest
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command import crashsolve, environment

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ROOT / "solver" / "PYTHON.md"
CHANNELS = ROOT / "solver" / "theory" / "channels.md"


def blocks(path: Path, language: str) -> list[str]:
    """Fenced blocks of one language."""
    return re.findall(rf"```{language}\n(.*?)```", path.read_text("utf-8"), re.DOTALL)


@pytest.mark.long
def test_the_examples_of_the_python_page_are_what_python_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("pyvista")
    shutil.copy(ROOT / "decks" / "tutorial" / "head_form.yaml", tmp_path)
    monkeypatch.chdir(tmp_path)
    # as plain Python, some 1200 steps are cheaper than a compiler
    monkeypatch.setenv("CRASHSOLVE_PLAIN", "1")
    text = "\n".join(blocks(PYTHON, "python"))
    page = doctest.DocTestParser().get_doctest(text, {}, "PYTHON.md", str(PYTHON), 0)
    assert len(page.examples) > 20
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS, verbose=False)
    reported: list[str] = []
    runner.run(page, out=reported.append)
    assert runner.failures == 0, "".join(reported)


@pytest.mark.long
def test_a_new_statistic_is_one_file_that_deck_and_commands_know(tmp_path: Path) -> None:
    """The file, the deck and the commands of the page, with a copy of the package."""
    (statistic,), (deck,) = blocks(CHANNELS, "python"), blocks(CHANNELS, "yaml")
    package = tmp_path / "source" / "crashsolve"
    shutil.copytree(ROOT / "solver" / "crashsolve", package)
    (package / "channels" / "statistics" / "rms.py").write_text(statistic, "utf-8")
    path, folder = tmp_path / "flight.yaml", tmp_path / "flight.results"
    path.write_text(deck, "utf-8")
    search = os.pathsep.join([str(package.parent), str(ROOT / "postproc")])
    changes = {"CRASHSOLVE_PLAIN": "1", "PYTHONPATH": search}
    done = crashsolve(path, "-o", folder, **changes)
    assert done.returncode == 0, done.stderr
    # watched with the error of its trapezoids, known in closed form
    assert "rbdout.ball.velocity.x rms = 3 m/s" in done.stdout

    def crashpost(*words: object) -> str:
        command = [sys.executable, "-m", "crashpost", *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True, env=environment(**changes))
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "1 of 1 expectations met" in crashpost("expect", folder)
    value = float(crashpost("value", folder, "rbdout.ball.position.x:rms"))
    assert value == pytest.approx(3**0.5, rel=1e-4)
    picture = tmp_path / "rms.svg"
    crashpost("plot", folder, "rbdout.ball.position.x:rms", "-o", picture)
    assert "rms 1.732" in picture.read_text("utf-8")
    words = ("--steps", "0.02,0.01", "--integrators", "rattle", "--jobs", 1)
    study = ("study", path, "-o", tmp_path / "study", *words)
    done = crashsolve(*study, "--channel", "rbdout.ball.position.x:rms", **changes)
    assert done.returncode == 0, done.stderr
    assert "rbdout.ball.position.x rms" in done.stdout
