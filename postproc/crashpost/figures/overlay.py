"""Names of overlaid results: the differences between their decks.

The values of `--set` and of sweeps are parameters, which results keep; those that follow from
others are left out. Where the rest does not distinguish the results, all parameters do, or other
numbers and words of their decks, and else the names of their folders.
"""

from collections.abc import Sequence

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.results.status import Json
from crashpost.results.text import printable

# of a legend: more differences are shown by folders
MAX_DIFFERENCES = 3
# fields of decks that change no physics
INEFFECTIVE = ("title", "output", "expect", "watch", "parameters")


def names(results: Sequence[Result]) -> list[str]:
    """A name for each result, all different."""
    if len(results) == 1:
        return [results[0].title]
    stated = [_stated(result) for result in results]
    with_units = [result.stored_json("parameters_with_units", dict) or {} for result in results]
    for values in (stated, [_parameters(result) for result in results], _decks(results)):
        differing = _differing(values)
        descriptions = [
            _description(own, texts, differing, values)
            for own, texts in zip(values, with_units, strict=True)
        ]
        if 0 < len(differing) <= MAX_DIFFERENCES and len(set(descriptions)) == len(descriptions):
            return descriptions
    folders = [_folder(result) for result in results]
    if len(set(folders)) < len(folders):
        folders = [printable(str(result.folder)) for result in results]
    return folders


def different_fields(results: Sequence[Result]) -> list[str]:
    """Positions of numbers and words that change physics and in which decks differ, parameters
    replaced by their values; raises PostError for a broken deck.
    """
    return [printable(path) for path in _differing(_decks(results))]


def _folder(result: Result) -> str:
    return printable(result.folder.resolve().name.removesuffix(".results"))


def _parameters(result: Result) -> Json:
    return result.stored_json("parameters", dict) or {}


def _stated(result: Result) -> Json:
    """The parameters without those that follow from others."""
    derived = result.stored_json("derived_parameters", list) or []
    return {name: v for name, v in _parameters(result).items() if name not in derived}


def _decks(results: Sequence[Result]) -> list[Json]:
    """Every number and word of the decks by its position; raises PostError for a broken deck."""
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    leaves_of_runs = []
    for result in results:
        try:
            tree = yaml.load(result.deck_text, Loader=loader) or {}
        except (yaml.YAMLError, RecursionError, ValueError) as error:
            raise PostError(f"{result.file}: the stored deck cannot be read ({error})") from error
        leaves: Json = {}
        if isinstance(tree, dict):
            _collect(
                {key: part for key, part in tree.items() if key not in INEFFECTIVE}, "", leaves
            )
        leaves_of_runs.append(leaves)
    return leaves_of_runs


def _collect(part: dict[str, object] | list[object], path: str, leaves: Json) -> None:
    pairs = part.items() if isinstance(part, dict) else enumerate(part, start=1)
    for key, inner in pairs:
        where = f"{path}.{key}" if path else str(key)
        if isinstance(inner, dict | list):
            _collect(inner, where, leaves)
        else:
            leaves[where] = inner


def _differing(values: Sequence[Json]) -> list[str]:
    """The paths at which not all have the same."""
    positions = dict.fromkeys(path for own in values for path in own)
    return [p for p in positions if any(own.get(p) != values[0].get(p) for own in values)]


def _description(own: Json, texts: Json, positions: Sequence[str], values: Sequence[Json]) -> str:
    """Names and values; those that were given with a unit as they were."""
    shown = [
        printable(str(texts[path]))
        if path in texts
        else _shown(own.get(path), [other.get(path) for other in values])
        for path in positions
    ]
    return ", ".join(
        f"{printable(path)} {text}" for path, text in zip(positions, shown, strict=True)
    )


def _shown(value: object, among: Sequence[object]) -> str:
    """A value with as many digits as distinguish it from the others; - where a deck has none."""
    if isinstance(value, float):
        for digits in (5, 9, 17):
            if len({f"{v:.{digits}g}" for v in set(among) if isinstance(v, float)}) == len(
                {v for v in among if isinstance(v, float)}
            ):
                return f"{value:.{digits}g}"
    return "-" if value is None else printable(str(value))
