"""Claim: samples taken in compiled code are those that Python takes one by one, to the bit."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.recording.changing import changing
from crashsolve.recording.histories import Histories
from crashsolve.recording.resampling import Resampling
from crashsolve.recording.sampling import Schedule
from crashsolve.simulation.forward import _march_through
from crashsolve.system.engine import Engine

# of a call of the compiled loop: more than one sample has, and fewer than two
STEPS = 13

# two balls fall upon each other and on a floor: touches within intervals, at their ends, and none
DECK = """\
control: {end_time: 0.3, integrator: METHOD}
output: {history: {interval: INTERVAL}}
bodies:
  a: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.15], velocity: [0.1, 0, -2]}
  b: {mass: 2, inertia: [1, 1, 1], position: [0.02, 0, 0.5], velocity: [0, 0, -1]}
surfaces:
  a: {type: sphere, body: a, radius: 0.1}
  b: {type: sphere, body: b, radius: 0.1}
  f: {type: plane}
springs: {s: {type: linear, a: b, b: ground, stiffness: 300, length: 0.4}}
loads: {g: {type: gravity, acceleration: [0, 0, -9.81]}}
contacts:
  floor: {a: [a, b], b: [f], normal: {type: kelvin_voigt, stiffness: 1e6, restitution: 0.5}}
  pair: {a: [a], b: [b], normal: {type: kelvin_voigt, stiffness: 1e7, restitution: 0.9}}
