"""Many questions about one result in one call, for programs: JSON in, JSON out.

    asked     [{channel, statistic, during, unit}, ...]      during and unit may be absent
    answered  [{value, unit}, ...], in the same order; {problem} where there is no answer

The statistic `path` asks for the whole history and is answered by {time, value, unit}, both lists.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from crashpost.errors import PostError
from crashpost.result import Result
from crashpost.statistic import statistic, unit_of, within
from crashpost.units import factor

PATH = "path"


def answers(result: Result, questions: Path) -> list[dict[str, Any]]:
    """The answers to the questions in a file; raises PostError when the file is none."""
    try:
        asked = json.loads(questions.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise PostError(f"{questions}: {error}") from error
    if not isinstance(asked, list) or not all(isinstance(entry, dict) for entry in asked):
        raise PostError(f"{questions}: must be a list of tables")
    return [answer(result, entry) for entry in asked]


def answer(result: Result, asked: dict[str, Any]) -> dict[str, Any]:
    """The answer to one question: {value, unit}, with times for a path, or {problem}."""
    try:
        series, word = result.series(str(asked["channel"])), str(asked["statistic"])
        during = (
            (float(asked["during"][0]), float(asked["during"][1])) if asked.get("during") else None
        )
        if word == PATH:
            time, values, unit = within(series, during) if during else series
            wanted = asked.get("unit") or unit
            if not np.isfinite(values).all():
                raise PostError("division by zero at some of its samples")
            return {
                "time": time.tolist(),
                "value": (values * factor(unit, wanted)).tolist(),
                "unit": wanted,
            }
        unit = unit_of(word, series.unit)
        wanted = asked.get("unit") or unit
        value = statistic(series, word, during) * factor(unit, wanted)
        return {"value": value, "unit": wanted}
    except KeyError as error:
        return {"problem": f"{error} is missing"}
    except (PostError, TypeError, ValueError, LookupError, OverflowError) as error:
        return {"problem": str(error)}
