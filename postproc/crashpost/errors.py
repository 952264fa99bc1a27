"""Message of crashpost for a request that it cannot fulfil: one kind of error for all requests."""

from resource import RLIM_INFINITY, RLIMIT_AS, getrlimit

from crashsolve.channels.errors import ChannelError as PostError
from crashsolve.channels.errors import unknown

__all__ = ["PostError", "memory_limit", "unknown"]


def memory_limit() -> str:
    """The limit of memory of this process in words; empty without one."""
    limit, _ = getrlimit(RLIMIT_AS)
    return (
        "" if limit == RLIM_INFINITY else f"memory is limited to {limit / 1e9:.3g} GB (ulimit -v)"
    )
