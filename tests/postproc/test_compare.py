"""Results side by side, ratings against tests, and files for other programs."""

from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
from small_results import TIME, Command, two_cars, write_result, write_status

from crashpost.compare.difference import compare
from crashpost.compare.rating import rating
from crashpost.errors import PostError
from crashpost.exports.mme import code
from crashpost.results.result import Result
from crashpost.values.measured import Column, Measurement
from crashsolve.channels.series import Series

FORCE = "deforc.buffer.force"


def shifted(folder: Path, share: float) -> Path:
    """Two cars, the buffer's force wrong by a share of its range at its peak alone."""
    families = two_cars()
    unit, meaning, values = families["deforc"][1]["force"]
    values = values.copy()
    values[200] -= share * np.ptp(values)
    families["deforc"][1]["force"] = (unit, meaning, values)
    write_result(folder, families, title="Cars", parameters=f'{{"share": {share}}}')
    write_status(folder)
    return folder


def test_a_difference_is_reported_over_the_range_with_its_time(tmp_path: Path) -> None:
    runs = [Result(shifted(tmp_path / f"{k}", share)) for k, share in enumerate((0.0, 0.02))]
    compared = compare(runs)
    worst = compared.differences[0]
    # the peak that is wrong widens the range itself
    assert worst.largest == pytest.approx(0.02 / 1.02, rel=1e-9)
    assert (worst.channel, worst.time) == (FORCE, TIME[200])
    assert not compared.remarks
    assert all(one.largest == 0.0 for one in compared.differences[1:])


def test_the_exit_code_states_whether_results_differ(
    tmp_path: Path, cars: Path, crashpost: Command
) -> None:
    near, far = shifted(tmp_path / "n", 0.005), shifted(tmp_path / "f", 0.02)
    exact = shifted(tmp_path / "e", 0.0)
    code_, out, _ = crashpost("compare", exact, near)
    assert (code_, "0 of 8 channels" in out) == (0, True)
    code_, out, _ = crashpost("compare", exact, far)
    assert (code_, out.count("beyond")) == (1, 1)
    assert "share 0.02" in out
    assert crashpost("compare", exact, far, "--tolerance", "0.03")[0] == 0
    assert crashpost("compare", exact, near, far, "--tolerance", "0")[0] == 1
    page = tmp_path / "c.html"
    assert crashpost("compare", exact, far, "-o", page)[0] == 1
    assert "Buffer: force" in page.read_text()
    for wrong, message in (
        ((FORCE,), "two results or more"),
        ((near, "--tolerance", "-1"), "takes a share"),
        ((near, "--during", "0:1"), "need --test"),
        ((near, "deforc.bufer.force"), "did you mean"),
    ):
        code_, _, err = crashpost("compare", exact, *wrong)
        assert (code_, message in err) == (2, True)


def test_round_off_is_no_difference_and_a_missing_channel_is(tmp_path: Path) -> None:
    runs = []
    for k in range(2):
        families = two_cars()
        noise = 1e-9 * (-1.0) ** np.arange(401)[:, None] * (1 + k)
        families["jntforc"] = (["pin"], {"force/x": ("N", "", noise)})
        if k:
            del families["deforc"][1]["length"]
        runs.append(Result(write_result(tmp_path / f"{k}", families)))
    compared = compare(runs)
    noise = next(one for one in compared.differences if one.channel.startswith("jntforc"))
    assert noise.largest < 1e-8
    assert compared.remarks == [f"1 channel in {tmp_path / '0'} only: deforc.buffer.length"]


