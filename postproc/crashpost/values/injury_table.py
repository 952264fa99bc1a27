"""All measures of injury of a result in one table, with their errors by the samples."""

from collections.abc import Mapping

from crashpost.results.result import Result
from crashpost.values import injury, occupant_injury
from crashpost.values.injury_measure import HEADER, USUAL, rows


def table(result: Result, units: Mapping[str, str] = USUAL) -> list[list[str]]:
    """The measures as text, under injury_measure.HEADER, SI units shown in `units`; none without a
    role or before there are samples.
    """
    if len(result.time) < 2:
        return []
    return rows(result, lambda one: injury.measures(one) + occupant_injury.measures(one), units)


def notes(table_rows: list[list[str]]) -> list[str]:
    """What a reader must know of the errors and limits of a table; none of an empty one."""
    texts = ["The error is that of the interval of samples: the measure of every second one."]
    if any(row[HEADER.index("limit")] for row in table_rows):
        texts.append("Limits are those for a 50th percentile man, whatever the occupant's size.")
    return texts if table_rows else []
