"""Claim: a run that was stopped or killed and goes on gives the same bits as one left alone."""

import json
import random
import shutil
import signal
import time
from pathlib import Path
from typing import Any

import h5py
import pytest
from command import crashsolve, differences, gone_on, start
from quick import first_quick

from crashpost.cli import main as crashpost
from crashsolve.recording.sampling import Schedule
from crashsolve.simulation.resume import differing

HEAP = Path(__file__).parent / "heap.yaml"

DAMPED = """
control: {end_time: 2, integrator: dormand_prince_8, tolerance: 1.0e-8}
output: {history: {interval: 0.01}, restart: {every: 0.1}}
bodies: {bob: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [-1, 0, 0]}}
joints: {pin: {type: revolute, b: bob, at: [0, 0, 0], axis: [0, 0, 1]}}
springs: {damper: {type: linear, b: bob, at_a: [0, -2, 0], stiffness: 20, damping: 1, length: 2}}
loads: {weight: {type: gravity, acceleration: [0, -9.81, 0]}}
"""

# not a sample between its start and its end
UNSEEN = """
control: {{end_time: {end}, integrator: {method}, step: 1.0e-3}}
output: {{history: {{interval: {end}}}}}
bodies: {{bob: {{mass: 1, inertia: [0.1, 0.1, 0.1], position: [-1, 0, 0]}}}}
joints: {{pin: {{type: revolute, b: bob, at: [0, 0, 0], axis: [0, 0, 1]}}}}
springs: {{tie: {{type: linear, b: bob, at_a: [0, -2, 0], stiffness: 20, length: 2}}}}
"""

# [s] that a machine may take for what another does at once
BUSY = 600
# a run of half a second, in which control.txt is looked at every 0.1 s
SLOW = ("--set", "control.step_max=1e-6")

# one worker runs all of them, and compiles their scenes once
pytestmark = pytest.mark.xdist_group("runs")


def status(folder: Path) -> dict[str, Any]:
    content: dict[str, object] = json.loads((folder / "status.json").read_text("utf-8"))
    return content


def wait_for(path: Path, seconds: float = BUSY) -> None:
    """Wait until a file exists; compiling may come first."""
    until = time.monotonic() + seconds
    while not path.exists():
        assert time.monotonic() < until, f"{path} never came"
        time.sleep(0.01)


@pytest.mark.parametrize("number", first_quick([signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU]))
def test_a_run_stopped_by_a_signal_goes_on_to_the_same_bits(
    number: int, deck: Path, uninterrupted: dict[Path, Path], tmp_path: Path
) -> None:
    # on a busy machine the run may end before the signal is sent: then try again
    for _ in range(10):
        shutil.rmtree(tmp_path / "states", ignore_errors=True)
        run = start(deck, "-o", tmp_path)
        wait_for(tmp_path / "states" / "000001.h5")
        run.send_signal(number)
        run.communicate(timeout=BUSY)
        if run.returncode == 3:
            break
    stopped = status(tmp_path)
    assert (stopped["state"], stopped["exit_code"]) == ("stopped", 3)
    assert 0 < stopped["time"] < stopped["end_time"]
    assert (
        (tmp_path / "log.txt").read_text("utf-8").endswith("S t o p p e d   o n   r e q u e s t\n")
    )
    assert crashpost(["summary", str(tmp_path)]) == 0
    assert crashsolve(deck, "-o", tmp_path, "--restart").returncode == 0
    assert status(tmp_path)["state"] == "finished"
    assert differences(tmp_path, uninterrupted[deck]) == []


@pytest.mark.parametrize("method, end", [("rattle", 2000), ("dormand_prince_5", 500)])
@pytest.mark.long
def test_a_signal_need_not_wait_for_a_sample(method: str, end: int, tmp_path: Path) -> None:
    deck, whole, cut = tmp_path / "unseen.yaml", tmp_path / "whole", tmp_path / "cut"
    deck.write_text(UNSEEN.format(method=method, end=end), "utf-8")
    assert crashsolve(deck, "-o", whole).returncode == 0
    # on a busy machine the run may end before the signal is sent: then try again
    for _ in range(10):
        shutil.rmtree(cut, ignore_errors=True)
        run = start(deck, "-o", cut)
        wait_for(cut / "states" / "000000.h5")
        time.sleep(0.3)
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=BUSY)
        if run.returncode == 3 and status(cut)["time"] > 0:
            break
    assert 0 < status(cut)["time"] < end
    assert crashsolve(deck, "-o", cut, "--restart").returncode == 0
    # the one left alone has not been dumped
    assert [name for name in differences(cut, whole) if not name.startswith("dump:")] == []


def resumed(text: str, folder: Path) -> Path:
    """Results of a deck, from its start to its end; going on from a dump must give the same."""
    deck = folder / "pendulum.yaml"
    deck.write_text(text, "utf-8")
    whole, again = folder / "whole", folder / "again"
    assert crashsolve(deck, "-o", whole).returncode == 0
    assert "t = 1.9 s" in gone_on(deck, whole, again)
    return whole


