"""Claims of the elastic beam: all six decks meet their expectations, with and without friction."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick

from crashpost.cli import main as crashpost
from crashpost.results.result import Result

DECKS = Path(__file__).parents[2] / "decks" / "scenes"
# one worker runs all of them, and compiles both scenes once
pytestmark = pytest.mark.xdist_group("beam_impact")


def run(folder: Path, deck: str, **changes: object) -> Path:
    words = [word for name, value in changes.items() for word in ("--set", f"{name}={value}")]
    path = DECKS / f"beam_impact_{deck}.yaml"
    done = crashsolve(path, "-o", folder, "--set", "control.estimate=off", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.parametrize("mu", first_quick([0.0, 0.35]))
@pytest.mark.parametrize("model", ["continuous", "unilateral"])
@pytest.mark.parametrize(
    "elements", [10, *(pytest.param(n, marks=pytest.mark.long) for n in (4, 20))]
)
def test_the_decks_meet_their_expectations(
    elements: int, model: str, mu: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path, f"{elements}_{model}", mu=mu)
    code = crashpost(["expect", str(tmp_path)])
    assert code == 0, capsys.readouterr().out


@pytest.mark.long
def test_captures_lose_less_as_the_mesh_is_refined(tmp_path: Path) -> None:
    lost = []
    for elements in (5, 10, 20):
        folder = run(tmp_path / str(elements), "10_unilateral", elements=elements, mu=0.35)
        result = Result(folder)
        # the first capture is that of half an element's mass at 2 m/s
        first = np.interp(0.501, *result.series("rcforc.node_1.dissipated")[:2])
        assert first == pytest.approx(0.5 * (10.0 / elements) * 2.0**2, rel=1e-9)
        lost.append(result.series("glstat.model.energy.contact_dissipated").values[-1])
    assert lost[0] > lost[1] > lost[2]
    assert lost[2] < 0.5 * lost[0]
