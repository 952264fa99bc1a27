"""What all tests have: scenes that a test builds itself are compiled by a process of the server."""

import forked
import pytest

from crashsolve.compiler import machine


@pytest.fixture(scope="session", autouse=True)
def compiler_of_the_server() -> None:
    """Compile without a start of Python for each scene."""
    machine._compile_apart = forked.compiled
