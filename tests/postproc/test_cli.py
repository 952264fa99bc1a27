"""The commands as a shell sees them: standard output, standard error, exit code."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from small_results import SPEED, TIME, Command, two_cars, write_result, write_status

from crashsolve import __version__


def test_value_prints_one_number_that_reads_back_exactly(cars: Path, crashpost: Command) -> None:
    code, out, err = crashpost("value", cars, "deforc.buffer.force", "--statistic", "min")
    stored = two_cars()["deforc"][1]["force"][2]
    assert (code, err) == (0, "")
    assert float(out) == stored.min()
    assert out == f"{stored.min()!r}".removeprefix("np.float64(").removesuffix(")") + "\n"


def test_value_converts_and_computes(cars: Path, crashpost: Command) -> None:
    arguments = ("--statistic", "at:0", "--unit", "km/h")
    assert float(crashpost("value", cars, "rbdout.A.velocity.x", *arguments)[1]) == 54.0
    code, out, _ = crashpost("value", cars, "(-rbdout.A.velocity.x / 3)", "--statistic", "min")
    assert (code, float(out)) == (0, -SPEED / 3)


def test_value_reads_a_time_window(cars: Path, crashpost: Command) -> None:
    channel, times = "rbdout.A.velocity.x", TIME[(TIME >= 0.02) & (TIME <= 0.05)]
    for statistic, expected in (("argmax", times[0]), ("argmin", times[-1])):
        words = ("--statistic", statistic, "--during", "0.02:0.05")
        assert float(crashpost("value", cars, channel, *words)[1]) == expected


@pytest.mark.parametrize("window", ["0.1", "a:b", "0:1:2", "0:9", "0.05:0.02"])
def test_a_wrong_time_window_exits_with_2(cars: Path, crashpost: Command, window: str) -> None:
    words = ("rbdout.A.velocity.x", "--statistic", "max", "--during", window)
    code, out, err = crashpost("value", cars, *words)
    assert (code, out) == (2, "")
    assert "--during takes" in err or "samples" in err or "no sample" in err


@pytest.mark.parametrize(
    ("channel", "statistic", "words"),
    [
        ("rbdout.A.velocty.x", "max", "did you mean 'velocity.x'?"),
        ("rbdout.A.velocity.x", "mx", "did you mean 'max'?"),
        ("rbdout.A.velocity.x", "at:99", "outside the samples"),
        ("deforc.A.force", "max", "no deforc of 'A', which has rbdout"),
        ("rbdout.A.velocity.x + deforc.buffer.force", "max", "cannot add 'm/s' and 'N'"),
    ],
)
def test_value_refuses_with_code_2_and_an_empty_output(
    cars: Path, crashpost: Command, channel: str, statistic: str, words: str
) -> None:
    code, out, err = crashpost("value", cars, channel, "--statistic", statistic)
    assert (code, out) == (2, "")
    assert words in err


def test_values_answers_many_questions_at_once(
    cars: Path, crashpost: Command, tmp_path: Path
) -> None:
    speed = "rbdout.A.velocity.x"
    requested = [
        {"channel": speed, "statistic": "at:0", "unit": "km/h"},
        {"channel": speed, "statistic": "argmax", "during": [0.02, 0.05]},
        {"channel": "rbdout.A.velocty.x", "statistic": "max"},
        {"channel": f"2 * {speed}", "statistic": "path"},
        {"statistic": "max"},
    ]
    path = tmp_path / "questions.json"
    path.write_text(json.dumps(requested), "utf-8")
    code, out, err = crashpost("values", cars, path)
    first, window, wrong, whole, broken = json.loads(out)
    assert (code, err) == (0, "")
    assert first == {"value": 54.0, "unit": "km/h"}
    assert window == {"value": TIME[TIME >= 0.02][0], "unit": "s"}
    assert "did you mean 'velocity.x'?" in wrong["problem"]
    np.testing.assert_array_equal(whole["time"], TIME)
    assert (whole["value"][0], whole["unit"]) == (2 * SPEED, "m/s")
    assert broken == {"problem": "'channel' is missing"}
    path.write_text("{}", "utf-8")
    assert crashpost("values", cars, path)[0] == 2


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"durng": [0.0, 0.1]}, "unknown field 'durng'; did you mean 'during'?"),
        ({"during": [0.1]}, "during must be two times in seconds, not [0.1]"),
        ({"during": ["a", "b"]}, "during must be two times in seconds, not"),
        ({"during": 0.0}, "during must be two times in seconds, not 0.0"),
        ({"unit": 5}, "unit must be a text such as 'mm', not 5"),
    ],
)
def test_a_question_that_cannot_be_read_is_no_other_question(
    entry: dict[str, object], words: str, cars: Path, crashpost: Command, tmp_path: Path
) -> None:
    path = tmp_path / "questions.json"
    question = {"channel": "rbdout.A.velocity.x", "statistic": "max"}
    path.write_text(json.dumps([question | entry]), "utf-8")
    (answer,) = json.loads(crashpost("values", cars, path)[1])
    assert words in answer["problem"]


def test_summary_shows_status_energies_balances_peaks_and_warnings(
    cars: Path, crashpost: Command
) -> None:
    (cars / "log.txt").write_text("warning: too fast\nwarning: too fast\n")
    code, out, _ = crashpost("summary", cars)
    assert code == 0
    for words in (
        "Two cars",
        "status   finished, t = 0.1405 s",
        "spring stored",
        "momentum balance         1e-10 %",
        "deforc.buffer.force",
        "1 x  too fast",
    ):
        assert words in out


def test_summary_of_an_empty_history_says_so(tmp_path: Path, crashpost: Command) -> None:
    columns = {"velocity/x": ("m/s", "", np.empty((0, 1)))}
    write_result(tmp_path, {"rbdout": (["A"], columns)}, np.empty(0), reserved=8)
    code, out, _ = crashpost("summary", tmp_path)
    assert code == 0
    assert "status   unknown" in out
    assert "history  0 samples" in out


def test_summary_of_a_failed_run_gives_the_message(cars: Path, crashpost: Command) -> None:
    write_status(cars, "failed", message="energy balance 7 % at t = 0.03 s", time=None)
    assert "message  energy balance 7 %" in crashpost("summary", cars)[1]


def test_channels_lists_and_filters(cars: Path, crashpost: Command) -> None:
    code, out, _ = crashpost("channels", cars, "deforc.*")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()[2:]] == [
        "deforc.buffer.force",
        "deforc.buffer.length",
    ]
    code, out, err = crashpost("channels", cars, "tyres.*")
    assert (code, out) == (2, "")
    assert "no channel fits" in err


def test_exported_numbers_read_back_exactly(cars: Path, tmp_path: Path, crashpost: Command) -> None:
    target = tmp_path / "out.csv"
    patterns = ("rbdout.*", "rbdout.A.*", "deforc.buffer.length")
    assert crashpost("export", cars, *patterns, "-o", target)[0] == 0
    rows = list(csv.reader(target.open()))
    assert rows[0] == [
        "time [s]",
        "rbdout.A.velocity.x [m/s]",
        "rbdout.car-b.velocity.x [m/s]",
        "deforc.buffer.length [m]",
    ]
    numbers = np.array(rows[1:], float)
    assert np.array_equal(numbers[:, 0], TIME)
    assert np.array_equal(numbers[:, 1:3], two_cars()["rbdout"][1]["velocity/x"][2])


def test_a_shorter_mme_export_leaves_no_channel_of_a_longer_one(
    cars: Path, tmp_path: Path, crashpost: Command
) -> None:
    for patterns, count in ((["*"], 9), (["rbdout.*"], 2)):
        assert crashpost("export", cars, *patterns, "-o", tmp_path / "run.mme")[0] == 0
        assert len(list((tmp_path / "Channel").glob("run.[0-9]*"))) == count


@pytest.mark.parametrize("state", ["running", "failed", "stopped"])
def test_numbers_of_a_run_that_did_not_end_say_so(
    cars: Path, tmp_path: Path, crashpost: Command, state: str
) -> None:
    asks = (
        ["value", cars, f"{SPEED_A}:final"],
        ["plot", cars, SPEED_A, "-o", tmp_path / "p.svg"],
        ["export", cars, SPEED_A, "-o", tmp_path / "x.csv"],
    )
    for ask in asks:
        assert crashpost(*ask)[2] == ""
    # of another machine, on which the process may live
    write_status(cars, state, host="elsewhere")
    for ask in asks:
        code, out, reported = crashpost(*ask)
        assert code == 0
        assert out.strip()
        assert f"not finished ({state} at t = 0.140496 s)" in reported


@pytest.mark.parametrize("arguments", [("-o", "no/such/folder/x.csv"), ("nothing*", "-o", "x.csv")])
def test_an_impossible_export_exits_with_2(
    cars: Path,
    crashpost: Command,
    arguments: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert crashpost("export", cars, *arguments)[0] == 2
    assert not list(tmp_path.glob("*.csv"))


@pytest.mark.parametrize("command", [["summary"], ["channels"], ["expect"], ["report"]])
def test_a_missing_result_exits_with_2(
    tmp_path: Path, crashpost: Command, command: list[str]
) -> None:
    code, out, err = crashpost(*command, tmp_path / "none.results")
    assert (code, out) == (2, "")
    assert "no such file" in err


@pytest.mark.parametrize("arguments", [[], ["value", "x"], ["dance", "x"]])
def test_wrong_usage_exits_with_2(crashpost: Command, arguments: list[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        crashpost(*arguments)
    assert stop.value.code == 2


def test_commands_that_draw_nothing_load_no_matplotlib(cars: Path) -> None:
    for command in (
        ["summary"],
        ["channels"],
        ["expect"],
        ["value", "time", "--statistic", "max"],
        ["export", "-o", str(cars / "x.csv")],
    ):
        line = [command[0], str(cars), *command[1:]]
        program = (
            f"import sys; from crashpost.cli import main; code = main({line!r}); "
            "sys.exit(code or any(m in sys.modules for m in ('matplotlib', 'scipy', 'pydantic')))"
        )
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        assert run.returncode == 0, run.stderr


def test_a_reader_who_leaves_early_is_no_error(cars: Path) -> None:
    # far more lines than a pipe holds
    ids = [f"body_{n}" for n in range(4000)]
    columns = {"velocity/x": ("m/s", "of the mass centre", np.zeros((2, len(ids))))}
    write_result(cars, {"rbdout": (ids, columns)}, np.array([0.0, 1.0]))
    command = f"{sys.executable} -m crashpost channels {cars} | head -1"
    run = subprocess.run(command, shell=True, capture_output=True, text=True)
    assert run.stdout.startswith("channel")
    assert run.stderr == ""


SPEED_A, SPEED_B = "rbdout.A.velocity.x", "rbdout.car-b.velocity.x"


@pytest.mark.parametrize(
    ("word", "least"),
    [
        (f"-{SPEED_A}", -SPEED),
        (f"-abs({SPEED_A})", -SPEED),
        (f"-'{SPEED_B}'", -SPEED * 4 / 3),
        (f"-({SPEED_A} + 1)", -SPEED - 1),
        (f"-2*{SPEED_A}", -2 * SPEED),
        (f"-time*{SPEED_A}/time", -SPEED),
        (f"-hic({SPEED_A} / '1 s', '15 ms') + {SPEED_A} / '1 m/s' * 0", None),
    ],
)
def test_expressions_may_begin_with_a_minus(
    cars: Path, crashpost: Command, word: str, least: float | None
) -> None:
    code, out, err = crashpost("value", cars, word, "--statistic", "min", "--during", "0.001:0.14")
    assert (code, err) == (0, "")
    if least is not None:
        # the window begins a moment after the impact
        assert float(out) == pytest.approx(least, rel=1e-3)
    target = cars / "x.csv"
    assert crashpost("export", cars, f"-{SPEED_A}", "-o", target)[0] == 0
    assert target.read_text().startswith(f"time [s],-{SPEED_A} [m/s]")


def test_patterns_names_and_expressions_are_one_syntax(
    cars: Path, crashpost: Command, tmp_path: Path
) -> None:
    words = ("rbdout.*", f"-{SPEED_A}")
    names = [SPEED_A, SPEED_B, f"-{SPEED_A}"]
    listed = crashpost("channels", cars, *words)[1].splitlines()[2:]
    assert [line.split()[0] for line in listed] == names
    target = tmp_path / "x.csv"
    assert crashpost("export", cars, *words, "-o", target)[1].endswith("3 channels\n")
    values = crashpost("value", cars, *words, "--statistic", "final")[1].splitlines()[2:]
    assert [line.split()[0] for line in values] == names
    picture = tmp_path / "x.svg"
    assert crashpost("plot", cars, *words, "--unit", "rbdout.*=km/h", "-o", picture)[0] == 0
    assert "km/h" in picture.read_text()
    for command in (["channels"], ["value", "--statistic", "max"], ["plot"], ["export", "-o", "x"]):
        code, _, err = crashpost(command[0], cars, "rbdout.nothing.*", *command[1:])
        assert (code, "no channel fits 'rbdout.nothing.*'" in err) == (2, True)


def test_a_statistic_may_stand_behind_its_channel(
    cars: Path, crashpost: Command, tmp_path: Path
) -> None:
    assert float(crashpost("value", cars, f"{SPEED_A}:max")[1]) == SPEED
    picture = tmp_path / "x.svg"
    words = (f"{SPEED_A}:max", f"{SPEED_A}:argmin", f"{SPEED_A}:integral", f"{SPEED_A}:mean")
    assert crashpost("plot", cars, *words, "-o", picture)[0] == 0
    drawn = picture.read_text()
    for reported in ("max 15 m/s", "argmin 140.5 ms", "integral ", "mean "):
        assert reported in drawn
    assert "name the number" in crashpost("value", cars, SPEED_A)[2]
    assert "is another results folder" in crashpost("value", cars, cars, f"{SPEED_A}:max")[2]
    assert "did you mean 'max'?" in crashpost("plot", cars, f"{SPEED_A}:mx")[2]
    assert "whole histories" in crashpost("export", cars, f"{SPEED_A}:max", "-o", picture)[2]


def test_a_time_without_a_sample_is_reported(
    cars: Path, crashpost: Command, tmp_path: Path
) -> None:
    between, sampled = float(TIME[100] + TIME[101]) / 2, float(TIME[100])
    code, out, err = crashpost("value", cars, f"{SPEED_A}:at:{between!r}")
    exact = SPEED * (2 + np.cos(np.pi * between / TIME[-1])) / 3
    stated = float(err.split("its error is about ")[1].split()[0])
    assert code == 0
    # a line instead of a curve: what is stated is what it is wrong by
    assert 0.5 < abs(float(out) - exact) / stated < 2.0
    assert "A deck that watches at:" in err
    assert crashpost("value", cars, f"{SPEED_A}:at:{sampled!r}")[2] == ""
    requested = [{"channel": SPEED_A, "statistic": f"at:{between!r}"}]
    path = tmp_path / "questions.json"
    path.write_text(json.dumps(requested), "utf-8")
    (answer,) = json.loads(crashpost("values", cars, path)[1])
    assert "no sample at" in answer["remark"]


def test_version_and_completion(capsys: pytest.CaptureFixture[str], crashpost: Command) -> None:
    pytest.importorskip("shtab")
    for module in ("crashpost", "crashsolve"):
        command = [sys.executable, "-m", module, "--version"]
        run = subprocess.run(command, capture_output=True, text=True)
        assert run.stdout == f"{module} {__version__}\n"
        for shell in ("bash", "zsh"):
            command = [sys.executable, "-m", module, "completion", shell]
            run = subprocess.run(command, capture_output=True, text=True)
            assert run.returncode == 0 and module in run.stdout
        script = subprocess.run([*command[:-1], "bash"], capture_output=True, text=True).stdout
        assert subprocess.run(["bash", "-n"], input=script, text=True).returncode == 0


def test_without_scipy_a_filter_says_what_to_install(
    cars: Path, crashpost: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    code, out, err = crashpost("value", cars, f"cfc({SPEED_A}, 60):max")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "pip install 'crashsolve[signal]'" in err
    assert crashpost("value", cars, f"envelope({SPEED_A}, '3 ms'):max")[0] == 0