"""


class Taken:
    """A run from sample to sample, in blocks where that is possible or one by one."""

    def __init__(self, deck: Path, in_blocks: bool) -> None:
        read = read_deck(deck)
        self.engine = Engine(*build(read))
        self.histories, self.times = Histories(self.engine), [0.0]
        kept = self.histories.kept
        self.resampling = Resampling(self.engine, kept, True, self.take)
        self.blocks, marched = [], 0
        self.engine.start()
        self.engine.sample()
        self.histories.take()
        march, schedule, k = self.resampling.march, Schedule.of(read), 0
        if not in_blocks:
            # samples at steps of an interval as well are taken by Python
            march.look = lambda: None
        march.restart_count()
        self.resampling.begin()
        while not schedule.is_end(k):
            times = schedule.times(k + 1, 50)
            if in_blocks and march.can_march(float(times[-1])):
                count, _, left = march.go(times)
                self.times += times[:count].tolist()
                if left is not None:
                    self.engine.answer(left)
                marched, k = marched + count, k + count
                self.hand_over()
                if count:
                    continue
            k += 1
            self.resampling.reach(schedule.time(k))
            self.resampling.sample_steps(schedule.time(k))
            self.engine.sample(schedule.time(k))
            self.resampling.begin_interval()
            march.finish_interval()
            self.take(schedule.time(k))
        self.hand_over(full=True)
        self.marched, self.phase = marched, march.phase

    def take(self, time: float, is_stored: bool = False) -> None:
        self.times.append(time)
        if not is_stored:
            self.histories.take()
        self.hand_over()

    def hand_over(self, full: bool = False) -> None:
        if full or self.histories.kept.is_full:
            # the next samples overwrite them
            values = self.histories.values().items()
            self.blocks.append({family: own.copy() for family, own in values})

    def rows(self, family: str) -> np.ndarray:
        return np.concatenate([block[family] for block in self.blocks])


@pytest.mark.parametrize("interval", ["1e-3", "0.011"])
@pytest.mark.parametrize("method", ["rattle", "dormand_prince_5"])
def test_blocks_of_samples_are_samples_one_by_one(
    tmp_path: Path, method: str, interval: str
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.replace("METHOD", method).replace("INTERVAL", interval), "utf-8")
    fast, slow = Taken(deck, True), Taken(deck, False)
    count = round(0.3 / float(interval))
    # most are taken in blocks; some wait for Python, where a touch hides between two samples
    assert 0.6 * count < fast.marched < count and slow.marched == 0
    assert fast.times == slow.times and len(fast.times) > count
    for family in fast.histories.families:
        np.testing.assert_array_equal(fast.rows(family.name), slow.rows(family.name), family.name)
    assert fast.phase.tobytes() == slow.phase.tobytes()
    assert fast.resampling.march.marks.tobytes() == slow.resampling.march.marks.tobytes()
    ends = changing(fast.engine), changing(slow.engine)
    for name, array in ends[0].items():
        assert array.tobytes() == ends[1][name].tobytes(), name


def test_extremes_of_a_block_are_those_of_its_numbers(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.replace("METHOD", "rattle").replace("INTERVAL", "1e-3"), "utf-8")
    engine = Engine(*build(read_deck(deck)))
    histories = Histories(engine)
    # its code seeks them
    Resampling(engine, histories.kept, True, lambda *what: None)
    engine.start()
    count = 9
    for k in range(count):
        engine.advance(0.01 * (k + 1))
        engine.sample()
        histories.take()
    values = histories.values()
    extremes = histories.extremes(count)
    assert extremes is not None and set(extremes) == set(values)
    for family, own in values.items():
        for name, at, of in (("least", "at_least", np.min), ("greatest", "at_greatest", np.max)):
            np.testing.assert_array_equal(extremes[family][name], of(own, axis=0).T, family)
            first = (own == of(own, axis=0)).argmax(axis=0).T
            np.testing.assert_array_equal(extremes[family][at], first, family)
    for wrong in (np.nan, np.inf, -np.inf):
        for row in (0, 4, count - 1):
            values["rbdout"][row, 1, 2], kept = wrong, values["rbdout"][row, 1, 2]
            assert histories.extremes(count) is None
            values["rbdout"][row, 1, 2] = kept
    assert histories.extremes(count) is not None


def test_samples_ahead_are_those_of_the_schedule() -> None:
    schedule = Schedule(0.1, 1.0, 0.03).with_times({0.25, 0.7})
    for first in (0, 3, 5, 25):
        times = schedule.times(first, 12)
        expected = [schedule.time(k) for k in range(first, first + len(times))]
        assert times.tolist() == expected
        assert len(times) == 12 or times[-1] == 1.0


def test_a_pause_within_a_block_finds_all_samples_recorded(tmp_path: Path) -> None:
    # a dump that is asked for then writes the samples before it, with their times
    deck = tmp_path / "deck.yaml"
    text = DECK.replace("METHOD", "rattle, step: 1e-4").replace("INTERVAL", "1e-3")
    deck.write_text(text, "utf-8")
    engine = Engine(*build(read_deck(deck)))
    histories, times, pauses = Histories(engine), [0.0], []
    resampling = Resampling(engine, histories.kept, True, lambda *what: None)
    engine.start()
    engine.sample()
    histories.take()
    resampling.march.restart_count()
    resampling.begin()

    def look() -> None:
        pauses.append(len(times))
        assert histories.kept.count == len(times)
        engine._steps_per_call = STEPS

    engine.on_pause, engine._steps_per_call = look, STEPS
    run: Any = SimpleNamespace(
        engine=engine,
        resampling=resampling,
        histories=histories,
        recorder=SimpleNamespace(add_stored=times.extend),
        cpu={"steps": 0.0, "output": 0.0},
        sampled=0.0,
        account=SimpleNamespace(keep_alive=lambda: None),
        schedule=SimpleNamespace(end=1.0),
        write=lambda now, force: None,
        handle_requests=lambda: None,
    )
    # the balls fall freely until 0.024 s
    schedule = np.arange(1, 21) * 1e-3
    while len(times) < 20:
        _march_through(run, schedule[len(times) - 1 :])
    assert len(set(pauses)) > 2


@pytest.mark.parametrize(("interval", "copies"), [("1e-4", 0), ("4e-4", 20)])
def test_an_interval_of_one_step_needs_no_snapshot(
    tmp_path: Path, interval: str, copies: int
) -> None:
    # of free flight
    deck = tmp_path / "deck.yaml"
    text = DECK.replace("METHOD", "rattle, step: 1e-4")
    deck.write_text(text.replace("INTERVAL", interval), "utf-8")
    engine = Engine(*build(read_deck(deck)))
    resampling = Resampling(engine, Histories(engine).kept, True, lambda *what: None)
    engine.start()
    engine.sample()
    resampling.begin()
    # a dump there has none
    assert not [name for name in resampling.memory() if "/begin/" in name]
    total = 0
    for k in range(1, 21):
        assert resampling.march.go(np.array([k * float(interval)]))[0] == 1
        total += int(resampling.march.job.copies)
    assert total == copies
    resampling.reach(21 * float(interval))
    assert [name for name in resampling.memory() if "/begin/" in name]
