"""Writes frames as a film: mp4 with imageio-ffmpeg, gif with Pillow."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from crashpost.errors import PostError
from crashpost.results.whole_file import whole_file

ENDINGS = (".mp4", ".gif")


def write_film(path: Path, frames: Iterator[np.ndarray], fps: float, size: tuple[int, int]) -> None:
    """Write frames (height, width, 3) one by one; raises PostError."""
    with whole_file(path) as partial:
        if path.suffix == ".gif":
            _write_gif(partial, frames, fps)
        else:
            _write_mp4(partial, frames, fps, size)


def can_write_mp4() -> bool:
    """Whether there is an encoder that can be called."""
    try:
        check_encoder()
    except PostError:
        return False
    return True


def check_encoder() -> None:
    """Raises PostError without imageio-ffmpeg or the program that it calls."""
    from shutil import which

    try:
        import imageio_ffmpeg

        program = imageio_ffmpeg.get_ffmpeg_exe()
        if which(program) is None:
            raise RuntimeError(f"there is no program '{program}'")
    except (ImportError, RuntimeError) as error:
        advice = "install imageio-ffmpeg anew, or write a .gif"
        raise PostError(f"an mp4 needs an encoder that works: {error}; {advice}") from None


def _write_mp4(path: Path, frames: Iterator[np.ndarray], fps: float, size: tuple[int, int]) -> None:
    check_encoder()
    import imageio_ffmpeg

    # what a file cannot be made for is known here, and lost in the encoder
    path.touch()
    # yuv420p plays in every browser; 0 (best) to 51: 26 is a quarter of a megabyte for 4 s
    writer = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=fps,
        codec="libx264",
        macro_block_size=2,
        output_params=["-crf", "26", "-preset", "fast", "-movflags", "+faststart"],
        ffmpeg_log_level="error",
    )
    writer.send(None)
    count = 0
    try:
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
            count += 1
        writer.close()
        # the encoder reports nothing when it fails, as on a full disk
        if imageio_ffmpeg.count_frames_and_secs(str(path))[0] == count:
            return
    except (OSError, RuntimeError):
        # both with the commands of the encoder, and without its reason
        pass
    finally:
        writer.close()
    raise OSError(
        f"the encoder failed after {count} frames; is there room on the disk and in memory?"
    )


def _write_gif(path: Path, frames: Iterator[np.ndarray], fps: float) -> None:
    from PIL import Image

    few = (Image.fromarray(f).quantize(96, dither=Image.Dither.NONE) for f in frames)
    first = next(few)
    # gif counts hundredths of a second
    duration = max(10 * round(100.0 / fps), 20)
    first.save(path, save_all=True, append_images=few, duration=duration, loop=0, optimize=False)
