"""What the solver's writer writes is what crashpost reads: the one test that imports both."""

import json
from pathlib import Path

import numpy as np
import pytest

from crashpost.reports.views import appearance, scenes_of
from crashpost.results.result import Result
from crashpost.values.figure import figures_of

channels = pytest.importorskip("crashsolve.output.channels")
history = pytest.importorskip("crashsolve.output.history")
status = pytest.importorskip("crashsolve.output.status")


def write(folder: Path, *, close: bool) -> None:
    columns = (channels.Column("velocity", "x", "m/s", ""), channels.Column("energy", "", "J", ""))
    families = (channels.Family("rbdout", ("A", "car-b"), columns),)
    metadata = {"title": "Two", "expect": [], "deck_text": "title: Two\n"}
    writer = history.HistoryWriter(folder / "history.h5", families, metadata)
    rows = [[[step, 2.0], [-step, 3.0]] for step in range(5)]
    writer.append(0.1 * np.arange(5), {"rbdout": np.array(rows)})
    writer.close() if close else writer.flush()


@pytest.mark.parametrize("close", [True, False])
def test_crashpost_reads_what_the_solver_writes(tmp_path: Path, close: bool) -> None:
    write(tmp_path, close=close)
    result = Result(tmp_path)
    names = [channel.name for channel in result.channels()]
    assert sorted(names) == [
        "rbdout.A.energy",
        "rbdout.A.velocity.x",
        "rbdout.car-b.energy",
        "rbdout.car-b.velocity.x",
    ]
    time, values, unit = result.series("rbdout.car-b.velocity.x")
    assert unit == "m/s"
    np.testing.assert_allclose(time, 0.1 * np.arange(5))
    assert values.tolist() == [0.0, -1.0, -2.0, -3.0, -4.0]
    assert (result.title, result.stored_json("expect")) == ("Two", [])


def test_a_written_status_is_understood(tmp_path: Path) -> None:
    write(tmp_path, close=True)
    entry = status.Status("finished", 1.0, 100, 1.0, 1e-5, float("nan"), 0.1, 0.2, 0)
    status.write_status(tmp_path / "status.json", entry)
    assert Result(tmp_path).finished


def test_a_scene_of_a_deck_is_understood() -> None:
    cards = pytest.importorskip("crashsolve.deck.run_cards.output")
    dump = pytest.importorskip("crashsolve.deck.dump")
    written = {"title": "Crush", "at": [0, "50 ms", "max:rcforc.left.normal"], "show": ["A", "C"]}
    card = cards.Report.model_validate({"scenes": [{**written, "view": "1,-1,0.5"}]})
    stored = json.loads(json.dumps(dump.as_data(card)))
    (scene,) = scenes_of(stored)
    assert scene["at"] == ["0", "50 ms", "max:rcforc.left.normal"]
    assert appearance(scene) == {"show": ("A", "C"), "view": "1,-1,0.5"}
    # without figures of its own a report keeps the default ones
    assert not stored["figures"]


def test_a_figure_of_a_deck_is_understood() -> None:
    cards = pytest.importorskip("crashsolve.deck.run_cards.output")
    dump = pytest.importorskip("crashsolve.deck.dump")
    reference = {"label": "plateau", "kind": "band", "from": 0.8, "to": 1.2, "source": "Fig. 16"}
    curve = {"channel": "-rcforc.left.force.normal", "label": "left"}
    written = {"title": "Force", "y": [curve, "rcforc.right.force.normal"], "y_unit": "MN"}
    card = cards.Report.model_validate({"figures": [{**written, "reference": [reference]}]})
    (figure,) = figures_of(json.loads(json.dumps(dump.as_data(card))))
    assert figure.y_unit == "MN"
    assert [c.channel for c in figure.y] == [curve["channel"], "rcforc.right.force.normal"]
    assert (figure.reference[0].from_, figure.reference[0].to) == (0.8, 1.2)
