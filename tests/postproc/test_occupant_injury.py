"""Claim: measures of neck, chest, thigh and brain are those of their closed forms."""

from pathlib import Path

import numpy as np
import pytest
from small_results import write_result, write_status

from crashpost.results.result import Result
from crashpost.values import injury_table, occupant_injury
from crashpost.values.injury_measure import HEADER, Measure, rows, verdict
from crashpost.values.occupant_injury import bric, femur_share, measures, nij, viscous

TIME = np.linspace(0.0, 0.2, 4001)
DECK = """
sensors:
  head: {type: accelerometer, role: head}
  neck: {type: section_force, role: neck, joint: condyles}
  thigh: {type: section_force, role: femur_left, joint: knee}
  ribs: {type: displacement, role: chest_deflection}
springs:
  cone: {type: cone_stop, joint: condyles}
  other: {type: cone_stop, joint: hip}
"""


def row_of(table: list[list[str]], name: str, measure: str) -> list[str]:
    (row,) = (row for row in table if row[0] == name and row[1].split(",")[0] == measure)
    return row


def occupant(folder: Path, deck: str = DECK) -> Result:
    """Half waves of 0.1 s, slow beside every filter: what they do to a peak is below 0.1 %."""
    wave = np.where(TIME < 0.1, np.sin(np.pi * TIME / 0.1), 0.0)

    def columns(unit: str, **of: np.ndarray) -> dict[str, tuple[str, str, np.ndarray]]:
        return {name.replace("_", "/"): (unit, "", value) for name, value in of.items()}

    two = np.zeros((len(TIME), 2))
    force, moment, springs = two.copy(), two.copy(), two.copy()
    force[:, 0], force[:, 1] = 3403.0 * wave, 8000.0 * wave
    # half of the moment on the neck is that of the spring in its joint
    moment[:, 0], springs[:, 0], springs[:, 1] = -40.0 * wave, -22.0 * wave, 1e3
    families = {
        "secforc": (
            ["neck", "thigh"],
            columns("N", force_z=-force) | columns("N m", moment_y=moment),
        ),
        "deforc": (["cone", "other"], columns("N m", moment_y=springs)),
        "disbout": (["ribs"], columns("m", change=-0.05 * wave[:, None])),
    }
    spin = wave[:, None]
    families["nodout"] = (
        ["head"],
        {
            f"angular_velocity/{a}": ("rad/s", "", w * spin)
            for a, w in zip("xyz", (66.25, -56.45, 42.87), strict=True)
        },
    )
    write_result(folder, families, TIME, deck_text=deck)
    write_status(folder)
    return Result(folder)


def test_measures_of_half_waves(tmp_path: Path) -> None:
    result = occupant(tmp_path / "run")
    table = rows(result, measures)
    # tension of half its intercept and flexion of 62 in 310
    neck = row_of(table, "Neck", "Nij")
    assert neck[1] == "Nij, tension and flexion" and neck[6] == "within"
    assert float(neck[2]) == pytest.approx(0.7, rel=2e-3)
    assert row_of(table, "Neck", "neck tension")[2].startswith("3.40")
    # 8 kN of compression, and cos(pi 5 / 100) of it for 10 ms
    peak, held = (row_of(table, "Thigh", text) for text in ("compression", "compression for 10 ms"))
    assert float(peak[2].split()[0]) == pytest.approx(8.0, rel=2e-3)
    # to a sample at either end
    level = 8.0 * np.cos(np.pi * 5 / 100)
    assert float(held[2].split()[0]) == pytest.approx(level, rel=2e-3)
    assert (peak[6], held[6]) == ("within", "beyond")
    # the ratio is largest of the whole 10 ms
    share = row_of(table, "Thigh", "share of the limit of its time")
    assert float(share[2]) == pytest.approx(level / 7.58, rel=2e-3) and share[6] == "beyond"
    assert float(row_of(table, "Head", "BrIC")[2]) == pytest.approx(3.0**0.5, rel=2e-3)
    # D = 50 mm sin: VC = 1.3 pi D^2 / (2 x 0.1 s x 0.229 m) sin(2 ...)
    expected = 1.3 * np.pi * 0.05**2 / (2 * 0.1 * 0.229)
    assert float(row_of(table, "Ribs", "VC")[2].split()[0]) == pytest.approx(expected, rel=5e-3)
    assert row_of(table, "Ribs", "deflection")[6] == "beyond"


