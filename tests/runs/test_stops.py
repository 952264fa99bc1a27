"""Claim: a run that cannot go on says when, where, why and what to do, and leaves whole files."""

import json
import resource
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from command import arguments, crashsolve, environment
from quick import first_quick

from crashpost.results.result import Result

HERE = Path(__file__).parent
OSCILLATOR = HERE / "oscillator.yaml"
SHORTER = "take a shorter step: reduce control.safety or control.step"
FOLDED = (
    "relative to the body at the other end of a spring or beam element; such an element is valid "
    "for relative rotations below 3 rad: take more elements or segments; where parts rotate "
    "freely, take a joint with springs of its own"
)
STOPS = {
    "long_step": (
        "t = 0.1 s, cycle 10, the model: the energy balance is off by 104 % of the largest energy; "
        f"{SHORTER}; control.energy_limit sets the bound"
    ),
    "small_step": (
        "t = 0.000125 s, cycle 1, body 'block': the step has collapsed to 0.000141 s; "
        "look for a stiffness that is far too large, or a mass that is far too small, on this body"
    ),
    "curve_end": (
        "t = 0.501 s, cycle 501, curve 'push': read at 0.501, outside its range 0 to 0.5; "
        "extend the curve, or set extrapolate: hold or linear on its card"
    ),
    "contradiction": (
        "t = 0.5 s, cycle 500, joint 'rod': the joints cannot be closed (error 2.45e-06 of the "
        "model's size): they contradict each other, or the step is too long; "
        f"{SHORTER}; or remove a joint"
    ),
    "fast_spin": (
        "t = 0.01 s, cycle 1, body 'rotor': it rotates by 10 rad in a step of 0.01 s; angles are "
        "counted in steps of less than a quarter of a revolution: take steps below 0.00157 s"
    ),
    "folded_bushing": (
        f"t = 0.564 s, cycle 141, body 'wheel': it has rotated by 3.03 rad {FOLDED}"
    ),
    "swung_joint": (
        "t = 0.601 s, cycle 601, spring 'twist': its joint has swung by 3 rad, where azimuth and "
        "twist are not defined; keep its swing below 3 rad: by narrower half angles or a stiffer "
        "stop, or a cone where there is none"
    ),
    "folded_beam": (
        f"t = 0.0142105 s, cycle 1131, body 'rod_1, node rod_end': it has rotated by 3 rad {FOLDED}"
    ),
}


def check_stop(folder: Path, code: int, message: str) -> None:
    """Log, status and histories of a run that failed."""
    log = (folder / "log.txt").read_text("utf-8").splitlines()
    assert f"error: {message}" in log
    assert log[-1] == "E r r o r    t e r m i n a t i o n"
    status = json.loads((folder / "status.json").read_text("utf-8"))
    assert (status["state"], status["exit_code"]) == ("failed", code)
    assert status["message"] == message


def assert_finite(folder: Path) -> None:
    for channel in Result(folder).channels("*"):
        _, values, _ = Result(folder).series(channel.name)
        assert np.isfinite(values).all(), channel.name


