"""Claim: what is found of many channels at once, in slabs, is what each channel says."""

from pathlib import Path

import numpy as np
import pytest

from crashpost.results import extremes
from crashpost.results.result import Result
from crashpost.values.events import events
from crashpost.values.summary import peaks


@pytest.mark.parametrize("size", [8, 200, 1 << 24])
def test_extremes_in_slabs_are_those_of_the_histories(
    size: int, cars: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Slabs of one sample, of some and of all; also the first sample where a value comes twice."""
    whole = [peak for peak in peaks(Result(cars))]
    reported = events(Result(cars))
    monkeypatch.setattr(extremes, "SLAB", size)
    result = Result(cars)
    assert [peak for peak in peaks(result)] == whole
    assert events(result) == reported
    for channel in result.channels():
        values = result.series(channel.name).values
        assert result.span(channel.name) == (values.min(), values.max())
    for peak in whole:
        time, values, _ = result.series(peak.channel)
        assert peak.least_time == time[np.argmin(values)]
        assert peak.greatest_time == time[np.argmax(values)]


def test_a_channel_is_known_by_its_whole_name_alone(cars: Path) -> None:
    result = Result(cars)
    names = [channel.name for channel in result.channels()]
    assert all(result.has(name) for name in names)
    assert not result.has("time") and not result.has("") and not result.has(names[0] + ".x")
    # a wildcard spans the dots
    ending = names[-1].rsplit(".", 1)[-1]
    assert names[-1] in [c.name for c in result.channels(f"*{ending}")]
