"""Units: reading, products, conversion."""

import pytest

from crashpost.errors import PostError
from crashsolve.channels.display import Product, factor, measure_the_same, readable


@pytest.mark.parametrize(
    ("source", "wanted", "expected"),
    [
        ("m/s", "km/h", 3.6),
        ("m", "mm", 1e3),
        ("N", "kN", 1e-3),
        ("N", "tf", 1 / 9806.65),
        ("N", "t", 1 / 9806.65),
        ("kg", "t", 1e-3),
        ("rad/s", "rpm", 9.549296585513721),
        ("m/s^2", "g0", 1 / 9.80665),
        ("N m", "kJ", 1e-3),
        ("N s/m", "kg/s", 1.0),
        ("N/m^1.5", "kN/mm^1.5", 1e-3 * 1e-3**1.5),
        ("", "%", 100.0),
        ("kg m/s", "N s", 1.0),
    ],
)
def test_conversion_has_the_textbook_factor(source: str, wanted: str, expected: float) -> None:
    assert factor(source, wanted) == pytest.approx(expected, rel=1e-15)


def test_different_dimensions_are_refused() -> None:
    with pytest.raises(PostError, match="they measure different things"):
        factor("N", "mm")


@pytest.mark.parametrize("text", ["furlong", "m^", "5", "N//m"])
def test_unreadable_units_are_refused(text: str) -> None:
    with pytest.raises(PostError, match="unit"):
        factor("m", text)


def test_an_unknown_unit_is_shown_as_it_is_and_like_none_other() -> None:
    assert factor("furlong", "furlong") == 1.0
    assert not measure_the_same("furlong", "m")
    assert measure_the_same("N s", "kg m/s") and not measure_the_same("J", "N")


def test_an_acceleration_in_g_and_a_force_in_t_are_what_people_mean() -> None:
    assert factor("m/s^2", "g") == pytest.approx(1 / 9.80665)
    assert factor("kg", "g") == pytest.approx(1e3)


def test_products_cancel_and_print_in_the_notation_of_the_result_files() -> None:
    work = Product.parse("N/m").times(Product.parse("m")).times(Product.parse("m"))
    assert str(work) == "N m"
    assert str(work.times(Product.parse("s"), -1)) == "N m/s"
    assert str(Product.parse("1/s")) == "1/s"
    assert str(Product.parse("m").times(Product.parse("m"), -1)) == ""


@pytest.mark.parametrize(
    ("unit", "largest", "expected"),
    [
        ("N", 2.5e6, "MN"),
        ("N", 12.0, "N"),
        ("m", 0.22, "mm"),
        ("s", 3.0, "s"),
        ("s", 0.3, "ms"),
        ("J", 0.0, "J"),
        ("kg m/s", 1e6, "kg m/s"),
        ("N s", 9e5, "kN s"),
        ("N", float("nan"), "N"),
    ],
)
def test_readable_unit_fits_the_largest_value(unit: str, largest: float, expected: str) -> None:
    assert readable(unit, largest) == expected
