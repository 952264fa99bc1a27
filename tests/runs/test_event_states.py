"""Claim: states are at first touch, largest force and first yield; all else is as without."""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, datasets

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.contact.node_to_surface import make_room
from crashsolve.recording.changing import Snapshot, changing
from crashsolve.recording.engines import engine_of

DECKS = Path(__file__).parents[2] / "decks"

# a bar that yields as a ball strikes it, on a floor that a second ball touches from the start, and
# two cylinders, of which the one that is farther from the floor lands as the run ends
DECK = """\
control: {end_time: 0.2, estimate: off}
output: {history: {interval: 0.00037}}
bodies:
  a: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.1], velocity: [0, 0, 0]}
  b: {mass: 2, inertia: [1, 1, 1], position: [0, 0, 0.45], velocity: [0, 0, -2]}
  d: {mass: 0.1, inertia: [1, 1, 1], position: [2, 0, 0.15]}
  c: {mass: 0.1, inertia: [1, 1, 1], position: [1, 0, 0.285], velocity: [0, 0, -1]}
surfaces:
  d: {type: cylinder, body: d, radius: 0.1, length: 0.2}
  c: {type: cylinder, body: c, radius: 0.1, length: 0.2}
  a: {type: sphere, body: a, radius: 0.1}
  b: {type: sphere, body: b, radius: 0.1}
  f: {type: plane}
springs:
  bar: {type: elastoplastic, a: a, b: ground, stiffness: 1e5, yield_force: 40, length: 0.1}
contacts:
  floor: {a: [a], b: [f], normal: {type: kelvin_voigt, stiffness: 1e6, restitution: 0.5}}
  late: {a: [d, c], b: [f], normal: {type: hertz, stiffness: 1e3}}
  pair: {a: [a], b: [b], normal: {type: kelvin_voigt, stiffness: 1e5, restitution: 0.9}}
"""


def times_of_states(folder: Path) -> list[float]:
    times = []
    for path in sorted((folder / "states").glob("*.h5")):
        with h5py.File(path) as file:
            times.append(float(file.attrs["time"]))
    return times


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Of the same deck, with states at events and at intervals alone."""
    folder = tmp_path_factory.mktemp("events")
    deck = folder / "deck.yaml"
    deck.write_text(DECK, "utf-8")
    folders = {}
    for name, requested in {
        "events": (),
        "plain": ("--set", "output.states.interval=0.004"),
    }.items():
        folders[name] = folder / name
        done = crashsolve(deck, "-o", folders[name], *requested)
        assert done.returncode == 0, done.stderr
    return folders


def test_states_are_at_events(results: dict[str, Path]) -> None:
    times, plain = (times_of_states(results[name]) for name in ("events", "plain"))
    assert times == sorted(times) and set(plain) < set(times)
    with h5py.File(results["events"] / "history.h5") as file:
        time, force = file["rcforc/time"][:], file["rcforc/normal"][:]
        touch = time[np.argmax(np.count_nonzero(file["rcforc/onsets"][:], axis=1) > 1)]
        largest = time[np.argmax(force.max(axis=1))]
        begins = time[np.argmax(file["deforc-elastoplastic/set"][:, 0] != 0.0)]
    assert set(times) - set(plain) <= {touch, largest, begins}
    assert {touch, largest, begins} <= set(times)
    # three events, of which none has met a state by chance
    assert len(times) == len(plain) + len({touch, largest, begins})


def test_a_state_at_an_event_is_the_sample_there(results: dict[str, Path]) -> None:
    folder = results["events"]
    with h5py.File(folder / "history.h5") as file:
        time, z = file["rbdout/time"][:], file["rbdout/position/z"][:]
    with h5py.File(folder / "mesh.h5") as file:
        start = file["mass_centres/points"][:, 2]
    for path in sorted((folder / "states").glob("*.h5")):
        with h5py.File(path) as file:
            row = int(np.flatnonzero(time == file.attrs["time"])[0])
            moved = file["mass_centres/displacement"][:, 2]
            # the path of 0.4 m by a float of 32 bits
            np.testing.assert_allclose(moved, z[row] - start, rtol=0, atol=3e-8)


def test_a_state_shows_the_forces_of_what_touches_at_its_time(results: dict[str, Path]) -> None:
    folder, shown = results["events"], []
    with h5py.File(folder / "history.h5") as file:
        time, touching = file["rcforc/time"][:], file["rcforc/touching"][:]
    for path in sorted((folder / "states").glob("*.h5")):
        with h5py.File(path) as file:
            row = int(np.flatnonzero(time == file.attrs["time"])[0])
            drawn = file["contacts/contact"][:][np.any(file["contacts/force"][:], axis=1)]
        counts = [np.count_nonzero(drawn == card) for card in range(touching.shape[1])]
        # what touches at no depth has no force
        assert (counts <= touching[row]).all()
        shown.append(counts[1])
    # the cylinder at the end alone
    assert shown[-1] > 0 and not any(shown[: len(shown) // 2])


def test_all_else_is_as_without_states_at_events(results: dict[str, Path]) -> None:
    histories = [datasets(results[name] / "history.h5") for name in ("events", "plain")]
    for name, values in histories[0].items():
        assert np.array_equal(values, histories[1][name]), name


def test_the_index_lists_the_states_by_time(results: dict[str, Path]) -> None:
    index = (results["events"] / "states.xdmf").read_text("utf-8")
    for k, time in enumerate(times_of_states(results["events"])):
        assert f"states/{k:06d}.h5" in index and repr(time)[:8] in index


@pytest.mark.long
def test_a_run_with_states_at_events_goes_on(results: dict[str, Path], tmp_path: Path) -> None:
    folder = tmp_path / "again"
    shutil.copytree(results["events"], folder)
    deck = results["events"].parent / "deck.yaml"
    done = crashsolve(deck, "-o", folder, "--set", "output.restart.every=0.05")
    assert done.returncode == 0, done.stderr
    before = times_of_states(folder)
    again = crashsolve(deck, "-o", folder, "--set", "output.restart.every=0.05", "--restart")
    assert again.returncode == 0, again.stderr
    assert set(times_of_states(folder)) <= set(before)


def test_what_is_restored_may_be_restored_once_more() -> None:
    """Two events in one interval begin at the same sample; shells gave the second another begin."""
    deck = read_deck(DECKS / "verification/contact/faces.yaml")
    engine = engine_of(deck, *build(deck))
    engine.start()
    before = Snapshot(engine)
    before.take()
    kept = {name: array.copy() for name, array in changing(engine).items()}
    for _ in range(2):
        # what a step does: in place, and by longer lists in place of short ones
        group = next(g for g in engine.model.nodal_groups if g.narrow is None)
        group.arrays["totals"]["pairs"] = group.arrays["p"]["room"]
        make_room(engine.model.nodal_groups)
        group.arrays["probe_states"]["depth"] = 1.0
        before.restore_copy()
        now = changing(engine)
        assert now.keys() == kept.keys()
        for name, array in now.items():
            np.testing.assert_array_equal(array, kept[name], name)
        assert group.arrays["p"]["room"][0] == len(group.arrays["near"])
