"""Claim: one run to a folder, signals and files of any kind end in a stop, never in a traceback."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import h5py
import pytest
from command import arguments, crashsolve, environment, start

from crashpost.results.status import read_status
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.streams import lost, print_line
from crashsolve.output.errors import OutputError
from crashsolve.output.lock import Lock
from crashsolve.output.log import STOPPED, Log
from crashsolve.simulation import progress
from crashsolve.simulation.heartbeat import Heartbeat
from crashsolve.simulation.requests import SIGNALS, Requests, interrupt_as_keyboard

OSCILLATOR = Path(__file__).parents[1] / "runs" / "oscillator.yaml"
# as plain Python: nothing is to be compiled, and a run of a million steps lasts; 0.5 GB would come
PLAIN = {"CRASHSOLVE_PLAIN": "1"}
# [s] that a machine may take for what another does at once
BUSY = 600
SHORT = ("--set", "control.end_time=0.02", "--set", "control.estimate=off")
LONG = ("--set", "control.end_time=100", "--set", "control.estimate=off")


def until(happens: Callable[[], bool], run: subprocess.Popen[str]) -> None:
    """Wait for something that a run does, as long as it lives: the machine may be busy."""
    end = time.monotonic() + BUSY
    while not happens():
        assert run.poll() is None and time.monotonic() < end
        time.sleep(0.01)


def marches(folder: Path) -> bool:
    """Whether a run has begun to take steps."""
    path = folder / "log.txt"
    return path.exists() and "step set by" in path.read_text("utf-8")


@pytest.fixture
def live(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], Path]]:
    """A run that lasts, and its folder."""
    run = start(OSCILLATOR, "-o", tmp_path / "live", *LONG, **PLAIN)
    try:
        until(lambda: marches(tmp_path / "live"), run)
        yield run, tmp_path / "live"
    finally:
        run.kill()
        run.communicate()


def test_a_second_run_is_refused_without_harm_to_the_first(
    live: tuple[subprocess.Popen[str], Path],
) -> None:
    run, folder = live
    for more in ((), ("--restart",)):
        done = crashsolve(OSCILLATOR, "-o", folder, *SHORT, *more, **PLAIN)
        assert done.returncode == 5
        assert f"another run writes to this folder (process {run.pid} on" in done.stderr
        assert "Traceback" not in done.stderr
    assert run.poll() is None
    assert read_status(folder / "status.json")["state"] == "running"
    # nobody but its process held the lock
    run.send_signal(signal.SIGKILL)
    run.communicate()
    assert read_status(folder / "status.json")["state"] == "killed"
    with h5py.File(folder / "history.h5") as file:
        assert file["glstat/time"].shape[0] > 0
    assert crashsolve(OSCILLATOR, "-o", folder, *SHORT, **PLAIN).returncode == 0
    assert read_status(folder / "status.json")["state"] == "finished"


def test_what_is_no_file_of_words_is_passed_over_and_the_run_can_be_stopped(
    live: tuple[subprocess.Popen[str], Path],
) -> None:
    run, folder = live
    control, log = folder / "control.txt", folder / "log.txt"
    os.mkfifo(control)
    until(lambda: "control.txt is not a plain file" in log.read_text("utf-8"), run)
    control.unlink()
    control.mkdir()
    time.sleep(0.5)
    assert run.poll() is None
    control.rmdir()
    (folder / "words").write_bytes(b"\xff\x1b[2J nonsense stop")
    os.replace(folder / "words", control)
    output, errors = run.communicate(timeout=BUSY)
    assert run.returncode == 3
    assert "Traceback" not in errors
    assert "\x1b" not in output + log.read_text("utf-8")


def test_a_folder_of_that_name_that_is_there_before_the_run_does_not_end_it(tmp_path: Path) -> None:
    (tmp_path / "out" / "control.txt").mkdir(parents=True)
    done = crashsolve(OSCILLATOR, "-o", tmp_path / "out", *SHORT, **PLAIN)
    assert done.returncode == 0, done.stderr
    assert "control.txt is not a plain file" in done.stdout


def test_a_second_interrupt_ends_at_once(live: tuple[subprocess.Popen[str], Path]) -> None:
    run, folder = live
    for pause in (0.0005, 0.3, 0.0):
        with suppress(ProcessLookupError):
            run.send_signal(signal.SIGINT)
        time.sleep(pause)
    _, errors = run.communicate(timeout=BUSY)
    assert run.returncode == 3
    assert "Traceback" not in errors
    status = read_status(folder / "status.json")
    assert (status["state"], status["exit_code"]) == ("stopped", 3)
    h5py.File(folder / "history.h5").close()


def test_an_old_status_does_not_speak_for_a_new_run(tmp_path: Path) -> None:
    assert crashsolve(OSCILLATOR, "-o", tmp_path, *SHORT, **PLAIN).returncode == 0
    assert read_status(tmp_path / "status.json")["state"] == "finished"
    run = start(OSCILLATOR, "-o", tmp_path, *LONG, **PLAIN)
    said = (tmp_path / "status.json").read_text
    until(lambda: '"running"' in said(), run)
    run.kill()
    run.communicate()
    assert read_status(tmp_path / "status.json")["state"] == "killed"


def test_the_status_is_that_of_a_run_from_its_preparation_on(tmp_path: Path) -> None:
    deck, pulse = read_deck(OSCILLATOR), Heartbeat("a test", print)
    (tmp_path / "status.json").write_text('{"state": "finished"}')
    with progress.preparing(deck, tmp_path, pulse, append=False):
        status = json.loads((tmp_path / "status.json").read_text("utf-8"))
        assert (status["state"], status["message"]) == ("running", "preparing")


def read_again(requests: Requests) -> set[str]:
    """What has been asked, whenever it was looked at last."""
    requests._due = 0.0
    requests.read()
    return requests.words


def test_a_request_that_is_not_written_yet_is_waited_for(tmp_path: Path) -> None:
    """A shell opens control.txt before it writes into it, and a run may look between both."""
    requests = Requests(tmp_path, Log(tmp_path / "log.txt"), end=lambda: None)
    control = tmp_path / "control.txt"
    for text in ("", "\n"):
        control.write_text(text)
        assert not read_again(requests)
        assert control.exists()
    control.write_text("dump stop\n")
    assert read_again(requests) == {"dump", "stop"}
    assert not control.exists()


def test_a_request_that_is_taken_back_while_it_is_read_does_not_end_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def taken_back(path: Path, _: int) -> str:
        path.unlink()
        raise FileNotFoundError(path)

    requests = Requests(tmp_path, Log(tmp_path / "log.txt"), end=lambda: None)
    (tmp_path / "control.txt").write_text("stop")
    monkeypatch.setattr("crashsolve.simulation.requests.read_plain", taken_back)
    assert not read_again(requests)


def test_standard_output_that_is_full_before_there_is_a_log_is_said_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a busy machine the first words come before the log: that the deck is being read."""
    with open("/dev/full", "w") as full:
        monkeypatch.setattr(sys, "stdout", full)
        print_line("reading the deck")
        Log(tmp_path / "log.txt").line("goes on")
    assert "warning: standard output: No space left" in (tmp_path / "log.txt").read_text("utf-8")
    assert not lost


