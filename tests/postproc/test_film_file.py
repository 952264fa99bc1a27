"""Claim: a film that cannot be encoded is an error of one line, and leaves no file."""

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from crashpost.errors import PostError
from crashpost.renders.film_file import can_write_mp4, write_film


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
    # a report then has a gif
    assert not can_write_mp4()


def test_an_encoder_that_is_no_program_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "none"))
    assert not can_write_mp4()
    with pytest.raises(PostError, match="there is no program"):
        write_film(tmp_path / "film.mp4", iter([]), 25.0, (64, 64))


def test_a_film_that_does_not_reach_the_disk_is_an_error(tmp_path: Path) -> None:
    """The encoder dies at the limit of a file's size, as on a full disk, and reports nothing."""
    pytest.importorskip("imageio_ffmpeg")
    code = (
        "import resource, sys\nimport numpy as np\nfrom pathlib import Path\n"
        "from crashpost.renders.film_file import write_film\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "noise = np.random.default_rng(1)\n"
        "frames = (noise.integers(0, 255, (64, 64, 3), np.uint8) for _ in range(50))\n"
        "write_film(Path(sys.argv[1]), frames, 25.0, (64, 64))\n"
    )
    command = [sys.executable, "-c", code, str(tmp_path / "film.mp4")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1 and "the encoder failed after" in done.stderr
    assert not list(tmp_path.iterdir())
    with pytest.raises(PostError, match="No such file"):
        write_film(tmp_path / "none" / "film.mp4", iter([]), 25.0, (64, 64))
