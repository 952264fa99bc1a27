"""Claim: two threads are bitwise identical to one, go on to them, and stop where one does."""

import shutil
import signal
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from bench import plain
from command import crashsolve, differences, gone_on, start
from shells import Elements

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.partition import halve
from crashsolve.system.compose import compose
from crashsolve.system.threads import worker

# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("threads")

# a yielding plate, held, pressed and damped, on which a ball falls, beside one that flies
DECK = """
title: Two plates and a ball
control: {threads: 2, end_time: 4e-4, safety: 0.8, check_every: 10}
materials:
  steel: {type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 2e8}
bodies:
  ball:
    mass: 0.1
    inertia: [8e-5, 8e-5, 8e-5]
    position: [0.16, 0.15, 0.022]
    velocity: [0, 0, -20]
parts:
  plate:
    type: shell
    mesh: {type: grid, along: [0.3, 0, 0], across: [0, 0.3, 0], elements: [14, 13]}
    thickness: 0.002
    material: steel
    layers: 3
    thinning: true
    nodes: [{name: mid, at: [0.15, 0.15, 0]}]
    hold: [{nodes: u0}, {nodes: v0, motions: [x, z]}]
  other:
    type: shell
    mesh: {type: grid, along: [0.1, 0, 0], across: [0, 0.1, 0], elements: [5, 5], at: [0, 0, 0.1]}
    thickness: 0.002
    material: steel
    layers: 3
    drag: 50
    velocity: [0, 1, 0]
    angular_velocity: [300, 0, 100]
surfaces:
  ball: {type: sphere, body: ball, radius: 0.02}
  plate: {type: nodes, part: plate}
contacts:
  hits: {a: [plate], b: [ball], normal: {type: kelvin_voigt, stiffness: 1e7, damping: 10}}
loads: {q: {type: pressure, part: plate, pressure: 1e5}}
output: {history: {interval: 2e-5}, states: {interval: 1e-4}, restart: {every: 1e-4}}
"""


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The deck, and its results with two threads."""
    folder = tmp_path_factory.mktemp("threads")
    deck = folder / "plates.yaml"
    deck.write_text(DECK, "utf-8")
    done = crashsolve(deck, "-o", folder / "two")
    assert done.returncode == 0, done.stdout + done.stderr
    return deck, folder / "two"


def test_two_threads_give_the_bits_of_one(two: tuple[Path, Path], tmp_path: Path) -> None:
    deck, folder = two
    done = crashsolve(deck, "-o", tmp_path, "--set", "control.threads=1")
    assert done.returncode == 0, done.stderr
    assert differences(tmp_path, folder) == []


def test_the_second_thread_alone_has_points_lent(two: tuple[Path, Path]) -> None:
    # did the first as well, it might clear what the second has begun to add: seldom, by chance
    text = compose(build(read_deck(two[0]))[0])
    first, _, second = text.partition("def assist")
    # once for the elements, once for the pressure on them
    assert second.count("worker.lend(") == 2 and "worker.lend(" not in first


def test_two_threads_go_on_from_a_dump_to_the_same_bits(
    two: tuple[Path, Path], tmp_path: Path
) -> None:
    deck, folder = two
    gone_on(deck, folder, tmp_path / "again")


def test_two_threads_stop_at_a_signal_and_go_on(two: tuple[Path, Path], tmp_path: Path) -> None:
    deck, folder = two
    # on a busy machine the run may end before the signal is sent: then try again
    for _ in range(10):
        shutil.rmtree(tmp_path / "cut", ignore_errors=True)
        run = start(deck, "-o", tmp_path / "cut")
        until = time.monotonic() + 60
        while not (tmp_path / "cut/states/000001.h5").exists() and time.monotonic() < until:
            time.sleep(0.001)
        run.send_signal(signal.SIGTERM)
        if run.wait(60) == 3:
            break
    assert run.returncode == 3
    assert crashsolve(deck, "-o", tmp_path / "cut", "--restart").returncode == 0
    assert differences(tmp_path / "cut", folder) == []


def test_a_step_too_long_stops_two_threads(two: tuple[Path, Path], tmp_path: Path) -> None:
    # some ten times the stable one
    done = crashsolve(two[0], "-o", tmp_path, "--set", "control.step=3e-5")
    assert done.returncode == 4
    assert "take a shorter step" in done.stderr + done.stdout


def mixed(rng: np.random.Generator) -> tuple[Any, list[list[int]]]:
    """A warped grid of quadrilaterals and triangles in an order without any sense."""
    n, m = 9, 8
    u, v = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    nodes = np.stack([0.1 * u.ravel(), 0.1 * v.ravel(), 0.01 * np.sin(u * v).ravel()], axis=1)
    faces = []
    for i in range(n - 1):
        for j in range(m - 1):
            a, b, c, d = (
                k + 1 for k in (i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1)
            )
            faces += [[a, b, c, c], [a, c, d, d]] if rng.random() < 0.4 else [[a, b, c, d]]
    return nodes.tolist(), [faces[k] for k in rng.permutation(len(faces))]


@pytest.mark.parametrize("element", ["reduced", "fully_integrated", "triangles"])
def test_halves_of_a_part_push_its_points_as_the_whole(element: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    mesh, motion = mixed(rng), 1e-3 * rng.normal(size=(72, 6))
    whole = Elements(tmp_path, mesh, element=element)
    forces = whole.move(motion)
    cut = Elements(tmp_path, mesh, element=element)
    halves = halve(cut.model, cut.state)
    points = halves.points.view(np.recarray)
    own = points[:72]
    own.v, own.w = motion[:, :3], motion[:, 3:]
    own.r += own.v
    shared = {
        "lanes": cut.state.blocks,
        "work": cut.scene.work,
        "curves": cut.scene.curves,
        "points": points,
        "loans": halves.loans.view(np.recarray),
        "lent": halves.lent.view(np.recarray),
        "second_clock": halves.second_clock.view(np.recarray),
    }
    word = cut.model.element_groups()[0].word
    # the second first: the order of the threads does not count
    for k, corners in ((1, halves.corners), (0, cut.scene.corners)):
        clock = shared["second_clock"][0] if k else cut.clock
        scene = SimpleNamespace(corners=corners, **shared)
        if k:
            plain(worker.lend)(scene)
        row = halves.rows[k][word].view(np.recarray)[0]
        assert row.element_count > 0
        for kind in cut.kinds:
            plain(kind.deform)(row, clock, 1.0, scene, cut.material)
    assert len(halves.loans) > 50
    plain(worker.take_back)(cut.clock, scene)
    found = np.hstack([own.force, own.torque])
    assert found.tobytes() == forces.tobytes()
    assert cut.clock.element_rate == whole.clock.element_rate
    assert cut.clock.limit_element == whole.clock.limit_element


WRONG = {
    "threads: 2": ("threads: 3", "control: threads: must be at most 2, not 3"),
    "{threads: 2,": (
        "{threads: 2, integrator: generalized_alpha, step: 1e-5,",
        "threads: share explicit steps only; say integrator: rattle",
    ),
    DECK[DECK.index("parts:") :]: (
        "",
        "control: threads: share the elements of shells, and there are none; leave it out",
    ),
}


@pytest.mark.parametrize("right", list(WRONG))
def test_threads_without_a_use_are_refused(tmp_path: Path, right: str) -> None:
    wrong, message = WRONG[right]
    path = tmp_path / "wrong.yaml"
    assert right in DECK
    path.write_text(DECK.replace(right, wrong), "utf-8")
    with pytest.raises(DeckErrors) as caught:
        read_deck(path)
    assert message in str(caught.value)
