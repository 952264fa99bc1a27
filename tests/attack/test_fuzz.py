"""Claim: whatever stands in a deck or a result file, there is an answer or one clear error.

No traceback, no signal, nothing that takes 20 s. A small part belongs to the suite, the large one,
20,000 checks, 500 runs and 1,000 looks at damaged results, to `make long`. Every case follows from
its seed.
"""

import os
import random
import resource
import shutil
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import pytest
from mutations import Decks, damage

from crashpost.cli import main as crashpost
from crashsolve.cli import main as crashsolve
from crashsolve.deck.read import read_deck
from crashsolve.foundation.errors import CrashsolveError
from crashsolve.model.build import build

HERE = Path(__file__).parent
OSCILLATOR = HERE.parent / "runs" / "oscillator.yaml"
# [s]
HANGS, STOPPED_AFTER = 20, 3
# [bytes] so that what is too large for a machine does not depend on the machine
MEMORY, DISK = 3 << 30, 200 << 20


class HangError(Exception):
    """Something took too long."""


@contextmanager
def no_longer_than(seconds: float) -> Iterator[None]:
    """Raise HangError in what takes longer."""

    def hang(_: int, __: FrameType | None) -> None:
        raise HangError

    before = signal.signal(signal.SIGALRM, hang)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def little_memory() -> Iterator[None]:
    """As on a machine with little memory."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def check(deck: Path) -> str:
    """Check a deck; returns what is wrong with the answer, if anything."""
    try:
        with no_longer_than(HANGS):
            build(read_deck(deck))
    except CrashsolveError as error:
        text = str(error)
        return "" if text and text.isprintable() or "\n" in text else f"message {text!r}"
    except BaseException:
        return traceback.format_exc()
    return ""


def spent(work: Callable[[], int], seconds: float) -> tuple[int, str]:
    """Exit code and output of work done in a child; -9 after so many seconds."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.dup2(writing, 1)
        os.dup2(writing, 2)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        code = 1
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (DISK, DISK))
            code = work()
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    os.close(writing)
    end = time.monotonic() + seconds
    pieces = []
    os.set_blocking(reading, False)
    while True:
        over, status = os.waitpid(child, os.WNOHANG)
        try:
            while piece := os.read(reading, 1 << 16):
                pieces.append(piece)
        except BlockingIOError:
            pass
        if over:
            break
        if time.monotonic() > end:
            os.kill(child, signal.SIGKILL)
            status = os.waitpid(child, 0)[1]
            break
        time.sleep(0.005)
    os.close(reading)
    text = b"".join(pieces).decode(errors="replace")
    return os.waitstatus_to_exitcode(status), text


def check_many(seed: int, count: int, folder: Path) -> None:
    """Check decks that are changed at random."""
    decks, rng, faults = Decks(folder / "decks"), random.Random(seed), []
    for number in range(count):
        deck = decks.changed(rng, numbers_alone=rng.random() < 0.7)
        fault = check(deck)
        if fault:
            shutil.copy(deck, folder / f"{number}.yaml")
            faults.append(f"{folder / str(number)}.yaml: {fault}")
    assert not faults, f"{len(faults)} of {count}:\n" + "\n".join(faults[:20])


def test_changed_decks_are_read_or_refused(tmp_path: Path) -> None:
    with little_memory():
        check_many(1, 120, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 120))
def test_very_many_changed_decks_are_read_or_refused(seed: int, tmp_path: Path) -> None:
    with little_memory():
        check_many(seed, 1000, tmp_path)


def is_slow(deck: Path) -> bool:
    """Whether a step takes seconds as plain Python: implicit steps of elements."""
    text = deck.read_text("utf-8")
    implicit = ("quasi_static", "radau_iia_5", "generalized_alpha", "auto")
    return "parts:" in text and any(word in text for word in implicit)


def run(deck: Path, folder: Path) -> int:
    """Run a deck as plain Python; ask it to stop after a while."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"

    def stop(_: int, __: FrameType | None) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, STOPPED_AFTER)
    return crashsolve([str(deck), "-o", str(folder), "--set", "control.estimate=off"])


def run_many(seed: int, count: int, folder: Path) -> None:
    """Run decks that are changed at random and that check has let pass."""
    decks, rng, faults, number = Decks(folder / "decks"), random.Random(seed), [], 0
    out = folder / "out"
    while number < count:
        deck = decks.changed(rng, numbers_alone=True)
        try:
            build(read_deck(deck))
        except CrashsolveError:
            continue
        if is_slow(deck):
            continue
        number += 1
        shutil.rmtree(out, ignore_errors=True)
        code, text = spent(lambda deck=deck: run(deck, out), STOPPED_AFTER + HANGS)
        # asked to stop before it listened, or a history beyond DISK
        is_meant = code in (0, 2, 3, 4, -signal.SIGTERM) or (code == 5 and "too large" in text)
        if not is_meant or "Traceback" in text:
            shutil.copy(deck, folder / f"{number}.yaml")
            faults.append(f"{folder / str(number)}.yaml: code {code}\n{text[-1500:]}")
    assert not faults, f"{len(faults)} of {count}:\n" + "\n".join(faults[:20])


def test_changed_decks_run_or_stop(tmp_path: Path) -> None:
    run_many(2, 8, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(200, 210))
def test_very_many_changed_decks_run_or_stop(seed: int, tmp_path: Path) -> None:
    run_many(seed, 50, tmp_path)


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of a run, with all that a report shows."""
    folder = tmp_path_factory.mktemp("sound")
    code, text = spent(lambda: run(OSCILLATOR, folder), 100)
    assert code == 0, text
    return folder


def look_at_many(seed: int, count: int, sound: Path, folder: Path) -> None:
    """Ask crashpost about results that are damaged at random."""
    rng, faults = random.Random(seed), []
    results, other = folder / "results", folder / "other"
    (folder / "questions.json").write_text('[{"channel": "time", "statistic": "max"}]')
    commands = (
        *(["summary"], ["channels"], ["expect"], ["expect", "--partial"]),
        ["value", "glstat.model.step", "--statistic", "max"],
        *(["export", "--csv", str(other)], ["report", "-o", str(other)]),
        ["values", str(folder / "questions.json")],
    )
    for _ in range(count):
        shutil.rmtree(results, ignore_errors=True)
        shutil.copytree(sound, results)
        what, (command, *words) = damage(results, rng), rng.choice(commands)
        arguments = [command, str(results), *words]
        code, text = spent(lambda arguments=arguments: crashpost(arguments), HANGS)
        is_one_line = text.startswith("crashpost: error: ") and text.count("\n") == 1
        # a report tells of figures that cannot be drawn below its own name
        is_report = command == "report" and "crashpost: error: " in text
        if code not in (0, 1, 2) or "\x1b" in text or (code == 2 and not is_one_line | is_report):
            faults.append(f"{command}, {what}: code {code}\n{text[-800:]}")
    assert not faults, f"{len(faults)} of {count}:\n" + "\n".join(faults[:20])


def test_damaged_results_give_an_answer_or_one_line(sound: Path, tmp_path: Path) -> None:
    look_at_many(3, 60, sound, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(300, 310))
def test_very_many_damaged_results_give_an_answer_or_one_line(
    seed: int, sound: Path, tmp_path: Path
) -> None:
    look_at_many(seed, 100, sound, tmp_path)