def test_samples_within_steps_go_on_to_the_same_bits(tmp_path: Path) -> None:
    # a dump every 0.1 s, in the middle of some step
    log = (resumed(DAMPED, tmp_path) / "log.txt").read_text("utf-8")
    # far fewer than the 200 samples
    assert int(log.split("accepted, rejected")[1].split(",")[0]) < 100


@pytest.mark.long
@pytest.mark.parametrize(
    "method", ["generalized_alpha", pytest.param("radau_iia_5", marks=pytest.mark.long)]
)
def test_what_an_implicit_step_is_guessed_from_is_kept(method: str, tmp_path: Path) -> None:
    resumed(DAMPED.replace("dormand_prince_8", method), tmp_path)


def test_the_first_run_of_a_scene_has_the_bits_of_the_next(tmp_path: Path) -> None:
    cache, made = tmp_path / "cache", []
    for name in ("first", "next"):
        done = crashsolve(HEAP, "-o", tmp_path / name, CRASHSOLVE_CACHE=str(cache))
        assert done.returncode == 0
        made.append({path: path.stat().st_mtime_ns for path in cache.rglob("*.o")})
    # the first compiled what the next has loaded
    assert made[0] and made[0] == made[1]
    assert differences(tmp_path / "first", tmp_path / "next") == []


@pytest.mark.parametrize("seed", [1, *(pytest.param(n, marks=pytest.mark.long) for n in (2, 3))])
def test_a_run_killed_at_any_moment_stays_readable_and_goes_on_to_the_same_bits(
    seed: int, mechanism: Path, tmp_path: Path
) -> None:
    whole, cut, rng, kills = tmp_path / "whole", tmp_path / "cut", random.Random(seed), 0
    assert crashsolve(mechanism, "-o", whole, *SLOW).returncode == 0
    # on a busy machine a run may end before it is killed: then try again, from the beginning
    for _ in range(20):
        (cut / "states.xdmf").unlink(missing_ok=True)
        run = start(mechanism, "-o", cut, "--restart", *SLOW)
        wait_for(cut / "states.xdmf")
        time.sleep(rng.uniform(0.0, 0.4))
        run.kill()
        code = run.wait(BUSY)
        assert crashpost(["summary", str(cut)]) == 0
        assert crashpost(["channels", str(cut)]) == 0
        kills += code == -signal.SIGKILL
        if kills == 2:
            break
        if code == 0:
            shutil.rmtree(cut)
    assert kills > 0
    assert crashsolve(mechanism, "-o", cut, "--restart", *SLOW).returncode == 0
    assert differences(cut, whole) == []


