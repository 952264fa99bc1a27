"""Claim: a run that writes chosen channels writes them to the bit as one that writes all."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve, datasets

from crashpost import cli
from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.recording.histories import Histories, Start, families_of
from crashsolve.recording.selection import written_channels
from crashsolve.study.settings import settings

DECKS = Path(__file__).parents[2] / "decks"

# a box on a joint, with its mass centre off its origin, strikes a ball on a bar that yields
DECK = """\
control: {end_time: 0.1, integrator: rattle}
output: {history: {interval: 1e-3, channels: CHANNELS}}
bodies:
  box: {mass: 2, inertia: [1, 1, 1], mass_centre: [0, 0, 0.1], velocity: [0, 0, -1]}
  ball: {mass: 1, inertia: [1, 1, 1], position: [0, 0, -0.25]}
  free: {mass: 1, inertia: [1, 1, 1], position: [3, 0, 0], velocity: [1, 0, 0]}
joints:
  slide: {type: prismatic, a: ground, b: box, at: [0, 0, 0], axis: [0, 0, 1]}
  guide: {type: prismatic, a: ground, b: ball, at: [0, 0, -0.25], axis: [0, 0, 1]}
springs:
  bar: {type: elastoplastic, a: ball, b: ground, stiffness: 1e5, yield_force: 40, length: 0.25}
surfaces:
  box: {type: sphere, body: box, radius: 0.1}
  ball: {type: sphere, body: ball, radius: 0.1}
  far: {type: sphere, body: free, radius: 0.1}
contacts:
  strike: {a: [box], b: [ball], normal: {type: kelvin_voigt, stiffness: 1e6, restitution: 0.5}}
  never: {a: [far], b: [ball], normal: {type: kelvin_voigt, stiffness: 1e6, restitution: 0.5}}
sensors:
  nose: {type: accelerometer, body: box, role: head, gravity: true}
  seat: {type: accelerometer, body: ball, role: vehicle, gravity: true}
  tail: {type: accelerometer, body: free, role: chest, gravity: true}
loads: {w: {type: gravity}}
watch:
  - {channel: rbdout.ball.velocity.z, statistic: final}
  - {channel: rcforc.strike.peak_depth, statistic: max}
