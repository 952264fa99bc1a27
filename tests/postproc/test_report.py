"""Figures, comparisons with published values, and the page that shows them."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure as Canvas
from small_results import SPEED, TIME, Command, expectation, two_cars, write_result, write_status

from crashpost.compare.references import comparisons
from crashpost.errors import PostError
from crashpost.figures import draw
from crashpost.figures.gallery import family_figures, momentum_figures
from crashpost.reports.build import report
from crashpost.results import ledger
from crashpost.results.result import Result
from crashpost.values.figure import figures_of
from crashpost.values.words import labels

FORCE = "-deforc.buffer.force"
PEAK = 6.708203932499369  # MN: speed times the root of stiffness times reduced mass
FIGURE: dict[str, object] = {
    "title": "Buffer force <A>",
    "y": [{"channel": FORCE, "label": "run & read"}, "2 * deforc.buffer.force"],
    "x_unit": "ms",
    "y_unit": "MN",
    "note": "Read from a plot.",
    "reference": [
        {"label": "peak", "value": 7.0, "channel": FORCE, "statistic": "max", "source": "Fig. 1"},
        {
            "label": "range",
            "kind": "band",
            "from": 6,
            "to": 7,
            "channel": FORCE,
            "statistic": "max",
        },
        {"label": "late mean", "kind": "band", "from": 0.0, "to": 1.0, "over": [100, 140]}
        | {"channel": FORCE, "statistic": "mean", "during": [0.0, 0.14]},
        {"label": "when", "kind": "point", "points": [[70, 6.5]]}
        | {"channel": FORCE, "statistic": "argmax"},
        {"label": "printed", "kind": "curve", "points": [[0, 0], [70, 6.5], [140, 0]]},
    ],
}


def write(folder: Path, *figures: object, **attributes: object) -> Result:
    described = {"report": json.dumps({"figures": figures})} if figures else {}
    write_result(folder, two_cars(), title="Cars <2>", **described, **attributes)
    write_status(folder)
    return Result(folder)


VOID = ("meta", "br", "wbr")


class Page(HTMLParser):
    """Collects what the page would fetch and whether its tags close."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []
        self.ids: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        links = [values.get(key) or "" for key in ("src", "href", "xlink:href", "data")]
        self.fetched += [link for link in links if link and not link.startswith("#")]
        self.ids += [values["id"] or ""] if "id" in values else []

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_page_is_whole_and_fetches_nothing(tmp_path: Path) -> None:
    entry = expectation("rbdout.A.velocity.x", "final", SPEED / 3, 1e-9)
    text, problems = report(write(tmp_path, FIGURE, FIGURE, expect=json.dumps([entry])))
    page = Page(text)
    assert (page.open, page.fetched, problems) == ([], [], [])
    assert not re.search(r"url\((?!#)|@import", text)
    assert len(page.ids) == len(set(page.ids))


def test_the_page_shows_title_deck_status_figures_and_verdicts(tmp_path: Path) -> None:
    entry = expectation("rbdout.A.velocity.x", "final", 4.0, 1e-9)
    result = write(tmp_path, FIGURE, deck_text="bodies: {A: <1>}", expect=json.dumps([entry]))
    (tmp_path / "log.txt").write_text("  bodies  2\n\n     cycle   time s\nwarning: too <fast>\n")
    text, _ = report(result)
    for words in (
        "Cars &lt;2&gt;",
        "bodies: {A: &lt;1&gt;}",
        "finished",
        "Buffer force &lt;A&gt;",
        "run &amp; read",
        "Read from a plot.",
        "0 of 1",
        "FAIL",
        "too &lt;fast&gt;",
        "6.708\u00a0MN",
        "kinetic",
    ):
        assert words in text
    assert "too <fast>" not in text


