"""Which of many cases the quick suite takes: the others are run by `make long`."""

from collections.abc import Iterable
from typing import Any

import pytest


def first_quick(values: Iterable[Any], count: int = 1) -> list[Any]:
    """Cases of a test, all but the first `count` marked long."""
    params = [case if isinstance(case, type(pytest.param())) else _case(case) for case in values]
    late = [pytest.param(*c.values, id=c.id, marks=[*c.marks, pytest.mark.long]) for c in params]
    return [*params[:count], *late[count:]]


def _case(value: object) -> Any:
    """A case of one value or of several."""
    return pytest.param(*value) if isinstance(value, (tuple, list)) else pytest.param(value)
