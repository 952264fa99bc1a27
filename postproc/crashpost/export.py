"""Histories as comma-separated values, one row per sample, for other programs."""

import csv
from collections.abc import Sequence
from pathlib import Path

from crashpost.errors import PostError
from crashpost.result import Channel, Result


def export_csv(result: Result, path: Path, patterns: Sequence[str]) -> int:
    """Write time and all channels that fit a pattern, exactly; returns the number of channels."""
    channels = _chosen(result, patterns)
    columns = [result.series(channel.name).values.tolist() for channel in channels]
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time [s]", *(f"{c.name} [{c.unit or '-'}]" for c in channels)])
            writer.writerows(zip(result.time.tolist(), *columns, strict=True))
    except OSError as error:
        raise PostError(f"{path}: {error.strerror}") from error
    return len(channels)


def _chosen(result: Result, patterns: Sequence[str]) -> list[Channel]:
    """Channels in the order of the patterns, each once; raises PostError for an idle pattern."""
    chosen: dict[str, Channel] = {}
    for pattern in patterns:
        fitting = list(result.channels(pattern))
        if not fitting:
            raise PostError(f"no channel fits '{pattern}'; see `crashpost channels`")
        chosen |= {channel.name: channel for channel in fitting}
    return list(chosen.values())