def test_without_a_description_every_family_that_moves_has_a_figure(tmp_path: Path) -> None:
    text, problems = report(write(tmp_path))
    titles = re.findall(r"<h3>(.*?)</h3>", text)
    wanted = ["Springs: force over length", "Springs: force", "Bodies: velocity along x"]
    wanted += ["Energies", "Energy balance", "Momentum"]
    assert (titles, problems) == (wanted, [])


def test_a_family_shows_what_is_worth_a_look_rather_than_its_first_quantity(tmp_path: Path) -> None:
    moving = np.linspace(0.0, 1.0, len(TIME))[:, None]
    columns = {name: ("m", "", moving) for name in ("depth", "force/x", "normal")}
    motion = {name: ("m", "", moving) for name in ("acceleration/x", "velocity/x")}
    still = {"angle": ("rad", "", moving), "distance": ("m", "", 0.0 * moving)}
    families = {
        "rcforc": (["touch"], columns),
        "rbdout": (["A"], motion),
        "nodout": (["chip"], motion),
        "disbout": (["gap"], still),
    }
    write_result(tmp_path, families)
    titles = {figure.title for figure in family_figures(Result(tmp_path))}
    wanted = {"Contacts: contact force along x", "Bodies: velocity along x", "Distances: angle"}
    wanted |= {"Accelerometers and nodes: acceleration along x"}
    assert titles == wanted


def test_energies_are_listed_before_what_was_lost_and_momenta_found_in_any_unit(
    tmp_path: Path,
) -> None:
    one = np.ones((len(TIME), 1))
    names = ("brake_dissipated", "plastic", "kinetic", "spring_stored", "potential")
    columns = {f"energy/{name}": ("J", "", one) for name in names}
    columns |= {"mechanical": ("J", "", one), "angular_momentum/z": ("N m s", "", one)}
    columns |= {"momentum/x": ("N s", "", one), "momentum/y": ("N s", "", 1e-9 * one)}
    write_result(tmp_path, {"glstat": (["model"], columns)})
    result = Result(tmp_path)
    labels = [entry.label for entry in ledger.energies(result)]
    left, lost = ["kinetic", "potential", "spring stored", "mechanical"], ["plastic"]
    assert labels == [*left, *lost, "brake dissipated"]
    figures = momentum_figures(result)
    assert [figure.title for figure in figures] == ["Momentum", "Angular momentum"]
    # a curve that cannot be seen is not drawn
    assert [[curve.label for curve in figure.y] for figure in figures] == [["x"], ["z"]]


def test_points_on_the_border_are_drawn_and_those_beyond_are_not(tmp_path: Path) -> None:
    points = {"label": "p", "kind": "point", "points": [[140, 1], [200, 1]]}
    figure = {**FIGURE, "x_range": [0, 140], "y_range": [0, 10], "reference": [points]}
    result = write(tmp_path, figure)
    (drawn,) = figures_of(result.stored_json("report"))
    canvas = Canvas().subplots()
    draw._draw(canvas, result, drawn)
    (line,) = [line for line in canvas.lines if line.get_label() == "p"]
    assert (line.get_xdata().tolist(), line.get_clip_on()) == ([140.0], False)


def test_a_figure_that_cannot_be_drawn_leaves_its_reason(
    tmp_path: Path, crashpost: Command
) -> None:
    write(tmp_path, {"title": "Wrong", "y": ["rbdout.A.speed"]}, FIGURE)
    code, out, err = crashpost("report", tmp_path)
    page = tmp_path / "report.html"
    assert (code, out) == (2, f"{page}\n")
    assert "figure 'Wrong'" in err
    assert "unknown rbdout quantity" in page.read_text()
    assert "Buffer force" in page.read_text()


def test_a_report_of_a_failed_run_without_samples_is_written(tmp_path: Path) -> None:
    columns = {"energy/kinetic": ("J", "", np.empty((0, 1)))}
    write_result(tmp_path, {"glstat": (["model"], columns)}, np.empty(0), reserved=4)
    write_status(tmp_path, "failed", message="the step fell below its limit")
    text, problems = report(Result(tmp_path))
    assert problems == []
    assert "the step fell below its limit" in text


