"""One run in a results folder at a time.

The kernel of the system keeps the lock for the process that holds it, and releases it when that
process ends, however it ends. The file stays: to remove it would let two runs lock two files of one
name.
"""

import fcntl
import os
from contextlib import suppress
from pathlib import Path
from typing import Self

from crashsolve.output.errors import OutputError
from crashsolve.output.files import reported

NAME = "run.lock"


class Lock:
    """Holds a results folder until the end of its block, or that of the process.

    Several may hold a shared lock, as the tasks of one sweep do; none beside one that is not.

    Raises OutputError while another run has it, or when the file cannot be made.
    `warning` is set where the file system has no locks.
    """

    def __init__(self, folder: Path, is_shared: bool = False) -> None:
        self.warning = ""
        kind = fcntl.LOCK_SH if is_shared else fcntl.LOCK_EX
        path = folder / NAME
        with reported(path):
            # to be written, as NFS asks of exclusive locks; never a pipe that waits, nor a link
            flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK
            self._descriptor = os.open(path, flags, 0o666)
        try:
            fcntl.flock(self._descriptor, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.read(self._descriptor, 200).decode(errors="replace").strip()
            os.close(self._descriptor)
            stated = f"another run writes to this folder ({owner})"
            advice = "stop it, wait for its end, or name another folder with -o"
            raise OutputError(folder, f"{stated}; {advice}") from None
        except OSError as error:
            self.warning = f"{path} cannot be locked ({error.strerror}): start no other run here"
        with suppress(OSError):
            owner = f"process {os.getpid()} on {os.uname().nodename}\n"
            os.ftruncate(self._descriptor, 0)
            os.pwrite(self._descriptor, owner.encode(), 0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._descriptor)


def is_held(folder: Path) -> bool:
    """Whether a run holds this folder, found without waiting; only where none is about to
    start.
    """
    try:
        descriptor = os.open(folder / NAME, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return False
    except BlockingIOError:
        return True
    except OSError:
        # a file system without locks cannot say
        return False
    finally:
        os.close(descriptor)
