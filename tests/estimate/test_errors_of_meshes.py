"""Claim: an error has the mesh in it, within a factor of ten, or says that meshes state none."""

import json
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest
from quick import first_quick
from small_runs import CANTILEVER

from crashsolve.channels.series import Series
from crashsolve.deck.reading.deck import read_deck
from crashsolve.estimate.error import Estimate
from crashsolve.estimate.estimator import Estimator, estimate_in_memory, left_out
from crashsolve.estimate.mesh import (
    Meshes,
    chance_margin,
    mesh_error,
    window_about,
    window_about_extreme,
    with_mesh,
)
from crashsolve.meshes._mesh import net
from crashsolve.model.build import build
from crashsolve.model.integrator_selection import with_chosen_method
from crashsolve.recording.histories import families_of
from crashsolve.study.watch import Watch

FACTOR = 10.0


def error(order: float, *numbers: float) -> tuple[float | None, str]:
    """The error of the first of numbers of scale 1."""
    return mesh_error([np.array([x]) for x in numbers], 1.0, order)


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_three_meshes_of_an_order_state_the_error(order: float) -> None:
    size, how = error(order, *(1.0 + 0.01 * m**order for m in (1, 2, 4)))
    assert size == pytest.approx(0.01)
    assert f"order {order:.2f}" in how


def test_two_meshes_state_their_difference() -> None:
    assert error(2.0, 1.0, 1.03)[0] == pytest.approx(0.03)


def test_a_lucky_difference_does_not_make_the_error_small() -> None:
    # the coarser ones say 0.12 / 4 / 3
    assert error(2.0, 1.0, 1.0 + 1e-9, 1.12)[0] == pytest.approx(0.01)


def test_histories_that_cross_do_not_agree() -> None:
    # they differ by 0.05, and cross at the end
    time = np.linspace(0.9, 1.0, 101)
    paths = [np.sin(40.0 * time), np.sin(40.0 * time) + 0.05 * np.sin(60.0 * (time - 1.0))]
    assert abs(paths[0][-1] - paths[1][-1]) < 1e-12
    assert 0.005 < chance_margin(paths) < 0.05


def test_the_history_about_a_moment_is_within_the_run() -> None:
    watch = Watch("x", ("a.b.c",), "at:0.98")
    about = window_about(watch, 0.0, 1.0)
    assert about is not None and about.during == pytest.approx((0.93, 1.0))
    for word in ("max", "path"):
        assert window_about(replace(watch, statistic=word), 0.0, 1.0) is None


@pytest.mark.parametrize(
    ("statistic", "window"),
    # sin(10 t) is 1 at 0.157 and -1 at 0.471, and passes 0 at 0.314 and 0.628
    [
        ("max", (0.0, np.pi / 10.0)),
        ("min", (np.pi / 10.0, np.pi / 5.0)),
        # |sin| has half of its largest value at asin(0.5) and pi - asin(0.5)
        ("abs_max", (np.pi / 60.0, np.pi / 12.0)),
    ],
)
def test_the_history_about_an_extreme_is_its_half_of_the_range(
    statistic: str, window: tuple[float, float]
) -> None:
    time = np.linspace(0.0, 0.7, 7001)
    about = window_about_extreme(
        Watch("x", ("a.b.c",), statistic), Series(time, np.sin(10.0 * time), "m")
    )
    assert about is not None
    assert about.statistic == "path"
    # samples 1e-4 s apart
    assert about.during == pytest.approx(window, abs=2e-4)


def test_maxima_that_coincide_do_not_agree() -> None:
    # pulses of the same height, one of half the width of the other
    time = np.linspace(0.0, 1.0, 1001)
    paths = [np.exp(-(((time - 0.5) / width) ** 2)) for width in (0.1, 0.05)]
    assert paths[0].max() == paths[1].max()
    about = window_about_extreme(Watch("x", ("a.b.c",), "max"), Series(time, paths[0], "N"))
    assert about is not None and about.during is not None
    near = (time >= about.during[0]) & (time <= about.during[1])
    # half of its height is within 0.1 S, S = sqrt(ln 2): the mean square of the difference there is
    # (f(2) - 2 f(5) + f(8)) / 2S = 0.3354^2 with f(a) = sqrt(pi / a) erf(sqrt(a) S)
    assert chance_margin([path[near] for path in paths]) == pytest.approx(0.25 * 0.3354, rel=0.01)


