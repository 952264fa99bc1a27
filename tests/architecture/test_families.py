"""Claim: a family of laws is one folder: made in a copy of the package, it is known everywhere."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, environment

ROOT = Path(__file__).resolve().parents[2]
DECLARATION = '''"""Tethers: ropes between two bodies."""

from typing import Any, Protocol

from crashsolve.deck.family import LINE, Family


class TetherLaw(Protocol):
    """What the file of a tether provides beside its card."""

    def build(self, card: Any, scene: Any) -> Any:
        """Words into symbols."""

    def force(self, p, old, new, out, t, h, nodes, rows, curves):
        """Forces on both bodies."""


FAMILY = Family(
    entry="tether",
    follows="springs",
    law=TetherLaw,
    energy=("tether",),
    channels=("tetherout", "tension of tethers"),
    picture=LINE,
    uses=(),
    integrators=("rattle", "dormand_prince_5"),
)
'''
ROPE = '''"""Rope that pulls and does not push.

    F = k (l - l_0)   while l > l_0
"""

from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.motion import apply_force, arm, mobility, point_at, stiffen
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import norm, scale, sub, vec


class Rope(Card):
    """Elastic rope between two points."""

    a: BodyName = word("first body", default="ground")
    b: BodyName = word("second body")
    at_a: Vec3 = quantity("m", "in the frame of a", default=(0.0, 0.0, 0.0))
    at_b: Vec3 = quantity("m", "in the frame of b", default=(0.0, 0.0, 0.0))
    stiffness: float = quantity("N/m", "tension over elongation", gt=0)
    length: float = quantity("m", "length without tension", gt=0)


PARAMETERS = Record(
    node_a=("index", "a"),
    node_b=("index", "b"),
    point_a=("m", 3, "of a"),
    point_b=("m", 3, "of b"),
    stiffness=("N/m", "k"),
    length=("m", "l_0"),
)
HISTORY = Record(longest=("m", "length so far"))
OUTPUT = Record(force=("N", "tension"))


def build(card, scene):
    return scene.attachments(card) | {"stiffness": card.stiffness, "length": card.length}


@kernel
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: nodes, out, new."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    d_a, d_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    way = sub(point_at(b, d_b), point_at(a, d_a))
    length = norm(way)
    u, x = scale(1.0 / length, way), max(length - p.length, 0.0)
    out.force = p.stiffness * x
    out.stored, out.power, out.loss = 0.5 * p.stiffness * x * x, 0.0, 0.0
    new.longest = max(old.longest, length)
    apply_force(a, scale(out.force, u), d_a)
    apply_force(b, scale(-out.force, u), d_b)
    stiffen(a, mobility(a, d_a, u), p.stiffness, 0.0)
    stiffen(b, mobility(b, d_b, u), p.stiffness, 0.0)
'''
DECK = """\
title: a ball on a rope
control: {end_time: 0.2, step: 1e-3, integrator: rattle, estimate: off}
bodies: {ball: {mass: 2.0, inertia: [1, 1, 1], position: [0, 0, -1.01]}}
tethers: {line: {type: rope, b: ball, stiffness: 5000.0, length: 1.0}}
output: {history: {interval: 0.01}, states: {interval: 0.1}, restart: {every: 0.1}}
expect:
  - {channel: tetherout.line.force, statistic: 'at:0', value: 50, tolerance: 1e-9, because: exact,
     source: k x}
  - {channel: glstat.model.energy.tether_stored, statistic: 'at:0', value: 0.25, tolerance: 1e-9,
     because: exact, source: k x^2 / 2}
"""


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A copy of the package with a family more, and a deck that uses it."""
    folder = tmp_path_factory.mktemp("families")
    package = folder / "source" / "crashsolve"
    shutil.copytree(ROOT / "solver" / "crashsolve", package, ignore=lambda *_: ["__pycache__"])
    (package / "tethers").mkdir()
    (package / "tethers" / "__init__.py").write_text(DECLARATION, "utf-8")
    (package / "tethers" / "rope.py").write_text(ROPE, "utf-8")
    (folder / "deck.yaml").write_text(DECK, "utf-8")
    yield folder


