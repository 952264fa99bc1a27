"""The folder of compiled code, which no other user can write, and the files in it, each with a
checksum.

The files here are executed. So every folder on the path to it must belong to this user or to root,
and others must not be able to write it, unless it is sticky as /tmp is. A file counts only with the
checksum of its name and content: a damaged one is as good as absent, and made anew. The folder is
named after a hash of every source file of the package and of the version of llvmlite, so that no
other sources, and no other compiler, can have made it.
"""

import errno
import fcntl
import grp
import hashlib
import os
import pwd
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import llvmlite

from crashsolve.foundation.errors import CrashsolveError, ExitCode
from crashsolve.foundation.sources import source_files

CHOSEN = "CRASHSOLVE_CACHE"
PACKAGE = Path(__file__).resolve().parent.parent
# messages about the folder, for the log
notes: list[str] = []


class CacheError(CrashsolveError):
    """Compiled code cannot be kept where it should be."""

    exit_code = ExitCode.OUTPUT


@cache
def cache_folder() -> Path:
    """Folder for composed steps and compiled code of exactly these sources. Raises CacheError."""
    # another compiler makes other code of the same sources
    digest, root = hashlib.sha256(llvmlite.__version__.encode()), str(PACKAGE)
    for path in source_files(root):
        digest.update(path[len(root) + 1 :].encode())
        # a run reads them all: an object of Python for each would take a quarter longer
        file = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        while part := os.read(file, 1 << 15):
            digest.update(part)
        os.close(file)
    return find_folder(digest.hexdigest()[:16])


def find_folder(name: str) -> Path:
    """A folder of this name that only this user can write: `CRASHSOLVE_CACHE`, home or temporary.

    Raises: CacheError where others can write to `CRASHSOLVE_CACHE`, or this user cannot.
    """
    given = os.environ.get(CHOSEN)
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    # a compute node may have a home that cannot be written
    temporary = Path(tempfile.gettempdir()).absolute()
    for root in (Path(given or f"{home}/crashsolve"), temporary / f"crashsolve-{os.geteuid()}"):
        folder = root.absolute() / name
        try:
            # before anything is made there, and what lies in it already
            refuse_foreign(root.absolute())
            make_private(folder)
            refuse_foreign(folder)
        except CacheError as reason:
            if given:
                raise
            notes.append(f"{reason}; compiled code is kept elsewhere")
            continue
        except OSError as reason:
            if given:
                raise _unfit(root, reason.strerror or str(reason)) from reason
            continue
        if _is_writable(folder):
            return folder
        if given:
            raise _unfit(root, "it cannot be written")
    return _passing_folder(name)


def _unfit(root: Path, reason: str) -> CacheError:
    """The error for a cache folder, chosen by the user, that cannot be used."""
    advice = "name a folder of your own that can be written, or unset it"
    return CacheError(f"{CHOSEN}={root}: compiled code cannot be there: {reason}; {advice}")


def make_private(folder: Path) -> None:
    """Make a folder and those above it, for this user alone. Raises OSError."""
    for path in (*reversed(folder.parents), folder):
        with suppress(FileExistsError):
            if not path.exists():
                path.mkdir(0o700)


def refuse_foreign(folder: Path) -> None:
    """Raise CacheError where another user could change files of the folder."""
    for path in _between_marks(folder):
        try:
            info = os.lstat(path)
        except OSError:
            continue
        # in a namespace of users, root may have another number
        if info.st_uid not in (0, os.geteuid(), os.stat("/").st_uid):
            raise CacheError(
                f"compiled code cannot be in {folder}: {path} belongs to another user; "
                f"set {CHOSEN} to a folder of your own"
            )
        if not stat.S_ISLNK(info.st_mode) and _others_write(info):
            advice = f"chmod go-w {path}, or set {CHOSEN} to a folder of your own"
            message = f"compiled code cannot be in {folder}: others can write to {path}"
            raise CacheError(f"{message}; {advice}")


def _between_marks(folder: Path) -> Iterator[Path]:
    """The folder and all above it, links as they are written and where they lead."""
    for path in dict.fromkeys((folder, Path(os.path.realpath(folder)))):
        yield path
        yield from path.parents


