"""log.txt and what the user sees meanwhile."""

import io
from pathlib import Path

import pytest

from crashsolve.output.log import ERROR, HEADER, HEADER_EVERY, NORMAL, Log


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


class BrokenPipe(io.StringIO):
    """A stream whose reader has gone."""

    def write(self, text: str) -> int:
        raise BrokenPipeError


def filled(log: Log) -> None:
    """Write one of everything."""
    log.banner("crashsolve 0.1.0", {"deck": "train.yaml", "host": "n01"})
    log.section("model", ["3 bodies", "2 contacts"])
    log.cycle(10, 1e-3, 1e-4, 5.0e6, 0.012, 3e-12, 75.4, "contact buffers")
    log.timing({"contact": 3.0, "joints": 1.0})
    log.citations(["Goldsmith 1960"])


def test_stream_shows_what_the_file_holds(tmp_path: Path) -> None:
    stream = io.StringIO()
    log = Log(tmp_path / "log.txt", stream)
    filled(log)
    log.progress(0.5)
    log.finish(NORMAL)
    text = (tmp_path / "log.txt").read_text()
    assert stream.getvalue() == text
    assert text.splitlines()[-1] == NORMAL
    for words in ("train.yaml", "2 contacts", "contact buffers", "75.0 %", "Goldsmith 1960"):
        assert words in text


def test_error_termination_is_the_last_line(tmp_path: Path) -> None:
    log = Log(tmp_path / "log.txt", io.StringIO())
    log.error("the step has collapsed")
    log.finish(ERROR)
    lines = (tmp_path / "log.txt").read_text().splitlines()
    assert lines[0] == "error: the step has collapsed"
    assert lines[-1] == ERROR


def test_warnings_are_shown_once_counted_and_repeated_at_the_end(tmp_path: Path) -> None:
    log = Log(tmp_path / "log.txt", io.StringIO())
    for _ in range(3):
        log.warning("impact too fast")
    log.warning("joint redundant")
    assert log.warnings.total() == 4
    log.finish(NORMAL)
    before, after = (tmp_path / "log.txt").read_text().split("warnings: 4, of which distinct: 2")
    assert before.count("warning: impact too fast") == 1
    assert "3 x  impact too fast" in after
    assert "1 x  joint redundant" in after


def test_header_is_repeated_among_the_cycle_lines(tmp_path: Path) -> None:
    log = Log(tmp_path / "log.txt", io.StringIO())
    for cycle in range(HEADER_EVERY + 1):
        log.cycle(cycle, 0.0, 1e-6, 1e3, -0.5, 0.0, None, "spring s")
    lines = (tmp_path / "log.txt").read_text().splitlines()
    assert lines.count(HEADER) == 2
    row = lines[lines.index(HEADER) + 1]
    # every number ends under the last letter of its heading
    assert len(row) - len("  spring s") == HEADER.index("  step set by")


def test_progress_appears_on_a_terminal_only(tmp_path: Path) -> None:
    terminal, pipe = Terminal(), io.StringIO()
    for stream in (terminal, pipe):
        log = Log(tmp_path / "log.txt", stream)
        log.progress(0.5)
        log.line("next")
        log.finish(NORMAL)
    assert "50.0 %" in terminal.getvalue()
    assert "\r\x1b[Knext" in terminal.getvalue()
    assert "%" not in pipe.getvalue() + (tmp_path / "log.txt").read_text()


def test_a_run_continues_without_a_reader(tmp_path: Path) -> None:
    log = Log(tmp_path / "log.txt", BrokenPipe())
    filled(log)
    log.finish(NORMAL)
    assert (tmp_path / "log.txt").read_text().endswith(NORMAL + "\n")


@pytest.mark.parametrize(("append", "kept"), [(True, True), (False, False)])
def test_restart_appends_to_the_log(tmp_path: Path, append: bool, kept: bool) -> None:
    Log(tmp_path / "log.txt", io.StringIO()).line("first run")
    Log(tmp_path / "log.txt", io.StringIO(), append=append).line("second run")
    assert ("first run" in (tmp_path / "log.txt").read_text()) == kept