def test_signs_choose_the_intercept() -> None:
    force, moment = np.array([6806.0, -6160.0, 0, 0]), np.array([0, 0, 310.0, -135.0])
    np.testing.assert_allclose(nij(force, moment), 1.0, rtol=1e-15)


def test_a_steady_compression_has_the_viscous_criterion_of_its_rate() -> None:
    time = np.linspace(0.0, 0.01, 101)
    # differences of a straight line are exact
    np.testing.assert_allclose(viscous(time, 4.0 * time)[-1], 1.3 * 4.0 * 0.04 / 0.229, rtol=1e-9)


def test_an_expanding_chest_has_no_viscous_criterion() -> None:
    time = np.linspace(0.0, 0.01, 101)
    # it expands ever faster, so that rate and deflection have the same sign
    assert np.all(viscous(time, -40.0 * time**2) == 0.0)


def test_the_limit_of_a_femur_falls_with_the_time_of_its_load() -> None:
    time = np.linspace(0.0, 0.1, 10001)
    # 8.9 kN for 5 ms, below 9.07 kN and not held for 10 ms: its limit is the middle of both
    force = np.where((time > 0.02) & (time < 0.025), 8900.0, 1000.0)
    # a sample at either end
    assert femur_share(time, force) == pytest.approx(8900.0 / 8325.0, rel=1e-3)
    for level, limit in ((500.0, 7580.0), (9070.0, 7580.0)):
        assert femur_share(time, np.full(len(time), level)) == pytest.approx(level / limit)
    assert femur_share(time, np.where(time == 0.05, 9070.0, 0.0)) == pytest.approx(1.0)


def test_brain_takes_the_largest_of_each_axis() -> None:
    spins = [np.array([0.0, -66.25]), np.array([56.45, 0.0]), np.array([0.0, 0.0])]
    assert bric(spins) == pytest.approx(2.0**0.5, rel=1e-12)


def test_a_level_must_be_held_without_a_break() -> None:
    held = occupant_injury._exceeded_for(np.arange(6.0), np.array([0, 5.0, 4, 5, 0, 9]), 2.0)
    assert held == 4.0
    assert occupant_injury._exceeded_for(np.arange(2.0), np.ones(2), 2.0) == 0.0


def test_a_run_shorter_than_the_time_of_a_limit_is_not_assessed_by_it() -> None:
    force = np.full(11, 2e4)
    held = occupant_injury._held_for(np.linspace(0.0, 0.005, 11), force)
    assert held == (None, "needs a history of 10 ms or more")
    assert occupant_injury._held_for(np.linspace(0.0, 0.02, 11), force) == (2e4, "in one span")


def test_what_no_sensor_serves_is_named(tmp_path: Path) -> None:
    table = rows(occupant(tmp_path / "run"), measures)
    missing = {row[1] for row in table if row[0] == "Occupants"}
    assert missing == {"3 ms clip of the chest", "force of the right femur"}


def test_moments_beside_the_joint_of_the_neck_are_named(tmp_path: Path) -> None:
    joint = "joints: {condyles: {type: spherical, a: neck, b: head}}\n"
    beside = (
        "  rubber: {type: bushing, a: head, b: neck}\n  far: {type: bushing, a: head, b: seat}\n"
    )
    table = rows(occupant(tmp_path / "run", DECK + beside + joint), measures)
    row = row_of(table, "Neck", "Nij is without moments")
    assert row[HEADER.index("when")].startswith("of 'rubber'; springs count that name")
    # what is not whole is not called within its limit
    index = HEADER.index("verdict")
    assert row_of(table, "Neck", "Nij")[index] == "not assessed: moments are missing"
    assert not any("without" in row[1] for row in rows(occupant(tmp_path / "other"), measures))