def test_a_run_that_cannot_be_prepared_has_failed(tmp_path: Path) -> None:
    assert crashsolve(OSCILLATOR, "-o", tmp_path, *SHORT, **PLAIN).returncode == 0
    (tmp_path / "log.txt").unlink()
    (tmp_path / "log.txt").mkdir()
    done = crashsolve(OSCILLATOR, "-o", tmp_path, *SHORT, **PLAIN)
    assert done.returncode == 5
    assert "log.txt: Is a directory" in done.stderr
    status = read_status(tmp_path / "status.json")
    assert (status["state"], status["exit_code"]) == ("failed", 5)


# compiles for ever, however fast the machine is and however late the signal comes
COMPILES = """
import sys, time
from pathlib import Path
from crashsolve import cli
from crashsolve.simulation import solve

def compiling(*_, **__):
    Path(sys.argv[1], "compiles").touch()
    time.sleep(600)

solve.prepared_engine = compiling
sys.exit(cli.main(sys.argv[2:]))
"""


def test_an_interrupt_while_compiling_is_a_stop_on_request(tmp_path: Path) -> None:
    # SIGINT is ignored in what a shell runs behind itself
    words = [sys.executable, "-c", COMPILES, tmp_path, OSCILLATOR, "-o", tmp_path]
    run = subprocess.Popen(words, stderr=subprocess.PIPE, text=True, env=environment())
    try:
        until(lambda: (tmp_path / "compiles").exists(), run)
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=BUSY)
    finally:
        run.kill()
    assert run.returncode == 3
    assert read_status(tmp_path / "status.json")["state"] == "stopped"
    log = (tmp_path / "log.txt").read_text()
    assert "interrupted while preparing" in log and log.splitlines()[-1] == STOPPED


