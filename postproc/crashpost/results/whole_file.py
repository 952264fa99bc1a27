"""Files that are there whole or not at all, also where a disk is full."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from crashpost.errors import PostError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Where to write a file, which takes its name at the end; raises PostError.

    What is no plain file, as a pipe or /dev/null, is written to as it is.
    """
    target = path.resolve()
    is_plain = target.is_file() or not target.exists()
    partial = target.with_name(f".{target.stem}.partial{target.suffix}") if is_plain else target
    try:
        yield partial
        if is_plain:
            partial.replace(target)
    except OSError as error:
        raise PostError(f"{path}: {error.strerror or error}") from error
    finally:
        if is_plain:
            partial.unlink(missing_ok=True)


def write_html(path: Path, text: str) -> None:
    """Write a page of HTML; raises PostError."""
    with whole_file(path) as partial:
        partial.write_text(text, encoding="utf-8", errors="xmlcharrefreplace")
