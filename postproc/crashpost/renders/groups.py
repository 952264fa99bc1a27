"""Which bodies belong together by their names."""


def is_node(name: str, parts: list[str]) -> bool:
    """Whether a body is a node of a part by its name."""
    return any(name.startswith(f"{part}_") for part in parts)


def groups(names: list[str]) -> list[int]:
    """For each body the shortest other whose name it begins with: A_bogie_1 belongs to A."""
    positions = {name: k for k, name in enumerate(names)}
    found = []
    for k, name in enumerate(names):
        words = name.split("_")
        heads = ("_".join(words[:n]) for n in range(1, len(words)))
        found.append(next((positions[head] for head in heads if positions.get(head)), k))
    return found
