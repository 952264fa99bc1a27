"""Claims of the quasi-static solution: quadratic convergence, work of loads, balance of forces,
stability, clear refusals.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors, SolverError
from crashsolve.model import ledger
from crashsolve.model.build import build
from crashsolve.recording.engines import engine_of
from crashsolve.statics import equilibrium
from crashsolve.statics.balance import EQUAL, ROUND, Forces
from crashsolve.statics.pseudo_transient import warning_of_rotating_loads
from crashsolve.statics.stability import unstable_mode

DECK = """
title: cantilever at rest
control: {end_time: 1, solution: quasi_static}
materials: {soft: {type: elastic, young: 1e3, poisson: 0, density: 1}}
sections: {s: {type: general, area: 1, I_y: 1e-3, I_z: 1e-3, torsion: 2e-3, shear_y: 1, shear_z: 1}}
curves: {rise: {points: [[0, 0], [1, 1]]}}
parts:
  p: {type: beam, mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 4}, section: s, material: soft}
joints: {clamp: {type: weld, b: p_start, at: [0, 0, 0]}}
loads: {tip: {type: force, body: p_end, force: [0, 1, 1], curve: rise}}
"""  # noqa: E501
# stiff against stretch and shear, so that critical loads are those of bending alone
STIFF = DECK.replace("area: 1,", "area: 1e4,").replace(
    "shear_y: 1, shear_z: 1", "shear_y: 1e4, shear_z: 1e4"
)
CLAMP = "clamp: {type: weld, b: p_start, at: [0, 0, 0]}"
TIP = "tip: {type: force, body: p_end, force: [0, 1, 1], curve: rise}"
# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("quasi_static")


def engine(folder: Path, text: str = DECK) -> equilibrium.StaticEngine:
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    deck = read_deck(path)
    solver = engine_of(deck, *build(deck))
    assert isinstance(solver, equilibrium.StaticEngine)
    solver.start()
    return solver


@pytest.mark.long
def test_corrections_fall_quadratically_to_round_off(tmp_path: Path) -> None:
    solver, sizes = engine(tmp_path), []
    for _ in range(8):
        direction = solver.correction(0.3)
        sizes.append(float(np.abs(direction).max()))
        solver.shift(solver.state.nodes, direction)
    # each is the square of the one before, then a share: differences over 1e-7 of the size see
    # the stretch of what they turn, and round-off of 1e-16 / 1e-7
    near = [k for k in range(7) if sizes[k] < 0.01]
    assert len(near) >= 2
    for k in near:
        assert sizes[k + 1] < 20.0 * sizes[k] ** 2 + 1e-3 * sizes[k] + 1e-13
    assert sizes[-1] < 1e-11


def test_work_of_loads_is_stored_to_second_order_in_the_load_step(tmp_path: Path) -> None:
    solver, missing = engine(tmp_path), []
    start = {g.word: g.history.copy() for g in solver.model.groups}
    nodes, clock = solver.state.nodes.copy(), solver.state.clock.copy()
    for steps in (4, 8):
        solver.state.nodes[:], solver.state.clock[:] = nodes, clock
        for g in solver.model.groups:
            g.history[:] = start[g.word]
        for k in range(steps):
            solver.reach((k + 1) / steps)
        solver.sample()
        missing.append(abs(solver.ledger[ledger.IMBALANCE]))
    assert missing[1] < 1e-2 * solver.ledger[ledger.ELASTIC]
    assert np.log2(missing[0] / missing[1]) == pytest.approx(2.0, abs=0.3)


def test_where_no_equilibrium_is_found_the_run_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solver = engine(tmp_path)
    before = solver.state.nodes.copy()
    monkeypatch.setattr(equilibrium, "MAX_ITERATIONS", 1)
    with pytest.raises(SolverError, match="no equilibrium found for the next load step"):
        solver.reach(1.0)
    # what failed has left no trace
    np.testing.assert_array_equal(solver.state.nodes["r"], before["r"])


def run(solver: equilibrium.StaticEngine, steps: int = 10) -> None:
    for k in range(steps):
        solver.reach((k + 1) / steps)
        solver.sample()


def bracket(solver: equilibrium.StaticEngine) -> tuple[float, float, str]:
    """Times [s] between which an equilibrium becomes unstable, and the position."""
    with pytest.raises(SolverError, match="becomes unstable between t = .* s and t = ") as caught:
        run(solver)
    stable, unstable = (float(part.split(" s")[0]) for part in caught.value.cause.split("t = ")[1:])
    assert stable == pytest.approx(float(solver.clock.time), rel=1e-5)
    assert stable < unstable
    return stable, unstable, caught.value.location


# of a column with E I = 1 and L = 1, clamped at one end
EULER = np.pi**2 / 4.0


def test_a_column_is_refused_beyond_its_critical_load(tmp_path: Path) -> None:
    load = f"force: [{-1.25 * EULER}, 0, 0]"
    stable, unstable, location = bracket(engine(tmp_path, STIFF.replace("force: [0, 1, 1]", load)))
    # 4 elements leave 3e-5 of the critical load; a load step over 2^7 is 1e-3 of it
    assert 1.25 * stable == pytest.approx(1.0, abs=2e-3)
    assert 1.25 * unstable == pytest.approx(1.0, abs=2e-3)
    assert "p_end" in location


@pytest.mark.long
def test_a_shaft_is_refused_beyond_its_critical_torque(tmp_path: Path) -> None:
    # Greenhill (1883): 2 pi E I / L where both ends may tilt; the torques keep their axes, and
    # the joints, which hold the ends and one spin, have no part in them
    ends = (
        "a: {type: universal, b: p_start, at: [0, 0, 0], axis: [0, 1, 0], second_axis: [0, 0, 1]}\n"
        "  b: {type: point_on_line, a: ground, b: p_end, at: [1, 0, 0], axis: [1, 0, 0]}"
    )
    torque = 1.05 * 2.0 * np.pi
    twist = "".join(
        f"\n  {name}: {{type: torque, body: p_{name}, torque: [{moment}, 0, 0], curve: rise}}"
        for name, moment in (("start", -torque), ("end", torque))
    )
    text = STIFF.replace("elements: 4", "elements: 8").replace(f"{{{CLAMP}}}", f"\n  {ends}")
    solver = engine(tmp_path, text.replace(f"{{{TIP}}}", twist))
    stable, unstable, _ = bracket(solver)
    # a load step over 2^6 is 0.16 % of the load, and 8 elements leave less
    assert 1.05 * stable == pytest.approx(1.0, abs=2e-3)
    assert 1.05 * unstable == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize(("load", "flutters"), [(19.5, False), (20.5, True)])
def test_a_column_under_a_force_that_follows_it_may_flutter(
    load: float, flutters: bool, tmp_path: Path
) -> None:
    # Beck (1952): 20.05 E I / L^2, and no load at which an equilibrium is left without vibration;
    # the bracket of 2.5 % holds the 2 % that 8 elements with their masses in the nodes leave
    text = STIFF.replace("elements: 4", "elements: 8")
    text = text.replace("force: [0, 1, 1]", f"force: [{-load}, 0, 0], axes: body")
    solver = engine(tmp_path, text)
    solver.reach(1.0)
    assert [("(flutter)" in note) for note in solver.step_warnings()] == [True] * flutters


PENDULUM = """
control: {end_time: 1, solution: quasi_static}
bodies: {bob: {mass: 1, inertia: [1, 1, 1], position: [0, 0, -1]}}
joints: {pivot: {type: revolute, a: ground, b: bob, at: [0, 0, 0], axis: [0, 1, 0]}}
loads: {weight: {type: gravity}}
"""


def test_a_pendulum_hangs_and_does_not_stand(tmp_path: Path) -> None:
    run(engine(tmp_path, PENDULUM), 1)
    with pytest.raises(SolverError, match="becomes unstable between 0 %") as caught:
        engine(tmp_path, PENDULUM.replace("[0, 0, -1]", "[0, 0, 1]"))
    assert "bob" in caught.value.location
    assert "a body that is balanced above its joint needs a support" in caught.value.advice


SPRUNG = DECK.replace(
    f"joints: {{{CLAMP}}}",
    "springs: {s: {type: bushing, a: ground, b: p_start, stiffness: [10, 10, 10], "
    "rotational_stiffness: [10, 10, 10]}}",
).replace("force: [0, 1, 1]", "force: [0, 0.01, 0]")


def test_springs_alone_may_hold_a_beam(tmp_path: Path) -> None:
    solver = engine(tmp_path, SPRUNG)
    solver.reach(1.0)
    tip = solver.state.nodes["r"][solver.model.bodies.index("p_end"), 1]
    # shift and tilt of the spring, bending, of which 4 elements leave 1 / 4 n^2, and shear
    assert tip == pytest.approx(0.01 * (0.1 + 0.1 + 1.0 / 3.0 + 1.0 / 500.0), rel=1e-2)


def test_what_moves_freely_stops_the_run(tmp_path: Path) -> None:
    # a pendulum about a vertical axis weighs the same wherever it is
    vertical = PENDULUM.replace("[0, 1, 0]", "[0, 0, 1]")
    spins = SPRUNG.replace("rotational_stiffness: [10, 10, 10]", "rotational_stiffness: [0, 0, 0]")
    for text in (vertical, spins):
        with pytest.raises(SolverError, match="no equilibrium found") as caught:
            engine(tmp_path, text)
        assert "support what can move freely" in caught.value.advice


FOLLOWED = """
control: {end_time: 1, solution: quasi_static}
materials: {m: {type: elastic, young: 1e9, poisson: 0, density: 1}}
parts:
  q:
    type: shell
    mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [1, 1]}
    thickness: 0.1
    material: m
    nodes: [{name: a, at: [1, 0, 0]}, {name: b, at: [1, 1, 0]}]
    supports: [{nodes: u0}]
