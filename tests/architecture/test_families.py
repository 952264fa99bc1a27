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
from adding import files
from command import crashsolve, environment

ROOT = Path(__file__).resolve().parents[2]
# the family of the guide, as it stands there
(DECLARATION, ROPE, DECK) = files("8. A family").values()


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
    return crashsolve(*words, CRASHSOLVE_PLAIN="1", PYTHONPATH=search)


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
        # what it stores comes back as motion, and all of it is reported under its own name
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
    reported = (
        "tethers cannot be stepped by radau_iia_5; set integrator: rattle or dormand_prince_5"
    )
    assert (done.returncode, reported in done.stderr) == (2, True), done.stderr


def test_a_run_goes_on_from_its_dump_to_the_same_bits(home: Path, tmp_path: Path) -> None:
    whole, parted = tmp_path / "whole", tmp_path / "parted"
    assert run(home, home / "deck.yaml", "-o", whole).returncode == 0
    short = home / "deck.yaml", "-o", parted, "--set", "control.end_time=0.1"
    assert run(home, *short).returncode == 0
    done = run(home, home / "deck.yaml", "-o", parted, "--restart", "--until", "0.2")
    assert done.returncode == 0, done.stderr
    with h5py.File(whole / "history.h5") as one, h5py.File(parted / "history.h5") as other:
        for name in ("tetherout-rope/force", "glstat/energy/tether_stored"):
            assert np.array_equal(one[name], other[name]) and len(one[name]) == 21


@pytest.mark.long
def test_the_contract_tests_ask_about_it(home: Path) -> None:
    """Deck, card, kernels, layer, balance, energy, tangents: the tests are those of all laws."""
    tests = home / "tests"
    for name in ("bench.py", "contract", "architecture/test_laws.py", "architecture/test_house.py"):
        (tests / name).parent.mkdir(parents=True, exist_ok=True)
        copy = shutil.copytree if (ROOT / "tests" / name).is_dir() else shutil.copy
        copy(ROOT / "tests" / name, tests / name)
    deck = home / "decks" / "verification" / "tethers" / "rope.yaml"
    deck.parent.mkdir(parents=True)
    shutil.copy(home / "deck.yaml", deck)
    shutil.copytree(home / "source", home / "solver")
    folders = (home / "solver", ROOT / "postproc", tests)
    given = environment(PYTHONPATH=os.pathsep.join(map(str, folders)), CRASHSOLVE_PLAIN="1")
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rA", str(tests)]
    requested = "tethers or (imports_only and down) or has_its_layer"
    done = subprocess.run(
        [*words, "-k", requested], env=given, capture_output=True, text=True, cwd=home, check=False
    )
    assert done.returncode == 0, done.stdout
    for claim in (
        "test_a_law_has_card_build_and_kernels[tethers/rope]",
        "test_imports_only_go_down_the_layers",
        "test_every_package_of_the_solver_has_its_layer",
        "test_every_column_is_written_and_the_past_is_kept[tethers/rope]",
        "test_action_equals_reaction_also_in_moment[0-tethers/rope]",
        "test_work_is_stored_or_lost_or_done_from_outside[1-tethers/rope]",
        "test_implicit_methods_have_its_tangent_or_do_not_step_it[tethers/rope]",
    ):
        assert claim in done.stdout, claim


@pytest.mark.parametrize(
    ("file", "old", "new", "reported"),
    [
        ("__init__", "    picture=LINE,\n", "", "__init__.py: a family must declare picture: see"),
        (
            "__init__",
            '    law=TetherLaw,\n    energy=("tether",),\n',
            "",
            "must declare law, energy: see",
        ),
        ("__init__", '"springs"', '"ropes"', "follows 'ropes', which is no section"),
        ("__init__", "law=TetherLaw", "law=dict", "`law` must be a Protocol"),
        ("__init__", 'energy=("tether",)', "energy=()", "must name an entry of the ledger"),
        ("rope", "def force(p, old, new,", "def force(p, new, old,", "not force(p, new, old, out"),
        ("rope", "HISTORY =", 'LEDGER = "hemp"\nHISTORY =', "must be one of tether, as declared"),
        # what Python says of a file, with its line and without a traceback
        ("rope", "HISTORY =", "HISTORY ==", ": NameError: name 'HISTORY' is not defined"),
        ("rope", "    d_a, d_b =", "    d_a, d_b = =", ": SyntaxError: invalid syntax"),
        ("rope", "class Rope(", "class Ropes(", "rope.py has no `class Rope(...)`, its card"),
        (
            "rope",
            'OUTPUT = Record("force  N  tension")',
            'OUTPUT = Record("stored  J  own")',
            "columns declared twice: ['stored']; every law of force has these of itself",
        ),
        (
            "rope",
            ' | {"stiffness": card.stiffness, "length": card.length}',
            ' | {"stiffness": card.stiffness}',
            "crashsolve.tethers.rope: build returns nothing for 'length' of PARAMETERS",
        ),
        ("rope", "def force(", "def pull(", "must provide force (Forces on bodies, stored energy"),
    ],
)
def test_what_is_forgotten_is_one_error_in_words(
    home: Path, file: str, old: str, new: str, reported: str
) -> None:
    path = home / "source" / "crashsolve" / "tethers" / f"{file}.py"
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    try:
        done = run(home, "check", home / "deck.yaml")
    finally:
        path.write_text(text, "utf-8")
    # 2 where the deck names a type that its file does not make
    assert done.returncode == (2 if "Ropes" in new else 1)
    # one clear line, and no traceback above it
    (line,) = done.stderr.splitlines()
    assert reported in line
