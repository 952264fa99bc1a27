"""Histories as comma-separated values, one row per sample, for other programs."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crashpost.choice import channels
from crashpost.errors import PostError
from crashpost.result import Result


def export_csv(result: Result, path: Path, words: Sequence[str]) -> int:
    """Write time and all channels that the words name, exactly; returns their number.

    Raises PostError for a word that names none, and for an expression without a value somewhere.
    """
    names = channels(result, words)
    series = [result.series(name) for name in names]
    for name, one in zip(names, series, strict=True):
        if not np.isfinite(one.values).all():
            raise PostError(f"division by zero at some samples of '{name}'")
    columns = [one.values.tolist() for one in series]
    heads = [f"{name} [{one.unit or '-'}]" for name, one in zip(names, series, strict=True)]
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time [s]", *heads])
            writer.writerows(zip(result.time.tolist(), *columns, strict=True))
    except OSError as error:
        raise PostError(f"{path}: {error.strerror}") from error
    return len(names)
