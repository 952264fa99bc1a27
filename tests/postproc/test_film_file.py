"""Claim: a film that cannot be encoded is an error of one line, and leaves no file."""

import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from crashpost.errors import PostError
from crashpost.renders.film_file import write_film


def test_an_encoder_that_does_not_work_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The package is there, and its program is not."""
    broken = ModuleType("imageio_ffmpeg")

    def no_program() -> str:
        raise RuntimeError("No ffmpeg exe could be found.")

    monkeypatch.setattr(broken, "get_ffmpeg_exe", no_program, raising=False)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", broken)
    frames = iter([np.zeros((64, 64, 3), np.uint8)] * 2)
    with pytest.raises(PostError, match=r"needs an encoder that works.*write a \.gif"):
        write_film(tmp_path / "film.mp4", frames, 25.0, (64, 64))
    assert not list(tmp_path.iterdir())
