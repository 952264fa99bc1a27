"""Channels as ISO/TS 13499 (ISO-MME) has them: a header file, an index, a text file per channel.

    NAME.mme    Channel/NAME.chn    Channel/NAME.001 ...

Channels of a simulation have no position in the standard's list of codes: those that are not known
are written `?`, and the names of crashpost stand beside them. Histories of unequal intervals refer
to a channel of their times.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.results.table import number
from crashpost.values import injury
from crashsolve.channels.display import measure_the_same
from crashsolve.channels.series import Series

EDITION = "1.6"
NO_VALUE = "NOVALUE"
# letters of a channel code before its dimension
SLOT = 12
# the standard counts files with three digits
MAX_CHANNELS = 999
# [of the mean interval] samples are as even as this, or their times are written
EVEN = 1e-6
# physical dimension of the channel code, by a unit of its kind
DIMENSIONS = {
    "m": "DS",
    "m/s": "VE",
    "m/s^2": "AC",
    "rad": "AN",
    "rad/s": "AV",
    "rad/s^2": "AA",
    "N": "FO",
    "N m": "MO",
    "s": "TI",
}
DIRECTIONS = {"x": "X", "y": "Y", "z": "Z", "resultant": "R"}


def write_mme(result: Result, path: Path, series: dict[str, Series]) -> None:
    """The files of a test named as `path`, NAME.mme; raises PostError."""
    times = {} if _is_even(result.time) else {"time": Series(result.time, result.time, "s")}
    channels = {**times, **series}
    if len(channels) > MAX_CHANNELS:
        raise PostError(f"{len(channels)} channels; ISO-MME counts to {MAX_CHANNELS}: name fewer")
    positions = _positions(result)
    folder = path.parent / "Channel"
    try:
        folder.mkdir(exist_ok=True)
        rows = [("Number of channels", str(len(channels)))]
        for serial, (name, one) in enumerate(channels.items(), start=1):
            own = code(name, one.unit, positions.get(name.split(".")[1] if "." in name else "", ""))
            rows.append((f"Name of channel {serial:03d}", f"{own} / {name}"))
            lines = [*_head(name, one, own, is_even=not times), *map(repr, one.values.tolist())]
            _write(folder / f"{path.stem}.{serial:03d}", lines)
        # channels of an earlier and longer export would pass for some of this one
        for serial in range(len(channels) + 1, MAX_CHANNELS + 1):
            (folder / f"{path.stem}.{serial:03d}").unlink(missing_ok=True)
        _write(folder / f"{path.stem}.chn", _lines(rows))
        _write(path, _lines(_test(result, path.stem)))
    except OSError as error:
        raise PostError(f"{error.filename or path}: {error.strerror}") from error


def code(name: str, unit: str, position: str = "") -> str:
    """The channel code of 16 characters: test object 1, dimension, direction, no filter.

    `position` are the first 12 letters, test object to fine location 3, where the deck gives them.
    """
    dimension = next((d for u, d in DIMENSIONS.items() if _is_of(unit, u)), "??")
    last = name.rsplit(".", 1)[-1]
    return f"{position or '1' + '?' * 11}{dimension}{DIRECTIONS.get(last, '0')}0"


def _positions(result: Result) -> dict[str, str]:
    """The codes of positions that sensors have in the deck, by the sensors' names."""
    return {
        name: str(card["mme"])
        for name, card in injury.sensors(result).items()
        if len(str(card.get("mme") or "")) == SLOT
    }


def _is_of(unit: str, kind: str) -> bool:
    # an angle would pass for a pure number, which is no dimension of the list
    same = measure_the_same(unit, kind) and (("rad" in kind) == ("rad" in unit or "deg" in unit))
    # a moment and an energy have one dimension
    return same and (kind != "N m" or unit == "N m")


def _is_even(time: np.ndarray) -> bool:
    steps = np.diff(time)
    return len(steps) > 0 and bool(np.ptp(steps) <= EVEN * np.mean(steps))


def _test(result: Result, name: str) -> list[tuple[str, str]]:
    return [
        ("Data format edition number", EDITION),
        ("Laboratory name", NO_VALUE),
        ("Customer name", NO_VALUE),
        ("Title", result.title),
        ("Test reference number", name),
        ("Type of the test", "Simulation"),
        ("Date of the test", str(result.attributes.get("started", NO_VALUE))[:10]),
        ("Number of test objects", "1"),
        ("Name of test object 1", result.title),
    ]


def _head(name: str, one: Series, own: str, *, is_even: bool) -> list[str]:
    """The descriptors above the values of a channel."""
    least, greatest = int(np.argmin(one.values)), int(np.argmax(one.values))
    interval = (one.time[-1] - one.time[0]) / max(len(one.time) - 1, 1)
    implicit = is_even or name == "time"
    return _lines(
        [
            ("Test object number", "1"),
            ("Name of the channel", name),
            ("Laboratory channel code", NO_VALUE),
            ("Customer channel code", NO_VALUE),
            ("Channel code", own),
            ("Unit", one.unit or "1"),
            ("Reference system", NO_VALUE),
            ("Pre-filter type", NO_VALUE),
            ("Cut off frequency", NO_VALUE),
            ("Channel amplitude class", NO_VALUE),
            ("Reference channel", "implicit" if implicit else "explicit"),
            ("Reference channel name", NO_VALUE if implicit else code("time", "s")),
            ("Sampling interval", repr(float(interval)) if is_even else NO_VALUE),
            ("Bit resolution", NO_VALUE),
            ("Time of first sample", repr(float(one.time[0]))),
            ("Number of samples", str(len(one.time))),
            ("First global maximum value", number(one.values[greatest])),
            ("Time of maximum value", number(one.time[greatest])),
            ("First global minimum value", number(one.values[least])),
            ("Time of minimum value", number(one.time[least])),
        ]
    )


def _lines(rows: Sequence[tuple[str, str]]) -> list[str]:
    return [f"{name:<28}:{text}" for name, text in rows]


def _write(path: Path, lines: Sequence[str]) -> None:
    # the standard's letters are those of ISO 8859-1
    path.write_text("\n".join(lines) + "\n", encoding="latin-1", errors="replace")