def test_comparisons_have_the_values_of_the_closed_form(tmp_path: Path) -> None:
    result = write(tmp_path, FIGURE)
    (figure,) = figures_of(result.stored_json("report"))
    peak, band, mean, when = comparisons(result, figure)
    assert peak.computed == pytest.approx(PEAK, rel=1e-9)
    assert peak.difference == pytest.approx(PEAK - 7.0, rel=1e-9)
    assert peak.percent == pytest.approx(100 * (PEAK / 7.0 - 1), rel=1e-9)
    assert (band.difference, band.published) == (0.0, "6 to 7")
    assert mean.difference == pytest.approx(2 * PEAK / np.pi - 1.0, rel=1e-2)
    assert (when.computed, when.unit) == (pytest.approx(500 * TIME[-1], rel=1e-9), "ms")


def test_offsets_and_scales_apply_to_curve_and_comparison_alike(tmp_path: Path) -> None:
    reference = {"label": "stroke", "value": 0, "statistic": "max"}
    reference["channel"] = "1 - deforc.buffer.length"
    figure = {"title": "Stroke", "y": [reference["channel"]], "y_unit": "mm", "y_offset": -100.0}
    result = write(tmp_path, {**figure, "reference": [reference]})
    (stroke,) = figures_of(result.stored_json("report"))
    (compared,) = comparisons(result, stroke)
    assert compared.computed == pytest.approx(100 * PEAK - 100, rel=1e-9)
    assert draw.svg(result, stroke, "f")[0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"titel": "x"}, "unknown field 'titel'; did you mean 'title'?"),
        ({"y": []}, "y must list channels"),
        ({"y": [{"label": "x"}]}, "'channel' is missing"),
        ({"y_scale": "cubic"}, "y_scale is linear or log, not 'cubic'"),
        ({"x_range": [1, 2, 3]}, "'x_range' cannot be [1, 2, 3]"),
        ({"reference": [{"label": "a", "kind": "cloud"}]}, "unknown kind of reference 'cloud'"),
        ({"reference": [{"label": "a"}]}, "a level needs value"),
        ({"reference": [{"label": "a", "value": 1, "channel": "x"}]}, "goes with statistic"),
        (
            {"reference": [{"label": "a", "value": 1, "channel": "x", "statistic": "argmax"}]},
            "a time is compared with points",
        ),
        ({"reference": [{"label": "a", "kind": "point", "points": [[1]]}]}, "'points' cannot be"),
        ({"reference": ["a"]}, "expected fields, found 'a'"),
    ],
)
def test_a_wrong_description_is_refused_naming_the_figure(
    change: dict[str, object], words: str
) -> None:
    with pytest.raises(PostError) as refusal:
        figures_of({"figures": [{**FIGURE, **change}]})
    assert words in str(refusal.value)


def test_an_svg_is_well_formed_scalable_and_repeats_bit_for_bit(tmp_path: Path) -> None:
    result = write(tmp_path, FIGURE)
    (figure,) = figures_of(result.stored_json("report"))
    text, keys = draw.svg(result, figure, "f1")
    root = ElementTree.fromstring(text)
    assert "viewBox" in root.attrib
    assert not {"width", "height"} & root.attrib.keys()
    assert (text, keys) == draw.svg(result, figure, "f1")
    assert [key.mark for key in keys] == ["line", "line", "dash", "band", "band", "point", "dots"]


def test_thinning_keeps_the_peaks_and_the_ends() -> None:
    x = np.linspace(0, 1, 100_001)
    y = np.sin(40 * x)
    y[54_321] = 50.0
    thin_x, thin_y = draw._thinned(x, y)
    assert len(thin_x) < 5000
    assert thin_y.max() == 50.0
    assert thin_x[[0, -1]].tolist() == [0.0, 1.0]
    assert np.all(np.diff(thin_x) > 0)


