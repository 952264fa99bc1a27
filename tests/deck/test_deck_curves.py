"""Claim: a curve goes through its points, and each interpolation keeps its promise."""

from importlib import import_module
from math import erf, pi, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from crashsolve.channels.units import BASES, parse_unit
from crashsolve.curves import file, formula, table
from crashsolve.curves._card import EXTRAPOLATE
from crashsolve.curves._derivatives import with_derivative
from crashsolve.curves._enclosures import bounds, deviation
from crashsolve.curves._piecewise import coefficients, hermite
from crashsolve.deck.card import law_class, reference_of
from crashsolve.deck.keywords import SECTIONS
from crashsolve.deck.laws import types_in
from crashsolve.deck.numbers import Context, SiFloat
from crashsolve.deck.reading.deck import read_deck
from crashsolve.deck.reading.expressions import Expression, ExpressionError
from crashsolve.deck.schema import _nested_folders
from crashsolve.foundation import curve
from crashsolve.foundation.errors import DeckErrors

X = np.array([0.0, 0.1, 0.4, 0.5, 1.5, 2.0])
Y = np.array([0.0, 1.0, 1.0, 3.0, -2.0, -2.5])
LAWS = [
    (folder, word)
    for folder in [*(section.folder for section in SECTIONS.values()), *_nested_folders()]
    for word in types_in(folder)
]
KINDS = ("linear", "smooth", "cubic")


def values(x: np.ndarray, c: np.ndarray, at: float | np.ndarray, derivative: int = 0) -> np.ndarray:
    """Value or derivative of piecewise cubics, by numpy alone."""
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    s = at - x[i]
    c0, c1, c2, c3 = c[i].T
    if derivative == 2:
        return 2 * c2 + 6 * c3 * s
    if derivative == 1:
        return c1 + 2 * c2 * s + 3 * c3 * s**2
    return c0 + c1 * s + c2 * s**2 + c3 * s**3