def run(home: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """A command of the copy, in plain Python."""
    search = os.pathsep.join([str(home / "source"), str(ROOT / "postproc")])
    return crashsolve(*words, NUMBA_DISABLE_JIT="1", PYTHONPATH=search)


def test_it_is_checked_and_stands_in_manual_and_schema(home: Path, tmp_path: Path) -> None:
    assert run(home, "check", home / "deck.yaml").returncode == 0
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(DECK.replace("stiffness", "stifness"), "utf-8")
    done = run(home, "check", wrong)
    assert done.returncode == 2
    assert "tether 'line': unknown field 'stifness'; did you mean 'stiffness'?" in done.stderr
    manual = run(home, "keywords").stdout
    assert manual.index("\n## springs") < manual.index("\n## tethers") < manual.index("\n## parts")
    assert "| `stiffness` | number | N/m |" in manual[manual.index("\n## tethers") :]
    schema = json.loads(run(home, "schema").stdout)
    assert "tethers" in schema["properties"]


def test_it_is_in_the_step_the_ledger_the_channels_pictures_and_dumps(
    home: Path, tmp_path: Path
) -> None:
    text = run(home, "explain", home / "deck.yaml").stdout
    step = text[text.index("composed step") :]
    assert "tethers_rope.force(p[i], old, new, o, time, h, nodes, rows, curves)" in step
    done = run(home, home / "deck.yaml", "-o", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "history.h5") as file:
        energy = file["glstat/energy"]
        # what it stores comes back as motion, and all of it is told under its own name
        total = np.ravel(energy["tether_stored"]) + np.ravel(energy["kinetic"])
        assert np.ravel(energy["tether_stored"])[0] == pytest.approx(0.25)
        # (omega h)^2 / 4 of a step at the middle of the swing, omega = 50/s
        assert total == pytest.approx(0.25, rel=1e-3)
        assert np.ravel(energy["tether_dissipated"]).tolist() == [0.0] * len(total)
        assert np.ravel(file["tetherout-rope/force"])[0] == pytest.approx(50.0)
    states = (tmp_path / "states.xdmf").read_text("utf-8")
    assert "tethers" in states and "tension" in states
    (dump, *_) = sorted(tmp_path.glob("restart_*.h5"))
    with h5py.File(dump) as file:
        names: list[str] = []
        file.visit(names.append)
        assert any("tethers" in name for name in names)


def test_what_cannot_step_it_is_refused(home: Path, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(DECK.replace("integrator: rattle", "integrator: radau_iia_5"), "utf-8")
    done = run(home, "check", wrong)
    told = "tethers cannot be stepped by radau_iia_5; say integrator: rattle or dormand_prince_5"
    assert (done.returncode, told in done.stderr) == (2, True), done.stderr


def test_the_tests_of_laws_and_of_the_house_ask_about_it(home: Path) -> None:
    code = (
        "import test_laws, test_house, crashsolve\n"
        "assert ('tethers', 'rope') in test_laws.LAWS\n"
        "assert test_laws.KERNELS['tethers'] == ('build', 'force')\n"
        "test_laws.test_a_law_has_card_build_and_kernels(('tethers', 'rope'))\n"
        "assert test_house.floor('crashsolve.tethers.rope') == 1\n"
    )
    folders = (home / "source", ROOT / "postproc", ROOT / "tests", ROOT / "tests/architecture")
    given = environment(PYTHONPATH=os.pathsep.join(map(str, folders)))
    done = subprocess.run([sys.executable, "-c", code], env=given, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        ("__init__", "    picture=LINE,\n", "", "__init__.py: a family must declare picture: see"),
        (
            "__init__",
            '    law=TetherLaw,\n    energy=("tether",),\n',
            "",
            "must declare law, energy: see",
        ),
        ("__init__", '"springs"', '"ropes"', "follows 'ropes', which is no section"),
        ("__init__", "law=TetherLaw", "law=Any", "`law` must be a Protocol"),
        ("rope", "def force(", "def pull(", "must provide force (Forces on both bodies)"),
    ],
)
def test_what_is_forgotten_is_one_error_in_words(
    home: Path, file: str, old: str, new: str, told: str
) -> None:
    path = home / "source" / "crashsolve" / "tethers" / f"{file}.py"
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    try:
        done = run(home, "check", home / "deck.yaml")
    finally:
        path.write_text(text, "utf-8")
    assert done.returncode == 1
    # what went wrong stands in the last line
    assert told in done.stderr.splitlines()[-1]
