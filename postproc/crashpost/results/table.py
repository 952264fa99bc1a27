"""Aligned text tables for the terminal."""

from collections.abc import Sequence


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns padded to their widest cell; columns of numbers are set to the right."""
    columns = list(zip(*rows, strict=True)) or [()] * len(header)
    widths = [max(map(len, (head, *cells))) for head, cells in zip(header, columns, strict=True)]
    right = [all(map(_is_number, cells)) for cells in columns]
    lines = [header, ["-" * width for width in widths], *rows]
    return "\n".join(_line(cells, widths, right) for cells in lines)


def number(value: float) -> str:
    """A value for people: five digits, no trailing zeros, no negative zero."""
    return f"{value + 0.0:.5g}"


def _is_number(cell: str) -> bool:
    try:
        return cell == "-" or float(cell.removesuffix("%")) is not None
    except ValueError:
        return False


def _line(cells: Sequence[str], widths: Sequence[int], right: Sequence[bool]) -> str:
    padded = [
        cell.rjust(width) if to_right else cell.ljust(width)
        for cell, width, to_right in zip(cells, widths, right, strict=True)
    ]
    return "  ".join(padded).rstrip()
