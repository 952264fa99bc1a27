"""Figures of one result and of several: words, colours, units, tests with corridors, limits."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure as Canvas
from small_results import SPEED, TIME, Command, two_cars, write_result, write_status

from crashpost.errors import PostError
from crashpost.figures import draw, gallery
from crashpost.figures.overlay import names
from crashpost.figures.panels import PlotRequest, panels, profile
from crashpost.figures.style import COLOURS, DASHES, MAX_LINES, line_style
from crashpost.results.result import Result
from crashpost.values import events, injury, injury_table, pulse, words
from crashpost.values.figure import Curve, Figure, figures_of
from crashpost.values.measured import read_test
from crashpost.values.units import Units, on_page

FORCE = "deforc.buffer.force"


def run(
    folder: Path,
    scale: float = 1.0,
    parameters: str = "{}",
    deck: str = "",
    derived: str = "[]",
    texts: str = "{}",
) -> Result:
    """Two cars, the force of their buffer times `scale`."""
    families = two_cars()
    ids, columns = families["deforc"]
    unit, meaning, values = columns["force"]
    columns["force"] = (unit, meaning, scale * values)
    words = {"parameters": parameters, "derived_parameters": derived, "deck_text": deck}
    words["parameters_with_units"] = texts
    write_result(folder, families, title="Cars", **words)
    write_status(folder)
    return Result(folder)


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        (["rcforc.buffers.normal"], "Buffers: contact force"),
        (["-rcforc.left_rail.depth"], "Left rail: gap"),
        (["-'rcforc.car-a.depth'"], "Car-a: gap"),
        (["rbdout.A.velocity.x"], "A: velocity along x"),
        (["rbdout.A.angular_velocity.x"], "A: angular velocity about x"),
        (["glstat.model.energy.contact_dissipated"], "Energy dissipated in contacts"),
        (["glstat.model.energy.kinetic"], "Kinetic energy"),
        (["rbdout.A.velocity.x", "rbdout.B.velocity.x"], "Velocity along x"),
        (["rbdout.A.velocity.x", "rbdout.A.velocity.z"], "A: velocity"),
        (["cfc(nodout.head.acceleration.x, 180)"], "Head: acceleration along x, CFC 180"),
        (["hic(nodout.head.resultant, '15 ms')"], "Head: resultant, HIC 15 ms"),
        (["rcforc.a.normal / 2 + rcforc.b.normal"], "A: contact force / 2 + B: contact force"),
        (["abs(a.b.c) - abs(d.e.f)"], "abs(B: c) - abs(E: f)"),
        (["time"], "time"),
    ],
)
def test_titles_are_words(channels: list[str], expected: str) -> None:
    assert words.title(channels) == expected


# Machado, Oliveira and Fernandes (2009), IEEE TVCG 15, 1291-1298: severity 1, linear RGB
BLIND = {
    "nobody": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
               [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
               [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
               [0.004733, 0.691367, 0.303900]],
}  # fmt: skip


def linear(colour: str) -> np.ndarray:
    """Linear red, green and blue of #rrggbb (IEC 61966-2-1)."""
    shares = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)


