"""Many questions about one result in one call, for programs: JSON in, JSON out.

    asked     [{channel, statistic, during, unit}, ...]      during and unit may be absent
    answered  [{value, unit}, ...], in the same order; {problem} where there is no answer, and with
              {remark} where a time was asked for at which there is no sample

The statistic `path` asks for the whole history and is answered by {time, value, unit}, both lists.
"""

import json
from pathlib import Path

import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.results.answer import answer
from crashpost.results.result import Result
from crashpost.results.status import Json
from crashsolve.channels.display import factor
from crashsolve.channels.series import Window, covered

PATH = "path"
FIELDS = ("channel", "statistic", "during", "unit")


def answers(result: Result, questions: Path) -> list[Json]:
    """The answers to the questions in a file; raises PostError when the file is none."""
    try:
        requested = json.loads(questions.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise PostError(f"{questions}: {error}") from error
    if not isinstance(requested, list) or not all(isinstance(entry, dict) for entry in requested):
        raise PostError(f"{questions}: must be a list of tables")
    return [_answer(result, entry) for entry in requested]


def _unit(requested: Json) -> str:
    """The requested unit; "" for that of the channel. Raises PostError."""
    unit = requested.get("unit") or ""
    if not isinstance(unit, str):
        raise PostError(f"unit must be a text such as 'mm', not {json.dumps(unit)}")
    return unit


def _window(requested: Json) -> Window | None:
    """The times asked for [s]; None for the whole run. Raises PostError."""
    ends = requested.get("during")
    if ends is None or ends == []:
        return None
    if not isinstance(ends, list) or len(ends) != 2 or not all(map(_is_number, ends)):
        raise PostError(f"during must be two times in seconds, not {json.dumps(ends)}")
    return float(ends[0]), float(ends[1])


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _answer(result: Result, requested: Json) -> Json:
    try:
        for name in requested:
            if name not in FIELDS:
                raise unknown("field", name, FIELDS)
        channel, word = str(requested["channel"]), str(requested["statistic"])
        during = _window(requested)
        if word == PATH:
            time, values, unit = covered(result.series(channel), during)
            wanted = _unit(requested) or unit
            if not np.isfinite(values).all():
                raise PostError("division by zero at some of its samples")
            return {
                "time": time.tolist(),
                "value": (values * factor(unit, wanted)).tolist(),
                "unit": wanted,
            }
        reply = answer(result, channel, word, during, _unit(requested))
        remark = {"remark": reply.remark} if reply.remark else {}
        return {"value": reply.value, "unit": reply.unit, **remark}
    except KeyError as error:
        return {"problem": f"{error} is missing"}
    except (PostError, TypeError, ValueError, LookupError, OverflowError) as error:
        return {"problem": str(error)}