def _others_write(info: os.stat_result) -> bool:
    """Whether others can replace files of a folder; in a sticky one they cannot."""
    if info.st_mode & stat.S_ISVTX:
        return False
    by_group = info.st_mode & stat.S_IWGRP and not _is_own_group(info.st_gid)
    return bool(info.st_mode & stat.S_IWOTH or by_group)


def _is_own_group(number: int) -> bool:
    """Whether a group is the one that many systems make for every user, without other members."""
    try:
        user, group = pwd.getpwuid(os.geteuid()), grp.getgrgid(number)
    except KeyError:
        return False
    is_users = user.pw_gid == number and user.pw_name == group.gr_name
    return is_users and set(group.gr_mem) <= {user.pw_name}


def _is_writable(folder: Path) -> bool:
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _passing_folder(name: str) -> Path:
    """A folder for this run and the processes it starts; it goes with the run."""
    import atexit
    import shutil

    root = tempfile.mkdtemp(prefix="crashsolve-")
    atexit.register(shutil.rmtree, root, ignore_errors=True)
    os.environ[CHOSEN] = root
    notes.append(
        f"no folder was found that can keep compiled code for the next run: set {CHOSEN} to one "
        "of your own"
    )
    folder = Path(root) / name
    make_private(folder)
    return folder


def write_sealed(path: Path, content: bytes, sync: bool = True) -> None:
    """Write a file with its checksum, as `write_whole` does. Raises CacheError."""
    write_whole(path, _seal(path, content) + b"\n" + content, sync)


def read_sealed(path: Path) -> bytes | None:
    """Content of a file of this user with its checksum; None for one absent, damaged or foreign."""
    sealed = read_own(path)
    seal, _, content = (sealed or b"").partition(b"\n")
    return content if sealed and seal == _seal(path, content) else None


def _seal(path: Path, content: bytes) -> bytes:
    digest = hashlib.blake2b(path.name.encode() + b"\n" + content, digest_size=20)
    return digest.hexdigest().encode()


def write_whole(path: Path, content: bytes, sync: bool = True) -> None:
    """Write a file under another name, wait for the disk, rename. Raises CacheError."""
    try:
        descriptor, partial = tempfile.mkstemp(dir=path.parent, prefix="partial.")
        try:
            with open(descriptor, "wb") as file:
                file.write(content)
                file.flush()
                if sync:
                    os.fsync(descriptor)
            os.replace(partial, path)
        except BaseException:
            Path(partial).unlink(missing_ok=True)
            raise
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else error
        raise CacheError(f"{path}: compiled code cannot be kept: {reason}") from error


def read_own(path: Path) -> bytes | None:
    """Bytes of a plain file that belongs to this user or root; None without one."""
    try:
        # neither a link nor a pipe that would wait for a writer
        flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
        with open(os.open(path, flags), "rb") as file:
            info = os.fstat(file.fileno())
            if not stat.S_ISREG(info.st_mode) or info.st_uid not in (0, os.geteuid()):
                return None
            return file.read()
    except OSError:
        return None


@contextmanager
def locked(path: Path) -> Iterator[int | None]:
    """Hold the exclusive lock of this file, waiting for it; None where files cannot be locked.

    The system takes it back from a process that has died. Raises: CacheError.
    """
    lock = path.with_name(f"{path.name}.lock")
    held = _held(lock)
    try:
        yield held
    finally:
        if held is not None:
            # waiting processes find that it is gone, and make another
            lock.unlink(missing_ok=True)
            os.close(held)


def free_lock(path: Path) -> int | None:
    """The exclusive lock of this file for another process; None where it is held, or cannot be."""
    try:
        return _held(path.with_name(f"{path.name}.lock"), fcntl.LOCK_NB)
    except CacheError:
        return None


def _held(lock: Path, how: int = 0) -> int | None:
    """A descriptor of a file that is locked, and still lies where it was made."""
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    while True:
        try:
            descriptor = os.open(lock, flags, 0o600)
        except OSError as error:
            raise CacheError(f"{lock}: compiled code cannot be kept: {error.strerror}") from error
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | how)
            if os.path.samestat(os.fstat(descriptor), os.stat(lock)):
                return descriptor
        except FileNotFoundError:
            pass
        except OSError as error:
            os.close(descriptor)
            if error.errno in (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP):
                return None
            raise CacheError(f"{lock}: cannot be locked: {error.strerror}") from error
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)