@pytest.mark.parametrize("statistic", ["final", "argmax", "mean"])
def test_other_numbers_have_no_extreme(statistic: str) -> None:
    series = Series(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 0.0]), "m")
    assert window_about_extreme(Watch("x", ("a.b.c",), statistic), series) is None


@pytest.mark.parametrize(
    ("numbers", "scale", "true"),
    [
        # a plate of shells struck by a ball, 8, 4 and 2 elements along a side, against 32: lowest
        # position and last velocity of the ball, energy of the plate
        ((0.0153326, 0.01594, 0.0199022), 0.0205, 9.2e-5),
        ((3.65038, 3.27287, 9.16622), 10.0, 0.19),
        ((21.6953, 21.415, 11.1109), 47.0, 0.81),
    ],
)
def test_a_useless_third_mesh_does_not_make_the_error_large(
    numbers: tuple[float, ...], scale: float, true: float
) -> None:
    size, _ = mesh_error([np.array([x]) for x in numbers], scale, 1.0)
    assert size is not None
    assert true / 10.0 < size < 10.0 * true


def test_an_order_near_nothing_makes_no_error_of_any_size() -> None:
    size, _ = error(2.0, 1.0, 1.045, 1.095)
    assert size is not None
    # an order of 0.15: two and a half times the larger difference, were it believed
    assert size <= 2.0 * 0.05 * (1.0 + 1e-12)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        # more than half; no smaller than before; back again
        ((1.0, 1.6, 2.4), "more than half"),
        ((1.0, 1.2, 1.39), "do not converge to one value"),
        ((1.0, 1.1, 0.8), "do not converge to one value"),
    ],
)
def test_meshes_that_state_no_error_say_so(numbers: tuple[float, ...], words: str) -> None:
    size, how = error(2.0, *numbers)
    assert size is None
    assert words in how


def test_differences_that_do_not_shrink_and_are_small_are_the_error() -> None:
    assert error(2.0, 1.0, 1.01, 0.97)[0] == pytest.approx(0.04)


# the tip of a cantilever that is loaded at once; the end of a bar that is pulled, until the wave
# comes back; the middle of a struck plate
SCENES = {
    "cantilever": f"""
control: {{end_time: 4e-3, estimate: mesh}}
{CANTILEVER}
watch: [{{channel: rbdout.arm_tip.position.z, statistic: final}}]
""",
    "bar": """
control: {end_time: 0.06, estimate: mesh}
materials: {m: {type: elastic, young: 1e5, poisson: 0, density: 1000}}
sections: {s: {type: circle, radius: 0.05}}
parts:
  bar: {type: beam, section: s, material: m,
        mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: COUNT}}
joints: {clamp: {type: weld, b: bar_start, at: [0, 0, 0]}}
loads: {f: {type: force, body: bar_end, at: [0, 0, 0], force: [10, 0, 0]}}
watch: [{channel: rbdout.bar_end.position.x - 1, statistic: final}]
""",
    "plate": """
control: {end_time: 1e-3, estimate: mesh}
materials: {m: {type: elastic, young: 2.1e11, poisson: 0.3, density: 7850}}
parts:
  p:
    type: shell
    mesh: {type: grid, along: [0.2, 0, 0], across: [0, 0.2, 0], elements: [COUNT, COUNT]}
    thickness: 0.004
    material: m
    nodes: [{name: middle, at: [0.1, 0.1, 0]}]
    supports: [{nodes: u0}, {nodes: u1}, {nodes: v0}, {nodes: v1}]
loads: {f: {type: force, body: p_middle, force: [0, 0, 100]}}
watch: [{channel: rbdout.p_middle.position.z, statistic: max}]
""",
}


def estimate(folder: Path, name: str, count: int, word: str = "") -> Estimate:
    """The estimate of a scene on so many elements."""
    path = folder / f"{name}{count}.yaml"
    text = SCENES[name].replace("COUNT", str(count)).replace("WORD", word)
    path.write_text(text, "utf-8")
    _, (estimated,), _ = estimate_in_memory(read_deck(path))
    return estimated