def test_a_loop_is_thinned_without_losing_where_it_turns() -> None:
    """A curve over an abscissa that goes to and fro: its box stays, in few points."""
    along = np.linspace(0, 60, 200_001)
    x, y = np.sin(along), along * np.cos(along)
    thin_x, thin_y = draw._thinned(x, y)
    assert len(thin_x) < 5000
    for thin, whole in ((thin_x, x), (thin_y, y)):
        assert (thin.min(), thin.max()) == (whole.min(), whole.max())
    # in the order of time: no step is longer than one bucket
    assert np.max(np.hypot(np.diff(thin_x), np.diff(thin_y))) < 60 * 60 / 700


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        (["rbdout.A.velocity.x", "rbdout.B.velocity.x"], ["A", "B"]),
        (["rbdout.A.velocity.x", "rbdout.B.velocity.z"], ["A x", "B z"]),
        (["glstat.model.energy.spring_stored"], ["glstat.model.energy.spring_stored"]),
        (["-a.b.c", "a.b.c"], ["-a.b.c", "a.b.c"]),
        (["a.b.c", "a.b.c.d"], ["a.b.c", "a.b.c.d"]),
    ],
)
def test_labels_are_the_words_that_differ(channels: list[str], expected: list[str]) -> None:
    assert labels(channels) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.30000000000000004, "0.3"),
        (-2.5, "\N{MINUS SIGN}2.5"),
        (9e5, "900000"),
        (0.0, "0"),
        (3e-14, "3·10⁻¹⁴"),
        (2e12, "2·10¹²"),
    ],
)
def test_ticks_carry_their_own_power_of_ten(value: float, expected: str) -> None:
    assert draw.tick(value) == expected


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_plot_writes_the_format_of_the_ending(
    cars: Path, tmp_path: Path, crashpost: Command, ending: str
) -> None:
    target = tmp_path / f"x.{ending}"
    channels = ("rbdout.A.velocity.x", "rbdout.car-b.velocity.x", "deforc.buffer.force")
    code, out, _ = crashpost("plot", cars, *channels, "--unit", "time=ms", "-o", target)
    assert (code, out) == (0, f"{target}\n")
    begins = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[ending]
    assert target.read_bytes().startswith(begins)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "x.docx"], "x.docx"),
        (["--unit", "deforc.buffer.force=mm"], "cannot show 'N' in 'mm'"),
        (["--unit", "rbdout.A.velocity.x=m/s"], "which is not drawn"),
        (["--unit", "=kN"], "--unit takes CHANNEL=UNIT"),
        (["--unit", "furlong"], "furlong"),
        (["--against", "deforc.buffer.lenght"], "did you mean 'length'?"),
    ],
)
def test_an_impossible_plot_exits_with_2(
    cars: Path, crashpost: Command, arguments: list[str], words: str
) -> None:
    code, out, err = crashpost("plot", cars, "deforc.buffer.force", *arguments)
    assert (code, out) == (2, "")
    assert words in err


def test_the_page_says_errors_and_cost(tmp_path: Path) -> None:
    write_result(tmp_path, two_cars(), title="Cars")
    entry = {"channel": FORCE, "statistic": "max", "during": [0.0, 0.1], "value": 6.7e6}
    entry |= {"unit": "N", "error": 670.0, "scale": 6.7e6, "how": "2 coarser runs, order <2>"}
    unknown = {"channel": "a.b.c", "statistic": "final", "value": 1.0, "error": None, "scale": 2.0}
    write_status(
        tmp_path,
        watched=[entry, unknown | {"how": "not estimated: no further run took different steps"}],
        rejected=7,
        average_step={"before": 1e-3, "during": 2e-5, "after": None},
        cpu_stages={"steps": 0.25},
        real_time_factor=0.5,
    )
    text, problems = report(Result(tmp_path))
    assert not problems
    errors = text.split('id="errors"')[1].split("</section>")[0].replace("<wbr>", "")
    for words in (
        "1.0e-04",
        "6.7e-04",
        "MN",
        "from 0 to 100 ms",
        "order &lt;2&gt;",
        "not estimated",
    ):
        assert words in errors
    assert "<b>1.0e-04</b><span>largest estimated error" in text
    cost = text.split('id="cost"')[1].split("</section>")[0]
    for what, value in (("steps rejected", "7"), ("average step during contact", "0.02 ms")):
        assert re.search(rf"<td>{what}</td><td class=.num.>{value}</td>", cost)
    assert "after contact" not in cost
    assert "CPU time, steps" in cost