def test_other_times_and_a_shorter_run_are_met(tmp_path: Path) -> None:
    columns = {"velocity/x": ("m/s", "", np.array([[0.0], [1.0], [2.0]]))}
    write_result(tmp_path / "a", {"rbdout": (["b"], columns)}, np.array([0.0, 1.0, 2.0]))
    columns = {"velocity/x": ("m/s", "", np.array([[0.0], [1.5]]))}
    write_result(tmp_path / "b", {"rbdout": (["b"], columns)}, np.array([0.0, 1.5]))
    runs = [Result(tmp_path / name) for name in "ab"]
    compared = compare(runs)
    assert compared.differences[0].largest == pytest.approx(0.0, abs=1e-15)
    assert "compared in the time of both" in compared.remarks[0]
    columns = {"velocity/x": ("N", "", np.zeros((2, 1)))}
    write_result(tmp_path / "c", {"rbdout": (["b"], columns)}, np.array([0.0, 1.5]))
    with pytest.raises(PostError, match="cannot|is in 'm/s' and in 'N'"):
        compare([runs[0], Result(tmp_path / "c")])


def pulse(time: np.ndarray, delay: float = 0.0, size: float = 1.0) -> np.ndarray:
    """A smooth pulse of 60 ms."""
    return size * np.exp(-(((time - 0.05 - delay) / 0.012) ** 2))


@pytest.mark.long
def test_the_rating_of_a_measured_curve() -> None:
    time = np.linspace(0.0, 0.1, 1001)
    measured = Column("force", "kN", pulse(time))
    test = Measurement("t", Column("time", "ms", 1e3 * time), (measured,))
    same = rating(Series(time, 1e3 * pulse(time), "N"), test, measured)
    # the same curve in other units: 1, but for the last digits of N and kN, s and ms
    assert same[:5] == pytest.approx((1.0,) * 5, abs=2e-3)
    assert same.grade == "excellent"
    late = rating(Series(time, 1e3 * pulse(time, 0.004), "N"), test, measured)
    # of a shift of 4 % of the interval, linear to 20 %: 1 - 4/20
    assert late.phase == pytest.approx(0.8, abs=0.01)
    small = rating(Series(time, 500 * pulse(time), "N"), test, measured)
    assert small.overall < late.overall < same.overall
    with pytest.raises(PostError, match="share less than"):
        rating(Series(time + 0.099, time, "N"), test, measured)
    with pytest.raises(PostError, match="does not change"):
        rating(Series(time, 0 * time, "N"), test, measured)


@pytest.mark.long
def test_rate_one_result_against_a_test(tmp_path: Path, cars: Path, crashpost: Command) -> None:
    path = tmp_path / "pole.csv"
    force = two_cars()["deforc"][1]["force"][2][:, 0]
    rows = [f"{1e3 * t},{f / 1e3}" for t, f in zip(TIME, force, strict=True)]
    path.write_text("\n".join(["time [ms],force [kN]", *rows]))
    code_, out, err = crashpost("compare", cars, FORCE, "--test", path)
    assert (code_, err) == (0, "")
    assert "excellent" in out
    assert crashpost("compare", cars, "rbdout.A.velocity.x", "--test", path)[0] == 2


def test_parquet_holds_the_bits_and_the_units(
    cars: Path, tmp_path: Path, crashpost: Command
) -> None:
    target = tmp_path / "x.parquet"
    assert crashpost("export", cars, "rbdout.*", f"-{FORCE}", "-o", target)[0] == 0
    table = pq.read_table(target)
    assert table.schema.field(f"-{FORCE}").metadata[b"unit"] == b"N"
    assert table.schema.field("time").metadata[b"unit"] == b"s"
    frame = table.to_pandas()
    np.testing.assert_array_equal(frame.index, TIME)
    stored = Result(cars).series("rbdout.A.velocity.x").values
    np.testing.assert_array_equal(frame["rbdout.A.velocity.x"], stored)


def read_mme(path: Path) -> tuple[dict[str, str], np.ndarray]:
    """Descriptors and values of a channel's file, by the layout of ISO/TS 13499."""
    lines = path.read_text("latin-1").splitlines()
    head = dict(line.split(":", 1) for line in lines if ":" in line)
    values = np.array([float(line) for line in lines if ":" not in line])
    return {name.strip(): text for name, text in head.items()}, values


