"""Claim: a wrong plan is refused before anything runs, each error at its location."""

from pathlib import Path

import pytest

from crashsolve.foundation.errors import CrashsolveError
from crashsolve.sweep.plan import read_plan
from crashsolve.sweep.runner import prepared

WAGON = Path(__file__).resolve().parents[2] / "decks" / "queue" / "wagon.yaml"
MEASURE = "measure: [{channel: rcforc.buffer.normal, statistic: max}]"
RIGHT = f"""deck: wagon.yaml
design: {{type: sobol, runs: 4}}
vary:
  speed: {{from: "5 km/h", to: "15 km/h"}}
  mass: ["10 t", "20 t"]
{MEASURE}
"""
# what is replaced in the right plan, by what, and what is said of it
WRONG = {
    "a word that is no field": ("design:", "desing:", "2:1: error: unknown field 'desing'"),
    "no deck": ("deck: wagon.yaml", "deck: wagn.yaml", "1:7: error: deck: there is no file"),
    "no measure": (MEASURE, "measure: []", "6:1: error: measure: is empty"),
    "nothing varied": ("vary:\n  speed", "vary: {}\nset:\n  speed", "vary: is empty"),
    "zero runs": ("runs: 4", "runs: 0", "2:29: error: design runs: must be from 1 to 100000"),
    "no number of runs": (", runs: 4", "", "runs: sobol needs their number"),
    "no power of two": ("runs: 4", "runs: 6", "not balanced; take a power of two, 4 or 8"),
    "an unknown design": ("sobol", "sobl", "must be 'grid', 'list', 'latin_hypercube', 'sobol'"),
    "a range upside down": ('"15 km/h"', '"1 km/h"', "from: 5 is more than to: 1"),
    "an empty range": ('"15 km/h"', '"5 km/h"', "from: and to are both 5, which leaves nothing"),
    "two units": ('"15 km/h"', '"15 m/s"', "in one unit, not in 'km/h' and 'm/s'"),
    "no end": (', to: "15 km/h"', "", "needs a list of values, or a range"),
    "no unit at all": ('"15 km/h"', '"15 kmh"', "4:31: error: vary speed to: must be a number"),
    "no values": ('["10 t", "20 t"]', "[]", "vary mass: an empty list"),
    "a value twice": ('["10 t", "20 t"]', '["10 t", "20 t", "10 t"]', "has the value 10 t twice"),
    "a list of lists": ('["10 t", "20 t"]', "[[1], [2]]", "vary mass 1: must be a number or a"),
    "a bare value": ('["10 t", "20 t"]', "10 t", "5:9: error: vary mass: must be a list"),
    "a name twice": ("mass: [", "speed: [", "'speed' is given twice; first in line 4"),
    "one parameter twice": ("mass: [", "parameters.speed: [", "'parameters.speed' is given alr"),
    "varied and set": ("deck: wagon.yaml", "deck: wagon.yaml\nset: {mass: 1}", "'mass' is given"),
    "a count of a drawn range": ('"15 km/h"', '"15 km/h", count: 3', "count: belongs to a grid"),
    "a range in a list": ("type: sobol, runs: 4", "type: list", "does not go with design: list"),
    "a range without count": ("type: sobol, runs: 4", "type: grid", "write count: 5"),
    "a seed of a grid": ("sobol, runs: 4", "grid, seed: 2", "the values alone say what is run"),
    "two headings": (MEASURE, MEASURE.replace("]", "]\nx: 1")[:-5].replace(
        "max}", "max}, {channel: rcforc.buffer.normal, statistic: max}"), "is a heading already"),
    "a name of the table": ("mass: [", "state: [", "'state' is a column of the table already"),
    "an expression": ("rcforc.buffer.normal", "\"maxx(rcforc.buffer.normal)\"", "maxx"),
    "a unit": ("statistic: max", "statistic: max, unit: kNN", "measure 1 unit: unknown unit"),
    "no statistic": ("statistic: max", "statistic: maxi", "unknown statistic 'maxi'"),
    "no deviation": ('{from: "5 km/h", to', '{distribution: normal, mean: "5 km/h", to',
                     "distribution: normal needs 'deviation'"),
    "a mean of a range": ('"15 km/h"}', '"15 km/h", mean: 3}', "mean: belongs to distribution"),
    "a log range from zero": ('{from: "5 km/h"', '{distribution: log_uniform, from: "0 km/h"',
                              "from: must be greater than 0 for log_uniform"),
    "limits beyond all values": (
        '{from: "5 km/h", to: "15 km/h"}',
        "{distribution: normal, mean: 0, deviation: 1, from: 50, to: 60}",
        "the limits leave nothing of the distribution",
    ),
    # of the deck
    "an unknown parameter": ("mass: [", "mas: [", "5:3: error: run 1: mas = "),
    "an unknown path": ("mass: [", "bodies.wagn.mass: [", "unknown body 'wagn'"),
    "a word without use": ('mass: ["10 t", "20 t"]', "control.steps: [5, 6]",
                           "5:3: error: run 1: control: control.steps = 5: it belongs to"),
    "a set word without use": ("deck: wagon.yaml", "deck: wagon.yaml\nset: {control.steps: 5}",
                               "2:7: error: run 1: control: control.steps = 5: it belongs to"),
    "a value the deck refuses": ('["10 t", "20 t"]', '["-1 t", "-2 t"]', "must be greater than 0"),
    "a wrong unit": ('"5 km/h", to: "15 km/h"', '"5 kg", to: "15 kg"', "4:3: error: run 1: speed"),
}  # fmt: skip