def lab(light: np.ndarray) -> np.ndarray:
    """CIE L*a*b* under D65."""
    to_xyz = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
              [0.0193339, 0.1191920, 0.9503041]]  # fmt: skip
    x = np.array(to_xyz) @ np.clip(light, 0, 1) / [0.95047, 1, 1.08883]
    f = np.where(x > 0.008856, np.cbrt(x), 7.787 * x + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("eyes", BLIND)
def test_colours_differ_to_all_eyes_and_stand_out_from_paper(eyes: str) -> None:
    seen = [np.array(BLIND[eyes]) @ linear(colour) for colour in COLOURS]
    # 2.3 is just noticeable side by side; thin lines apart need several times that
    least = min(np.linalg.norm(lab(a) - lab(b)) for a, b in itertools.combinations(seen, 2))
    assert least > 15
    luminance = [linear(colour) @ [0.2126, 0.7152, 0.0722] for colour in COLOURS]
    assert min(1.05 / (0.05 + y) for y in luminance) >= 3.0  # WCAG 2.1, graphics


def test_lines_of_a_figure_differ_and_neighbours_in_dashes() -> None:
    looks = [line_style(n) for n in range(MAX_LINES)]
    assert len(set(looks)) == MAX_LINES == len(COLOURS) * len(DASHES)
    assert all(a[1] != b[1] for a, b in itertools.pairwise(looks))


def test_legends_state_what_differs(tmp_path: Path) -> None:
    runs = [
        run(tmp_path / f"{k}.results", parameters=f'{{"speed": {v}, "mass": 3.0}}')
        for k, v in enumerate((10.0, 12.5))
    ]
    assert names(runs) == ["speed 10", "speed 12.5"]
    texts = ("{}", '{"speed": "45 km/h"}')
    given = [
        run(tmp_path / f"given{i}", parameters=f'{{"speed": {v}}}', texts=text)
        for i, (v, text) in enumerate(zip((10.0, 12.5), texts, strict=True))
    ]
    assert names(given) == ["speed 10", "speed 45 km/h"]
    close = [
        run(tmp_path / f"c{k}", parameters=f'{{"v": {v!r}}}') for k, v in enumerate((1.0, 1 + 1e-7))
    ]
    assert len(set(names(close))) == 2
    # a value that --set changed somewhere in the deck is no parameter
    decks = [
        run(tmp_path / f"d{k}", deck=f"springs: {{s: {{stiffness: {k + 1}.0}}}}") for k in (0, 1)
    ]
    assert names(decks) == ["springs.s.stiffness 1", "springs.s.stiffness 2"]
    # parameters that do not distinguish all tell nothing
    three = [
        run(tmp_path / f"t{k}", parameters=f'{{"v": {v}}}', deck=f"a: {{b: {k}}}")
        for k, v in enumerate((1.0, 1.0, 2.0))
    ]
    assert names(three) == ["a.b 0", "a.b 1", "a.b 2"]
    # what follows from another parameter is left out, unless it alone differs
    both = [
        run(tmp_path / f"f{k}", parameters=f'{{"speed": {k}, "v": {2 * k}}}', derived='["v"]')
        for k in (1, 2)
    ]
    assert names(both) == ["speed 1", "speed 2"]
    only = [run(tmp_path / f"o{k}", parameters=f'{{"v": {k}}}', derived='["v"]') for k in (1, 2)]
    assert names(only) == ["v 1", "v 2"]
    same = [run(tmp_path / f"s{k}.results") for k in (0, 1)]
    assert names(same) == ["s0", "s1"]


def test_a_channel_has_a_curve_for_every_result(tmp_path: Path) -> None:
    runs = [run(tmp_path / f"{k}", k, parameters=f'{{"k": {k}.0}}') for k in (1, 2)]
    (figure,) = panels(runs, names(runs), PlotRequest([FORCE]))
    assert [(curve.run, curve.label) for curve in figure.y] == [(0, "k 1"), (1, "k 2")]
    canvas = Canvas().subplots()
    draw._draw(canvas, runs, figure)
    first, second = (line.get_ydata() for line in canvas.lines[:2])
    np.testing.assert_allclose(second, 2 * first)
    (both,) = panels(runs, names(runs), PlotRequest(["rbdout.*.velocity.x"]))
    assert [curve.label for curve in both.y] == ["A, k 1", "A, k 2", "car-b, k 1", "car-b, k 2"]


def test_a_name_must_be_in_every_result(tmp_path: Path) -> None:
    other = two_cars()
    del other["deforc"]
    write_result(tmp_path / "b", other)
    runs = [run(tmp_path / "a"), Result(tmp_path / "b")]
    with pytest.raises(PostError, match=r"/b: .*deforc"):
        panels(runs, ["a", "b"], PlotRequest([FORCE]))
    (figure,) = panels(runs, ["a", "b"], PlotRequest(["deforc.*.force"]))
    assert [curve.run for curve in figure.y] == [0]


def test_a_page_has_one_unit_of_time_and_the_units_asked_for(tmp_path: Path) -> None:
    result = run(tmp_path)
    level = {"label": "l", "value": 2.0, "tolerance": 0.5, "over": [0.01, 0.02]}
    moment = {"label": "m", "kind": "point", "points": [[0.07, 3]], "tolerance": 0.01}
    moment |= {"channel": FORCE, "statistic": "argmin"}
    entry = {"title": "t", "y": [FORCE], "y_unit": "MN", "x_range": [0, 0.1], "y_range": [-8, 0]}
    (figure,) = figures_of({"figures": [{**entry, "x_offset": 0.01, "reference": [level, moment]}]})
    shown = on_page(result, figure, Units.read(["kN,mm"]), "ms")
    assert (shown.x_unit, shown.y_unit, shown.x_range) == ("ms", "kN", (0.0, 100.0))
    assert (shown.x_offset, shown.y_range) == (10.0, (-8000.0, 0.0))
    first, second = shown.reference
    assert (first.value, first.tolerance, first.over) == (2000.0, 500.0, (10.0, 20.0))
    assert second.points == ((pytest.approx(70.0), 3000.0),)
    # the tolerance of a moment is one of time
    assert second.tolerance == pytest.approx(10.0)


TEST = """# a remark
time [ms]; measured [kN]; lower [kN]; upper [kN]
0; 0; -500; 500
70; -6500; -7000; -6000
140; -100; -500; 500
"""


def test_measured_curves_and_corridors_are_drawn_in_the_units_shown(tmp_path: Path) -> None:
    path = tmp_path / "pole_test.csv"
    path.write_text(TEST)
    result = run(tmp_path / "r")
    request = PlotRequest(
        [FORCE, "rbdout.A.velocity.x"], units=Units.read(["MN"]), tests=[read_test(path)]
    )
    force, velocity = panels([result], ["r"], request)
    curve, corridor = force.reference
    assert not velocity.reference
    assert (curve.label, curve.kind) == ("pole test: measured", "curve")
    assert curve.points[1] == (70.0, -6.5)
    assert (corridor.kind, corridor.points[1], corridor.upper[1]) == (
        "corridor",
        (70, -7),
        (70, -6),
    )
    text, keys = draw.svg(result, force, "f")
    assert [key.mark for key in keys] == ["line", "dots", "band"]
    with pytest.raises(PostError, match="fits no figure drawn"):
        panels([result], ["r"], PlotRequest(["rbdout.A.velocity.x"], tests=[read_test(path)]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a line of names and at least two"),
        ("0 1\n1 2\n2 3\n", "name columns as"),
        ("time [s],F [kN]\n0,1\n1\n", ":3: 1 columns where the first line has 2"),
        ("time [s],F [kN]\n0,1\n1,x\n", ":3: could not convert"),
        ("time [s],F [kN]\n0,1\n1,nan\n", ":3: a value is not finite"),
        ("time [s],F [kN]\n0,1\n0,2\n", "times must increase"),
        ("time [s],F [furlong]\n0,1\n1,2\n", "furlong"),
        ("time [s],lower [kN]\n0,1\n1,2\n", "two columns, lower and upper"),
        ("time [s],lower [kN],upper [kN]\n0,1,2\n1,2,1\n", "lower is above upper"),
    ],
)
def test_a_wrong_test_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(PostError, match=re.escape(message)):
        read_test(path)


def test_limits_and_logarithms(cars: Path, tmp_path: Path, crashpost: Command) -> None:
    target = tmp_path / "x.png"
    assert crashpost("plot", cars, "-o", target, FORCE, "--x-range", "10:50", "--log", "x")[0] == 0
    for wrong, message in (
        (("--y-range", "1:1"), "two different numbers"),
        (("--x-range", "a:b"), "takes FROM:TO"),
        (("--x-range", "500:600"), "no sample lies from 500 to 600"),
        (("rbdout.A.velocity.x", "--y-range", "0:1"), "for one panel, and 2"),
        (("--log", "y"), "no positive value"),
        (("--at", "0"), "--at goes with --along"),
        (("nothing.results",), "no such file"),
        ((tmp_path,), "without history.h5"),
        ((cars,), "named twice"),
    ):
        code, out, err = crashpost("plot", cars, FORCE, *wrong, "-o", target)
        assert (code, out) == (2, "")
        assert message in err


def test_limits_show_what_lies_between_them(tmp_path: Path) -> None:
    result = run(tmp_path)
    (figure,) = panels(
        [result], ["r"], PlotRequest([FORCE], units=Units.read(["N"]), x_range=(0.0, 10.0))
    )
    canvas = Canvas().subplots()
    draw._draw(canvas, result, figure)
    least = min(result.series(FORCE).values[TIME <= 0.01])
    assert canvas.get_ylim()[0] == pytest.approx(1.05 * least, rel=1e-6)


def beam(folder: Path) -> Result:
    """Five nodes along x above a wall, which sink in turn."""
    ids = [f"tube_{k}" for k in range(5)]
    time = np.array([0.0, 0.5, 1.0])
    x = np.tile(np.arange(5.0), (3, 1))
    z = 0.1 - np.outer(time, [0.01, 0.02, 0.03, 0.02, 0.01])
    write_result(
        folder, {"rbdout": (ids, {"position/x": ("m", "", x), "position/z": ("m", "", z)})}, time
    )
    return Result(folder)


def test_a_gap_along_an_interface(tmp_path: Path) -> None:
    result = beam(tmp_path)
    gap, along = "rbdout.tube_*.position.z - '50 mm'", "rbdout.tube_*.position.x"
    figure = profile(result, gap, along, [0.0, 0.75], PlotRequest(units=Units.read(["mm"])))
    assert (figure.x_unit, figure.y_unit) == ("mm", "mm")
    first, second = figure.y
    assert (first.label, second.label) == ("0 s", "0.75 s")
    expected = 50 - 750 * np.array([0.01, 0.02, 0.03, 0.02, 0.01])
    np.testing.assert_allclose(np.array(second.points), np.c_[1e3 * np.arange(5), expected])
    draw.svg(result, figure, "f")
    with pytest.raises(PostError, match="has no pattern"):
        profile(result, "rbdout.tube_1.position.z", along, [], PlotRequest())
    with pytest.raises(PostError, match="no channel fits"):
        profile(result, "rbdout.rail_*.position.z", along, [], PlotRequest())


def head(folder: Path) -> Result:
    """A half sine of 50 g for 10 ms on a head, and a contact that touches then."""
    time = np.linspace(0, 0.04, 401)
    pulse = np.where((time >= 0.01) & (time <= 0.02), np.sin(np.pi * (time - 0.01) / 0.01), 0.0)
    zero, one = np.zeros((401, 1)), pulse[:, None]
    since = np.where(time < 0.01, -1.0, 0.01)[:, None]
    left = np.where(time < 0.02, -1.0, 0.02)[:, None]
    axes = {f"acceleration/{a}": ("m/s^2", "", zero) for a in "xy"}
    axes["acceleration/z"] = ("m/s^2", "", 50 * 9.80665 * one)
    touch = {"normal": ("N", "", 1e3 * one), "depth": ("m", "", 0.02 * one - 0.01)}
    touch |= {"first_touch": ("s", "", since), "last_release": ("s", "", left)}
    touch |= {"touching": ("1", "", (one > 0) * 1.0)}
    part = {"plastic": ("J", "", np.cumsum(np.maximum(one - 0.5, 0), axis=0))}
    families = {
        "nodout": (["driver_head"], axes),
        "rcforc": (["bag"], touch),
        "matsum-shell": (["door"], part),
        "rbdout": (["heads"], axes),
    }
    card = "{type: accelerometer, body: b, role: head}"
    deck = f"sensors: {{driver_head: {card}, head_rest: {{type: accelerometer, body: b}}}}"
    write_result(folder, families, time, deck_text=deck)
    write_status(folder)
    return Result(folder)


def test_gap_crush_and_injury_come_by_default(tmp_path: Path) -> None:
    result = head(tmp_path)
    titles = [figure.title for figure in gallery.default_figures(result)]
    for title in (
        "Bag: contact force",
        "Bag: smallest gap",
        "Contact force over penetration",
        "Driver head: acceleration",
    ):
        assert title in titles
    # the role says what is a head, not its name
    assert [one.name for one in injury.positions(result)] == ["Driver head"]
    rows = {row[1]: row[2:] for row in injury_table.table(result)}
    # closed forms of a half sine, as in decks/tutorial/head_form.yaml
    value, _, *rest = rows["largest acceleration"]
    assert [value, *rest] == ["50 g", "", "", "", "at 15 ms"]
    assert rows["CFC 1000"][-1] == "axis by axis"
    assert rows["HIC, 15 ms"][2:5] == ["700", "49 CFR 571.208", "within"]
    exact = 0.4146456495 * 50**2.5 * 0.01
    assert float(rows["HIC, 15 ms"][0]) == pytest.approx(exact, rel=3e-3)
    # of a resolved pulse the error by samples is known, and small
    assert 0.0 < float(rows["HIC, 15 ms"][1]) < 3e-3 * exact
    assert float(rows["3 ms clip"][0].removesuffix(" g")) == pytest.approx(44.55, rel=1e-3)
    assert float(rows["Severity Index"][0]) == pytest.approx(
        0.4576558581 * 50**2.5 * 0.01, rel=2e-3
    )


def test_what_is_not_filtered_is_not_called_filtered_nor_judged(tmp_path: Path) -> None:
    """Samples of 1 ms, where class 1000 needs one every 0.1 ms."""
    time = np.linspace(0, 0.04, 41)
    wave = 50 * 9.80665 * np.sin(np.pi * time / 0.04)[:, None] ** 2
    axes = {f"acceleration/{a}": ("m/s^2", "", wave) for a in "xyz"}
    deck = "sensors: {dummy: {type: accelerometer, body: b, role: head}}"
    write_result(tmp_path, {"nodout": (["dummy"], axes)}, time, deck_text=deck)
    result = Result(tmp_path)
    rows = injury_table.table(result)
    assert rows[0][1] == "not filtered" and "not every 1 ms" in rows[0][-1]
    assert not any("CFC" in row[1] for row in rows)
    assert {row[6] for row in rows} == {"", "not assessed: not filtered"}
    (figure,) = injury.injury_figures(result)
    assert figure.y[0].label == "resultant, not filtered"


def test_advice_is_not_what_was_done_already(tmp_path: Path) -> None:
    """Samples every 0.1 ms, but for a gap of 2 ms."""
    time = np.concatenate([np.arange(0, 200) * 1e-4, 0.0219 + np.arange(0, 200) * 1e-4])
    axes = {"acceleration/x": ("m/s^2", "", np.sin(200 * time)[:, None])}
    write_result(tmp_path, {"nodout": (["dummy"], axes)}, time)
    with pytest.raises(PostError) as reported:
        Result(tmp_path).series("cfc(nodout.dummy.acceleration.x, 1000)")
    assert "give output.history.interval" not in str(reported.value)
    assert "none for 2 ms from 19.9 ms on" in str(reported.value)


def test_samples_that_are_dense_during_contacts_alone_are_too_few(tmp_path: Path) -> None:
    """Samples every 5 ms, and 0.1 ms apart in one of these intervals."""
    time = np.concatenate([np.arange(0, 5) * 5e-3, 0.02 + np.arange(1, 51) * 1e-4, [0.03, 0.035]])
    axes = {"acceleration/x": ("m/s^2", "", np.sin(200 * time)[:, None])}
    write_result(tmp_path, {"nodout": (["dummy"], axes)}, time)
    with pytest.raises(PostError, match=r"6 are up to 5 ms apart: give output\.history\.interval"):
        Result(tmp_path).series("cfc(nodout.dummy.acceleration.x, 1000)")


def test_the_load_criterion_of_a_constant_deceleration() -> None:
    """A = 20 g: free for t = sqrt(2 s / A), then held for T = 2 S / (A t), a = A (t + T) / T."""
    a, time = 20 * 9.80665, np.linspace(0, 0.15, 3001)
    free = np.sqrt(2 * 0.065 / a)
    held = 2 * 0.235 / (a * free)
    value, start, end = pulse.load_criterion(time, -a * time)
    # chords of samples 0.05 ms apart: second order, 1e-6 of the times
    assert (start, end) == pytest.approx((free, free + held), rel=1e-4)
    assert value == pytest.approx(a * (free + held) / held, rel=1e-4)
    with pytest.raises(PostError, match="moves freely by 65 mm"):
        pulse.load_criterion(time, -0.1 * time)


def test_what_happened_first(tmp_path: Path) -> None:
    reported = [(round(event.time, 4), event.text) for event in events.events(head(tmp_path))]
    # sin > 1/2 from a sixth of the pulse on
    assert reported == [
        (0.01, "Bag: first contact"),
        (0.0117, "Door begins to yield"),
        (0.015, "Bag: largest contact force, 1 kN"),
        (0.02, "Bag: last release"),
    ]


def test_too_many_curves_are_refused(tmp_path: Path) -> None:
    ids = [f"b{k}" for k in range(MAX_LINES + 1)]
    values = np.ones((2, len(ids))) * np.arange(len(ids))
    write_result(
        tmp_path, {"rbdout": (ids, {"velocity/x": ("m/s", "", values)})}, np.array([0.0, 1])
    )
    result = Result(tmp_path)
    (figure,) = panels([result], ["r"], PlotRequest(["rbdout.*"]))
    with pytest.raises(PostError, match="can be distinguished"):
        draw.svg(result, figure, "f")


def test_standard_figures_by_their_words(cars: Path, tmp_path: Path, crashpost: Command) -> None:
    for word in ("energy", "crush", "momentum", "motion"):
        assert crashpost("plot", cars, word, "-o", tmp_path / "x.svg")[0] == 0
    code, _, err = crashpost("plot", cars, "gap", "-o", tmp_path / "x.svg")
    assert (code, "nothing to draw: no gap" in err) == (2, True)
    assert SPEED in Result(cars).series("rbdout.A.velocity.x").values


def test_the_time_of_a_contact_that_has_not_been_is_not_drawn(cars: Path, tmp_path: Path) -> None:
    """It lies before the run, which would be the lowest point of every figure."""
    touch = np.where(TIME < 0.05, -1.0, 0.05)[:, None]
    families = two_cars()
    families["rcforc"] = (["hit"], {"first_touch": ("s", "when that was first", touch)})
    result = Result(write_result(tmp_path, families))
    figure = Figure("Touch", (Curve("rcforc.hit.first_touch"), Curve("-rcforc.hit.first_touch")))
    lines = draw._scaled([result], figure).lines
    np.testing.assert_array_equal(np.isnan(lines[0].y), TIME < 0.05)
    np.testing.assert_allclose(lines[0].y[TIME >= 0.05], 0.05)
    # of an expression nothing is left out
    assert np.isfinite(lines[1].y).all()


def test_a_figure_of_some_of_many_channels_says_so() -> None:
    names = [f"rcforc.c{k}.normal" for k in range(9)]
    assert gallery._among("Contact force", names[:8], names) == "Contact force, the 8 largest of 9"
    # others that are zero throughout are not left out
    assert gallery._among("Contact force", names[:3], names) == "Contact force"
    assert gallery._among("Contact force", names[:8], names[:8]) == "Contact force"