def test_iso_mme_holds_header_index_and_channels(
    cars: Path, tmp_path: Path, crashpost: Command
) -> None:
    target = tmp_path / "crash.mme"
    assert crashpost("export", cars, "rbdout.*", FORCE, "-o", target)[0] == 0
    assert "Title                       :Two cars" in target.read_text()
    index = (tmp_path / "Channel" / "crash.chn").read_text()
    assert "Number of channels          :3" in index
    head, values = read_mme(tmp_path / "Channel" / "crash.003")
    assert head["Name of the channel"] == FORCE
    assert (head["Channel code"], head["Unit"]) == ("1???????????FO00", "N")
    assert (head["Reference channel"], int(head["Number of samples"])) == ("implicit", 401)
    assert float(head["Sampling interval"]) == pytest.approx(TIME[1], rel=1e-12)
    np.testing.assert_array_equal(values, Result(cars).series(FORCE).values)


def test_iso_mme_of_uneven_samples_refers_to_their_times(
    tmp_path: Path, crashpost: Command
) -> None:
    time = np.array([0.0, 1.0, 1.5])
    columns = {"velocity/x": ("m/s", "", np.ones((3, 1)))}
    write_result(tmp_path / "r", {"rbdout": (["b"], columns)}, time)
    assert crashpost("export", tmp_path / "r", "-o", tmp_path / "r.mme")[0] == 0
    head, values = read_mme(tmp_path / "Channel" / "r.001")
    np.testing.assert_array_equal(values, time)
    other, _ = read_mme(tmp_path / "Channel" / "r.002")
    assert other["Reference channel name"] == head["Channel code"] == "1???????????TI00"


@pytest.mark.parametrize(
    ("channel", "unit", "expected"),
    [
        ("nodout.head.acceleration.x", "m/s^2", "1???????????ACX0"),
        ("glstat.model.energy.kinetic", "J", "1???????????" + "??" + "00"),
        ("deforc.rotation.moment", "N m", "1???????????MO00"),
        ("rbdout.a.velocity.resultant", "m/s", "1???????????VER0"),
        ("hinge.a.angle", "rad", "1???????????AN00"),
        ("rcforc.a.onsets", "1", "1???????????" + "??" + "00"),
    ],
)
def test_channel_codes_have_sixteen_letters(channel: str, unit: str, expected: str) -> None:
    assert code(channel, unit) == expected
    assert len(expected) == 16


def test_an_unknown_ending_is_refused(cars: Path, tmp_path: Path, crashpost: Command) -> None:
    code_, _, err = crashpost("export", cars, "-o", tmp_path / "x.xlsx")
    assert (code_, ".csv, .parquet, .mme" in err) == (2, True)
    assert not (tmp_path / "x.xlsx").exists()


def test_results_of_a_run_that_goes_on_are_read(tmp_path: Path) -> None:
    first = write_result(tmp_path / "a", two_cars(), reserved=5)
    with h5py.File(first / "history.h5") as file:
        assert len(file["rbdout/time"]) > len(TIME)
    assert not compare([Result(first), Result(write_result(tmp_path / "b", two_cars()))]).remarks


def test_fields_in_which_decks_differ_are_named_and_moments_left_out(tmp_path: Path) -> None:
    """A name by a parameter must not hide another change; -1 s is no moment of a contact."""
    results, time = [], np.linspace(0.0, 1.0, 3)
    columns = {"first_touch": ("s", "", np.array([[-1.0], [-1.0], [0.6]]))}
    columns["normal"] = ("N", "", np.array([[0.0], [0.0], [1.0]]))
    for name, deck in (("a", "springs: {s: {k: 1, c: 2}}"), ("b", "springs: {s: {k: 3, c: 4}}")):
        write_result(tmp_path / name, {"rcforc": (["x"], columns)}, time, deck_text=deck)
        results.append(Result(tmp_path / name))
    compared = compare(results)
    assert compared.remarks == ["the decks differ in 2 fields: springs.s.k, springs.s.c"]
    assert [one.channel for one in compared.differences] == ["rcforc.x.normal"]
    assert compare(results, ["rcforc.x.first_touch"]).differences
