"""Claim: tension is never unstable, however long the elements; compression beside it still is."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command import crashsolve

from crashpost.result import Result
from crashsolve.parts._beam_tangent import forces_by_motions, lack_in_tension

E, SIDE, LENGTH = 1e9, 0.01, 1.0
BENDING = E * SIDE**4 / 12.0
EULER = np.pi**2 * BENDING / (4.0 * LENGTH**2)
STEEL: dict[str, dict[str, Any]] = {
    "beam": {"type": "elastic"},
    "fibre_beam": {"type": "elastoplastic", "yield_stress": 1e6, "hardening": 1e8},
}


def solved(folder: Path, kind: str, parts: dict[str, tuple[int, float]], steps: int) -> Any:
    """Cantilevers of so many elements, with forces along them at their ends."""
    steel = {"young": E, "poisson": 0, "density": 1000} | STEEL[kind]
    deck: dict[str, Any] = {
        "control": {"end_time": 1, "solution": "quasi_static", "steps": steps, "tolerance": 1e-9},
        "materials": {"steel": steel},
        "sections": {"bar": {"type": "rectangle", "width": SIDE, "height": SIDE}},
        "curves": {"rise": {"points": [[0, 0], [1, 1]]}},
        **{word: {} for word in ("parts", "joints", "loads")},
    }
    for k, (name, (count, force)) in enumerate(parts.items()):
        mesh = {"shape": "line", "from": [0, k, 0], "to": [LENGTH, k, 0], "elements": count}
        card = {"type": kind, "mesh": mesh, "section": "bar", "material": "steel"}
        more = {"fibres": [2, 2]} if kind == "fibre_beam" else {}
        deck["parts"][name] = card | {"side": [0, 1, 0]} | more
        deck["joints"][name] = {"type": "weld", "b": f"{name}_start", "at": [0, k, 0]}
        load = {"type": "force", "body": f"{name}_end", "force": [force, 0, 0], "curve": "rise"}
        deck["loads"][name] = load
    (folder / "deck.yaml").write_text(yaml.safe_dump(deck))
    return crashsolve(folder / "deck.yaml", "-o", folder, NUMBA_DISABLE_JIT="1")


@pytest.mark.parametrize("kind", ["beam", "fibre_beam"])
def test_a_bar_in_tension_is_stable_and_told_to_be_too_long(kind: str, tmp_path: Path) -> None:
    # elastic, 108 E I / l^2; bending bears less than 12 of it in one element
    done = solved(tmp_path, kind, {"bar": (1, 90.0)}, 1)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "'bar_1' bears more tension" in done.stdout + done.stderr
    end = Result(tmp_path).series("rbdout.bar_end.position.x").values[-1]
    # of the stretch, which the tolerance of the run is over
    assert end - LENGTH == pytest.approx(90.0 * LENGTH / (E * SIDE**2), rel=1e-6)


def test_a_bar_of_enough_elements_is_not_warned_of(tmp_path: Path) -> None:
    # 72 E I / L^2, and 4.5 E I / l^2
    done = solved(tmp_path, "fibre_beam", {"bar": (4, 60.0)}, 1)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "more tension" not in done.stdout + done.stderr


@pytest.mark.long
@pytest.mark.parametrize("kind", ["beam", "fibre_beam"])
@pytest.mark.parametrize("drawn", [0.0, 50.0])
def test_a_column_buckles_beside_a_bar_in_tension(kind: str, drawn: float, tmp_path: Path) -> None:
    exact = EULER * (1.0 + np.pi**2 / (48.0 * 4**2))
    for force, code in ((0.99 * exact, 0), (1.01 * exact, 4)):
        parts = {"bar": (1, drawn), "column": (4, -force)}
        done = solved(tmp_path, kind, parts, 1)
        assert done.returncode == code, done.stdout + done.stderr
        assert code == 0 or "'column_" in done.stdout + done.stderr


def test_elements_and_what_they_lack_have_the_work_along_the_bent_line() -> None:
    kinds = [("length", float), ("stiffness", float, 3), ("turning_stiffness", float, 3)]
    p, length, N = np.zeros(1, kinds), 2.0, 3.0
    p["length"], p["stiffness"] = length, [1e6, 0.0, 0.0]
    q, way = np.array([[1.0, 0.0, 0.0, 0.0]]), np.array([[length + N / 1e6, 0.0, 0.0]])
    K = lack_in_tension(p, q, q, way, np.array([N])) - forces_by_motions(p, q, q, way)
    for across, turn, sign in ((1, 5, 1.0), (2, 4, -1.0)):
        # of end b, the other clamped: w' = s / l + theta x / l, where w = s + theta l / 2
        to_slope = np.array([[1.0, -0.5 * sign * length], [0.0, sign]])
        work = N * np.array([[1.0 / length, 0.5], [0.5, length / 3.0]])
        at = [6 + across, 6 + turn]
        # the stretch N / 1e6 is left out
        expected = to_slope.T @ work @ to_slope
        assert K[0][np.ix_(at, at)] == pytest.approx(expected, rel=1e-5, abs=1e-5)
    compressed = lack_in_tension(p, q, q, way, np.array([-N]))
    assert not compressed.any()
