"""Channels in words: "Buffers: contact force" for rcforc.buffers.normal.

A name that no table has is shown as it is, an expression with the names of its channels.
"""

import re
from collections.abc import Sequence

NAME = r"[a-z]+\.[^.\s()*/+']+\.\w+(?:\.\w+)?"
# quantities of all families; where a family has its own word, "family quantity"
QUANTITIES = {
    "rcforc normal": "contact force",
    "rcforc force": "contact force",
    "rcforc tangential": "friction force",
    "rcforc depth": "penetration",
    "rcforc peak_depth": "largest penetration so far",
    "rcforc peak_normal": "largest contact force so far",
    "rcforc impulse": "contact impulse",
    "rcforc touching": "touching pairs",
    "jntforc force": "joint force",
    "jntforc moment": "joint moment",
    "deforc rate": "rate of elongation",
    "glstat step": "time step",
    "glstat mechanical": "mechanical energy",
    "glstat balance": "energy balance",
    "matsum strain": "elastic energy",
    "matsum plastic": "plastic work",
    "matsum deleted": "deleted elements",
}
# quantities of which energies are reported by their last word
ENERGIES = {"stored": "energy stored in", "dissipated": "energy dissipated in"}
TURNING = ("moment", "angular", "torque", "angle", "rotation")
FUNCTIONS = {
    "hic": "HIC",
    "si": "Severity Index",
    "cfc": "CFC",
    "clip": "clip",
    "envelope": "envelope",
    "resultant": "resultant",
    "norm": "resultant",
    "integral": "integral",
    "derivative": "derivative",
}


def is_name(channel: str) -> bool:
    """Whether the text is a channel name rather than arithmetic."""
    return re.fullmatch(NAME, channel) is not None


def quantity(channel: str) -> str:
    """Quantity of a channel in words: contact force along x."""
    family, _, column = channel.split(".", 2)
    first, _, component = column.partition(".")
    if family == "glstat" and first == "energy":
        return _energy(component)
    words = QUANTITIES.get(f"{family} {first}", first.replace("_", " "))
    return words + _direction(first, component)


def _energy(word: str) -> str:
    """Energies in words: spring_stored is the energy stored in springs."""
    prefix, _, kind = word.rpartition("_")
    if kind in ENERGIES and prefix:
        return f"{ENERGIES[kind]} {prefix.replace('_', ' ')}s".replace("frictions", "friction")
    words = word.replace("_", " ")
    return words if words.endswith(("work", "energy")) else f"{words} energy"


def _direction(first: str, component: str) -> str:
    if component in ("x", "y", "z") and first != "quaternion":
        return f" about {component}" if first.startswith(TURNING) else f" along {component}"
    return f" {component.replace('_', ' ')}" if component else ""


def entity(channel: str) -> str:
    """Whose channel it is, as a title begins; "" for the whole model."""
    family, name, _ = channel.split(".", 2)
    return "" if (family, name) == ("glstat", "model") else capital(name.replace("_", " "))


def capital(text: str) -> str:
    """The text with a capital first letter."""
    return text[:1].upper() + text[1:]


def title(channels: Sequence[str]) -> str:
    """A title for a figure of these channels."""
    if len(channels) == 1:
        return _one(channels[0])
    if not all(map(is_name, channels)):
        return "; ".join(map(_one, channels)) if len(channels) < 3 else ""
    entities = list(dict.fromkeys(map(entity, channels)))
    quantities = list(dict.fromkeys(map(quantity, channels)))
    shared = quantity_of_all(channels)
    what = shared or ", ".join(quantities[:3]) + (", ..." if len(quantities) > 3 else "")
    if len(entities) == 1:
        return f"{entities[0]}: {what}" if entities[0] else capital(what)
    return capital(what)


def quantity_of_all(channels: Sequence[str]) -> str:
    """The quantity that all channels share, in words, directions that differ left out; or ""."""
    if not channels or not all(map(is_name, channels)):
        return ""
    whole = {quantity(channel) for channel in channels}
    if len(whole) == 1:
        return whole.pop()
    parts = [channel.split(".", 2) for channel in channels]
    firsts = {(family, column.partition(".")[0]) for family, _, column in parts}
    if len(firsts) > 1:
        return ""
    family, first = firsts.pop()
    return "energy" if first == "energy" else quantity(f"{family}.x.{first}")


def _one(channel: str) -> str:
    """A single channel or expression."""
    if is_name(channel):
        whose = entity(channel)
        return f"{whose}: {quantity(channel)}" if whose else capital(quantity(channel))
    bare = channel.strip()
    gap = re.fullmatch(r"-\s*'?(rcforc\.[^.']+\.depth)'?", bare)
    if gap:
        return f"{entity(gap[1])}: gap"
    call = re.fullmatch(r"(\w+)\((.*)\)", bare, re.DOTALL)
    if call and call[1] in FUNCTIONS and _is_closed(call[2]):
        return _call(call[1], call[2])
    return re.sub(rf"'({NAME})'|({NAME})", lambda m: _one(m[1] or m[2]), bare)


def _call(function: str, inside: str) -> str:
    """A function of a channel: "Head: acceleration along x, CFC 180"."""
    arguments = _arguments(inside)
    numbers = [word.strip("'\" ") for word in arguments[1:] if not re.search(NAME, word)]
    channels = [word for word in arguments if re.search(NAME, word)]
    same = title(channels) if all(map(is_name, channels)) else ""
    what = same or ", ".join(map(_one, channels))
    return f"{what}, {FUNCTIONS[function]}" + "".join(f" {number}" for number in numbers)


def _arguments(inside: str) -> list[str]:
    """The arguments of a call, cut at commas outside of brackets and quotes."""
    arguments, depth, start, quoted = list[str](), 0, 0, ""
    for at, letter in enumerate(inside):
        if quoted:
            quoted = "" if letter == quoted else quoted
        elif letter in "'\"":
            quoted = letter
        elif letter == "," and not depth:
            arguments.append(inside[start:at].strip())
            start = at + 1
        depth += (letter == "(") - (letter == ")")
    return [*arguments, inside[start:].strip()]


def _is_closed(inside: str) -> bool:
    """Whether a bracket opened before the text is open to its end: no `f(a) + g(b)`."""
    depth = 0
    for letter in inside:
        depth += (letter == "(") - (letter == ")")
        if depth < 0:
            return False
    return True


def labels(channels: Sequence[str]) -> list[str]:
    """Short names that distinguish the channels: the words in which they differ."""
    words = [channel.split(".") for channel in channels]
    if len(words) < 2 or len({len(w) for w in words}) > 1 or not all(map(is_name, channels)):
        return list(channels)
    differing = [len(set(column)) > 1 for column in zip(*words, strict=True)]
    short = [[w for w, differs in zip(row, differing, strict=True) if differs] for row in words]
    return [
        " ".join(row).replace("_", " ") or name for row, name in zip(short, channels, strict=True)
    ]


def legend(channels: Sequence[str]) -> list[str]:
    """Labels for legends: a single channel and expressions in words."""
    short = labels(channels)
    return [
        _one(channel) if name == channel else name
        for name, channel in zip(short, channels, strict=True)
    ]