@pytest.mark.parametrize("kind", KINDS)
def test_every_point_is_hit_from_both_sides(kind: str) -> None:
    c = coefficients(X, Y, kind)
    assert values(X, c, X) == pytest.approx(Y, abs=1e-14)
    assert values(X, c, X - 1e-12)[1:] == pytest.approx(Y[1:], abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_two_points_give_a_straight_line(kind: str) -> None:
    c = coefficients(X[:2], Y[:2], kind)
    assert c == pytest.approx(np.array([[0.0, 10.0, 0.0, 0.0]]), abs=1e-12)


@pytest.mark.parametrize("kind", ["smooth", "cubic"])
def test_smooth_and_cubic_have_no_kink(kind: str) -> None:
    c = coefficients(X, Y, kind)
    inner = X[1:-1]
    after = values(X, c, inner, derivative=1)
    assert values(X, c, inner - 1e-10, derivative=1) == pytest.approx(after, abs=1e-6)


def test_cubic_has_no_jump_of_curvature_and_none_at_its_ends() -> None:
    c = coefficients(X, Y, "cubic")
    h = np.diff(X)
    curvature_after = 2 * c[1:, 2]
    curvature_before = 2 * c[:-1, 2] + 6 * c[:-1, 3] * h[:-1]
    assert curvature_before == pytest.approx(curvature_after, rel=1e-9, abs=1e-9)
    assert values(X, c, X[[0, -1]], derivative=2) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_smooth_never_overshoots() -> None:
    c = coefficients(X, Y, "smooth")
    for i in range(len(X) - 1):
        inside = values(X, c, np.linspace(X[i], X[i + 1] - 1e-12, 50))
        low, high = sorted(Y[i : i + 2])
        assert inside.min() >= low - 1e-12
        assert inside.max() <= high + 1e-12


@pytest.mark.parametrize(("kind", "order"), [("linear", 2), ("smooth", 2), ("cubic", 2)])
def test_interpolation_converges(kind: str, order: int) -> None:
    errors = []
    for n in (20, 40):
        x = np.linspace(0, 1.5, n + 1)
        c = coefficients(x, np.exp(x), kind)
        fine = np.linspace(0, 1.5, 1001)
        errors.append(np.abs(values(x, c, fine) - np.exp(fine)).max())
    assert np.log2(errors[0] / errors[1]) > order - 0.2


def test_codes_of_extrapolation_are_those_of_the_evaluator() -> None:
    assert EXTRAPOLATE == {"refuse": curve.REFUSE, "hold": curve.HOLD, "linear": curve.LINEAR}


def card_of(units: dict[str, str] | None = None, **fields: object) -> table.Table:
    names = {**dict(zip(BASES, ("m", "kg", "s", "rad"), strict=True)), **(units or {})}
    bases = {base: parse_unit(name) for base, name in names.items()}
    return table.Table.model_validate(fields, context=Context(bases) if units else Context())


@pytest.mark.parametrize(
    "fields",
    [
        {"points": [[0, 0], [0.002, 3000]]},
        {"points": [[0, 0], [2, 3]], "x_unit": "mm", "y_unit": "kN"},
        {"points": [["0 mm", 0], ["2 mm", "3 kN"]]},
        {"points": [[0, 0], [SiFloat(0.002), 3]], "x_unit": "mm", "y_unit": "kN"},
        {"points": [[0, 0], [2, 3]], "x_unit": "mm", "y_unit": "kN", "units": {"length": "in"}},
    ],
)
def test_points_are_in_si_whatever_their_units(fields: dict[str, Any]) -> None:
    x, c, beyond = table.build(card_of(**fields), None)
    assert x == pytest.approx([0.0, 0.002])
    assert c == pytest.approx(np.array([[0.0, 1.5e6, 0.0, 0.0]]))
    assert beyond == curve.REFUSE


def test_a_file_gives_the_same_curve_as_a_table(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text(
        "# crush test\ntime; way; force\n"
        + "".join(f"9; {x}; {y}\n" for x, y in zip(X, Y, strict=True))
    )
    by_file = file.File(file=str(path), columns=(2, 3), x_unit="mm", interpolation="cubic")
    by_table = card_of(points=list(zip(1e-3 * X, Y, strict=True)), interpolation="cubic")
    for first, second in zip(file.build(by_file, None), table.build(by_table, None), strict=True):
        assert first == pytest.approx(second)


@pytest.mark.parametrize(
    "text", ["", "x y\n", "0 0\n1 one\n", "0 0\n0 1\n", "0\n1\n", "0 0\n1 nan\n"]
)
def test_a_file_without_points_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "points.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match="diagnostic"):
        file.File(file=str(path))


@pytest.mark.parametrize(
    "text",
    ["0,0; 0,5\n1,0; 0,7\n", "0,0\t0,5\n1,0\t0,7\n", "t a\n0,5 1,5\n1,5 2,5\n", "0 0,5\n1 0,7\n"],
)
def test_a_decimal_comma_does_not_part_columns(text: str, tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text(text)
    with pytest.raises(ValidationError, match="diagnostic") as caught:
        file.File(file=str(path))
    assert "decimal points" in caught.value.errors()[0]["ctx"]["advice"]


def test_a_file_without_numbers_in_the_columns_says_so(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text('"0.5";"1.5"\n"1.5";"2.5"\n')
    with pytest.raises(ValidationError) as caught:
        file.File(file=str(path))
    assert "no line" in caught.value.errors()[0]["ctx"]["message"]


def test_a_byte_order_mark_hides_no_point(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_bytes(b"\xef\xbb\xbf0, 1\r\n1, 2\r\n2,\t3\r\n")
    assert file.read_columns(str(path), (1, 2)) == [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]


def test_a_quartic_formula_is_exact_at_its_breakpoints() -> None:
    card = formula.Formula.model_validate(
        {"expression": "x**4 - 2*x + 1", "from": -1.0, "to": 2.0, "segments": 5}
    )
    x, c, _ = formula.build(card, None)
    assert c[:, 0] == pytest.approx(x[:-1] ** 4 - 2 * x[:-1] + 1, abs=1e-12)
    assert c[:, 1] == pytest.approx(4 * x[:-1] ** 3 - 2, abs=1e-11)
    assert values(x, c, 2.0, derivative=1) == pytest.approx(30.0)


FORMULAS = {
    "1e5*x**1.5": lambda x: 1e5 * x**1.5,
    "sqrt(x)": np.sqrt,
    "1000*sin(500*x)": lambda x: 1000 * np.sin(500 * x),
    "abs(x-0.31)": lambda x: np.abs(x - 0.31),
    "max(0, sin(50*x))": lambda x: np.maximum(0, np.sin(50 * x)),
    "min(x, 2*x**2, 0.7)": lambda x: np.minimum(np.minimum(x, 2 * x**2), 0.7),
    "exp(-((x-0.1234)/1e-4)**2)": lambda x: np.exp(-(((x - 0.1234) / 1e-4) ** 2)),
    "atan2(x, 1+x) + log(1+x)**3 - tan(x)/acos(x/4)": lambda x: (
        np.arctan2(x, 1 + x) + np.log(1 + x) ** 3 - np.tan(x) / np.arccos(x / 4)
    ),
}


@pytest.mark.parametrize("expression", FORMULAS)
@pytest.mark.parametrize("segments", [1, 7, 200])
def test_a_formula_is_kept_to_its_tolerance(expression: str, segments: int) -> None:
    card = formula.Formula.model_validate(
        {"expression": expression, "from": 0, "to": 1, "segments": segments}
    )
    x, c, _ = formula.build(card, None)
    at = np.concatenate([np.random.default_rng(1).random(20_000), np.geomspace(1e-6, 1, 2000)])
    exact = FORMULAS[expression](at)
    # of the largest value in a piece, or FLOOR of the largest of all where that is small
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    ends = np.abs(FORMULAS[expression](x))
    scale = np.maximum(np.maximum(ends[i], ends[i + 1]), formula.FLOOR * ends.max())
    # round-off of x in the fastest of them, sin(500 x)
    off = np.abs(values(x, c, at) - exact) - 500 * formula.ROUND_OFF * ends.max()
    # the error is looked at in five places of a piece, so its peak may be a quarter above
    assert (off / scale).max() < 1.25 * formula.TOLERANCE


SMALL_VALUES = {
    "1e5*x**1.5": lambda x: 1e5 * x**1.5,
    "x**4": lambda x: x**4,
    "100*exp(30*x)": lambda x: 100 * np.exp(30 * x),
    "exp(-((x-0.1)/0.02)**2)": lambda x: np.exp(-(((x - 0.1) / 0.02) ** 2)),
}


@pytest.mark.parametrize("expression", SMALL_VALUES)
def test_small_values_of_a_formula_are_kept_to_its_tolerance_too(expression: str) -> None:
    card = formula.Formula.model_validate({"expression": expression, "from": 0, "to": 1})
    x, c, _ = formula.build(card, None)
    assert len(x) < 5000
    at = np.concatenate([np.random.default_rng(1).random(20_000), np.geomspace(1e-9, 1, 20_000)])
    exact = SMALL_VALUES[expression](at)
    scale = np.maximum(np.abs(exact), formula.LOW_FLOOR * np.abs(exact).max())
    # of the largest value of a piece, which may be twice that at a position
    assert (np.abs(values(x, c, at) - exact) / scale).max() < 2.5 * formula.TOLERANCE


def test_slopes_of_a_formula_are_its_derivative() -> None:
    card = formula.Formula.model_validate({"expression": "sin(x)**3/(1+x)", "from": 0, "to": 2})
    x, c, _ = formula.build(card, None)
    wave = 3 * np.sin(x) ** 2 * np.cos(x) / (1 + x) - np.sin(x) ** 3 / (1 + x) ** 2
    # round-off
    assert c[:, 1] == pytest.approx(wave[:-1], abs=1e-14)


@pytest.mark.parametrize(
    "expression",
    ["27.7*x", "0.1*(exp(10*(x - 1e-2 + max(2e-2 - x, 0)**2/4e-2)) - 1)", "max(x - 0.1, 0)**2"],
)
def test_round_off_and_jumps_of_acceleration_need_few_cubics(expression: str) -> None:
    """Halving finds where an acceleration jumps in 20 steps, and stops where round-off begins."""
    card = formula.Formula.model_validate({"expression": expression, "from": 0, "to": 0.21})
    x, _, _ = formula.build_motion(card, None, 2)
    # 200 at first, halved twice where the tolerance asks for it
    assert len(x) < 1000


@pytest.mark.parametrize(
    "expression, second",
    [
        ("0.1*sin(7*x)", lambda x: -4.9 * np.sin(7 * x)),
        ("2*x - 3*exp(-x)", lambda x: -3 * np.exp(-x)),
        ("x**4/12", lambda x: x**2),
    ],
)
def test_a_motion_by_a_formula_has_its_acceleration(expression: str, second: Any) -> None:
    card = formula.Formula.model_validate({"expression": expression, "from": 0, "to": 10})
    x, c, _ = formula.build_motion(card, None, 2)
    at = np.random.default_rng(2).random(5000) * 10
    off = np.abs(values(x, c, at, derivative=2) - second(at)).max()
    # the error is estimated to a quarter, as that of the values is
    assert off < 1.25 * formula.MOTION * np.abs(second(at)).max()


@pytest.mark.parametrize(
    "expression, end, exact, kept",
    [
        ("exp(x) - 1", 1e-6, np.expm1, 1e-9),
        ("1 - cos(x)", 1e-2, lambda x: 2 * np.sin(x / 2) ** 2, 1e-9),
        # round-off is 2e-16 of 5e-9
        ("1 - cos(x)", 1e-4, lambda x: 2 * np.sin(x / 2) ** 2, 5e-8),
        ("(1 + x)**3 - 1 - 3*x", 1e-3, lambda x: x**2 * (3 + x), 1e-9),
    ],
)
def test_differences_of_equal_terms_need_few_cubics(
    expression: str, end: float, exact: Any, kept: float
) -> None:
    """No cubic is halved for round-off, which 240,000 of them had followed."""
    card = formula.Formula.model_validate({"expression": expression, "from": 0, "to": end})
    x, y, _, tolerance = formula.sample(card)
    assert len(x) < 300
    assert tolerance <= kept
    _, c, _ = formula.build(card, SimpleNamespace(warnings=[]))
    at = np.random.default_rng(4).random(2000) * end
    off = np.abs(values(x, c, at) - exact(at)).max()
    assert off < 1.25 * tolerance * np.abs(y).max()


def test_a_motion_whose_acceleration_is_round_off_is_refused() -> None:
    card = formula.Formula.model_validate({"expression": "exp(x) - 1", "from": 0, "to": 1e-6})
    with pytest.raises(ExpressionError, match="cancels"):
        formula.sample(card, 2)


def test_a_velocity_by_a_formula_has_its_acceleration() -> None:
    """A fast term that is small beside the velocity, and large in its slope."""
    text = "1000 + 1e-3*sin(1e4*x)"
    card = formula.Formula.model_validate({"expression": text, "from": 0, "to": 0.1})
    at = np.random.default_rng(5).random(5000) * 0.1
    off = {}
    for order in (0, 1):
        x, _, _, _ = formula.sample(card, order)
        c = hermite(*formula.sample(card, order)[:3])
        off[order] = np.abs(values(x, c, at, derivative=1) - 10 * np.cos(1e4 * at)).max() / 10
    assert off[0] > 10 * formula.MOTION
    assert off[1] < 1.25 * formula.MOTION


def test_a_formula_that_jumps_is_refused() -> None:
    with pytest.raises(ValueError, match="error|jumps"):
        formula.Formula.model_validate({"expression": "atan2(0, x-0.3)", "from": 0, "to": 1})


@pytest.mark.parametrize("width", [1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize("other", ["0", "sin(x)", "1 + x**2", "sqrt(x)*max(0, 1-x/50)"])
def test_a_pulse_between_the_points_of_a_formula_is_found(width: float, other: str) -> None:
    text, middle = f"exp(-((x-1.234e-3)/{width})**2)", 1.234e-3
    cards = [{"expression": f"{other} + 1e4*{text}"}, {"expression": other}]
    area = 0.0
    for sign, card in zip((1.0, -1.0), cards, strict=True):
        x, c, _ = formula.build(formula.Formula.model_validate(card | {"from": 0, "to": 100}), None)
        # of the cubics near the pulse, exactly
        near = np.unique(np.r_[x[abs(x - middle) < 10 * width], middle + 10 * width * np.r_[-1, 1]])
        near = near[near >= 0.0]
        h = np.diff(near)
        ends = values(x, c, near)
        area += sign * float(h @ (ends[:-1] + 4 * values(x, c, near[:-1] + h / 2) + ends[1:]) / 6)
    # one side of the widest begins before the formula does, at erf(1.234)
    share = 0.5 * (1.0 + erf(min(middle / width, 10.0)))
    # cubics keep to 1e-9 of the values, or to 1e-6 of the largest where these are small
    assert area == pytest.approx(1e4 * sqrt(pi) * width * share, rel=2e-5)


@pytest.mark.parametrize(
    "expression",
    [
        *("x**3 - 2*x", "x**-2", "(x-1)**2", "(x-1)**-2", "2**x", "(x+1)**x", "abs(x-1)**1.5"),
        *("exp(-x**2)/(1+x*x)", "tan(x/3)", "tan(2*x)", "1/(x-2)", "min(x, 1, x**2)"),
        *("max(sin(x), 0.3)*x", "asin(x/10)", "acos(x/10-0.3)", "log(x+0.1)", "deg(x)/rad(x+1)"),
        *("atan2(x-1, x-2)", "atan2(sin(x), cos(x))", "abs(sin(5*x))", "-x+pi", "atan(x)*x**0.5"),
    ],
)
def test_a_formula_and_its_slope_lie_within_their_bounds(expression: str) -> None:
    random, word = np.random.default_rng(1), Expression(expression)
    left = random.uniform(0.01, 4, 1000)
    right = left + 10 ** random.uniform(-6, 0.3, 1000)
    limits = bounds(word, left, right)
    for part in random.random(20):
        jet = with_derivative(word, left + part * (right - left))
        for true, (low, high) in zip(jet, limits, strict=True):
            # round-off, of either
            slack = 1e-12 * (1.0 + np.abs(true))
            known = np.isfinite(true)
            assert (low[known] <= (true + slack)[known]).all()
            assert (true[known] <= (high + slack)[known]).all()
    # bounds that shrink with the square of the interval, where there are slopes
    middle = 0.5 * (left + right)
    narrow = deviation(word, middle, middle + 1e-5)
    assert np.median(narrow) < 1e-6


def test_one_segment_is_enough_for_a_cubic_formula() -> None:
    card = formula.Formula.model_validate({"expression": "x**3", "from": 0, "to": 2, "segments": 1})
    x, c, _ = formula.build(card, None)
    assert c == pytest.approx(np.array([[0.0, 0.0, 0.0, 1.0]]), abs=1e-12)
    assert list(x) == [0.0, 2.0]


BY_USE = """\
units: {length: mm, mass: t, time: ms, angle: deg}
control: {end_time: 1}
bodies:
  a: {mass: 1, inertia: [1, 1, 1]}
joints:
  pin: {type: revolute, a: ground, b: a, at: [0, 0, 0], axis: [0, 0, 1]}
springs:
  stop: {type: curve, a: ground, b: a, at_b: [9, 0, 0], curve: force, rate_curve: rate}
  turn: {type: rotation_stop, joint: pin, upper: 9, curve: moment}
loads:
  push: {type: force, body: a, force: [1, 0, 0], curve: pulse}
curves:
  force: {points: [[0, 0], [1, 2]]}
  rate: {points: [[0, 1], [1, 2]]}
  moment: {type: file, file: moment.csv}
  pulse: {points: [[0, 0], [2, 1], [5 s, 50 %]]}
  unused: {points: [[0, 0], [1 m, 2 kN]]}
"""


def test_the_use_of_a_curve_states_the_units_of_its_numbers(tmp_path: Path) -> None:
    (tmp_path / "moment.csv").write_text("0, 0\n1, 2\n")
    (tmp_path / "deck.yaml").write_text(BY_USE)
    deck = read_deck(tmp_path / "deck.yaml")
    (tmp_path / "again.yaml").write_text(deck.text)
    # mm, t and ms make MN; t mm^2/ms^2 over degrees of a moment
    wanted = {
        "force": ([0, 1e-3], [0, 2e6]),
        "rate": ([0, 1], [1, 2]),
        "moment": ([0, pi / 180], [0, 2e3]),
        "pulse": ([0, 2e-3, 5], [0, 1, 0.5]),
        "unused": ([0, 1], [0, 2e3]),
    }
    for path in (tmp_path / "deck.yaml", tmp_path / "again.yaml"):
        for name, (x, y) in wanted.items():
            card = read_deck(path).entries["curves"][name].card
            found_x, c, _ = import_module(type(card).__module__).build(card, None)
            np.testing.assert_allclose(found_x, x, rtol=1e-14)
            ends = c[-1] @ (x[-1] - x[-2]) ** np.arange(4)
            np.testing.assert_allclose([*c[:, 0], ends], y, rtol=1e-12)


def test_every_field_that_names_a_curve_states_the_units_of_its_axes() -> None:
    for folder, word in LAWS:
        card = law_class(folder, word)
        curves = {
            name for name, info in card.model_fields.items() if reference_of(info) == "curves"
        }
        assert curves == set(card.curve_axes), card
        for axes in card.curve_axes.values():
            for unit in axes:
                parse_unit(unit)


def test_an_error_of_what_uses_a_curve_is_the_only_one(tmp_path: Path) -> None:
    (tmp_path / "moment.csv").write_text("0, 0\n1, 2\n")
    for old, new in (
        ("rate_curve: rate}", "rate_curve: rate, colour: 3}"),
        ("curve, a", "kurve, a"),
    ):
        assert old in BY_USE
        (tmp_path / "deck.yaml").write_text(BY_USE.replace(old, new, 1))
        with pytest.raises(DeckErrors) as caught:
            read_deck(tmp_path / "deck.yaml")
        assert len(caught.value.errors) == 1