loads:
  blown: {type: pressure, part: q, pressure: 1}
  along: {type: force, body: q_a, force: [0, 0, 1], axes: body}
  fixed: {type: force, body: q_b, force: [0, 0, 1]}
"""


def test_what_stability_of_shells_leaves_out_is_reported_by_name(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(FOLLOWED, "utf-8")
    model, _ = build(read_deck(path))
    reported = warning_of_rotating_loads(model.groups)
    assert reported is not None
    assert "load 'along'" in reported
    assert "load 'blown'" in reported
    assert "'fixed'" not in reported
    assert "buckling or flutter may be missed" in reported
    assert "solution: transient" in reported
    assert warning_of_rotating_loads([g for g in model.groups if g.keyword != "loads"]) is None


@pytest.mark.long
def test_beyond_the_plastic_moment_there_is_no_equilibrium(tmp_path: Path) -> None:
    # 1.6 times the moment of first yield on a rectangle, which bears 1.5 times as much
    young, limit, height = 2e11, 2e7, 0.02
    moment = 1.6 * limit * height**3 / 6.0
    text = DECK.replace("elements: 4}", "elements: 1}, side: [0, 1, 0], fibres: [2, 32]")
    for old, new in (
        (
            "soft: {type: elastic, young: 1e3,",
            f"soft: {{type: elastoplastic, young: {young}, yield_stress: {limit},",
        ),
        (
            DECK[DECK.index("s: {type: general") : DECK.index("}\ncurves")],
            f"s: {{type: rectangle, width: {height}, height: {height}}}",
        ),
        ("type: beam", "type: fibre_beam"),
        (TIP, f"tip: {{type: torque, body: p_end, torque: [0, {moment}, 0], curve: rise}}"),
    ):
        assert old in text
        text = text.replace(old, new)
    solver = engine(tmp_path, text)
    with pytest.raises(SolverError, match="no equilibrium found") as caught:
        run(solver)
    # the limit moment of n rows, whose second moment is that of the section (theory, beams.md)
    most = 1.5 / np.sqrt(1.0 - 1.0 / 32**2)
    # the core that is still elastic has (1.5 - m) / 0.5 of the square of the height
    assert 1.6 * caught.value.time == pytest.approx(most, abs=3e-3)
    assert 1.6 * caught.value.time < most
    assert "collapses plastically" in caught.value.advice


@pytest.mark.long
def test_watched_channels_have_the_errors_of_load_steps(tmp_path: Path) -> None:
    names = "energy.external_work", "energy.elastic"
    watch = "".join(f"  - {{channel: glstat.model.{name}, statistic: final}}\n" for name in names)
    text = DECK.replace("quasi_static}", "quasi_static, steps: 4}") + "watch:\n" + watch
    (tmp_path / "deck.yaml").write_text(text, "utf-8")
    # a few hundred samples cost less than a compiler
    done = crashsolve(tmp_path / "deck.yaml", "-o", tmp_path, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stdout + done.stderr
    work, stored = json.loads((tmp_path / "status.json").read_text("utf-8"))["watched"]
    # what is stored depends on no load steps, the work does: to second order
    assert stored["error"] < 1e-8 * stored["value"]
    assert work["error"] == pytest.approx(abs(work["value"] - stored["value"]), rel=0.3)


def test_a_column_below_its_critical_load_is_not(tmp_path: Path) -> None:
    load = f"force: [{-0.9 * EULER}, 0, 0]"
    solver = engine(tmp_path, DECK.replace("force: [0, 1, 1]", load))
    run(solver, 2)
    assert float(solver.clock.time) == 1.0


@pytest.mark.parametrize("factor", [1e-12, 1e12])
def test_the_answer_scales_with_loads_and_stiffness(tmp_path: Path, factor: float) -> None:
    plain, scaled = DECK, DECK.replace("young: 1e3", f"young: {1e3 * factor!r}")
    scaled = scaled.replace("force: [0, 1, 1]", f"force: [0, {factor!r}, {factor!r}]")
    positions = []
    for text in (plain, scaled):
        solver = engine(tmp_path, text)
        run(solver, 2)
        positions.append(solver.state.nodes["r"].copy())
    np.testing.assert_allclose(positions[1], positions[0], rtol=0.0, atol=1e-9)


def test_the_course_of_time_and_the_number_of_load_steps_do_not_count(tmp_path: Path) -> None:
    positions = []
    for end, steps in ((1.0, 1), (1e-6, 3), (1e6, 5)):
        text = DECK.replace("end_time: 1,", f"end_time: {end!r},")
        solver = engine(tmp_path, text.replace("[1, 1]]", f"[{end!r}, 1]]"))
        for k in range(steps):
            solver.reach(end * (k + 1) / steps)
        positions.append(solver.state.nodes["r"].copy())
    for location in positions[1:]:
        # ten times what the tolerance leaves of the way
        np.testing.assert_allclose(
            location, positions[0], rtol=0.0, atol=10 * equilibrium.TOLERANCE
        )


def test_loads_without_a_curve_act_from_the_start_and_do_half_their_way(tmp_path: Path) -> None:
    solver = engine(tmp_path, DECK.replace("force: [0, 1, 1], curve: rise", "force: [0, 0.01, 0]"))
    solver.sample()
    location, stored = solver.nodes["r"].copy(), float(solver.ledger[ledger.ELASTIC])
    tip = solver.model.bodies.index("p_end")
    # P L^3 / 3 E I and shear P L / G A; 4 elements leave 1 / 4 n^2 of bending
    assert location[tip, 1] == pytest.approx(0.01 / 3.0 + 0.01 / 500.0, rel=2e-2)
    assert stored == pytest.approx(0.005 * location[tip, 1], rel=1e-4)
    assert abs(solver.ledger[ledger.IMBALANCE]) < 1e-4 * stored
    solver.reach(1.0)
    solver.sample()
    np.testing.assert_allclose(solver.nodes["r"], location, rtol=0.0, atol=1e-10)


def test_equilibrium_is_a_matter_of_forces() -> None:
    forces = Forces(size=2.0, tolerance=1e-6)
    forces._raise_largest(100.0, 0.0)
    g = np.zeros(12)
    for force, moment, stiffness, reported in (
        (0.9e-4, 1.9e-4, 0.0, EQUAL),
        (1.1e-4, 0.0, 0.0, 0),
        (0.0, 2.1e-4, 0.0, 0),
        # round-off of positions is no force; where it is as large as forces it proves no balance
        (1.1e-4, 0.0, 1e12, EQUAL),
        (1.1e-4, 0.0, 1e15, ROUND),
    ):
        g[6], g[9] = force, moment
        assert forces.balance(g, (stiffness, stiffness)) == reported


def test_stability_is_that_of_the_constrained_motion() -> None:
    # two motions of stiffness 1 and -1: stable where the second is held, or loads turn it over
    K, M = np.diag([1.0, -1.0]), np.eye(2)
    mode, _ = unstable_mode(K, np.zeros((0, 2)), M)
    assert mode is not None
    np.testing.assert_allclose(np.abs(mode / np.abs(mode).max()), [0.0, 1.0], atol=1e-12)
    assert unstable_mode(K, np.array([[0.0, 1.0], [0.0, 2.0]]), M) == (None, False)
    # Ziegler: eigenvalues of K are 1 +- 2 i
    assert unstable_mode(np.array([[1.0, 2.0], [-2.0, 1.0]]), np.zeros((0, 2)), M) == (None, True)
    # a zero is no unstable mode
    assert unstable_mode(np.diag([1.0, 0.0]), np.zeros((0, 2)), M) == (None, False)


SHELL = """  q:
    type: shell
    mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [1, 1]}
    thickness: 0.1
    material: soft