@pytest.mark.parametrize(
    ("name", "word", "count", "fine"),
    first_quick(
        [
            ("cantilever", "segments", 8, 32),
            ("cantilever", "beams", 8, 32),
            ("bar", "", 8, 0),
            pytest.param("plate", "", 16, 48, marks=pytest.mark.long),
        ]
    ),
)
def test_the_error_is_near_the_true_one(
    name: str, word: str, count: int, fine: int, tmp_path: Path
) -> None:
    estimated = estimate(tmp_path, name, count, word)
    # a constant force sends a front along the bar: u = F c t / (E A)
    front = 10.0 * 10.0 * 0.06 / (1e5 * np.pi * 0.05**2)
    truth = front if name == "bar" else estimate(tmp_path, name, fine, word).value
    assert estimated.value is not None
    assert truth is not None
    true = abs(estimated.value - truth)
    assert estimated.error is not None, estimated.how
    assert true / FACTOR <= estimated.error <= FACTOR * true, estimated.how
    assert estimated.how.startswith("time ")
    assert "; mesh " in estimated.how


def given_plate(folder: Path, is_file: bool, count: int) -> Path:
    """The deck of the plate with its elements one by one, or in a file; its sides are sets."""
    at, quads, sides = net(count, count)
    points = np.column_stack([0.2 * at, np.zeros(len(at))])
    numbers = {name: [int(k) + 1 for k in own] for name, own in sides.items()}
    corners = (quads + 1).tolist()
    if is_file:
        text = "*NODE\n" + "".join(f"{k}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(points, 1))
        text += "*ELEMENT, TYPE=S4\n"
        text += "".join(f"{k}, {', '.join(map(str, q))}\n" for k, q in enumerate(corners, 1))
        for name, own in numbers.items():
            text += f"*NSET, NSET={name}\n" + "".join(f"{k},\n" for k in own)
        (folder / "plate.inp").write_text(text, "utf-8")
        mesh: dict[str, object] = {"type": "file", "file": "plate.inp"}
    else:
        sets = [{"name": name, "nodes": own} for name, own in numbers.items()]
        mesh = {"type": "listed", "nodes": points.tolist(), "quads": corners, "sets": sets}
    grid = "{type: grid, along: [0.2, 0, 0], across: [0, 0.2, 0], elements: [COUNT, COUNT]}"
    path = folder / f"given_{is_file}.yaml"
    path.write_text(SCENES["plate"].replace(grid, json.dumps(mesh)), "utf-8")
    return path


@pytest.mark.long
@pytest.mark.parametrize("is_file", [False, True])
def test_given_meshes_in_rows_have_the_error_of_generated_ones(
    is_file: bool, tmp_path: Path
) -> None:
    if is_file:
        pytest.importorskip("meshio")
    _, (estimated,), _ = estimate_in_memory(read_deck(given_plate(tmp_path, is_file, 8)))
    other = estimate(tmp_path, "plate", 8)
    assert estimated.mesh is not None and other.mesh is not None
    # the same elements in another order: round-off of a thousand steps
    assert estimated.value == pytest.approx(other.value, rel=1e-9)
    assert estimated.mesh == pytest.approx(other.mesh, rel=1e-6)


def test_a_given_mesh_in_odd_rows_says_why_it_is_left_out(tmp_path: Path) -> None:
    deck = read_deck(given_plate(tmp_path, False, 5))
    model, state = build(deck)
    meshes = Estimator(with_chosen_method(deck, model), families_of(model, state)).mesh_runs(
        1.0, inf
    )
    assert not meshes.runs
    assert "the error estimates do not cover the mesh" in meshes.problem
    assert "rows of even numbers" in meshes.problem


def mesh_runs(folder: Path, old: str, new: str) -> Meshes:
    """The runs on coarser meshes of the plate with other words in its deck."""
    path = folder / "plate.yaml"
    path.write_text(SCENES["plate"].replace(old, new).replace("COUNT", "8"), "utf-8")
    deck = read_deck(path)
    model, state = build(deck)
    return Estimator(with_chosen_method(deck, model), families_of(model, state)).mesh_runs(1.0, inf)


def test_a_named_node_that_would_move_is_named_and_no_error_stated(tmp_path: Path) -> None:
    # the middle of five elements is no node, and neither of three
    meshes = mesh_runs(tmp_path, "[COUNT, COUNT]", "[5, 5]")
    assert not meshes.runs
    assert meshes.problem.endswith("node 'middle' of part 'p' is elsewhere on a coarser mesh")


def test_numbers_that_coarser_meshes_keep_are_named(tmp_path: Path) -> None:
    meshes = mesh_runs(tmp_path, "[COUNT, COUNT]", "[COUNT, 2]")
    assert meshes.lengths == [1.0, 2.0, 4.0]
    (remark,) = meshes.remarks
    assert remark.startswith("coarser meshes keep parts.p.mesh.elements.2 of 2: ")


def test_an_error_by_the_mesh_alone_says_that_of_time_is_not_known(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(SCENES["cantilever"].replace("COUNT", "8").replace("WORD", "beams"), "utf-8")
    watch = Watch("x", ("a.b.c",), "final")
    unknown = Estimate(watch, 1.0, "m", None, 1.0, "not estimated: no further run", inf)
    numbers = [np.array([x]) for x in (1.0, 1.03)]
    stated = with_mesh(unknown, numbers, read_deck(path), [1.0, 2.0])
    assert stated.error == pytest.approx(0.03)
    assert stated.how.startswith("time not estimated: no further run; mesh 0.03 m: ")
    # and an accuracy does not take it for reached
    assert stated.steps == inf


def test_lengths_that_are_no_powers_of_2_have_their_own_ratio() -> None:
    # 6, 4 and 2 elements: x = 1 + 0.01 l^2
    lengths = (1.0, 1.5, 3.0)
    numbers = [np.array([1.0 + 0.01 * length**2]) for length in lengths]
    assert mesh_error(numbers, 1.0, 2.0, lengths)[0] == pytest.approx(0.01)
    # of order 0 their differences are as ln 1.5 and ln 2
    numbers = [np.array([1.0 + 0.01 * np.log(length)]) for length in lengths]
    assert "do not shrink" in mesh_error(numbers, 1.0, 2.0, lengths)[1]


CONTACT = """
control: {end_time: 0.01}
bodies: {b: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 1], velocity: [1, 0, 0]}}
surfaces:
  s: {type: sphere, body: b, radius: 0.1}
  p: {type: plane, at: [0, 0, 0], normal: [0, 0, 1]}
contacts: {c: {a: [s], b: [p], normal: NORMAL, friction: FRICTION}}
watch: [rbdout.b.position.x]
"""
COULOMB = "{type: coulomb, friction_coefficient: 0.3, none_below: 1e-3, full_above: 1e-2}"


@pytest.mark.parametrize(
    ("normal", "friction", "words"),
    [
        ("{type: hertz, stiffness: 1e6}", "null", []),
        ("{type: penalty, stiffness: 1e6}", "null", ["the stiffness of penalty contacts"]),
        ("{type: hertz, stiffness: 1e6}", COULOMB, ["the speeds over which friction sets in"]),
    ],
)
def test_an_error_says_which_laws_it_leaves_out(
    normal: str, friction: str, words: list[str], tmp_path: Path
) -> None:
    text = CONTACT.replace("NORMAL", normal).replace("FRICTION", friction)
    (tmp_path / "deck.yaml").write_text(text, "utf-8")
    deck = read_deck(tmp_path / "deck.yaml")
    assert left_out(deck) == words
    _, (estimated,), _ = estimate_in_memory(deck)
    assert estimated.how.endswith(
        f"; without {words[0]}" if words and estimated.error else estimated.how
    )


def test_a_deck_that_changes_while_it_runs_states_no_error_of_the_mesh(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    text = SCENES["cantilever"].replace("COUNT", "8").replace("WORD", "beams")
    path.write_text(text, "utf-8")
    deck = read_deck(path)
    # another load, of which the coarser meshes are not to tell
    path.write_text(text.replace("[0, 0, 100]", "[0, 0, 200]"), "utf-8")
    _, (estimated,), _ = estimate_in_memory(deck)
    assert estimated.mesh is None
    assert "without the mesh" in estimated.how