def test_the_error_is_that_of_every_second_sample(tmp_path: Path) -> None:
    """A pulse of one sample has no index that samples could give, and a slow one has."""
    g, spike, slow = 9.80665, np.zeros(201), 50.0 * np.sin(np.pi * np.linspace(0, 1, 201)) ** 2
    spike[101] = 100.0
    axes = {f"acceleration/{a}": ("m/s^2", "", np.zeros((201, 2))) for a in "xy"}
    axes["acceleration/z"] = ("m/s^2", "", g * np.stack([spike, slow], axis=1))
    cards = ", ".join(f"{n}: {{type: accelerometer, role: head}}" for n in ("spike", "slow"))
    time = np.linspace(0.0, 0.1, 201)
    write_result(
        tmp_path / "run",
        {"nodout": (["spike", "slow"], axes)},
        time,
        deck_text=f"sensors: {{{cards}}}",
    )
    table = injury_table.table(Result(tmp_path / "run"))
    value, error = (HEADER.index(word) for word in ("value", "error of samples"))
    sharp, smooth = (row_of(table, name, "Severity Index") for name in ("Spike", "Slow"))
    # trapezoids of one sample: a^2.5 dt; without it nothing is left
    assert float(sharp[value]) == pytest.approx(1e5 * 5e-4, rel=1e-4)
    assert float(sharp[error]) == pytest.approx(float(sharp[value]), rel=1e-2)
    # (pi h / T)^2 / 12 of a^2.5 and of its straight lines
    assert float(smooth[error]) < 2e-3 * float(smooth[value])


def test_a_limit_within_the_error_decides_nothing() -> None:
    one = Measure("Head", "HIC, 15 ms", 690.0, limit=700.0)
    assert [verdict(one, error) for error in (None, 5.0, 20.0)] == [
        "within",
        "within",
        "uncertain: within the error",
    ]
    assert verdict(one._replace(value=None), None) == ""
    assert verdict(one._replace(missing="not filtered"), 0.0) == "not assessed: not filtered"


def test_belts_and_ejection_are_among_the_measures(tmp_path: Path) -> None:
    time = np.linspace(0.0, 0.1, 201)
    force = np.stack([3e3 * np.sin(np.pi * time / 0.1), np.zeros(201)], axis=1)
    families = {
        "beltout": (
            ["lap", "loose"],
            {"force/1": ("N", "", 0.5 * force), "force/2": ("N", "", force)}
            | {"pay_out": ("m", "", 1e-5 * force)},
        ),
        "disbout": (["rear"], {"distance": ("m", "", 8.0 * time[:, None])}),
    }
    deck = """
sensors:
  rear: {type: displacement, role: seat}
  condyles: {type: section_force, role: neck}
"""
    write_result(tmp_path / "run", families, time, deck_text=deck)
    table = injury_table.table(Result(tmp_path / "run"))
    row = row_of(table, "Lap", "largest force")
    assert (row[2], row[-1]) == ("3 kN", "at 50 ms, segment 2")
    assert row_of(table, "Lap", "largest pay-out")[2] == "30 mm"
    assert row_of(table, "Loose", "largest force")[2] == "0 kN"
    # 8 m/s: 0.5 m and 1 m from the seat, between two samples
    assert row_of(table, "Rear", "leaves the seat")[2] == "62.5 ms"
    never = row_of(table, "Rear", "is ejected")
    assert (never[2], never[-1]) == ("-", "is never 1 m away")


def test_measures_are_in_the_units_of_their_page(tmp_path: Path) -> None:
    result = occupant(tmp_path / "run")
    row = row_of(rows(result, measures, {"m": "m", "s": "s"}), "Ribs", "deflection")
    assert (row[2], row[HEADER.index("limit")], row[-1]) == ("0.05 m", "0.042 m", "at 0.05 s")
    assert row_of(rows(result, measures), "Ribs", "deflection")[-1] == "at 50 ms"


def test_the_table_states_whose_limits_it_has(tmp_path: Path) -> None:
    table = rows(occupant(tmp_path / "run"), measures)
    assert "50th percentile man, whatever the occupant's size" in injury_table.notes(table)[-1]
    # without a limit only the errors need a word
    bare = [["head", "largest acceleration", "1 g", "0.1 g", "", "", "", ""]]
    assert len(injury_table.notes(bare)) == 1
    assert injury_table.notes([]) == []
