"""Claim: every law has a stub with the columns of its rows, as its records declare them."""

from crashsolve.stubs import PACKAGE, SHARED_PATH, laws, shared_stub, stub


def test_stubs_are_those_of_the_records() -> None:
    stale = [
        str(path.relative_to(PACKAGE))
        for path, law in laws()
        if not path.is_file() or path.read_text("utf-8") != stub(law)
    ]
    assert not stale, f"make docs: {stale}"
    assert SHARED_PATH.read_text("utf-8") == shared_stub(), "make docs"


def test_no_stub_is_left_of_a_law_that_is_gone() -> None:
    assert {*PACKAGE.rglob("_rows/*")} == {path for path, _ in laws()}