def test_an_interrupt_that_python_drops_is_not_lost(tmp_path: Path) -> None:
    """One that comes while an object is disposed of is printed, and goes no further."""

    class Disposed:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGTERM)

    known = {number: signal.getsignal(number) for number in SIGNALS}
    requests = Requests(tmp_path, Log(tmp_path / "log.txt"), end=lambda: None)
    try:
        interrupt_as_keyboard()
        with catch_unraisable() as dropped:
            del (disposed := [Disposed()])[0]
            assert not disposed
        assert dropped == [KeyboardInterrupt]
        with pytest.raises(KeyboardInterrupt):
            requests.catch()
        # of a run that begins anew nothing has been asked
        interrupt_as_keyboard()
        requests.catch()
    finally:
        for number, handler in known.items():
            signal.signal(number, handler)


@contextmanager
def catch_unraisable() -> Iterator[list[type[BaseException]]]:
    """Kinds of the exceptions that Python drops meanwhile."""
    kinds: list[type[BaseException]] = []
    hook, sys.unraisablehook = sys.unraisablehook, lambda error: kinds.append(error.exc_type)
    try:
        yield kinds
    finally:
        sys.unraisablehook = hook


def test_an_interrupt_while_the_log_is_being_opened_is_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = []

    def interrupted(path: Path, append: bool) -> Log:
        log = Log(path, append=append)
        opened.append(log)
        if len(opened) == 1:
            raise KeyboardInterrupt
        return log

    monkeypatch.setattr(progress, "Log", interrupted)
    deck, pulse = read_deck(OSCILLATOR), Heartbeat("reading", print)
    with pytest.raises(KeyboardInterrupt), progress.preparing(deck, tmp_path, pulse, False):
        pytest.fail("nothing runs after an interrupt")
    lines = (tmp_path / "log.txt").read_text().splitlines()
    assert (lines[0], lines[-1]) == ("interrupted while preparing", STOPPED)
    assert read_status(tmp_path / "status.json")["state"] == "stopped"


def test_a_lock_is_for_one_and_ends_with_its_block(tmp_path: Path) -> None:
    with Lock(tmp_path), pytest.raises(OutputError, match="another run writes to this folder"):
        Lock(tmp_path)
    with Lock(tmp_path) as lock:
        assert not lock.warning
    (tmp_path / "run.lock").unlink()
    os.symlink(tmp_path / "elsewhere", tmp_path / "run.lock")
    with pytest.raises(OutputError, match="run.lock"):
        Lock(tmp_path)


def run_into(stream: str, folder: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """Run a command whose standard output is `stream` of a shell."""
    command = " ".join(f"'{word}'" for word in arguments(*words))
    return subprocess.run(
        ["sh", "-c", f"{command} {stream}"],
        stderr=subprocess.PIPE,
        text=True,
        env=environment(**PLAIN),
        timeout=BUSY,
    )


@pytest.mark.parametrize("stream", [">/dev/full 2>/dev/full", ">&- 2>&- <&-"])
def test_a_run_outlives_its_standard_output(stream: str, tmp_path: Path) -> None:
    done = run_into(stream, tmp_path, OSCILLATOR, "-o", tmp_path, *SHORT)
    assert done.returncode == 0
    assert not done.stderr
    log = (tmp_path / "log.txt").read_text("utf-8")
    assert log.endswith("N o r m a l    t e r m i n a t i o n\n")
    assert ("standard output: No space left on device" in log) == ("/dev/full" in stream)
    h5py.File(tmp_path / "history.h5").close()


def test_an_answer_that_cannot_be_determined_is_an_error(tmp_path: Path) -> None:
    done = run_into(">/dev/full", tmp_path, "check", OSCILLATOR)
    assert done.returncode == 5
    assert done.stderr == "standard output: No space left on device\n"
    assert run_into(">&-", tmp_path, "check", OSCILLATOR).returncode == 0


def test_errors_keep_their_code_where_nobody_can_be_determined(tmp_path: Path) -> None:
    absent = tmp_path / "absent.yaml"
    assert run_into(">/dev/full 2>/dev/full", tmp_path, "check", absent).returncode == 2
