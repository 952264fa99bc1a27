"""Which bodies belong together by their names."""

import itertools


def part_of(name: str, parts: list[str]) -> int | None:
    """Number of the part of which a body is a node by its name; None of other bodies."""
    owners = [k for k, part in enumerate(parts) if name.startswith(f"{part}_")]
    return max(owners, key=lambda k: len(parts[k]), default=None)


def groups(names: list[str]) -> list[int]:
    """For each body the shortest other whose name it begins with: A_bogie_1 belongs to A."""
    positions = {name: k for k, name in enumerate(names)}
    owners = []
    for k, name in enumerate(names):
        words = name.split("_")
        heads = ("_".join(words[:n]) for n in range(1, len(words)))
        owners.append(next((positions[head] for head in heads if positions.get(head)), k))
    return owners


def labels(names: list[str], most: int) -> list[str]:
    """Label of each name where only `most` are possible: the name, or the common words of a group.

    wheel_left and wheel_right become wheel. Where no first words make so few groups, neighbours in
    the order of the deck share one: body1 to body3, pallet_1 to 3.
    """
    if len(set(names)) <= most:
        return list(names)
    words = [name.split("_") for name in names]
    for count in range(1, max(map(len, words))):
        heads = ["_".join(own[:count]) for own in words]
        if 1 < len(set(heads)) <= most:
            members: dict[str, list[list[str]]] = {}
            for head, own in zip(heads, words, strict=True):
                members.setdefault(head, []).append(own)
            return [_shared(members[head]) for head in heads]
    return _neighbours(list(dict.fromkeys(names)), names, most)


def _neighbours(unique: list[str], names: list[str], most: int) -> list[str]:
    """Label of each name: the first and the last of as many neighbours as share one."""
    size = -(-len(unique) // most)
    shared = {}
    for first in range(0, len(unique), size):
        own = unique[first : first + size]
        same = f"{_shared([own[0].split('_'), own[-1].split('_')])}_"
        label = own[0] if len(own) == 1 else f"{own[0]} to {own[-1].removeprefix(same)}"
        shared |= dict.fromkeys(own, label)
    return [shared[name] for name in names]


def _shared(words: list[list[str]]) -> str:
    """The first words that all have."""
    same = itertools.takewhile(lambda own: len(set(own)) == 1, zip(*words, strict=False))
    return "_".join(own[0] for own in same)
