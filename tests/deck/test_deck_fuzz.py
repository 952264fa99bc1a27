"""Claim: a spoilt deck is read or refused, never met with a traceback, a hang or silence."""

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.foundation.errors import DeckErrors

TEXT = (Path(__file__).parent / "fuzzed.yaml").read_text("utf-8")
DATA: dict[str, object] = yaml.safe_load(TEXT)
Route = tuple[str | int, ...]
SPOIL = settings(
    max_examples=100,
    deadline=3000,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
# keywords under which the first words are names that the user is free to choose
NAMED = {"parameters", "curves", "bodies", "joints", "springs", "surfaces", "contacts", "loads"}


def routes(value: Any, route: Route = ()) -> Iterator[Route]:
    """Paths of all values of the deck."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value)
    for step, part in pairs:
        yield (*route, step)
        if isinstance(part, dict | list):
            yield from routes(part, (*route, step))


ROUTES = list(routes(DATA))
WORDS = [
    route
    for route in ROUTES
    if isinstance(route[-1], str) and not (len(route) == 2 and route[0] in NAMED)
]
VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=12),
    st.sampled_from([[], {}, [[]], [1, 2], {"type": "linear"}, 10**350, -1, 0, "ground", "front"]),
    st.sampled_from(["${", "${}", "${count}", "${1/0}", "${half} mm", "1 m", "-3 kN/mm", "type"]),
)


def outcome(folder: Path, text: str) -> Deck | str:
    """The deck that a text holds, or the messages that refuse it."""
    path = folder / "deck.yaml"
    path.write_bytes(text.encode("utf-8", "replace"))
    try:
        return read_deck(path)
    except DeckErrors as errors:
        assert errors.errors
        return str(errors)


def holder(data: Any, route: Route) -> Any:
    """The table or list in which the value at the end of a route stands."""
    for step in route[:-1]:
        data = data[step]
    return data


def renamed(route: Route, word: str) -> str:
    """The deck with one word replaced, in its location."""
    data = copy.deepcopy(DATA)
    table = holder(data, route)
    pairs = [(word if key == route[-1] else key, value) for key, value in table.items()]
    table.clear()
    table.update(pairs)
    return yaml.safe_dump(data, sort_keys=False)


def test_the_deck_to_be_spoilt_is_sound(tmp_path: Path) -> None:
    assert isinstance(outcome(tmp_path, TEXT), Deck)
    assert isinstance(outcome(tmp_path, yaml.safe_dump(DATA)), Deck)


@pytest.mark.parametrize("route", WORDS, ids=lambda route: ".".join(map(str, route)))
def test_an_unknown_word_is_named_wherever_it_stands(route: Route, tmp_path: Path) -> None:
    word = f"{route[-1]}x"
    message = outcome(tmp_path, renamed(route, word))
    assert isinstance(message, str)
    assert f"'{word}'" in message or route[-1] == "type"


@SPOIL
@given(route=st.sampled_from(WORDS), word=st.text(max_size=8))
def test_any_unknown_word_is_refused(route: Route, word: str, tmp_path: Path) -> None:
    known = {step for path in ROUTES for step in path if isinstance(step, str)}
    ended = outcome(tmp_path, renamed(route, word))
    assert isinstance(ended, str) or word in known or word in ("step_max", "title")


@SPOIL
@given(route=st.sampled_from(ROUTES), value=VALUES)
def test_a_value_of_any_kind_is_read_or_refused(
    route: Route, value: object, tmp_path: Path
) -> None:
    data = copy.deepcopy(DATA)
    holder(data, route)[route[-1]] = value
    outcome(tmp_path, yaml.safe_dump(data, sort_keys=False))


@SPOIL
@given(routes=st.lists(st.sampled_from(ROUTES), min_size=1, max_size=3))
def test_a_deck_with_parts_left_out_is_read_or_refused(routes: list[Route], tmp_path: Path) -> None:
    data = copy.deepcopy(DATA)
    for route in sorted(set(routes), key=lambda route: (len(route), str(route)), reverse=True):
        del holder(data, route)[route[-1]]
    outcome(tmp_path, yaml.safe_dump(data, sort_keys=False))


@SPOIL
@given(source=st.sampled_from(ROUTES), target=st.sampled_from(ROUTES))
def test_a_deck_with_a_part_elsewhere_is_read_or_refused(
    source: Route, target: Route, tmp_path: Path
) -> None:
    data = copy.deepcopy(DATA)
    holder(data, target)[target[-1]] = copy.deepcopy(holder(DATA, source)[source[-1]])
    outcome(tmp_path, yaml.safe_dump(data, sort_keys=False))


@SPOIL
@given(st.data())
def test_a_text_with_letters_changed_is_read_or_refused(
    tmp_path: Path, data: st.DataObject
) -> None:
    start = data.draw(st.integers(0, len(TEXT)))
    length = data.draw(st.integers(0, 6))
    letters = st.one_of(st.text(max_size=6), st.text("{}[]:,&*!|>'\"%@`#-?\n\t $0e", max_size=6))
    outcome(tmp_path, TEXT[:start] + data.draw(letters) + TEXT[start + length :])


@SPOIL
@given(first=st.integers(0, 60), count=st.integers(1, 6), to=st.integers(0, 60))
def test_a_text_with_lines_doubled_is_read_or_refused(
    first: int, count: int, to: int, tmp_path: Path
) -> None:
    lines = TEXT.splitlines(keepends=True)
    lines[to:to] = lines[first : first + count]
    outcome(tmp_path, "".join(lines))


@SPOIL
@given(st.one_of(st.text(max_size=200), st.binary(max_size=200)))
def test_any_text_or_bytes_are_refused(tmp_path: Path, content: str | bytes) -> None:
    if isinstance(content, str):
        assert isinstance(outcome(tmp_path, content), str)
        return
    path = tmp_path / "deck.yaml"
    path.write_bytes(content)
    with pytest.raises(DeckErrors):
        read_deck(path)
