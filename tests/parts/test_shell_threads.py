"""Claim: any number of threads gives the bits of one, goes on to them, and stops as one does."""

import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command import check_restart_after_signal, crashsolve, differences, gone_on, results
from quick import first_quick
from shells import Elements

from crashsolve.deck.reading.deck import read_deck
from crashsolve.deck.run_cards.control import CORES_GIVEN
from crashsolve.elements.shells.forces import blocks
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.partition import PIECES, cut
from crashsolve.system.compose import compose
from crashsolve.threads import jobs, worker

# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("threads")

DECKS = Path(__file__).parents[2] / "decks/verification/parts"
# a yielding plate, held and pressed; a ball and an ellipsoid fall on its nodes and faces, and a
# sheet, damped, which rubs and tears
DECK = """
title: Two plates and a ball
control: {threads: 2, end_time: 4e-4, safety: 0.8, check_every: 10}
materials:
  steel: {type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 2e8}
  weak: {type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 5e7,
    failure_strain: 5e-5}
bodies:
  ball:
    mass: 0.1
    inertia: [8e-5, 8e-5, 8e-5]
    position: [0.1, 0.1, 0.0202]
    velocity: [0, 0, -20]
  egg:
    mass: 0.05
    inertia: [4e-5, 4e-5, 4e-5]
    position: [0.06, 0.21, 0.0125]
    velocity: [0, 0, -20]
    angular_velocity: [100, 0, 0]
parts:
  plate:
    type: shell
    mesh: {type: grid, along: [0.3, 0, 0], across: [0, 0.3, 0], elements: [14, 13]}
    thickness: 0.002
    material: steel
    layers: 3
    thinning: true
    nodes: [{name: mid, at: [0.15, 0.15, 0]}]
    supports: [{nodes: u0}, {nodes: v0, motions: [x, z]}]
  other:
    type: shell
    mesh: {type: grid, along: [0.1, 0, 0], across: [0, 0.1, 0], elements: [5, 5],
      at: [0.17, 0.04, 0.0021]}
    thickness: 0.002
    material: weak
    layers: 3
    drag: 50
    velocity: [0, 5, -10]
    angular_velocity: [0, 30, 100]
surfaces:
  ball: {type: sphere, body: ball, radius: 0.02}
  egg: {type: ellipsoid, body: egg, semi_axes: [0.02, 0.015, 0.01]}
  plate: {type: nodes, part: plate}
  faces: {type: faces, part: plate, normals: continuous}
  sheet: {type: nodes, part: other, radius: 0.001}
contacts:
  hits: {a: [plate], b: [ball], normal: {type: kelvin_voigt, stiffness: 1e7, damping: 10}}
  rolls: {a: [egg], b: [faces], normal: {type: kelvin_voigt, stiffness: 1e7, damping: 10}}
  lies:
    a: [sheet]
    b: [faces]
    normal: {type: kelvin_voigt, stiffness: 1e6, damping: 10}
    friction: {type: coulomb, friction_coefficient: 0.2, full_above: 0.1, none_below: 0.01}
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


def test_the_scene_has_all_that_threads_share(two: tuple[Path, Path]) -> None:
    content = results(two[1])
    assert content["history.h5:matsum-shell/deleted"].max() > 0
    assert (content["history.h5:rcforc/peak_normal"].max(axis=0) > 0.0).all()
    assert content["history.h5:matsum-shell/plastic"].max() > 0.0


# beyond two, more than this machine has cores, and more than there are blocks of elements
@pytest.mark.parametrize("threads", first_quick([1, 3, 4, 8, 40], 2))
def test_any_number_of_threads_gives_the_same_bits(
    two: tuple[Path, Path], threads: int, tmp_path: Path
) -> None:
    deck, folder = two
    done = crashsolve(deck, "-o", tmp_path, "--set", f"control.threads={threads}")
    assert done.returncode == 0, done.stderr
    assert differences(tmp_path, folder) == []


def test_a_job_has_as_many_threads_as_it_was_given_cores(
    two: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(CORES_GIVEN, raising=False)
    path = tmp_path / "job.yaml"
    path.write_text(DECK.replace("threads: 2, ", ""), "utf-8")
    assert read_deck(path).threads == 1
    monkeypatch.setenv(CORES_GIVEN, "3")
    assert read_deck(path).threads == 3
    assert read_deck(two[0]).threads == 2
    monkeypatch.setenv(CORES_GIVEN, "all")
    with pytest.raises(DeckErrors, match="SLURM_CPUS_PER_TASK: must be a whole number"):
        build(read_deck(path))
    # of no matter where there is nothing to share, and to steps that cannot be shared
    path.write_text("control: {end_time: 1}\nbodies: {b: {mass: 1, inertia: [1, 1, 1]}}\n", "utf-8")
    assert read_deck(path).threads == 1
    implicit = {"control.integrator": "generalized_alpha", "control.step": "1e-5"}
    assert read_deck(DECKS / "shell_blast.yaml", implicit).threads == 1


def test_one_thread_has_nothing_of_several(two: tuple[Path, Path]) -> None:
    texts = [compose(build(read_deck(two[0], {"control.threads": n}))[0]) for n in "128"]
    assert texts[1] == texts[2] and "def assist" in texts[1]
    assert "worker" not in texts[0] and "jobs" not in texts[0]


@pytest.mark.parametrize("threads", [1, 3])
def test_a_restart_with_other_threads_has_the_same_bits(
    two: tuple[Path, Path], threads: int, tmp_path: Path
) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(DECK.replace("threads: 2", f"threads: {threads}"), "utf-8")
    assert "with other control.threads" in gone_on(other, two[1], tmp_path / "again")


def test_threads_stop_at_a_signal_and_continue(two: tuple[Path, Path], tmp_path: Path) -> None:
    threads = ("--set", "control.threads=3")
    check_restart_after_signal(*two, tmp_path / "cut", *threads)


def test_a_step_too_long_stops_any_number_of_threads_alike(
    two: tuple[Path, Path], tmp_path: Path
) -> None:
    reported = set()
    for threads in "13":
        # some ten times the stable one
        words = ("--set", "control.step=3e-5", "--set", f"control.threads={threads}")
        done = crashsolve(two[0], "-o", tmp_path / threads, *words)
        assert done.returncode == 4
        reported.add(
            next(line for line in done.stderr.splitlines() if "take a shorter step" in line)
        )
    assert len(reported) == 1


def test_every_piece_is_taken_once_whoever_comes_when() -> None:
    rng, next_piece = random.Random(1), worker.next_piece
    for threads, pieces in ((1, 1), (2, 8), (3, 2), (8, 33)):
        queues = np.zeros(worker.QUEUES + worker.LINE * threads, np.int64)
        for _ in range(3):
            called = worker.call(pieces, threads, queues)
            claim = []
            while (k := next_piece(rng.randrange(threads), called, threads, queues)) >= 0:
                claim.append(k)
                worker.finish(queues)
            assert sorted(claim) == list(range(pieces))
            worker.wait_for_all(pieces, queues)
        # one that comes late to a round finds nothing of the next
        worker.call(pieces, threads, queues)
        assert next_piece(0, called, threads, queues) == -1


def test_who_waits_long_sleeps(monkeypatch: pytest.MonkeyPatch) -> None:
    naps: list[int] = []
    offers: list[int] = []
    patient = worker.back_off
    monkeypatch.setitem(patient.__globals__, "sleep", naps.append)
    monkeypatch.setitem(patient.__globals__, "offer_processor", lambda: offers.append(1))
    polls = 0
    for _ in range(worker.SPINS + worker.YIELDS + 11):
        polls = patient(polls)
    assert (len(offers), naps) == (worker.YIELDS, [worker.SLEEP_TIME] * 10)


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


@pytest.mark.parametrize("threads", [2, 5])
@pytest.mark.parametrize("element", ["reduced", "fully_integrated", "triangles"])
def test_pieces_of_a_part_push_its_points_as_the_whole(
    element: str, threads: int, tmp_path: Path
) -> None:
    rng = np.random.default_rng(3)
    mesh, motion = mixed(rng), 1e-3 * rng.normal(size=(72, 6))
    whole = Elements(tmp_path, mesh, element=element)
    forces = whole.move(motion)
    one = Elements(tmp_path, mesh, element=element)
    pieces = cut(one.model, one.state, threads)
    points = pieces.points.view(np.recarray)
    own = points[:72]
    own.v, own.w = motion[:, :3], motion[:, 3:]
    own.r += own.v
    elements: Any = one.model.elements
    scene = SimpleNamespace(
        lanes=one.state.blocks,
        work=one.scene.work,
        curves=one.scene.curves,
        points=points,
        corners=elements.corners.base,
        pieces=pieces.pieces.view(np.recarray),
        originals=pieces.originals.view(np.recarray),
        replicas=pieces.replicas.view(np.recarray),
    )
    rows = pieces.rows[one.model.element_groups()[0].word].view(np.recarray)
    # a block is the least
    assert len(rows) == len(pieces.pieces) > 3
    assert len(rows) <= PIECES * threads
    # the order of the pieces does not count
    for k in rng.permutation(len(rows)):
        one.clock.element_rate = 0.0
        for kind in one.kinds:
            blocks.deform(kind, rows[k], one.clock, 1.0, scene, one.material)
        scene.pieces[k].rate = one.clock.element_rate
        scene.pieces[k].element = one.clock.limit_element
    assert len(pieces.originals) > 50
    for k in rng.permutation(len(rows)):
        jobs.collect_replicas(scene.pieces[k], scene)
    jobs.note_rates(one.clock, 0, scene)
    loads = np.hstack([own.force, own.torque])
    assert loads.tobytes() == forces.tobytes()
    assert one.clock.element_rate == whole.clock.element_rate
    assert one.clock.limit_element == whole.clock.limit_element


WRONG = {
    "threads: 2": ("threads: 1000000", "control: threads: must be at most 1024, not 1e+06"),
    "{threads: 2": ("{threads: 0", "control: threads: must be at least 1, not 0"),
    "threads: 2, end": ("threads: 1.5, end", "control: threads: must be a whole number"),
    "{threads: 2,": (
        "{threads: 2, integrator: generalized_alpha, step: 1e-5,",
        "threads: only explicit steps are shared; set integrator: rattle",
    ),
    DECK[DECK.index("parts:") :]: (
        "",
        "control: threads: share the elements of shells, and rigid contacts with many elements "
        "(1000 on both sides together), and there are neither; leave it out",
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