def test_a_dump_by_signal_or_control_file_changes_nothing(mechanism: Path, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    assert crashsolve(mechanism, "-o", whole, *SLOW).returncode == 0
    cut, unknown = tmp_path / "cut", "control.txt: unknown word 'sleep' (words: dump, states, stop)"
    # on a busy machine the run may end before it is asked: then try again
    for _ in range(10):
        shutil.rmtree(cut, ignore_errors=True)
        run = start(mechanism, "-o", cut, *SLOW)
        wait_for(cut / "states" / "000001.h5")
        run.send_signal(signal.SIGUSR1)
        run.send_signal(signal.SIGCONT)
        (cut / "control.txt").write_text("dump sleep\n", "utf-8")
        output, _ = run.communicate(timeout=BUSY)
        assert run.returncode == 0
        if not (cut / "control.txt").exists():
            break
    assert output.count("restart dump") > 5
    assert f"warning: {unknown}" in output
    assert differences(cut, whole) == []


def test_the_control_file_writes_a_state_and_stops(mechanism: Path, tmp_path: Path) -> None:
    # on a busy machine the run may end before it is asked: then try again
    for _ in range(10):
        shutil.rmtree(tmp_path / "states", ignore_errors=True)
        (tmp_path / "control.txt").unlink(missing_ok=True)
        run = start(mechanism, "-o", tmp_path, *SLOW)
        wait_for(tmp_path / "states" / "000000.h5")
        (tmp_path / "control.txt").write_text("states stop", "utf-8")
        run.communicate(timeout=BUSY)
        if run.returncode == 3:
            break
    assert run.returncode == 3
    states = sorted((tmp_path / "states").glob("*.h5"))
    assert len(states) >= 2
    assert (tmp_path / "log.txt").read_text("utf-8").count("continue with --restart") == 1


def test_a_new_run_forgets_the_dumps_of_the_old_one(mechanism: Path, tmp_path: Path) -> None:
    assert crashsolve(mechanism, "-o", tmp_path).returncode == 0
    short = ("--set", "end=0.05")
    assert crashsolve(mechanism, "-o", tmp_path, *short).returncode == 0
    assert not list(tmp_path.glob("restart_*.h5"))


def middle_of_an_array(path: Path) -> int:
    """Where in a dump the middle byte of its largest array is."""
    arrays: list[tuple[int, int]] = []

    def visit(name: str, one: h5py.Dataset | h5py.Group) -> None:
        if isinstance(one, h5py.Dataset) and one.id.get_offset() is not None:
            arrays.append((one.id.get_storage_size(), one.id.get_offset()))

    with h5py.File(path) as file:
        file.visititems(visit)
    size, begin = max(arrays)
    return begin + size // 2


def test_a_broken_dump_is_passed_over_and_no_dump_begins_anew(
    mechanism: Path, uninterrupted: dict[Path, Path], tmp_path: Path
) -> None:
    done = crashsolve(mechanism, "-o", tmp_path, "--restart", "--set", "end=0.5")
    assert done.returncode == 0
    assert "warning: no restart dump in the folder: the run begins anew" in done.stdout
    newest = max(tmp_path.glob("restart_*.h5"), key=lambda path: path.stat().st_mtime_ns)
    content = bytearray(newest.read_bytes())
    # in the middle of an array: not every byte of a file of HDF5 belongs to one
    content[middle_of_an_array(newest)] ^= 0xFF
    newest.write_bytes(content)
    again = crashsolve(mechanism, "-o", tmp_path, "--restart")
    assert again.returncode == 0
    assert f"warning: {newest}: dump skipped: wrong checksum" in again.stdout
    assert differences(tmp_path, uninterrupted[mechanism]) == []


def test_a_dump_of_another_deck_is_refused_with_the_names_of_what_differs(
    mechanism: Path, tmp_path: Path
) -> None:
    assert crashsolve(mechanism, "-o", tmp_path, "--set", "end=0.1").returncode == 0
    words = ("--set", "bodies.hammer.mass=5", "--set", "end=0.2", "--restart")
    refused = crashsolve(mechanism, "-o", tmp_path, *words)
    assert refused.returncode == 2
    assert "belongs to another deck, or other values of --set" in refused.stderr
    assert "they differ in bodies.hammer.mass; run without --restart" in refused.stderr
    back = crashsolve(mechanism, "-o", tmp_path, "--restart", "--until", "0.05")
    assert back.returncode == 2
    assert "control.end_time: 0.05 s lies before the dump, 0.1 s; give a later time" in back.stderr
    alone = crashsolve(mechanism, "-o", tmp_path, "--until", "0.2")
    assert (alone.returncode, "--until: error: continues from a dump" in alone.stderr) == (2, True)


def test_a_run_goes_on_to_another_end_with_the_bits_of_the_whole(
    mechanism: Path, uninterrupted: dict[Path, Path], tmp_path: Path
) -> None:
    # its last dump is at 0.2 s
    assert crashsolve(mechanism, "-o", tmp_path, "--set", "end=0.25").returncode == 0
    words = ("--restart", "--until", "500 ms", "--set", "control.energy_limit=0.04")
    done = crashsolve(mechanism, "-o", tmp_path, *words)
    assert done.returncode == 0, done.stderr
    assert "with other control.end_time, control.energy_limit" in done.stdout
    assert status(tmp_path)["end_time"] == 0.5
    names = [name for name in differences(tmp_path, uninterrupted[mechanism])]
    assert [name for name in names if "deck" not in name] == []


def test_what_says_only_how_to_go_on_may_differ() -> None:
    old = "parameters: {end: 1}\ncontrol: {end_time: 1, safety: 0.1}\nbodies: {b: {mass: 1}}\n"
    assert differing(old, old) == []
    on = "parameters: {end: 2}\ncontrol: {end_time: 2, safety: 0.1}\nbodies: {b: {mass: 1}}\n"
    assert differing(old, on) == [("control.end_time", False)]
    reported = on + "output: {log: {interval: 1}}\n"
    assert differing(on, reported) == [("output", False)]
    for word, other in (("mass: 1", "mass: 2"), ("b: {mass", "c: {mass"), ("safety", "start_time")):
        assert any(bound for _, bound in differing(old, old.replace(word, other))), word


@pytest.mark.parametrize("share", [1e-6, 0.3, 0.499, 0.7, 1.3])
def test_no_sample_of_another_schedule_is_passed_over(share: float) -> None:
    interval = 1e-3
    done = 0.2
    # an end just behind what has been sampled is reached as well
    schedule = Schedule(0.0, done + share * interval, interval)
    k = schedule.last_until(done)
    assert schedule.time(k) <= done < schedule.time(k + 1)
    # and so with intervals of another length
    other = Schedule(0.0, 1.0, 0.77e-3)
    k = other.last_until(done + share * interval)
    assert other.time(k) <= done + share * interval < other.time(k + 1)
