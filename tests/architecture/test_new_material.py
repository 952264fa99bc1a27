"""Claim: a material is one file: that of the guide, in a copy of the package, is taken by all.

By every element of shells and by fibres of beams, at rest and in motion, explicit and implicit; and
it keeps the contract of materials.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from command import crashsolve, environment

from crashpost.cli import main as crashpost

ROOT = Path(__file__).resolve().parents[2]
MATERIAL = "{type: bilinear_damage, young: 2e11, poisson: 0.3, density: 8000, yield_stress: 2e7, "
MATERIAL += "hardening: 2e10}"
# strips of one element of every kind, and a bar, under the same stress
DECK = f"""\
title: a new material under tension
parameters: {{S: 2.4e7, e: "${{(2e7 + (2.4e7 - 2e7) / 0.1) / 2e11}}"}}
control: CONTROL
materials: {{new: {MATERIAL}}}
sections: {{bar: {{type: rectangle, width: 0.1, height: 0.1}}}}
parts:
  reduced: &strip
    type: shell
    mesh: {{type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [1, 1]}}
    thickness: 0.1
    layers: 2
    material: new
    damping: DAMPING
    supports:
      - {{nodes: u0, motions: [x, z, rotation_x, rotation_y, rotation_z]}}
      - {{nodes: v0, motions: [y]}}
    nodes: [{{name: high, at: [1, 1, 0]}}]
    welded: []
    traces: [{{name: end, at: [1, 0, 0]}}]
    NODES
  full: {{<<: *strip, element: fully_integrated}}
  triangles: {{<<: *strip, element: triangles}}
  bar: {{type: fibre_beam, mesh: {{shape: line, from: [0, 5, 0], to: [1, 5, 0], elements: 1}},
    section: bar, material: new, fibres: [2, 2], damping: DAMPING}}
joints: {{wall: {{type: weld, b: bar_start, at: [0, 5, 0]}}}}
"""
REST = "{end_time: 1, solution: quasi_static, steps: 6, tolerance: 1e-9, estimate: off}"


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A copy of the package with the material of the guide."""
    folder = tmp_path_factory.mktemp("materials")
    package = folder / "source" / "crashsolve"
    shutil.copytree(
        ROOT / "solver" / "crashsolve", package, ignore=shutil.ignore_patterns("__pycache__")
    )
    guide = (ROOT / "solver" / "ADDING.md").read_text("utf-8")
    section = guide[guide.index("\n## A material\n") :]
    code = re.findall(r"```python\n(.*?)```", section, re.DOTALL)[0]
    (package / "materials" / "bilinear_damage.py").write_text(code, "utf-8")
    yield folder


def search(home: Path) -> str:
    return os.pathsep.join([str(home / "source"), str(ROOT / "postproc")])


def test_it_meets_the_contract(home: Path) -> None:
    """Limits as in tests/materials; energy between steps is not linear in the strain."""
    example = (
        MATERIAL.replace("2e11", "2.0e+11").replace("2e7", "2.0e+7").replace("2e10", "2.0e+10")
    )
    command = [sys.executable, str(ROOT / "tests" / "materials" / "one_layer.py"), example]
    position = environment() | {"PYTHONPATH": search(home), "CRASHSOLVE_PLAIN": "1"}
    reported = subprocess.run(
        command, capture_output=True, text=True, env=position, check=True
    ).stdout
    measured = {line.split(": ")[0]: float(line.split(": ")[1]) for line in reported.splitlines()}
    for word in ("tangent", "fibre by strain"):
        assert measured[word] < 1e-8, reported
    for word in ("rotated", "fibre stress"):
        assert measured[word] < 1e-14, reported
    assert max(measured["layer and fibre"], measured["layer and point"]) < 1e-8, reported
    # a fiftieth of the limit a step: its square where the slope changes, and beyond
    assert max(measured["balance"], measured["fibre balance"]) < 1e-3, reported
    assert measured["least lost"] >= 0.0, reported


def run_as_expected(
    text: str, home: Path, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run a deck with the package that knows the material; all its expectations must be met."""
    path = folder.with_suffix(".yaml")
    path.write_text(text, "utf-8")
    done = crashsolve(path, "-o", folder, PYTHONPATH=search(home))
    assert done.returncode == 0, done.stdout + done.stderr
    assert crashpost(["expect", str(folder)]) == 0, capsys.readouterr().out


@pytest.mark.long
def test_all_elements_bear_its_stress_at_rest(
    home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = DECK.replace("CONTROL", REST).replace("DAMPING", "0").replace("    NODES\n", "")
    text = (
        text.replace(
            "    nodes: [{name: high, at: [1, 1, 0]}]\n    welded: []\n",
            "    nodes: [{name: high, at: [1, 1, 0]}, {name: low, at: [1, 0, 0]}]\n",
        )
        .replace("    supports:\n", "    supports:\n")
        .replace("      - {nodes: v0, motions: [y]}\n", "")
    )
    text += "loads:\n  bar: {type: force, body: bar_end, force: ['${0.01 * S}', 0, 0]}\n"
    for part in ("reduced", "full", "triangles"):
        for end in ("low", "high"):
            text += f"  {part}_{end}: {{type: force, body: {part}_{end}, "
            text += "force: ['${0.05 * S}', 0, 0]}\n"
    text += "expect:\n"
    for body in ("reduced_high", "full_low", "triangles_high", "bar_end"):
        # strains of 3e-4: their square, and what the strip narrows
        text += f"  - {{channel: rbdout.{body}.position.x, statistic: final, value: '${{1 + e}}', "
        text += "tolerance: '${1e-3 * e}', because: exact, source: Y / E + (S - Y) / H}\n"
    run_as_expected(text, home, tmp_path / "rest", capsys)


@pytest.mark.long
@pytest.mark.parametrize(
    "control",
    [
        "{end_time: 2e-3, integrator: rattle, safety: 0.5, estimate: off}",
        pytest.param(
            "{end_time: 2e-3, integrator: generalized_alpha, step: 2e-5, estimate: off}",
            marks=pytest.mark.long,
        ),
    ],
    ids=["explicit", "implicit"],
)
def test_all_elements_move_with_it_and_their_energy_is_kept(
    control: str, home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Pulled by their speed until they are damaged, and back."""
    pull = "velocities: [{nodes: u1, velocity: [1.5, 0, 0]}]"
    text = DECK.replace("CONTROL", control).replace("DAMPING", "0").replace("NODES", pull)
    text = text.replace("    nodes: [{name: high, at: [1, 1, 0]}]\n    welded: []\n", "")
    text = text.replace("fibres: [2, 2],", "fibres: [2, 2], velocity: [0, 0, 0],")
    text += "loads: {bar: {type: force, body: bar_end, force: [4e5, 0, 0]}}\n"
    text += "output: {history: {interval: 2e-5}}\nexpect:\n"
    text += "  - {channel: glstat.model.balance, statistic: abs_max, value: 0, tolerance: 1, "
    text += (
        "because: exact, source: 'energy is kept; of its percent a few steps of explicit ones'}\n"
    )
    for part in ("reduced", "full", "triangles"):
        text += f"  - {{channel: matsum.{part}.plastic, statistic: final, value: 100, "
        text += "tolerance: 90, because: derived, source: some of m v^2 / 2}\n"
    run_as_expected(text, home, tmp_path / "motion", capsys)
