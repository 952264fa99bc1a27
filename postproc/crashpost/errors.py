"""Message of crashpost for a request that it cannot fulfil: one kind of error for all requests."""

from crashsolve.channels.errors import ChannelError as PostError
from crashsolve.channels.errors import unknown

__all__ = ["PostError", "unknown"]