"""
REFUSED = {
    "integrator": ("solution:", "integrator: radau_iia_5, solution:", "integrator: solution quasi"),
    "drag": ("joints:", f"{SHELL}    drag: 2\njoints:", "and solution quasi_static has none"),
    "welded": (
        "parts:",
        f"bodies: {{hub: {{mass: 1, inertia: [1, 1, 1], welded: [p_2]}}}}\nparts:\n{SHELL}",
        "a quasi-static solution with shells or fibre beams has no welded nodes",
    ),
    "velocity": (
        "section: s,",
        "section: s, velocity: [1, 0, 0],",
        "a quasi-static solution has no velocities",
    ),
    "memory": (
        "loads:",
        "springs: {s: {type: elastoplastic, a: ground, b: p_end, stiffness: 1, yield_force: 1}}\n"
        "loads:",
        "a quasi-static solution has no path-dependent laws yet",
    ),
    "contact": (
        "loads:",
        "surfaces: {a: {type: nodes, part: p}, b: {type: plane, at: [0, 0, -1]}}\n"
        "contacts: {c: {a: [a], b: [b], normal: {type: hertz, stiffness: 1}}}\nloads:",
        "a quasi-static solution has no contacts yet",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_needs_the_course_of_time_is_refused(case: str, tmp_path: Path) -> None:
    old, new, message = REFUSED[case]
    path = tmp_path / "deck.yaml"
    assert old in DECK
    path.write_text(DECK.replace(old, new, 1), "utf-8")
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    assert message in str(caught.value)


BARS = """
control: {end_time: 1, solution: quasi_static, steps: 4, estimate: off}
materials:
  slow: &slow {type: elastoplastic, young: 2e11, poisson: 0.3, density: 7800, yield_stress: 2e8,
               hardening: 1e9}
  rated: {<<: *slow, rate_D: 40, rate_q: 5}
sections: {square: {type: rectangle, width: 0.1, height: 0.1}}
parts:
  slow: &bar {type: fibre_beam, mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 1},
              section: square, material: slow, fibres: [2, 2]}
  rated: {<<: *bar, mesh: {shape: line, from: [0, 5, 0], to: [1, 5, 0], elements: 1},
          material: rated}
joints:
  one: {type: weld, b: slow_start, at: [0, 0, 0]}
  other: {type: weld, b: rated_start, at: [0, 5, 0]}
curves: {rise: {points: [[0, 0], [1, 1]]}}
loads:
  one: {type: force, body: slow_end, force: [2.5e6, 0, 0], curve: rise}
  other: {type: force, body: rated_end, force: [2.5e6, 0, 0], curve: rise}
"""


@pytest.mark.long
def test_an_equilibrium_has_no_rate_of_strain_and_may_begin_without_a_load(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(BARS, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stdout
    for bar in ("slow", "rated"):
        x = Result(tmp_path / "out").series(f"rbdout.{bar}_end.position.x").values[-1]
        # 250 MPa: 250e6 / E + 50e6 / H, to control.tolerance of it
        assert x - 1.0 == pytest.approx(0.05125, rel=1e-7)
