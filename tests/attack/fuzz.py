"""Many changed decks or damaged results: `python fuzz.py KIND SEED COUNT FOLDER`.

Kinds are checks, runs, compiled and looks. Prints every case that ends in a traceback, by a signal
or not within 20 s, and leaves its deck in the folder; the exit code is 1 if there is any. Every run
is a fork of this process, so that nothing is imported twice. With CRASHSOLVE_PLAIN=1 kernels run as
plain Python, but for those of `compiled`: a few decks, whose numbers alone change, so that few
steps are compiled.
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

from mutations import Decks, damage

from crashpost.cli import main as crashpost
from crashsolve.cli import main as crashsolve
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import CrashsolveError
from crashsolve.model.build import build

OSCILLATOR = Path(__file__).parents[1] / "runs" / "oscillator.yaml"
# [s]
HANGS, STOPPED_AFTER = 20, 3
# of the wall's clock to CPU time, for a child that is starved, or waits for ever
WAITS = 10
# [bytes] so that what is too large for a machine does not depend on the machine
MEMORY, DISK = 3 << 30, 200 << 20
# decks that run compiled: contact, springs through guides, tyres
COMPILED = ("tutorial/bouncing_ball", "verification/springs/cable", "verification/springs/strut")
COMPILED += ("verification/tyres/fiala", "verification/contact/crush_curve")
# methods whose steps take seconds as plain Python where nodes of parts are unknowns
IMPLICIT = ("radau_iia_5", "generalized_alpha", "auto")


class HangError(Exception):
    """Something took too long."""


@contextmanager
def no_longer_than(seconds: float) -> Iterator[None]:
    """Raise HangError in what takes more CPU time: the machine may be busy."""

    def hang(_: int, __: FrameType | None) -> None:
        raise HangError

    signal.signal(signal.SIGPROF, hang)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


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


def outcome(work: Callable[[], int], seconds: int) -> tuple[int, str]:
    """Exit code and output of work done in a child; a signal's after so many seconds of CPU time.

    A busy machine must not make a hang, so the clock on the wall only ends a child that waits.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.dup2(writing, 1)
        os.dup2(writing, 2)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        code = 1
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (DISK, DISK))
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
            code = work()
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    os.close(writing)
    end = time.monotonic() + WAITS * seconds
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


def checks(seed: int, count: int, folder: Path) -> Iterator[str]:
    """Check decks that are changed at random; yields what is wrong."""
    decks, rng = Decks(folder / "decks"), random.Random(seed)
    for number in range(count):
        deck = decks.changed(rng, numbers_alone=rng.random() < 0.7)
        fault = check(deck)
        if fault:
            yield kept(deck, folder, number) + fault


def kept(deck: Path, folder: Path, number: int) -> str:
    """Keep a deck that shows a fault, and the files it names; returns where."""
    target = folder / f"fault_{number}"
    shutil.copytree(deck.parent, target, dirs_exist_ok=True)
    return f"{target / deck.name}: "


def is_slow(deck: Path) -> bool:
    """Whether a step takes seconds as plain Python."""
    text = deck.read_text("utf-8")
    has_nodes = "parts:" in text and any(word in text for word in IMPLICIT)
    return has_nodes or "quasi_static" in text


def run(deck: Path, folder: Path) -> int:
    """Run a deck and ask it to stop after a while."""

    def stop(_: int, __: FrameType | None) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, STOPPED_AFTER)
    return crashsolve([str(deck), "-o", str(folder), "--set", "control.estimate=off"])


def runs(seed: int, count: int, folder: Path) -> Iterator[str]:
    """Run decks that are changed at random and that check lets pass; yields what is wrong."""
    decks, rng, number = Decks(folder / "decks"), random.Random(seed), 0
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
        fault = fault_of_run(deck, out)
        if fault:
            yield kept(deck, folder, number) + fault


def fault_of_run(deck: Path, out: Path) -> str:
    """What is wrong with how a run ends, if anything."""
    shutil.rmtree(out, ignore_errors=True)
    code, text = outcome(lambda: run(deck, out), STOPPED_AFTER + HANGS)
    # asked to stop before it listened; a history beyond DISK, or one that would hold NaN
    is_meant = code in (0, 2, 3, 4, -signal.SIGTERM) or (code == 5 and "far too large" in text)
    is_meant |= code == 5 and "File too large" in text
    return (
        "" if is_meant and "Traceback" not in text else f"code {code}\n{text[-1500:]}{trace(text)}"
    )


def trace(text: str) -> str:
    """The first traceback of an output."""
    at = text.find("Traceback")
    return "" if at < 0 else f"\n... {text[max(at - 300, 0) : at + 1500]}"


def compiled(seed: int, count: int, folder: Path) -> Iterator[str]:
    """Run decks compiled whose numbers are changed at random; yields what is wrong."""
    decks, rng = Decks(folder / "decks"), random.Random(seed)
    paths = [folder / "decks" / f"{name}.yaml" for name in COMPILED[: max(2, count // 20)]]
    decks.data = {path: decks.data[path] for path in paths}
    # compiled before a run is asked to stop after a while
    for path in paths:
        crashsolve([str(path), "-o", str(folder / "out"), "--set", "control.estimate=off"])
    for number in range(count):
        deck = decks.changed(rng, numbers_alone=True)
        fault = fault_of_run(deck, folder / "out")
        if fault:
            yield kept(deck, folder, number) + fault


def looks(seed: int, count: int, folder: Path) -> Iterator[str]:
    """Ask crashpost about results that are damaged at random; yields what is wrong."""
    rng, sound, results, other = random.Random(seed), *map(folder.joinpath, ("s", "r", "o"))
    code, text = outcome(lambda: run(OSCILLATOR, sound), 100)
    if code not in (0, 3):
        yield f"no results to damage: {text}"
        return
    questions = folder / "questions.json"
    questions.write_text('[{"channel": "time", "statistic": "max"}]')
    commands = (
        *(["summary"], ["channels"], ["expect"], ["expect", "--partial"]),
        ["value", "glstat.model.step", "--statistic", "max"],
        *(["export", "--csv", str(other)], ["report", "-o", str(other)]),
        ["values", str(questions)],
    )
    for _ in range(count):
        shutil.rmtree(results, ignore_errors=True)
        shutil.copytree(sound, results)
        what, (command, *words) = damage(results, rng), rng.choice(commands)
        arguments = [command, str(results), *words]
        code, text = outcome(lambda arguments=arguments: crashpost(arguments), HANGS)
        is_one_line = text.startswith("crashpost: error: ") and text.count("\n") == 1
        # a report lists figures that cannot be drawn below its own name
        is_report = command == "report" and "crashpost: error: " in text
        if code not in (0, 1, 2) or "\x1b" in text or (code == 2 and not is_one_line | is_report):
            yield f"{command}, {what}: code {code}\n{text[-800:]}"


def main(kind: str, seed: str, count: str, folder: str) -> int:
    """All cases of a kind; returns 1 for any fault."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    work = {"checks": checks, "runs": runs, "compiled": compiled, "looks": looks}[kind]
    faults = 0
    for fault in work(int(seed), int(count), Path(folder)):
        print(fault, flush=True)
        faults += 1
    print(f"{kind}: {faults} faults in {count}")
    return min(faults, 1)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
