"""A small result of two cars, and the command line under test."""

from pathlib import Path

import pytest
from small_results import Command, two_cars, write_result, write_status

from crashpost.cli import main


@pytest.fixture
def cars(tmp_path: Path) -> Path:
    """A finished result of two cars."""
    folder = write_result(
        tmp_path / "cars.results", two_cars(), title="Two cars", deck_text="title: Two cars\n"
    )
    write_status(folder)
    return folder


@pytest.fixture
def crashpost(capsys: pytest.CaptureFixture[str]) -> Command:
    """Run a command; returns exit code, standard output and standard error."""

    def run(*arguments: object) -> tuple[int, str, str]:
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run
