"""Claim: a file that cannot be written whole is an error, and is not there."""

from pathlib import Path

import pytest

from crashpost.errors import PostError
from crashpost.results.whole_file import whole_file, write_html


def test_what_fails_half_way_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text("before", "utf-8")
    with pytest.raises(PostError, match=r"x\.csv: No space left"), whole_file(path) as partial:
        partial.write_text("half", "utf-8")
        raise OSError(28, "No space left on device")
    assert path.read_text("utf-8") == "before"
    assert [one.name for one in tmp_path.iterdir()] == ["x.csv"]


def test_a_page_is_written_through_links_and_to_devices(tmp_path: Path) -> None:
    link, target = tmp_path / "link.html", tmp_path / "page.html"
    link.symlink_to(target)
    write_html(link, "page")
    assert link.is_symlink() and target.read_text("utf-8") == "page"
    write_html(Path("/dev/null"), "page")
    assert Path("/dev/null").is_char_device()
    with pytest.raises(PostError, match="No such file"):
        write_html(tmp_path / "none" / "x.html", "page")
