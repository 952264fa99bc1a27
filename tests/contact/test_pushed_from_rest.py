"""Claim: what forces push from rest, in one long step, meets what it would pass through."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build

DECK = """
control: {end_time: 1.5, estimate: off, integrator: METHOD}
output: {history: {interval: 0.5}}
bodies: {a: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [0, 0, HEIGHT]}}
surfaces:
  moves: {body: a, SHAPE}
  table: {type: box, at: [0, 0, -0.05], size: [1, 1, 0.1]}
contacts: {c: {a: [moves], b: [table], normal: {type: hertz, stiffness: 1e7}}}
loads: {p: {type: force, body: a, force: [0, 0, -100]PULSE}}
"""
SHAPES = {
    "sphere": "type: sphere, radius: 0.1",
    "box": "type: box, size: [0.2, 0.2, 0.2]",
    "cylinder": "type: cylinder, axis: [1, 0, 0], radius: 0.1, length: 0.2",
    "ellipsoid": "type: ellipsoid, semi_axes: [0.1, 0.1, 0.1]",
}
# begins within the run, where steps have grown
LATE = ", curve: late}}\ncurves: {late: {points: [[0, 0], [0.7, 0], [0.7001, 1], [9, 1]]}"
# 100 N press 1e7 N/m^1.5 by 0.5 mm; dropped from the gaps at 100 m/s^2, by less than 20 mm
LOWEST = 0.08


def deck(shape: str, gap: float, pulse: str = "", method: str = "rattle") -> str:
    """A body at a gap over a table, pushed down; it stands on the table at 0.1 m."""
    text = DECK.replace("SHAPE", SHAPES[shape]).replace("METHOD", method)
    return text.replace("HEIGHT", f"{0.1 + gap}").replace("PULSE}", pulse or "}")


def run(text: str, folder: Path) -> Result:
    """Result of a deck that ends normally."""
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    done = crashsolve(path, "-o", folder / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(folder / "out")


def lowest(result: Result) -> float:
    """Least height of the body at samples [m]."""
    return float(result.series("rbdout.a.position.z").values.min())


@pytest.mark.parametrize("pulse", ["", LATE], ids=["at once", "late"])
@pytest.mark.parametrize("gap", [1e-7, 0.05])
@pytest.mark.parametrize("shape", SHAPES)
def test_what_is_pushed_from_rest_stays_above_a_table(
    shape: str, gap: float, pulse: str, tmp_path: Path
) -> None:
    assert lowest(run(deck(shape, gap, pulse), tmp_path)) > LOWEST


@pytest.mark.parametrize("gap", [1e-7, 0.05, 0.07])
@pytest.mark.parametrize("method", ["dormand_prince_5", "generalized_alpha", "radau_iia_5"])
def test_so_do_methods_that_choose_their_steps_by_error(
    method: str, gap: float, tmp_path: Path
) -> None:
    assert lowest(run(deck("sphere", gap, LATE, method), tmp_path)) > LOWEST


@pytest.mark.parametrize("gap", [1e-7, 0.05])
def test_so_do_bodies_whose_near_pairs_are_listed(gap: float, tmp_path: Path) -> None:
    """A ball on a table of 900."""
    middles = {f"t{i}_{j}": (0.02 * i - 0.3, 0.02 * j - 0.3) for i in range(30) for j in range(30)}
    balls = "".join(
        f"  {name}: {{type: sphere, at: [{x}, {y}, -0.03], radius: 0.03}}\n"
        for name, (x, y) in middles.items()
    )
    head, _, tail = deck("sphere", gap).partition("  table: ")
    tail = tail.partition("\n")[2].replace("[table]", f"[{', '.join(middles)}]")
    result = run(f"{head}{balls}{tail}", tmp_path)
    (group,) = build(read_deck(tmp_path / "deck.yaml"))[0].contact_groups
    assert group.search is not None
    assert lowest(result) > LOWEST


def test_what_a_moment_swings_from_rest_meets_what_is_in_its_path(tmp_path: Path) -> None:
    """An arm of 1 m within a millimetre of a peg of 20 mm; 0.5 s of its moment are 50 rad."""
    text = """
control: {end_time: 0.5, estimate: off}
output: {history: {interval: 0.5}}
bodies: {a: {mass: 1, inertia: [0.1, 0.1, 0.1]}}
joints: {pin: {type: revolute, b: a, at: [0, 0, 0], axis: [0, 1, 0]}}
surfaces:
  arm: {type: cylinder, body: a, at: [0.5, 0, 0], axis: [1, 0, 0], radius: 0.01, length: 1}
  peg: {type: cylinder, at: [0.9, 0, -0.021], axis: [0, 1, 0], radius: 0.01, length: 1}
contacts: {c: {a: [arm], b: [peg], normal: {type: hertz, stiffness: 1e7}}}
loads: {p: {type: torque, body: a, torque: [0, 40, 0]}}
"""
    assert run(text, tmp_path).series("rcforc.c.peak_normal").values.max() > 40.0 / 0.9


@pytest.mark.parametrize("table", ["box, at: [0, 0, -0.01], size: [1, 1, 0.02]", "plane"])
def test_so_does_a_plate_whose_points_all_move_with_a_body(table: str, tmp_path: Path) -> None:
    """They are moved after the search for onsets; steps of a shell are short enough without it."""
    text = f"""
control: {{end_time: 0.5, estimate: off}}
output: {{history: {{interval: 0.5}}}}
bodies: {{a: {{mass: 1, inertia: [0.1, 0.1, 0.1], position: [0, 0, 0.05]}}}}
materials: {{m: {{type: elastic, young: 2e9, poisson: 0.3, density: 7850}}}}
parts:
  plate:
    type: shell
    mesh:
      {{type: grid, at: [-0.1, -0.1, 0.05], along: [0.2, 0, 0], across: [0, 0.2, 0],
       elements: [1, 1]}}
    material: m
    thickness: 0.01
    welded: [{{nodes: u0, to: a}}, {{nodes: u1, to: a}}]
surfaces:
  moves: {{type: nodes, part: plate}}
  table: {{type: {table}}}
contacts:
  c: {{a: [moves], b: [table], normal: {{type: kelvin_voigt, stiffness: 1e7, damping: 2e3}}}}
loads: {{p: {{type: force, body: a, force: [0, 0, -100], curve: late}}}}
curves: {{late: {{points: [[0, 0], [0.3, 0], [0.3001, 1], [9, 1]]}}}}
"""
    # four corners of 1e7 N/m bear 50 N over the plate's mass of 3 kg: tens of micrometres
    assert lowest(run(text, tmp_path)) > -1e-3