"""
# with every kind of pattern
CHOSEN = (
    "[nodout.nose.*, 'jntforc.guide.force.z', 'rbdout.*.origin.z']",
    "['rbdout.free.acceleration.x', '*.velocity.z']",
    "['deforc.*', rcforc.never.force.x]",
    "['nodout.*.acceleration.x']",
)


def written(folder: Path, channels: str, estimate: str = "auto") -> Path:
    deck = folder / "deck.yaml"
    text = DECK.replace("CHANNELS", channels).replace("rattle}", f"rattle, estimate: {estimate}}}")
    deck.write_text(text, "utf-8")
    return deck


def run(folder: Path, channels: str) -> Path:
    done = crashsolve(written(folder, channels), "-o", folder / "out")
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("whole"), "null")


def check_columns(folder: Path, whole: Path) -> set[str]:
    """Compare the columns of a history with those of one that has all; returns their paths."""
    own, every = datasets(folder / "history.h5"), datasets(whole / "history.h5")
    assert len(own) < len(every)
    # one dataset under many names
    times = [next(x for p, x in of.items() if p.endswith("/time")) for of in (own, every)]
    np.testing.assert_array_equal(*times)
    for path, values in own.items():
        family, _, column = path.partition("/")
        if column == "ids":
            assert set(values) <= set(every[path])
        elif column != "time":
            names = every[f"{family}/ids"].tolist()
            rows = [names.index(name) for name in own[f"{family}/ids"]]
            np.testing.assert_array_equal(values, every[path][:, rows], path)
    return set(own)


def estimates(folder: Path) -> list[str]:
    lines = (folder / "log.txt").read_text("utf-8").splitlines()
    return [line for line in lines if " of its scale" in line]


@pytest.mark.parametrize("channels", CHOSEN)
def test_chosen_channels_are_those_of_a_run_that_writes_all(
    tmp_path: Path, whole: Path, channels: str
) -> None:
    folder = run(tmp_path, channels)
    check_columns(folder, whole)
    # scales, errors, and states at events are as well
    assert estimates(folder) == estimates(whole) != []
    states = (sorted(p.name for p in (f / "states").glob("*.h5")) for f in (folder, whole))
    assert next(states) == next(states)


@pytest.mark.parametrize("gaps", [True, False])
def test_samples_without_gaps_have_the_same_forces(tmp_path: Path, gaps: bool) -> None:
    # seventy pairs, most of which do not touch at most samples
    deck = DECKS / "benchmark" / "dominoes.yaml"
    settings = ["control.estimate=off", "control.end_time=0.25", "output.history.interval=1e-3"]
    words = [word for setting in settings for word in ("--set", setting)]
    pattern = "rcforc.*.depth" if gaps else "rbdout.*"
    words += ["--set", f"output.history.channels=rcforc.*.force.* {pattern}"]
    assert crashsolve(deck, "-o", tmp_path / "some", *words).returncode == 0
    assert crashsolve(deck, "-o", tmp_path / "all", *words[:-2]).returncode == 0
    columns = check_columns(tmp_path / "some", tmp_path / "all")
    assert ("rcforc/depth" in columns) == gaps
    assert {"rcforc/force/x", "glstat/energy/contact_dissipated"} <= columns


def chosen(folder: Path, channels: str, estimate: str = "off") -> set[str]:
    deck = read_deck(written(folder, channels, estimate))
    model, state = build(deck)
    families = families_of(model, state, written_channels(deck, model, state))
    return {name for family in families for name in family.channels()}


def test_what_the_deck_and_events_need_is_always_written(tmp_path: Path) -> None:
    names = chosen(tmp_path, "[nodout.nose.resultant]")
    # the vector of a watched component, and what a peak follows
    assert {f"rbdout.ball.velocity.{axis}" for axis in "xyz"} <= names
    assert {"rcforc.strike.depth", "rcforc.never.peak_normal", "deforc.bar.set"} <= names
    assert {"glstat.model.balance", "glstat.model.energy.kinetic"} <= names
    assert not [name for name in names if "momentum" in name]
    assert "glstat.model.momentum_error" in chosen(tmp_path, "[glstat.model.momentum_error]")
    assert "nodout.nose.resultant" in names
    others = ("nodout.nose.velocity", "nodout.seat", "rbdout.box", "jntforc", "rcforc.strike.force")
    assert not [name for name in names if name.startswith(others)]
    # by which a run that estimates errors knows what its samples miss
    more = chosen(tmp_path, "[nodout.nose.resultant]", "auto")
    assert {"rbdout.box.position.x", "rbdout.free.angular_acceleration.z"} <= more - names


def test_of_a_sample_only_what_is_chosen_is_copied(tmp_path: Path) -> None:
    deck = read_deck(written(tmp_path, "[nodout.nose.resultant]", "off"))
    model, state = build(deck)
    channels = written_channels(deck, model, state)
    both = Histories(Start(model, state)), Histories(Start(model, state), channels)
    counts = [int((h.kept.tables["pieces"]["width"] * h.kept.tables["pieces"]["number"]).sum())
              for h in both]  # fmt: skip
    glstat = next(f for f in both[1].families if f.name == "glstat")
    others = sum(len(f.ids) * len(f.columns) for f in both[1].families if f.name != "glstat")
    # of glstat some are computed
    assert others < counts[1] <= others + len(glstat.columns) + 9 < counts[0] / 3
    assert [len(h.kept.tables["joints"]) for h in both] == [2, 0]
    assert [len(h.kept.tables["origins"]) for h in both] == [3, 0]


def test_motions_of_which_one_component_is_written_are_not_judged(tmp_path: Path) -> None:
    deck = written(tmp_path, "['rbdout.*.position.z', 'rbdout.*.acceleration.x']", "off")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    motions = {name for name in datasets(tmp_path / "out" / "history.h5") if "position" in name}
    assert motions == {"rbdout/position/z"}


@pytest.mark.parametrize(
    ("pattern", "advice"),
    [
        ("accelerometers.*", "families: glstat"),
        ("nodout.nosse.*", "did you mean 'nose'?"),
        ("nodout.*.aceleration.x", "did you mean 'acceleration.x'?"),
        ("rbdout", "write 'rbdout.*'"),
        ("*.velocity", "write '*.velocity.*'"),
        ("NODOUT.*", "families: glstat"),
    ],
)
def test_a_pattern_that_fits_nothing_is_refused(tmp_path: Path, pattern: str, advice: str) -> None:
    deck = written(tmp_path, f"['{pattern}', 'rbdout.*']")
    for words in (("check", deck), (deck, "-o", tmp_path / "out")):
        done = crashsolve(*words)
        assert done.returncode == 2
        assert f"'{pattern}' fits no channel" in done.stderr and advice in done.stderr
    with pytest.raises(DeckErrors):
        chosen(tmp_path, f"['{pattern}']")


def test_no_pattern_is_refused(tmp_path: Path) -> None:
    done = crashsolve("check", written(tmp_path, "[]"))
    assert done.returncode == 2 and "leave the field out for all" in done.stderr


def test_a_watched_channel_that_does_not_exist_is_refused_as_before(tmp_path: Path) -> None:
    deck = written(tmp_path, "['rbdout.*']")
    deck.write_text(deck.read_text("utf-8").replace("rbdout.ball.velocity.z", "rbdout.bal.x"))
    done = crashsolve("check", deck)
    assert done.returncode == 2 and "no rbdout of 'bal'" in done.stderr


def test_a_restart_continues_the_channels_and_refuses_others(tmp_path: Path, whole: Path) -> None:
    deck = written(tmp_path, "['nodout.*']")
    words = (deck, "-o", tmp_path / "out", "--set", "output.restart.every=0.03")
    assert crashsolve(*words, "--set", "control.end_time=0.05").returncode == 0
    done = crashsolve(*words, "--restart", "--set", "output.history.channels=nodout.nose.*")
    assert done.returncode == 5 and "have changed" in done.stderr
    assert crashsolve(*words, "--restart").returncode == 0
    two = (Result(folder).series("nodout.nose.acceleration.z") for folder in (words[2], whole))
    first, second = two
    np.testing.assert_array_equal(first.values, second.values)


def test_crashpost_states_what_was_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(run(tmp_path, "[nodout.nose.*, 'nodout.*.acceleration.x']"))
    # whole rectangles of a family are written, so nose alone chooses the velocity of all
    assert cli.main(["injury", folder]) == 0
    assert "not stated" not in capsys.readouterr().out
    folder = str(run(tmp_path, "['nodout.*.acceleration.x', 'rbdout.*']"))
    assert cli.main(["injury", folder]) == 0
    shown = capsys.readouterr().out
    for name in ("Nose", "Seat", "Tail"):
        assert f"{name}  " in shown
    assert shown.count("output.history.channels did not choose all of nodout.") == 3
    assert cli.main(["value", folder, "nodout.nose.acceleration.y:max"]) != 0
    message = capsys.readouterr().err
    assert "is not in the history, for which output.history.channels chose" in message
    for words in (["summary"], ["report"], ["pack"], ["plot", "--", "force", "gap", "crush"]):
        assert cli.main([words[0], folder, *words[2:]]) == 0, words


def test_a_study_measures_all_channels(tmp_path: Path) -> None:
    for channels, own in (("['nodout.*']", "null"), ("null", None)):
        grid = settings(read_deck(written(tmp_path, channels)), [], None, None)
        assert {one.overrides.get("output.history.channels") for one in grid} == {own}
