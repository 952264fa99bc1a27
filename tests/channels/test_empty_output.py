"""Claim: an empty name of an output is refused: it is no name of the current folder."""

from pathlib import Path

import pytest

import crashpost.cli
import crashsolve.cli


@pytest.mark.parametrize("word", ["run", "study", "sweep", "posture", "example"])
def test_the_solver_refuses_an_empty_folder(
    word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stop:
        crashsolve.cli.main([word, "deck.yaml", "-o", ""])
    assert stop.value.code == 2 and "--output: is empty" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("word", ["plot", "compare", "render", "film", "pack", "report"])
def test_the_post_processor_refuses_an_empty_name(
    word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        crashpost.cli.main([word, "x.results", "-o", " "])
    assert stop.value.code == 2 and "--output: is empty" in capsys.readouterr().err
