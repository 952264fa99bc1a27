"""Claim: a mutated plan, or a damaged folder of a sweep, gets an answer or one clear error."""

import copy
import json
import random
from pathlib import Path

import pytest
import yaml
from attack.mutations import change_anything, change_number

from crashpost.errors import PostError
from crashpost.sweeps import table
from crashsolve.foundation.errors import CrashsolveError
from crashsolve.sweep.design import points_of
from crashsolve.sweep.plan import read_plan

QUEUE = Path(__file__).resolve().parents[2] / "decks" / "queue"
PLANS = """
{deck: wagon.yaml, design: {type: saltelli, runs: 4, seed: 3},
 vary: {speed: {from: 5 km/h, to: 15 km/h},
 mass: {distribution: normal, mean: 20 t, deviation: 3 t, from: 10 t}}, time_limit: 10 s,
 measure: [{name: a, channel: rcforc.buffer.normal, statistic: max, unit: kN}]}
---
{deck: wagon.yaml, design: {type: grid}, vary: {a: [1, b, 3 m], b: {from: 1, to: 9, count: 3},
 c: {from: 1, to: 4, count: 4, whole: true}}, set: {d: true},
 measure: [{channel: 2 * a.b.c, statistic: "at:0.1"},
  {channel: a.b.c, statistic: min, during: [0, 1]}]}
---
{deck: wagon.yaml, design: {type: latin_hypercube, runs: 5}, vary: {
 a: {distribution: log_uniform, from: 1 m, to: 100 m},
 b: {distribution: triangular, from: 1, to: 4, peak: 2},
 c: {distribution: lognormal, mean: 3, deviation: 1, to: 9}},
 measure: [{channel: a.b.c, statistic: mean}]}
"""


@pytest.mark.parametrize("seed", range(3))
def test_a_mutated_plan_is_read_or_refused(seed: int, tmp_path: Path) -> None:
    (tmp_path / "wagon.yaml").write_text((QUEUE / "wagon.yaml").read_text("utf-8"), "utf-8")
    plans, rng = list(yaml.safe_load_all(PLANS)), random.Random(seed)
    path, good = tmp_path / "plan.yaml", 0
    for _ in range(150):
        data = copy.deepcopy(rng.choice(plans))
        for _ in range(rng.choice((1, 1, 2))):
            change = change_number if rng.random() < 0.6 else change_anything
            change(data, rng)
        text = yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
        path.write_bytes(text.encode("utf-8", "replace"))
        try:
            plan = read_plan(path)
            # what is drawn takes a moment
            points = points_of(plan) if (plan.card.design.runs or 0) < 1000 else []
        except CrashsolveError as refused:
            assert refused.exit_code == 2
            assert str(refused)
            continue
        good += 1
        for point in points:
            assert not {"nan", "inf", "-inf"} & {text.split()[0] for text in point.values()}
    assert 0 < good < 150


def sweep_folder(folder: Path) -> dict[str, object]:
    """sweep.json of one run that has failed."""
    mark = {"deck": "d", "files": "f", "version": "v"}
    run = folder / "runs" / "0001"
    run.mkdir(parents=True)
    (run / "run.json").write_text(json.dumps({"mark": mark, "state": "failed", "message": "m"}))
    return {
        "format": "crashsolve sweep",
        "format_version": 1,
        "title": "t",
        "plan": "p",
        "deck": "d",
        "design": "grid",
        "axes": [{"name": "a", "unit": "m", "is_of_numbers": True, "scale": "linear"}],
        "measures": [{"name": "x", "channel": "a.b.c", "statistic": "max", "unit": "m"}],
        "runs": [
            {"number": 1, "folder": "runs/0001", "values": {"a": "3 m"}, "overrides": {}}
            | {"mark": mark}
        ],
    }


def test_a_damaged_sweep_is_reported(tmp_path: Path) -> None:
    data, rng = sweep_folder(tmp_path), random.Random(5)
    path = tmp_path / "sweep.json"
    path.write_text(json.dumps(data), "utf-8")
    (row,) = table.read(tmp_path).rows
    assert (row.state, row.message, row.values) == ("failed", "m", [3.0])
    reported = 0
    for _ in range(300):
        wrong = copy.deepcopy(data)
        change_anything(wrong, rng)
        path.write_text(json.dumps(wrong, default=str), "utf-8")
        try:
            table.write(table.read(tmp_path))
        except PostError as error:
            reported += 1
            assert "sweep.json" in str(error)
    assert reported > 0