def written(folder: Path, text: str) -> Path:
    """A plan beside a copy of its deck."""
    (folder / "wagon.yaml").write_text(WAGON.read_text("utf-8"), "utf-8")
    path = folder / "plan.yaml"
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_plan_is_refused_with_place_and_reason(name: str, tmp_path: Path) -> None:
    old, new, reported = WRONG[name]
    assert old in RIGHT
    path = written(tmp_path, RIGHT.replace(old, new))
    with pytest.raises(CrashsolveError) as refused:
        prepared(read_plan(path))
    assert refused.value.exit_code == 2
    first = str(refused.value).splitlines()
    assert any(reported in line for line in first), refused.value
    assert any(line.startswith(str(tmp_path)) for line in first)


def test_all_errors_are_reported_at_once(tmp_path: Path) -> None:
    text = RIGHT.replace("runs: 4", "runs: 5").replace("statistic: max", "statistic: mx")
    with pytest.raises(CrashsolveError) as refused:
        read_plan(written(tmp_path, text.replace('"15 km/h"', "3")))
    assert len(str(refused.value).splitlines()) == 3


def test_the_first_run_with_a_wrong_deck_is_named_with_its_values(tmp_path: Path) -> None:
    text = RIGHT.replace('["10 t", "20 t"]', "{distribution: normal, mean: 1 t, deviation: 1 t}")
    path = written(tmp_path, text.replace("runs: 4", "runs: 64"))
    with pytest.raises(CrashsolveError) as refused:
        prepared(read_plan(path))
    first, last = str(refused.value).splitlines()
    assert "must be greater than 0" in first and "mass = -" in first and "run " in first
    # a normal distribution is below its mean less one deviation in 16 % of all draws
    assert "10 of the 64 runs have a wrong deck" in last


def test_a_right_plan_has_its_runs(tmp_path: Path) -> None:
    title, runs = prepared(read_plan(written(tmp_path, RIGHT)))
    assert title == "A wagon runs into a buffer stop"
    assert [run.number for run in runs] == [1, 2, 3, 4]
    assert all(run.values["speed"].endswith(" km/h") for run in runs)
    assert {run.values["mass"] for run in runs} == {"10 t", "20 t"}
    assert len({run.mark.deck for run in runs}) == 4