@pytest.mark.parametrize("name", first_quick(STOPS))
def test_a_numerical_stop_names_time_place_cause_and_advice(name: str, tmp_path: Path) -> None:
    done = crashsolve(HERE / "stops" / f"{name}.yaml", "-o", tmp_path, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 4
    assert done.stderr.splitlines()[-1] == STOPS[name]
    check_stop(tmp_path, 4, STOPS[name])
    assert_finite(tmp_path)


@pytest.mark.long
@pytest.mark.parametrize(
    "method", first_quick(("generalized_alpha", "radau_iia_5", "dormand_prince_8"))
)
def test_methods_that_choose_their_steps_count_every_turn(method: str, tmp_path: Path) -> None:
    text = (HERE / "stops" / "fast_spin.yaml").read_text("utf-8")
    deck = tmp_path / "deck.yaml"
    deck.write_text(text.replace("step: 0.01", f"integrator: {method}"), "utf-8")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    angle = Result(tmp_path / "out").series("hinge.hinge.angle").values[-1]
    # 1 N m brakes 1 kg m^2; the elastic line of 0.01 rad counts for less than the tolerance
    assert angle == pytest.approx(1000.0 * 0.2 - 0.5 * 0.2**2, abs=1e-4)


BLOW = """
control: {end_time: 2e-4, integrator: generalized_alpha, tolerance: 1e-5, check_every: 10}
bodies: {mass: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
springs: {s: {type: linear, b: mass, at_a: [0, 0, 0], at_b: [0, 0, 0], stiffness: 1e4}}
curves: {blow: {type: formula, expression: "1e6*x**2", from: 0, to: 0.02}}
loads: {blow: {type: force, body: mass, force: [1, 0, 0], curve: blow}}
"""


@pytest.mark.long
def test_a_blow_from_rest_is_not_judged_by_the_first_of_its_energy(tmp_path: Path) -> None:
    # after ten steps the mass has 1e-20 J, of which a third is not accounted for
    deck, folder = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(BLOW, "utf-8")
    done = crashsolve(deck, "-o", folder, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    # F = c t^2: v = c t^3 / 3, of which the spring takes k t^2 / 20 m = 2e-5
    v = Result(folder).series("rbdout.mass.velocity.x").values[-1]
    assert v == pytest.approx(1e6 * 2e-4**3 / 3.0, rel=1e-4)


def test_energy_out_of_nothing_stops_the_run_within_a_few_steps(tmp_path: Path) -> None:
    text = (HERE / "stops" / "long_step.yaml").read_text("utf-8")
    # ten steps to a sample, and a balance judged from the hundredth on
    assert "check_every: 10," in text
    deck, folder = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(text.replace("check_every: 10,", "check_every: 100,"), "utf-8")
    done = crashsolve(deck, "-o", folder, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 4
    check_stop(folder, 4, STOPS["long_step"])
    assert_finite(folder)
    assert len(Result(folder).series("glstat.model.energy.kinetic").values) == 1


def test_a_motion_that_is_not_finite_stops_the_run_and_reaches_no_file(tmp_path: Path) -> None:
    deck = HERE / "stops" / "long_step.yaml"
    done = crashsolve(deck, "-o", tmp_path, "--set", "limit=1e9", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 4
    message = "t = 0.6 s, cycle 60, body 'block': its motion has diverged: positions or "
    message += "velocities are not finite; "
    check_stop(tmp_path, 4, message + SHORTER)
    assert_finite(tmp_path)


def test_joints_that_do_not_fit_are_an_error_of_the_deck(tmp_path: Path) -> None:
    deck = HERE / "stops" / "inconsistency.yaml"
    done = crashsolve(deck, "-o", tmp_path, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 2
    message = f"{deck}:7:3: error: joint 'pin': is violated by the initial velocities: 1 (SI); "
    check_stop(tmp_path, 2, message + "correct the joint or the bodies")


def test_wrong_decks_and_overrides_leave_no_folder_behind(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    for words, message in (
        ((tmp_path / "no.yaml",), "the file cannot be read: No such file or directory"),
        ((OSCILLATOR, "--set", "limt=1"), "unknown parameter 'limt'; did you mean 'limit'?"),
        ((OSCILLATOR, "--set", "limit"), "--set limit: error: no value; write --set NAME=VALUE"),
        ((OSCILLATOR, "--set", "limit=far"), "far"),
    ):
        done = crashsolve(*words, "-o", folder)
        assert done.returncode == 2
        assert message in done.stderr
        assert "Traceback" not in done.stderr
        assert not folder.exists()


def test_a_folder_that_cannot_be_made_ends_with_code_5(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file", "utf-8")
    for folder in (taken, taken / "below"):
        done = crashsolve(OSCILLATOR, "-o", folder)
        assert done.returncode == 5
        assert done.stderr.startswith(f"{folder}: ")
        assert "Traceback" not in done.stderr


# of the largest file, the histories, 147 kB are due
@pytest.mark.parametrize("size", [400, 20_000, 60_000, 120_000])
def test_a_full_disk_ends_with_code_5_and_whole_files(size: int, tmp_path: Path) -> None:
    """No file may grow beyond `size` bytes, as if the disk were full."""
    done = subprocess.run(
        arguments(OSCILLATOR, "-o", tmp_path),
        capture_output=True,
        text=True,
        timeout=300,
        env=environment(CRASHSOLVE_PLAIN="1"),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
    )
    assert done.returncode == 5
    assert "File too large" in done.stderr
    assert "Traceback" not in done.stderr
    for path in tmp_path.rglob("*.h5"):
        h5py.File(path).close()
    assert not list(tmp_path.rglob("*.partial"))
