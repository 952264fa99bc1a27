"""Claim: an expression gives the number that arithmetic says, and runs no code."""

import math

import pytest

from crashsolve.deck.reading.expressions import MAX_LENGTH, Expression, ExpressionError

NAMES = {"speed": 54.0, "n": 3.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("speed/3.6", 15.0),
        ("2 + 3*4", 14.0),
        ("(2 + 3)*4", 20.0),
        ("-n**2", -9.0),
        ("2**-1", 0.5),
        ("+n - -n", 6.0),
        ("7/2", 3.5),
        ("sin(pi/6)", 0.5),
        ("cos(rad(60))", 0.5),
        ("deg(pi)", 180.0),
        ("atan2(1, -1)", 0.75 * math.pi),
        ("tan(atan(2)) + asin(1) - acos(0)", 2.0),
        ("sqrt(16) + exp(0) + log(1)", 5.0),
        ("abs(-3) + min(1, 2) + max(1, 2, 3)", 7.0),
        ("within(n, 3, 4) + within(-1, -1, -1)", 2.0),
        ("1e3", 1000.0),
        (" n ", 3.0),
    ],
)
def test_value(text: str, value: float) -> None:
    assert Expression(text).value(NAMES) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "n.real",
        "n[0]",
        "[n]",
        "(n, n)",
        "'text'",
        "True",
        "1j",
        "lambda: 1",
        "n if n else 1",
        "n and 1",
        "n < 1",
        "n % 2",
        "n // 2",
        "n | 1",
        "~n",
        "not n",
        "sin",
        "sin(x=1)",
        "sin(*n)",
        "(sin)(1)(2)",
        "(n := 3)",
        "f'{n}'",
        "",
        "1 +",
        "1; 2",
        "n = 3",
        "\0",
        "(" * 300 + "1" + ")" * 300,
        "sin()",
        "sin(1, 2)",
        "min()",
        "abs('x')",
        "1" * (MAX_LENGTH + 1),
        "1e999",
        "1e308*10",
        "9**9**9**9",
        "0**-1",
        "(-1)**0.5",
        "log(0)",
        "exp(1e6)",
        "within(n, 3.1, 4)",
        "within(n, 0, 2.9)",
        "within(n, 4, 2)",
        "within(n, 1)",
    ],
)
def test_all_else_is_refused(text: str) -> None:
    with pytest.raises(ExpressionError):
        Expression(text).value(NAMES)


def test_names_are_those_to_be_given() -> None:
    assert Expression("sin(b)*pi + a*sqrt(a)").names == ["a", "b"]