def test_without_estimates_there_is_no_table_of_them(tmp_path: Path) -> None:
    text, _ = report(write(tmp_path))
    assert 'id="errors"' not in text


def test_states_of_a_newer_format_are_reported(cars: Path, crashpost: Command) -> None:
    (cars / "states").mkdir()
    for path in (cars / "mesh.h5", cars / "states" / "000000.h5"):
        with h5py.File(path, "w") as file:
            file.attrs.update({"format": "crashsolve states", "format_version": 9, "time": 0.0})
    code, _, err = crashpost("report", cars, "--pictures", "strips")
    assert code == 2 and len(err.strip().splitlines()) == 1
    assert "pictures: " in err and "versions 2 to 3 (version 9)" in err
    assert "versions 2 to 3 (version 9)" in (cars / "report.html").read_text("utf-8")


def test_a_result_without_samples_is_not_drawn_as_empty_axes(
    tmp_path: Path, cars: Path, crashpost: Command
) -> None:
    with h5py.File(cars / "history.h5", "r+") as file:
        channel = next(Result(cars).channels("rbdout.*")).name
        for group in file.values():
            group["time"][...] = np.nan
    code, _, err = crashpost("plot", cars, channel, "-o", tmp_path / "x.png")
    assert (code, "holds no samples" in err) == (2, True)
    assert not (tmp_path / "x.png").exists()


def test_charts_and_tables_of_a_page_have_one_unit_for_each_quantity(tmp_path: Path) -> None:
    """The first figure shows forces in MN: so do events, peaks, expectations and errors."""
    time = np.linspace(0.0, 0.1, 11)
    force = 1e4 * np.sin(np.pi * time / 0.1)[:, None]
    columns = {"normal": ("N", "", force), "depth": ("m", "", 1e-6 * force)}
    figures = [
        {"title": "Force", "y": ["rcforc.bag.normal"], "y_unit": "MN", "x_unit": "ms"},
        {"title": "Again", "y": ["2 * rcforc.bag.normal"], "y_unit": "auto"},
    ]
    wanted = expectation("rcforc.bag.normal", "max", 1e4, 10.0)
    write_result(
        tmp_path,
        {"rcforc": (["bag"], columns)},
        time,
        report=json.dumps({"figures": figures}),
        expect=json.dumps([wanted]),
    )
    watched = {"channel": "rcforc.bag.normal", "statistic": "max", "value": 1e4, "unit": "N"}
    write_status(tmp_path, watched=[watched | {"error": 2.0, "scale": 1e4, "how": "x"}])
    page, problems = report(Result(tmp_path), "none")
    assert not problems
    text = re.sub(r"<svg.*?</svg>", "", page, flags=re.DOTALL).replace("<wbr>", "")
    rows = [re.sub(r"<[^>]*>", " ", row).split() for row in re.findall(r"<tr.*?</tr>", text)]
    assert "largest contact force, 0.01 MN" in text and " kN" not in page
    assert ["rcforc.bag.normal", "MN", "0", "0", "0.01", "50"] in rows
    # what no figure shows stays in SI
    assert ["rcforc.bag.depth", "m", "0", "0", "0.01", "50"] in rows
    (verdict,) = [row for row in rows if row[:1] == ["pass"]]
    assert verdict[3:8] == ["0.01", "0.01", "1e-05", "0", "MN"]
    assert ["rcforc.bag.normal", "max", "0.01", "MN", "2.0e-06", "2.0e-04", "x"] in rows
    assert page.count("force, MN") == 2
